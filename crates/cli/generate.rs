//! `asperity generate`: a random rough surface.

use asperity_io::HeightMapFormat;
use asperity_studies::GeneratePlan;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    let plan = GeneratePlan::new(document).map_err(refused)?;
    HeightMapFormat::of_output(&path).map_err(Failure::usage)?;
    check_outputs(&[&path], document)?;
    let surface = plan.write(&path, common).map_err(refused)?;
    results.print_file(common, || &surface.roughness, || surface.text())?;
    Ok(End::Complete)
}
