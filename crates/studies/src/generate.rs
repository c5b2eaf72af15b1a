//! Generate: random rough surfaces.

use std::path::Path;
use std::time::Instant;

use asperity_io::shown_path;
use asperity_simulate::{Observer, check_memory, short};
use asperity_surface::{HeightField, QuickRoughness};
use asperity_synthesis::{
    DrawnRoughness, FieldSynthesis, Realisation, Resolution, SpectrumMismatch, SurfaceRecipe,
};
use serde::Deserialize;

use crate::config::SurfaceConfig;
use crate::error::StudyError;
use crate::given::write_surface;
use crate::output::{note_lines, wrapped};
use crate::report::roughness::realisation_table;
use crate::settings::Document;

/// Random surfaces, and which of them is drawn.
#[derive(Clone, Debug, Deserialize)]
struct GenerateConfig {
    /// The random surfaces.
    surface: SurfaceConfig,
    /// The height map.
    generate: HeightMapConfig,
    /// The random numbers.
    run: SeedConfig,
}

/// `[generate]`: which of the surfaces of a seed is drawn.
#[derive(Clone, Debug, Deserialize)]
struct HeightMapConfig {
    /// Number of the first surface, from 0.
    realisation: u64,
    /// Ending of the files of several.
    format: String,
}

/// `[run]` of surfaces.
#[derive(Clone, Copy, Debug, Deserialize)]
struct SeedConfig {
    /// Seed of the surfaces.
    seed: u64,
    /// Number of surfaces in a folder; one in a file unless given.
    realisations: Option<u64>,
}

/// A surface that is planned, and fits into memory.
pub struct GeneratePlan {
    config: GenerateConfig,
    synthesis: FieldSynthesis,
    notes: Vec<String>,
}

/// A surface that was drawn and written.
pub struct GeneratedSurface {
    field: HeightField,
    heading: String,
    notes: Vec<String>,
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
        let shallow = surface.erosion.shallow_note(spacing, surface.unit);
        let few_lengths = amplitude_note(&recipe, surface.size(), spacing);
        let planning = FieldSynthesis::planning_bytes(&recipe, shape);
        check_memory("planning these surfaces", planning)?;
        let resolution = match surface.insist {
            true => Resolution::Any,
            false => Resolution::Facets,
        };
        let synthesis = FieldSynthesis::new(recipe, shape, spacing, resolution)?;
        check_memory("this surface", synthesis.peak_bytes())?;
        notes.extend(spectrum_note(synthesis.spectrum_mismatch()));
        notes.extend(few_lengths);
        notes.extend(shallow);
        Ok(Self {
            config,
            synthesis,
            notes,
        })
    }

    /// Names of the files of several surfaces, by their numbers among those of the seed; `None` of one.
    #[must_use]
    pub fn files(&self) -> Option<Vec<String>> {
        let (first, format) = (
            self.config.generate.realisation,
            &self.config.generate.format,
        );
        let count = self.config.run.realisations?;
        let last = first.saturating_add(count - 1);
        let digits = last.to_string().len();
        let name = |number| format!("surface_{number:0digits$}.{format}");
        Some((first..=last).map(name).collect())
    }

    /// Notes for the user on the surfaces, one sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number, among the surfaces of the seed, of the surface `after` places behind the first.
    fn number(&self, after: u64) -> u64 {
        self.config.generate.realisation.saturating_add(after)
    }

    /// Draws the surface `after` places behind the first.
    ///
    /// # Errors
    /// [`StudyError`] if its heights overflow.
    pub fn draw(&self, after: u64) -> Result<HeightField, StudyError> {
        let field = self
            .synthesis
            .draw(self.config.run.seed, self.number(after))?;
        Ok(field.with_unit(self.config.surface.unit))
    }

    /// Draws the surface `after` places behind the first, and writes it as a height map. The time that it takes is explained to
    /// `observer`.
    ///
    /// # Errors
    /// [`StudyError`] if its heights overflow, or the file cannot be written.
    pub fn write(
        &self,
        after: u64,
        path: &Path,
        observer: &dyn Observer,
    ) -> Result<GeneratedSurface, StudyError> {
        let clock = Instant::now();
        let (seed, number) = (self.config.run.seed, self.number(after));
        let field = self.draw(after)?;
        observer.explain(&format!("drawn in {:.3} s", clock.elapsed().as_secs_f64()));
        let note = write_surface(path, &field)?;
        Ok(GeneratedSurface {
            heading: format!(
                "{} x {} samples, periodic, seed {seed}, realisation {number}",
                field.nx(),
                field.ny(),
            ),
            field,
            notes: note.into_iter().chain(self.notes.iter().cloned()).collect(),
        })
    }
}

impl GeneratedSurface {
    /// Its roughness, with requested and realised statistics.
    #[must_use]
    pub fn roughness(&self) -> DrawnRoughness {
        DrawnRoughness::of(&self.field)
    }

    /// Text on the surface that was written as `path`: samples, requested and realised statistics, and notes.
    #[must_use]
    pub fn text(&self, path: &Path) -> String {
        let realisation = Realisation::of(&self.field);
        let lines = QuickRoughness::takes_some_lines(&self.field).then_some(QuickRoughness::LINES);
        let lines = self
            .field
            .shape()
            .map(|all| lines.filter(|some| *some < all));
        let table = realisation_table(realisation.as_ref(), self.field.unit(), lines);
        let notes = note_lines(&self.notes);
        wrapped(&format!(
            "{}: {}\n{table}{notes}",
            shown_path(path),
            self.heading
        ))
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
