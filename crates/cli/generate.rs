//! `asperity generate`: a random rough surface.

use asperity_studies::settings::Document;
use asperity_studies::{
    GeneratePlan, check_height_map_ending, realisation_table, wrapped, write_surface,
};
use asperity_synthesis::DrawnRoughness;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::note_lines;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    let plan = GeneratePlan::new(document).map_err(refused)?;
    check_height_map_ending(&path).map_err(Failure::usage)?;
    check_outputs(&[&path], document)?;
    let clock = std::time::Instant::now();
    let field = plan.draw().map_err(refused)?;
    common.say(|| format!("drawn in {:.3} s", clock.elapsed().as_secs_f64()));
    let note = write_surface(&path, &field).map_err(|error| refused(error.into()))?;
    let roughness = DrawnRoughness::of(&field);
    let text = || {
        let table = realisation_table(&roughness);
        let notes = note_lines(note.iter().chain(&plan.notes));
        wrapped(&format!(
            "{}: {} x {} samples, periodic, seed {}, realisation {}\n{table}{notes}",
            path.display(),
            field.nx(),
            field.ny(),
            plan.config.run.seed,
            plan.config.generate.realisation,
        ))
    };
    results.print_file(common, || &roughness, text)?;
    Ok(End::Complete)
}
