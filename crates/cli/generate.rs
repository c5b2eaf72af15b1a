//! `asperity generate`: random rough surfaces.

use asperity_io::HeightMapFormat;
use asperity_studies::GeneratePlan;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::{print, print_json, result_folder};
use crate::output_files::{check_outputs, refuse_file_name};

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    let plan = GeneratePlan::new(document).map_err(refused)?;
    let Some(names) = plan.files() else {
        HeightMapFormat::of_output(&path).map_err(Failure::usage)?;
        check_outputs(&[&path], document)?;
        let surface = plan.write(0, &path, common).map_err(refused)?;
        results.print_file(common, || &surface.roughness, || surface.text())?;
        return Ok(End::Complete);
    };
    refuse_file_name(&path, HeightMapFormat::from_path(&path).is_some())?;
    let folder = result_folder(&path, document, &names)?;
    let mut found = Vec::new();
    for (after, name) in (0..).zip(&names) {
        let file = folder.claim(name).map_err(Failure::failed)?;
        let surface = plan.write(after, &file, common).map_err(refused)?;
        if !results.json && !common.quiet {
            print(&surface.text())?;
        }
        found.push(surface.roughness);
    }
    folder.finish(true).map_err(Failure::failed)?;
    if results.json {
        print_json(&found)?;
    }
    Ok(End::Complete)
}
