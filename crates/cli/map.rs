//! `asperity map`: where each model holds.

use asperity_simulate::StoppedBy;
use asperity_studies::{
    MapConfig, MapError, Number, VerifyError, map, map_report, map_summary, map_table,
};

use crate::args::{Common, Map};
use crate::failure::Failure;
use crate::input::{read_config, refuse_config, refuse_surface};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;
use crate::verify::override_verification;

pub(crate) fn run(command: &Map, common: &Common) -> Result<(), Failure> {
    let of_verify = &command.verify;
    let file = of_verify.config.as_deref();
    let mut config = read_config(file, "map", MapConfig::from_toml)?;
    let alone = config.check().err().map(|error| error.to_string());
    let parts = (&mut config.surface, &mut config.material, &mut config.light);
    let efforts = (&mut config.run, &mut config.compare, &mut config.output);
    override_verification(parts, efforts, of_verify)?;
    if of_verify.medium.is_given() {
        return Err(Failure::usage(
            "a map is of models of surfaces alone, which know of no medium below",
        ));
    }
    let tolerances = &mut config.map;
    for (flag, tolerance) in [
        (
            command.tolerance_total_variation,
            &mut tolerances.total_variation,
        ),
        (command.tolerance_energy, &mut tolerances.energy),
        (command.tolerance_peak, &mut tolerances.peak),
    ] {
        *tolerance = flag.map_or(*tolerance, Number);
    }
    let refuse = |error: &dyn std::fmt::Display| refuse_config(file, alone.as_deref(), error);
    // Everything is checked before a ray is traced.
    config.check().map_err(|error| match error {
        VerifyError::Synthesis(error) => refuse_surface(error),
        VerifyError::Run(error) => Failure::failed(error),
        error => refuse(&error),
    })?;
    let names = config.files().map_err(|error| refuse(&error))?;
    let folder = result_folder(&of_verify.output, "map", &[file], &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = map(&config, &folder, &bar).map_err(|error| match error {
        MapError::Config(error) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    map_report(&folder, &outcome).map_err(Failure::failed)?;
    folder.finish().map_err(Failure::failed)?;
    for note in &outcome.notes {
        say(&format!("note: {note}"));
    }
    common.say(|| {
        let (resumed, computed) = (outcome.resumed, outcome.computed);
        format!("{resumed} cells from checkpoints, {computed} computed")
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
    if of_verify.json {
        return print_json(&map_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}\nresults in {}\n",
        map_table(&outcome),
        of_verify.output.display()
    ))
}
