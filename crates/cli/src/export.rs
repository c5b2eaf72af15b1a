//! `asperity export`: results as a file of another program.

use asperity_studies::ExportConfig;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: ExportConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let output = results.required();
    check_outputs(&[&output], document)?;
    let exported = config.export(&output);
    let exported = exported.map_err(|error| Failure::new(error.is_usage(), error))?;
    exported.write(&output).map_err(Failure::failed)?;
    results.print_file(common, || exported.summary(), || exported.text(&output))?;
    Ok(End::Complete)
}
