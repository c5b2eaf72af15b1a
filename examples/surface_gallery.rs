//! Draws the pictures of random surfaces and of structures in docs/reference/surfaces/: every spectrum, distribution and structure, shaded.
//!
//! The pictures are PNG files in the folder for temporary files. A height map that is named takes part by its spectrum and its heights.
//!
//! ```text
//! cargo run --release --example surface_gallery -- [measured.x3p]
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::path::Path;

use asperity_io::{read_height_map, write_bytes};
use asperity_plot::{Relief, Reliefs};
use asperity_studies::VerifyConfig;
use asperity_surface::{Border, HeightField, MissingPolicy};
use asperity_synthesis::{
    Erosion, Etch, FieldSynthesis, HeightTable, Psd, RadialTable, Resolution, Slip, SurfaceRecipe,
    TransformedHeights,
};

/// Samples a side.
const SIZE: usize = 192;

/// Random surfaces by keys of `[surface]`.
const RANDOM: [(&str, &str); 9] = [
    ("gaussian", "tau = 12\nsigma = 3"),
    (
        "exponential",
        "psd = 'exponential'\ncut_off = 6\ntau = 12\nsigma = 3",
    ),
    (
        "matern, nu 1.5",
        "psd = 'matern'\nnu = 1.5\ntau = 12\nsigma = 3",
    ),
    (
        "power-law, hurst 0.8",
        "psd = 'power-law'\nhurst = 0.8\nroll_off = 48\ncut_off = 6\nsigma = 3",
    ),
    (
        "two scales",
        "tau = 20\nsigma = 3\nsecond_tau = 4\nsecond_sigma = 0.4",
    ),
    (
        "tau-y 48, azimuth 20",
        "psd = 'matern'\nnu = 1.5\ntau = 6\ntau_y = 48\nazimuth = 20\nsigma = 3",
    ),
    (
        "skewness -1.2",
        "tau = 12\nsigma = 3\nskewness = -1.2\nkurtosis = 4.8",
    ),
    (
        "kurtosis 1.9",
        "tau = 12\nsigma = 3\nskewness = 0\nkurtosis = 1.9",
    ),
    (
        "slopes ggx",
        "tau = 6\nslopes = 'ggx'\nggx_alpha = 0.3\namplitude_ratio = 4",
    ),
];

const STRUCTURES: [(&str, &str); 10] = [
    (
        "pits",
        "structure = 'pits'\nwidth = 24\ndepth = 6\ndensity = 0.6",
    ),
    ("caps", "structure = 'caps'\nwidth = 24\ndepth = 6"),
    (
        "v-grooves, randomness 0.4",
        "structure = 'v-grooves'\nwidth = 24\ndepth = 6\nrandomness = 0.4",
    ),
    (
        "sine-grooves",
        "structure = 'sine-grooves'\nwidth = 24\ndepth = 6",
    ),
    (
        "blazed-grooves, azimuth 30°",
        "structure = 'blazed-grooves'\nwidth = 24\ndepth = 6\nazimuth = 30",
    ),
    (
        "scratches",
        "structure = 'scratches'\nwidth = 4\ndepth = 1\nscratch_length = 80\nspread = 10",
    ),
    ("cracks", "structure = 'cracks'\nwidth = 5\ndepth = 3"),
    (
        "pyramids",
        "structure = 'pyramids'\nwidth = 24\ndensity = 3\nrandomness = 0.5",
    ),
    (
        "inverted-pyramids",
        "structure = 'inverted-pyramids'\nwidth = 24",
    ),
    (
        "pits, sigma 0.3 on top",
        "structure = 'pits'\nwidth = 24\ndepth = 6\ndensity = 0.6\ntau = 5\nsigma = 0.3",
    ),
];

