//! `asperity verify`: explicit surfaces against the statistical models.

use asperity_studies::{
    CompareConfig, Count, LightConfig, MaterialConfig, Number, OutputConfig, RunConfig, Seconds,
    SurfaceConfig, VerifyConfig, VerifyError, verify, verify_report, verify_summary, verify_table,
};

use crate::args::{Common, Verify};
use crate::failure::Failure;
use crate::input::{override_ensemble, override_rays, read_config, refuse_config, refuse_surface};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(command: &Verify, common: &Common) -> Result<(), Failure> {
    let mut config = read_config(command.config.as_deref(), "verify", VerifyConfig::from_toml)?;
    let alone = (config.cases().err().map(|error| error.to_string()))
        .or_else(|| Some(config.ray_settings().err()?.to_string()))
        .or_else(|| Some(config.check_surfaces().err()?.to_string()));
    let parts = (&mut config.surface, &mut config.material, &mut config.light);
    let efforts = (&mut config.run, &mut config.compare, &mut config.output);
    override_verification(parts, efforts, command)?;
    if let Some(file) = command.medium.bottom_file() {
        return Err(Failure::usage(format!(
            "--bottom-surface {}: surfaces are drawn here, and so is what lies below them; take flat, same or independent",
            file.display()
        )));
    }
    config.medium = command.medium.over(config.medium)?;
    if command.models.is_none() {
        config.choose_models();
    }
    let refuse = |error: &dyn std::fmt::Display| {
        refuse_config(command.config.as_deref(), alone.as_deref(), error)
    };
    // Everything is checked before a ray is traced; the folder is made when there are results.
    config.cases().map_err(|error| refuse(&error))?;
    config.ray_settings().map_err(|error| refuse(&error))?;
    config.check_surfaces().map_err(|error| match error {
        VerifyError::Synthesis(error) => refuse_surface(error),
        error => refuse(&error),
    })?;
    let names = config.files().map_err(|error| refuse(&error))?;
    let inputs = [command.config.as_deref()];
    let folder = result_folder(&command.output, "verify", &inputs, &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = verify(&config, &bar).map_err(|error| match error {
        VerifyError::Config(_) | VerifyError::Model(_) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    verify_report(&folder, &outcome, &bar).map_err(Failure::failed)?;
    folder.finish().map_err(Failure::failed)?;
    common.say(|| format!("{} cases in {:.1} s", outcome.cases.len(), outcome.seconds));
    if interrupt::came() {
        say("interrupted; the results so far are written");
    }
    if command.json {
        return print_json(&verify_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}results in {}\n",
        verify_table(&outcome),
        command.output.display()
    ))
}

/// Puts the values of flags in the place of those of the file.
pub(crate) fn override_verification(
    parts: (&mut SurfaceConfig, &mut MaterialConfig, &mut LightConfig),
    (run, compare, output): (&mut RunConfig, &mut CompareConfig, &mut OutputConfig),
    command: &Verify,
) -> Result<(), Failure> {
    override_ensemble(parts, &command.ensemble)?;
    if command.realisations.is_some() || command.rays.is_some() {
        // As many as are asked for, and not as a target of the file asks for.
        run.target_error = None;
        run.of = None;
    }
    run.target_error = command.target_error.map(Number).or(run.target_error);
    run.of = command.of.or(run.of);
    run.max_time = command.max_time.map(Seconds).or(run.max_time);
    run.realisations = command.realisations.map_or(run.realisations, Count);
    run.rays = command.rays.map_or(run.rays, Count);
    run.estimator = command.estimator.unwrap_or(run.estimator);
    override_rays(run, &command.followed);
    run.refine |= command.refine;
    if let Some(models) = &command.models {
        let none = matches!(models.as_slice(), [one] if one == "none");
        compare.models = if none { Vec::new() } else { models.clone() };
    }
    compare.alpha = command.alpha.unwrap_or(compare.alpha);
    compare.model_rays = command.model_rays.map_or(compare.model_rays, Count);
    output.plots &= !command.no_plots;
    Ok(())
}
