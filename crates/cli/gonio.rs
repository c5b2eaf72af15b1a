//! `asperity gonio`: the whole BRDF and BTDF.

use asperity_simulate::{StoppedBy, counted};
use asperity_studies::settings::Document;
use asperity_studies::{
    GonioConfig, GonioError, MeasuredConfig, Sample, VerifyError, gonio, gonio_report,
    gonio_summary, gonio_table,
};
use serde_json::json;

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::given::{GivenShape, GivenSurface};
use crate::input::{refuse_config, refuse_simulation};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    document.check_required().map_err(Failure::usage)?;
    let refuse = |error: &dyn std::fmt::Display| refuse_config(document, error);
    let config: GonioConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    let sample = GivenSurface::of(&config.measured, common)?
        .map(|surface| sample(surface, &config.measured));
    let sample = sample.as_ref();
    // Everything is checked before a ray is traced.
    config.check(sample).map_err(|error| match error {
        VerifyError::Simulate(error) => refuse_simulation(error),
        error => refuse(&error),
    })?;
    let names = config.files(sample).map_err(|error| refuse(&error))?;
    let inputs = [document.file(), config.measured.file.as_deref()];
    let folder = result_folder(&path, "gonio", &inputs, &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = gonio(&config, sample, &folder, &bar).map_err(|error| match error {
        GonioError::Config(error) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    gonio_report(&folder, &outcome).map_err(Failure::failed)?;
    let is_complete = outcome.stopped_by.is_none();
    folder.finish(is_complete).map_err(Failure::failed)?;
    for note in &outcome.notes {
        say(&format!("note: {note}"));
    }
    common.say(|| {
        let (resumed, computed) = (outcome.resumed, outcome.computed);
        let resumed = counted(resumed as u64, "direction");
        format!("{resumed} from checkpoints, {computed} computed")
    });
    if let Some(stop) = outcome.stopped_by {
        let why = match stop {
            StoppedBy::Time => "the time is over",
            _ => "interrupted",
        };
        say(&format!(
            "{why}; {} of {} directions are finished, and the same command resumes",
            outcome.directions.len() - outcome.missing(),
            outcome.directions.len()
        ));
    }
    if results.json {
        return print_json(&gonio_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}\nresults in {}\n",
        gonio_table(&outcome),
        path.display()
    ))
}

/// A given surface as the measurement takes it.
fn sample(surface: GivenSurface, measured: &MeasuredConfig) -> Sample {
    let warnings = surface.warnings();
    let GivenSurface {
        shape,
        name,
        file,
        filled,
        ..
    } = surface;
    match (shape, file) {
        (GivenShape::Mesh(mesh), _) => Sample::of_mesh(mesh, name, warnings),
        (GivenShape::Field(field), None) => Sample::of_field(field, name, json!(null), Vec::new()),
        (GivenShape::Field(field), Some(_)) => {
            let read = json!({
                "points_filled": filled,
                "form_removed": measured.remove.to_string(),
                "generated": field.provenance(),
            });
            Sample::of_field(field, name, read, warnings)
        }
    }
}
