//! `asperity generate`: random rough surfaces.

use asperity_io::HeightMapFormat;
use asperity_studies::GeneratePlan;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::file_set::write_files;
use crate::output::print_json;
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
        results.print_file(common, || surface.roughness(), || surface.text(&path))?;
        return Ok(End::Complete);
    };
    refuse_file_name(&path, HeightMapFormat::from_path(&path).is_some())?;
    let mut found = Vec::new();
    let prints = !results.json && !common.quiet;
    write_files(
        &path,
        &names,
        document,
        !results.json,
        |after, file, place| {
            let surface = plan.write(after as u64, file, common).map_err(refused)?;
            let text = prints.then(|| surface.text(place));
            found.extend(results.json.then(|| surface.roughness()));
            Ok(text)
        },
    )?;
    if results.json {
        print_json(&found)?;
    }
    Ok(End::Complete)
}
