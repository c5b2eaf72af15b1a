//! `asperity generate`: a random rough surface.

use asperity_simulate::check_memory;
use asperity_studies::settings::Document;
use asperity_studies::{SurfaceConfig, realisation_table, wrapped};
use asperity_surface::{FieldSynthesis, Resolution, Roughness, Unreached};
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::input::{
    check_height_map_output, read_surface_files, refuse_config, refuse_surface, samples,
    write_surface,
};
use crate::output::note_lines;
use crate::output_files::check_outputs;

/// What is drawn.
#[derive(Deserialize)]
struct Settings {
    surface: SurfaceConfig,
    generate: HeightMap,
    run: Run,
}

/// The height map.
#[derive(Deserialize)]
struct HeightMap {
    realisation: u64,
}

/// The random numbers.
#[derive(Deserialize)]
struct Run {
    seed: u64,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut settings: Settings = document.read().map_err(Failure::usage)?;
    read_surface_files(&mut settings.surface)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let path = results.required();
    let surface = &settings.surface;
    let (_, recipe) = surface
        .recipe()
        .map_err(|error| refuse_config(document, &error))?;
    let [nx, ny] = surface.size();
    let shape = [samples(ny)?, samples(nx)?];
    let resolution = match surface.insist {
        true => Resolution::Any,
        false => Resolution::Facets,
    };
    let synthesis = FieldSynthesis::new(recipe, shape, surface.spacing(), resolution)
        .map_err(|error| refuse_surface(document.own_unit(), error))?;
    check_height_map_output(&path)?;
    check_outputs(&[&path], &[document.file()])?;
    check_memory("this surface", synthesis.peak_bytes()).map_err(Failure::failed)?;
    let clock = std::time::Instant::now();
    let (seed, realisation) = (settings.run.seed, settings.generate.realisation);
    let field = synthesis
        .draw(seed, realisation)
        .map_err(Failure::failed)?
        .with_unit(surface.unit);
    common.say(|| format!("drawn in {:.3} s", clock.elapsed().as_secs_f64()));
    let note = write_surface(&path, &field)?;

    let roughness = Roughness::of(&field);
    results.print_file(
        common,
        || &roughness,
        || {
            let table = realisation_table(&roughness);
            let missed = missed_note(synthesis.unreached());
            let notes: Vec<String> = note.into_iter().chain(missed).collect();
            let note = note_lines(&notes);
            wrapped(&format!(
                "{}: {nx} x {ny} samples, periodic, seed {seed}, realisation {realisation}\n{table}{note}",
                path.display(),
            ))
        },
    )?;
    Ok(End::Complete)
}

/// What heights of a distribution miss of the spectrum requested, if it is a half per cent of the slope variance or of the variance.
fn missed_note(unreached: Unreached) -> Option<String> {
    const TOLD: f64 = 0.005;
    let Unreached {
        autocorrelation,
        slope_variance: [x, y],
    } = unreached;
    (autocorrelation.max(x.abs()).max(y.abs()) > TOLD).then(|| {
        format!(
            "no Gaussian surface turns into these heights with this spectrum: the autocorrelation differs by up to {autocorrelation:.4} of the variance, and the slope variance by {:+.1} % along x and {:+.1} % along y",
            100.0 * x,
            100.0 * y
        )
    })
}
