//! `asperity generate`: a random rough surface.

use asperity_simulate::{check_memory, short};
use asperity_studies::settings::Document;
use asperity_studies::{SurfaceConfig, realisation_table, wrapped};
use asperity_synthesis::{
    DrawnRoughness, FieldSynthesis, Resolution, SpectrumMismatch, SurfaceRecipe,
};
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
    let source_notes = read_surface_files(&mut settings.surface)?;
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
    let few_lengths = amplitude_note(&recipe, [nx, ny], surface.spacing());
    let planning = FieldSynthesis::planning_bytes(&recipe, shape);
    check_memory("planning these surfaces", planning).map_err(Failure::failed)?;
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

    let roughness = DrawnRoughness::of(&field);
    results.print_file(
        common,
        || &roughness,
        || {
            let table = realisation_table(&roughness);
            let missed = missed_note(synthesis.spectrum_mismatch());
            let notes: Vec<String> = source_notes.into_iter().chain(note).chain(missed).chain(few_lengths).collect();
            let note = note_lines(&notes);
            wrapped(&format!(
                "{}: {nx} x {ny} samples, periodic, seed {seed}, realisation {realisation}\n{table}{note}",
                path.display(),
            ))
        },
    )?;
    Ok(End::Complete)
}

/// Lengths of the amplitude along the side of a tile from which slopes of GGX come near their distribution.
const AMPLITUDE_LENGTHS: f64 = 16.0;

/// That a tile holds few amplitudes of GGX slopes, if it does, and how many samples hold enough.
fn amplitude_note(recipe: &SurfaceRecipe, samples: [u64; 2], spacing: [f64; 2]) -> Option<String> {
    let SurfaceRecipe::StudentSlopes(student) = recipe else {
        return None;
    };
    let lengths = recipe.axis_correlation_lengths();
    let held = [0, 1].map(|axis| {
        let side = samples[axis] as f64 * spacing[axis];
        side / (student.amplitude_ratio() * lengths[axis])
    });
    let [x, y] = held.map(short);
    // Sizes that were computed may lack a rounding
    let is_few = held
        .iter()
        .any(|held| *held < AMPLITUDE_LENGTHS * (1.0 - 1e-9));
    let enough = [0, 1].map(|axis| {
        let count = samples[axis] as f64 * (AMPLITUDE_LENGTHS / held[axis]).max(1.0);
        2 * (0.5 * count).ceil() as u64
    });
    is_few.then(|| {
        format!(
            "the tile holds {x} amplitude lengths along x and {y} along y: the steepest slopes of GGX come from few places, and many tiles miss them; --size {},{} holds {AMPLITUDE_LENGTHS} of each",
            enough[0], enough[1]
        )
    })
}

/// What heights of a distribution miss of the spectrum requested, if it is a half per cent of the slope variance or of the variance.
fn missed_note(mismatch: SpectrumMismatch) -> Option<String> {
    const TOLD: f64 = 0.005;
    let SpectrumMismatch {
        autocorrelation,
        slope_variance: [x, y],
    } = mismatch;
    (autocorrelation.max(x.abs()).max(y.abs()) > TOLD).then(|| {
        format!(
            "no Gaussian surface turns into these heights with this spectrum: the autocorrelation differs by up to {autocorrelation:.4} of the variance, and the slope variance by {:+.1} % along x and {:+.1} % along y",
            100.0 * x,
            100.0 * y
        )
    })
}
