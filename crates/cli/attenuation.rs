//! `asperity attenuation`: shadowing and masking on explicit surfaces.

use asperity_studies::{
    AttenuationConfig, AttenuationError, Count, Number, OneOrMany, PerAxis, attenuation,
    attenuation_report, attenuation_summary, attenuation_table,
};

use crate::args::{Attenuation, Common};
use crate::failure::Failure;
use crate::input::{one_or_many, per_axis, read_config, refuse_config, refuse_surface};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;

pub(crate) fn run(command: &Attenuation, common: &Common) -> Result<(), Failure> {
    let file = command.config.as_deref();
    let mut config = read_config(file, "attenuation", AttenuationConfig::from_toml)?;
    let alone = config.check().err().map(|error| error.to_string());
    override_with_flags(&mut config, command)?;
    // Everything is checked before a surface is drawn; the folder is made when there are results.
    config.check().map_err(|error| match error {
        AttenuationError::Synthesis(error) => refuse_surface(error),
        AttenuationError::Run(error) => Failure::failed(error),
        error => refuse_config(file, alone.as_deref(), &error),
    })?;
    let folder = match &command.output {
        Some(path) => Some(result_folder(
            path,
            "attenuation",
            &[file],
            &config.files(),
        )?),
        None => None,
    };

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = attenuation(&config, &bar).map_err(Failure::failed)?;
    if let Some(folder) = folder {
        attenuation_report(&folder, &outcome, &bar).map_err(Failure::failed)?;
        folder.finish().map_err(Failure::failed)?;
    }
    if interrupt::came() {
        say(&format!(
            "interrupted; results are of the {} surfaces that were finished",
            outcome.work.realisations
        ));
    }
    common.say(|| {
        let work = &outcome.work;
        format!(
            "{} surfaces of {} points by {} in {:.2} s",
            work.realisations, work.points, work.way, work.seconds
        )
    });
    if command.json {
        return print_json(&attenuation_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    let place = command.output.as_ref().map_or(String::new(), |folder| {
        format!("results in {}\n", folder.display())
    });
    print(&format!("{}{place}", attenuation_table(&outcome)))
}

/// Puts the values of flags in the place of those of the file.
fn override_with_flags(
    config: &mut AttenuationConfig,
    command: &Attenuation,
) -> Result<(), Failure> {
    let surface = &mut config.surface;
    if !command.sigma.is_empty() {
        surface.sigma = one_or_many(&command.sigma);
    }
    surface.tau = command.tau.map_or(surface.tau, Number);
    if !command.length.is_empty() {
        let length = per_axis(&command.length, "--length")?;
        surface.length = Some(PerAxis::Each(length.map(Number)));
        surface.size = None;
    }
    if !command.size.is_empty() {
        surface.size = Some(PerAxis::Each(per_axis(&command.size, "--size")?.map(Count)));
        surface.length = None;
    }
    if !command.spacing.is_empty() {
        surface.spacing = PerAxis::Each(per_axis(&command.spacing, "--spacing")?.map(Number));
    }
    surface.border = command.border.unwrap_or(surface.border);
    surface.insist |= command.insist;

    let (light, view) = (&mut config.light, &mut config.view);
    if !command.theta.is_empty() {
        light.theta = one_or_many(&command.theta);
    }
    light.phi = command.phi.map_or(light.phi, Number);
    if !command.view_theta.is_empty() {
        view.theta = one_or_many(&command.view_theta);
    }
    view.phi = command.view_phi.map_or(view.phi, Number);
    if command.view_phi.is_some() && view.theta == OneOrMany::One(Number(0.0)) {
        return Err(Failure::usage(
            "--view-phi: the eye is straight above, where no azimuth is told from another; give --view-theta too",
        ));
    }

    let run = &mut config.run;
    run.realisations = command.realisations.map_or(run.realisations, Count);
    run.seed = command.seed.unwrap_or(run.seed);
    run.way = command.way.unwrap_or(run.way);
    run.mirror &= !command.no_mirror;
    run.heights |= command.heights;
    run.demarcation |= command.demarcation;
    // What figures show by name may not be measured any more.
    if !command.sigma.is_empty() {
        config.output.models_at_sigma = None;
    }
    if !command.theta.is_empty() {
        config.output.over_sigma_at_theta = None;
    }
    config.output.plots &= !command.no_plots;
    Ok(())
}
