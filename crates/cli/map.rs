//! `asperity map`: where each model is within tolerance.

use asperity_simulate::{StoppedBy, counted};
use asperity_studies::settings::Document;
use asperity_studies::{MapConfig, MapError, VerifyError, map, map_report, map_summary, map_table};

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::input::{refuse_config, refuse_simulation};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    document.check_required().map_err(Failure::usage)?;
    let refuse = |error: &dyn std::fmt::Display| refuse_config(document, error);
    let config: MapConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    // Everything is checked before a ray is traced.
    config.check().map_err(|error| match error {
        VerifyError::Simulate(error) => refuse_simulation(error),
        error => refuse(&error),
    })?;
    let names = config.files().map_err(|error| refuse(&error))?;
    let folder = result_folder(&path, "map", &[document.file()], &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = map(&config, &folder, &bar).map_err(|error| match error {
        MapError::Config(error) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    map_report(&folder, &outcome).map_err(Failure::failed)?;
    let is_complete = outcome.stopped_by.is_none();
    folder.finish(is_complete).map_err(Failure::failed)?;
    for note in &outcome.notes {
        say(&format!("note: {note}"));
    }
    common.say(|| {
        let (resumed, computed) = (outcome.resumed, outcome.computed);
        let resumed = counted(resumed as u64, "cell");
        format!("{resumed} from checkpoints, {computed} computed")
    });
    if let Some(stop) = outcome.stopped_by {
        let why = match stop {
            StoppedBy::Time => "the time is over",
            _ => "interrupted",
        };
        say(&format!(
            "{why}; {} of {} cells are finished and mapped, and the same command resumes",
            outcome.cells.len() - outcome.missing(),
            outcome.cells.len()
        ));
    }
    if results.json {
        return print_json(&map_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}\nresults in {}\n",
        map_table(&outcome),
        path.display()
    ))
}
