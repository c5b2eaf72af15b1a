//! `asperity verify`: explicit surfaces against the statistical models.

use asperity_experiment::{
    Count, MaterialKind, Number, PerAxis, Seconds, VerifyConfig, VerifyError, verify,
    verify_report, verify_summary, verify_table,
};
use asperity_io::{check_output_folder, read_text};

use crate::args::{Common, MaterialArgument, Verify};
use crate::failure::Failure;
use crate::input::{incident, is_mesh, material_kind, one_or_many, per_axis, refuse_surface};
use crate::interrupt;
use crate::output::{print, print_json, say};
use crate::progress::Bar;

pub(crate) fn run(command: &Verify, common: &Common) -> Result<(), Failure> {
    let mut config = match &command.config {
        Some(path) if is_mesh(path) => {
            return Err(Failure::usage(format!(
                "{} names a triangle mesh, but `asperity verify` draws its own surfaces and takes a configuration; `asperity trace` takes meshes",
                path.display()
            )));
        }
        Some(path) => {
            let text = read_text(path).map_err(Failure::failed)?;
            VerifyConfig::from_toml(&text)
                .map_err(|error| Failure::usage(format!("{}: {error}", path.display())))?
        }
        None => VerifyConfig::default(),
    };
    override_with_flags(&mut config, command)?;
    let refuse = |error: &dyn std::fmt::Display| match &command.config {
        Some(path) => Failure::usage(format!("{}: {error}", path.display())),
        None => Failure::usage(error),
    };
    // Everything is checked before a ray is traced; the folder is made when there are results.
    config.cases().map_err(|error| refuse(&error))?;
    config.run.ray_settings().map_err(|error| refuse(&error))?;
    config.check_surfaces().map_err(|error| match error {
        VerifyError::Synthesis(error) => refuse_surface(error),
        error => refuse(&error),
    })?;
    check_output_folder(&command.output).map_err(Failure::failed)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = verify(&config, &bar).map_err(|error| match error {
        VerifyError::Config(_) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    verify_report(&command.output, &outcome, &bar).map_err(Failure::failed)?;
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
fn override_with_flags(config: &mut VerifyConfig, command: &Verify) -> Result<(), Failure> {
    let surface = &mut config.surface;
    if let Some(tau) = command.tau {
        surface.tau = Number(tau);
    }
    surface.tau_y = command.tau_y.map(Number).or(surface.tau_y);
    surface.azimuth = command.azimuth.map_or(surface.azimuth, Number);
    if !command.smoothness.is_empty() {
        surface.smoothness = Some(one_or_many(&command.smoothness));
        surface.sigma = None;
    }
    if !command.sigma.is_empty() {
        surface.sigma = Some(one_or_many(&command.sigma));
        surface.smoothness = None;
    }
    if !command.size.is_empty() {
        surface.size = PerAxis::Each(per_axis(&command.size, "--size")?.map(Count));
    }
    if !command.spacing.is_empty() {
        surface.spacing = PerAxis::Each(per_axis(&command.spacing, "--spacing")?.map(Number));
    }
    surface.insist |= command.insist;

    let material = &mut config.material;
    if let Some(kind) = command.material {
        material.kind = material_kind(kind);
        // Indices of another material do not carry over.
        if kind == MaterialArgument::Mirror {
            material.eta = None;
        }
        if material.kind != MaterialKind::Conductor {
            material.kappa = None;
        }
    }
    if !command.eta.is_empty() {
        material.eta = Some(one_or_many(&command.eta));
    }
    if let Some(kappa) = command.kappa {
        material.kappa = Some(Number(kappa));
    }

    let light = &mut config.light;
    if !command.theta.is_empty() {
        light.theta = one_or_many(&command.theta);
    }
    if let Some(phi) = command.phi {
        light.phi = Number(phi);
    }
    if let Some(from) = command.from {
        light.from = incident(from);
    }

    let run = &mut config.run;
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
    run.seed = command.seed.unwrap_or(run.seed);
    run.bins = command.bins.unwrap_or(run.bins);
    run.accelerator = command.accelerator.unwrap_or(run.accelerator);
    run.estimator = command.estimator.unwrap_or(run.estimator);
    run.sampling = command.sampling.unwrap_or(run.sampling);
    run.in_plane_half_width = command
        .in_plane_half_width
        .map_or(run.in_plane_half_width, Number);
    run.side = command.side.unwrap_or(run.side);
    run.branching = command.branching.map_or(run.branching, Into::into);
    run.roulette = command.roulette.map_or(run.roulette, Number);
    run.max_order = command.max_order.unwrap_or(run.max_order);
    let compare = &mut config.compare;
    if let Some(models) = &command.models {
        let none = matches!(models.as_slice(), [one] if one == "none");
        compare.models = if none { Vec::new() } else { models.clone() };
    }
    compare.alpha = command.alpha.unwrap_or(compare.alpha);
    config.output.plots &= !command.no_plots;
    Ok(())
}
