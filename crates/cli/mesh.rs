//! `asperity mesh`: a height map as triangles.

use asperity_io::MeshFormat;
use asperity_studies::MeshConfig;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::print;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config: MeshConfig = document.read().map_err(Failure::usage)?;
    let output = Results::of(document).map_err(Failure::usage)?.required();
    MeshFormat::of_output(&output).map_err(Failure::usage)?;
    check_outputs(&[&output], document)?;
    let surface = config.triangles(document, common).map_err(refused)?;
    surface.write(&output).map_err(Failure::failed)?;
    if !common.quiet {
        print(&surface.text(&output))?;
    }
    Ok(End::Complete)
}
