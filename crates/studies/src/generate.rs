//! Generate: one random rough surface.

use asperity_simulate::{SimulateError, check_memory, short};
use asperity_surface::HeightField;
use asperity_synthesis::{FieldSynthesis, Resolution, SpectrumMismatch, SurfaceRecipe};
use serde::Deserialize;

use crate::config::SurfaceConfig;
use crate::error::StudyError;
use crate::settings::Document;

/// Random surfaces, and which of them is drawn.
#[derive(Clone, Debug, Deserialize)]
pub struct GenerateConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// The height map.
    pub generate: HeightMapConfig,
    /// The random numbers.
    pub run: SeedConfig,
}

/// `[generate]`: which of the surfaces of a seed is drawn.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct HeightMapConfig {
    /// Number of the surface, from 0.
    pub realisation: u64,
}

/// `[run]` of one surface.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct SeedConfig {
    /// Seed of the surfaces.
    pub seed: u64,
}

/// A surface that is planned, and fits into memory.
pub struct GeneratePlan {
    /// The configuration.
    pub config: GenerateConfig,
    synthesis: FieldSynthesis,
    /// Notes for the user, one sentence each.
    pub notes: Vec<String>,
}

impl GeneratePlan {
    /// Reads the configuration of a document and the files that it names, and plans the surface.
    ///
    /// # Errors
    /// [`StudyError`] if a value is invalid, a file cannot be read, or the surface cannot be drawn or held.
    pub fn new(document: &Document) -> Result<Self, StudyError> {
        let mut config: GenerateConfig = document.read()?;
        let surface = &mut config.surface;
        let mut notes = surface.read_files()?;
        let (_, recipe) = surface.recipe()?;
        let (shape, spacing) = (surface.shape(), surface.spacing());
        let few_lengths = amplitude_note(&recipe, surface.size(), spacing);
        let planning = FieldSynthesis::planning_bytes(&recipe, shape);
        check_memory("planning these surfaces", planning)?;
        let resolution = match surface.insist {
            true => Resolution::Any,
            false => Resolution::Facets,
        };
        let synthesis = FieldSynthesis::new(recipe, shape, spacing, resolution);
        let synthesis = synthesis.map_err(SimulateError::from)?;
        check_memory("this surface", synthesis.peak_bytes())?;
        notes.extend(spectrum_note(synthesis.spectrum_mismatch()));
        notes.extend(few_lengths);
        Ok(Self {
            config,
            synthesis,
            notes,
        })
    }

    /// Draws the surface.
    ///
    /// # Errors
    /// [`StudyError::Simulate`] if its heights overflow.
    pub fn draw(&self) -> Result<HeightField, StudyError> {
        let (seed, number) = (self.config.run.seed, self.config.generate.realisation);
        let field = self.synthesis.draw(seed, number);
        let field = field.map_err(SimulateError::from)?;
        Ok(field.with_unit(self.config.surface.unit))
    }
}

/// Lengths of the amplitude along the side of a tile from which slopes of GGX come near their distribution.
const AMPLITUDE_LENGTHS: f64 = 16.0;

/// Note on a tile that holds few amplitudes of GGX slopes, with the number of samples that hold enough.
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

/// Note on the part of the requested spectrum that heights of a distribution miss, from half a per cent of the slope variance or of the
/// variance on.
fn spectrum_note(mismatch: SpectrumMismatch) -> Option<String> {
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