/// Angle of repose of the surface that slipped.
const REPOSE_DEG: f64 = 17.0;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let measured = std::env::args().nth(1).filter(|name| name.contains('.'));
    let mut random = Vec::new();
    for (caption, keys) in RANDOM {
        random.push(relief(caption, &drawn(keys)?));
    }
    for (caption, recipe) in tables()? {
        random.push(relief(caption, &of_recipe(recipe)?));
    }
    if let Some(file) = measured {
        let recipe = like(Path::new(&file))?;
        random.push(relief("like: a machined surface", &of_recipe(recipe)?));
    }
    draw("Random surfaces", "asperity_surfaces_random.png", random)?;

    let mut structures = Vec::new();
    for (caption, keys) in STRUCTURES {
        structures.push(relief(caption, &drawn(keys)?));
    }
    let rough = drawn("tau = 12\nsigma = 6")?;
    let etch = Erosion::Etch(Etch { depth: 8.0 }).of(&rough)?;
    structures.push(relief("gaussian, etch 8", &etch));
    let slip = Slip {
        slope: REPOSE_DEG.to_radians().tan(),
        steps: 200,
    };
    structures.push(relief(
        &format!("gaussian, repose {REPOSE_DEG}°"),
        &Erosion::Slip(slip).of(&rough)?,
    ));
    draw(
        "Structures and erosion",
        "asperity_surfaces_structures.png",
        structures,
    )
}

/// A surface of these keys of `[surface]`.
fn drawn(keys: &str) -> Result<HeightField, Box<dyn Error>> {
    let config =
        VerifyConfig::from_toml(&format!("[surface]\nsize = {SIZE}\nspacing = 1\n{keys}"))?;
    let (_, recipe) = config.surface.recipe()?;
    of_recipe(recipe)
}

fn of_recipe(recipe: SurfaceRecipe) -> Result<HeightField, Box<dyn Error>> {
    let synthesis = FieldSynthesis::new(recipe, [SIZE; 2], [1.0; 2], Resolution::Any)?;
    Ok(synthesis.draw(2, 0)?)
}

/// A spectrum and a distribution of heights that were measured elsewhere, as tables.
fn tables() -> Result<Vec<(&'static str, SurfaceRecipe)>, Box<dyn Error>> {
    // A band of waves from 8 to 12 samples long
    let band = RadialTable::new(vec![0.5, 0.52, 0.79, 0.8], vec![0.0, 1.0, 1.0, 0.0])?;
    let band = Psd::of_radial_table(band, Some(3.0))?;
    // Plateaus at two heights
    let heights = [-2.0, -1.2, -0.8, 0.8, 1.2, 2.0];
    let probabilities = [0.0, 0.05, 0.45, 0.55, 0.95, 1.0];
    let plateaus = HeightTable::of_probabilities(&heights, &probabilities)?;
    let plateaus = TransformedHeights::of(Psd::gaussian(3.0, 12.0)?, plateaus);
    Ok(vec![
        ("psd of a table", band.into()),
        ("heights of a table", plateaus.into()),
    ])
}

/// Recipe with the spectrum and the distribution of heights of a file, its samples one length unit apart.
fn like(file: &Path) -> Result<SurfaceRecipe, Box<dyn Error>> {
    let field = read_height_map(file)?.into_height_field(MissingPolicy::Fill, Border::Open)?;
    let scale = field.spacing()[0].recip();
    let heights = field.heights().iter().map(|h| scale * h).collect();
    let field = HeightField::new(heights, field.shape(), [1.0; 2])?.with_border(field.border());
    Ok(TransformedHeights::of(Psd::like(&field)?, HeightTable::like(&field)?).into())
}

fn relief(caption: &str, field: &HeightField) -> Relief {
    Relief {
        caption: caption.to_owned(),
        heights: field.heights().to_vec(),
        shape: field.shape(),
        spacing: field.spacing()[0],
    }
}

fn draw(title: &str, name: &str, panels: Vec<Relief>) -> Result<(), Box<dyn Error>> {
    let figure = Reliefs {
        title: title.to_owned(),
        subtitle: format!(
            "tiles of {SIZE} x {SIZE} samples, lengths in samples; light from the upper left, slopes scaled to the same root mean square"
        ),
        columns: 4,
        panels,
    };
    let file = std::env::temp_dir().join(name);
    write_bytes(&file, &figure.draw()?.png()?)?;
    println!("{}", file.display());
    Ok(())
}
