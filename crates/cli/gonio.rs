//! `asperity gonio`: the whole BRDF and BTDF.

use std::path::Path;

use asperity_io::SurfaceFormat;
use asperity_simulate::StoppedBy;
use asperity_studies::{
    Count, GonioConfig, GonioError, MeasuredConfig, Number, PerAxis, Sample, Seconds, VerifyError,
    gonio, gonio_report, gonio_summary, gonio_table,
};
use asperity_surface::HeightField;
use serde_json::json;

use crate::args::{Common, Gonio, Reading};
use crate::failure::Failure;
use crate::input::{
    incident, name_of, one_or_many, override_material, override_rays, override_surfaces, per_axis,
    read_config, read_mesh_surface, read_surface, refuse_config, refuse_surface,
};
use crate::interrupt;
use crate::output::{print, print_json, result_folder, say};
use crate::progress::Bar;
use crate::trace::{field_warnings, flat, mesh_warnings};

pub(crate) fn run(command: &Gonio, common: &Common) -> Result<(), Failure> {
    let file = command.config.as_deref();
    let mut config = read_config(file, "gonio", GonioConfig::from_toml)?;
    let alone = match config.measured.is_given() {
        // What a file of a surface makes wrong is known when it is read.
        true => None,
        false => config.check(None).err().map(|error| error.to_string()),
    };
    override_config(&mut config, command)?;
    let sample = read_sample(&config.measured, common)?;
    let sample = sample.as_ref();
    let refuse = |error: &dyn std::fmt::Display| refuse_config(file, alone.as_deref(), error);
    // Everything is checked before a ray is traced.
    config.check(sample).map_err(|error| match error {
        VerifyError::Synthesis(error) => refuse_surface(error),
        VerifyError::Run(error) => Failure::failed(error),
        error => refuse(&error),
    })?;
    let names = config.files(sample).map_err(|error| refuse(&error))?;
    let inputs = [file, config.measured.file.as_deref()];
    let folder = result_folder(&command.output, "gonio", &inputs, &names)?;

    let bar = Bar::new(common);
    interrupt::listen();
    let outcome = gonio(&config, sample, &folder, &bar).map_err(|error| match error {
        GonioError::Config(error) => refuse(&error),
        _ => Failure::failed(error),
    })?;
    gonio_report(&folder, &outcome).map_err(Failure::failed)?;
    folder.finish().map_err(Failure::failed)?;
    for note in &outcome.notes {
        say(&format!("note: {note}"));
    }
    common.say(|| {
        let (resumed, computed) = (outcome.resumed, outcome.computed);
        format!("{resumed} directions from checkpoints, {computed} computed")
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
    if command.json {
        return print_json(&gonio_summary(&outcome));
    }
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}\nresults in {}\n",
        gonio_table(&outcome),
        command.output.display()
    ))
}

/// Puts the values of flags in the place of those of the file.
fn override_config(config: &mut GonioConfig, flags: &Gonio) -> Result<(), Failure> {
    let random = flags.surfaces.shape_is_given();
    if flags.surface.is_some() || flags.flat {
        if random || flags.realisations.is_some() {
            return Err(Failure::usage(
                "--surface and --flat take the place of random surfaces: leave out --tau, --tau-y, --azimuth, --smoothness, --sigma, --size, --insist and --realisations",
            ));
        }
        config.surface = Default::default();
        config.measured = MeasuredConfig {
            file: flags.surface.clone(),
            flat: flags.flat,
            ..Default::default()
        };
    } else if random {
        config.measured = MeasuredConfig::default();
    }
    override_measured(&mut config.measured, flags)?;
    if !config.measured.is_given() {
        override_surfaces(&mut config.surface, &flags.surfaces)?;
    }

    override_material(&mut config.material, &flags.substance);
    if let Some(file) = flags.medium.bottom_file() {
        return Err(Failure::usage(format!(
            "--bottom-surface {}: what lies below is drawn here or flat; take flat, same or independent",
            file.display()
        )));
    }
    config.medium = flags.medium.over(config.medium.take())?;

    let light = &mut config.light;
    if !flags.theta.is_empty() || !flags.phi.is_empty() {
        light.directions = None;
    }
    if !flags.theta.is_empty() {
        light.theta = Some(one_or_many(&flags.theta));
    }
    if !flags.phi.is_empty() {
        light.phi = Some(one_or_many(&flags.phi));
    }
    if flags.directions.is_some() {
        (light.theta, light.phi, light.directions) = (None, None, flags.directions);
    }
    light.azimuth = flags.light_azimuth.map(Into::into).or(light.azimuth);
    light.from = flags.from.map_or(light.from, incident);

    let run = &mut config.run;
    run.realisations = flags.realisations.map_or(run.realisations, Count);
    run.rays = flags.rays.map_or(run.rays, Count);
    run.max_time = flags.max_time.map(Seconds).or(run.max_time);
    override_rays(run, &flags.followed);
    config.output.plots &= !flags.no_plots;
    Ok(())
}

fn override_measured(measured: &mut MeasuredConfig, flags: &Gonio) -> Result<(), Failure> {
    measured.border = flags.border.or(measured.border);
    measured.unit = flags.unit.or(measured.unit);
    measured.missing = flags.missing.unwrap_or(measured.missing);
    measured.remove = flags.remove.unwrap_or(measured.remove);
    if measured.is_given() && !flags.surfaces.spacing.is_empty() {
        let spacing = per_axis(&flags.surfaces.spacing, "--spacing")?.map(Number);
        measured.spacing = Some(PerAxis::Each(spacing));
    }
    Ok(())
}

/// Reads the given surface, if there is one.
fn read_sample(measured: &MeasuredConfig, common: &Common) -> Result<Option<Sample>, Failure> {
    if measured.flat {
        let field: HeightField = flat()?;
        let name = "flat surface".to_owned();
        return Ok(Some(Sample::of_field(field, name, json!(null), Vec::new())));
    }
    let Some(path) = &measured.file else {
        return Ok(None);
    };
    let path: &Path = path;
    let reading = Reading {
        border: measured.border,
        spacing: (measured.spacing).map_or(Vec::new(), |s| s.xy().map(|n| n.0).to_vec()),
        unit: measured.unit,
        missing: measured.missing,
        remove: measured.remove,
    };
    match SurfaceFormat::from_path(path).map_err(Failure::failed)? {
        SurfaceFormat::Mesh(_) => {
            let mesh = read_mesh_surface(path, &reading, common)?;
            let warnings = mesh_warnings(&mesh);
            Ok(Some(Sample::of_mesh(mesh, name_of(path), warnings)))
        }
        SurfaceFormat::HeightMap(_) => {
            let input = read_surface(path, &reading, common)?;
            let warnings = field_warnings(&input.field, input.notes);
            let read = json!({
                "points_filled": input.filled,
                "form_removed": reading.remove.to_string(),
                "generated": input.field.provenance(),
            });
            let sample = Sample::of_field(input.field, name_of(path), read, warnings);
            Ok(Some(sample))
        }
    }
}
