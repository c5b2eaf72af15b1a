//! `asperity converge`: run time against error.

use asperity_studies::{
    ConvergeConfig, ConvergeError, Count, Number, OneOrMany, VerifyError, converge,
    converge_report, converge_summary, converge_table,
};

use crate::args::{Common, Converge};
use crate::failure::Failure;
use crate::input::{one_or_many, override_ensemble, read_config, refuse_config, refuse_surface};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(command: &Converge, common: &Common) -> Result<(), Failure> {
    let file = command.config.as_deref();
    let mut config = read_config(file, "converge", ConvergeConfig::from_toml)?;
    let alone = config.check().err().map(|error| error.to_string());
    override_with_flags(&mut config, command)?;
    let refuse = |error: &dyn std::fmt::Display| refuse_config(file, alone.as_deref(), error);
    // Everything is checked before a ray is traced; the folder is made when there are results.
    config.check().map_err(|error| match error {
        ConvergeError::Run(VerifyError::Synthesis(error)) => refuse_surface(error),
        ConvergeError::Run(VerifyError::Run(error)) => Failure::failed(error),
        error => refuse(&error),
    })?;
    let names = config.files().map_err(Failure::failed)?;
    let folder = result_folder(&command.output, "converge", &[file], &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = converge(&config, &bar).map_err(Failure::failed)?;
    converge_report(&folder, &outcome, &bar).map_err(Failure::failed)?;
    folder.finish().map_err(Failure::failed)?;
    if interrupt::came() {
        say("interrupted; the cases that were finished are written");
    }
    common.say(|| format!("{} cases in {:.1} s", outcome.cases.len(), outcome.seconds));
    if command.json {
        return print_json(&converge_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}results in {}\n",
        converge_table(&outcome),
        command.output.display()
    ))
}

/// Puts the values of flags in the place of those of the file.
fn override_with_flags(config: &mut ConvergeConfig, command: &Converge) -> Result<(), Failure> {
    let of_all = (&mut config.surface, &mut config.material, &mut config.light);
    override_ensemble(of_all, &command.ensemble)?;
    let run = &mut config.converge;
    if !command.estimators.is_empty() {
        run.estimators = OneOrMany::Many(command.estimators.clone());
    }
    if !command.samplings.is_empty() {
        run.samplings = OneOrMany::Many(command.samplings.clone());
    }
    if !command.accelerators.is_empty() {
        run.accelerators = OneOrMany::Many(command.accelerators.clone());
    }
    if !command.spacings.is_empty() {
        run.spacings = Some(one_or_many(&command.spacings));
    }
    if !command.rays.is_empty() {
        run.rays = counts(&command.rays);
    }
    if !command.surfaces.is_empty() {
        run.surfaces = counts(&command.surfaces);
    }
    if !command.errors.is_empty() {
        run.errors = OneOrMany::Many(command.errors.iter().copied().map(Number).collect());
    }
    run.repeats = command.repeats.map_or(run.repeats, Count);
    run.reference_rays = command.reference_rays.map_or(run.reference_rays, Count);
    run.reference_surfaces = command
        .reference_surfaces
        .map_or(run.reference_surfaces, Count);
    run.seed = command.seed.unwrap_or(run.seed);
    run.bins = command.bins.unwrap_or(run.bins);
    run.side = command.side.unwrap_or(run.side);
    config.output.plots &= !command.no_plots;
    Ok(())
}

fn counts(values: &[u64]) -> OneOrMany<Count> {
    OneOrMany::Many(values.iter().copied().map(Count).collect())
}
