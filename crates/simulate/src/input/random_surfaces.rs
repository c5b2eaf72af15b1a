//! Random surfaces: the recipe that draws them, by the cells that they consist of.

use std::sync::{Arc, OnceLock};

use asperity_surface::{HeightBlocks, HeightField, SlopeMoments, SplineSurface};
use asperity_synthesis::{
    FieldSynthesis, GivesUp, Resolution, SplineSynthesis, SurfaceRecipe, Synthesis, SynthesisError,
};

use asperity_tracer::Shape;
use serde::{Deserialize, Serialize};

use super::cells::Cells;

/// Random surfaces, by the cells that they consist of.
///
/// Read from a file they are not planned before they are drawn.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RandomSurfaces {
    cells: Cells,
    recipe: SurfaceRecipe,
    /// Cells `[rows, columns]`.
    shape: [usize; 2],
    /// `[dx, dy]`, length units per cell.
    spacing: [f64; 2],
    #[serde(skip)]
    planned: Arc<OnceLock<Planned>>,
    #[serde(skip)]
    height_blocks: Arc<OnceLock<Arc<[HeightBlocks]>>>,
}

/// Drawer of random surfaces.
#[derive(Debug)]
pub(crate) enum Planned {
    /// Gaussian heights on a grid, two triangles per cell.
    Flat(Synthesis),
    /// Gaussian coefficients of bicubic B-splines.
    Smooth(SplineSynthesis),
    /// Heights on a grid of a recipe that is not Gaussian, with cells of either kind put between.
    Fields(FieldSynthesis),
}

impl Planned {
    fn new(
        cells: Cells,
        recipe: SurfaceRecipe,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        Ok(match (recipe, cells) {
            (SurfaceRecipe::Gaussian(psd), Cells::Flat) => {
                Self::Flat(Synthesis::new(psd, shape, spacing, insist)?)
            }
            (SurfaceRecipe::Gaussian(psd), Cells::Smooth) => {
                Self::Smooth(SplineSynthesis::new(psd, shape, spacing, insist)?)
            }
            (recipe, cells) => {
                let resolution = match cells {
                    _ if insist => Resolution::Any,
                    Cells::Flat => Resolution::Facets,
                    Cells::Smooth => Resolution::Splines,
                };
                Self::Fields(FieldSynthesis::new(recipe, shape, spacing, resolution)?)
            }
        })
    }
}

impl RandomSurfaces {
    /// Plans surfaces of `recipe`, such as a power spectral density; the other parameters are those of [`Synthesis::new`].
    ///
    /// # Errors
    /// Same as [`Synthesis::new`], [`SplineSynthesis::new`] or [`FieldSynthesis::new`].
    pub fn new(
        cells: Cells,
        recipe: impl Into<SurfaceRecipe>,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        let recipe = recipe.into();
        let planned = Planned::new(cells, recipe.clone(), shape, spacing, insist)?;
        Ok(Self {
            cells,
            recipe,
            shape,
            spacing,
            planned: Arc::new(planned.into()),
            height_blocks: Arc::default(),
        })
    }

    /// The drawer, planned now if it was not. Surfaces that the grid does not resolve were refused before they were written to a file.
    pub(crate) fn planned(&self) -> Result<&Planned, SynthesisError> {
        if let Some(planned) = self.planned.get() {
            return Ok(planned);
        }
        let recipe = self.recipe.clone();
        let planned = Planned::new(self.cells, recipe, self.shape, self.spacing, true)?;
        Ok(self.planned.get_or_init(|| planned))
    }

    /// The synthesis of heights that are not Gaussian.
    pub(crate) fn other_heights(&self) -> Option<&FieldSynthesis> {
        match self.planned() {
            Ok(Planned::Fields(synthesis)) => Some(synthesis),
            _ => None,
        }
    }

    /// Returns whether facets are the structure itself, for structures without roughness; `None` for all others. The first call draws on
    /// the surface of `seed`, number 0, to find out.
    pub(crate) fn is_exact_structure(&self, seed: u64) -> Result<Option<bool>, SynthesisError> {
        match (self.planned()?, self.cells) {
            (Planned::Fields(synthesis), Cells::Flat) => synthesis.is_exact_structure(seed),
            _ => Ok(None),
        }
    }

    /// Kind of their cells.
    #[must_use]
    pub const fn cells(&self) -> Cells {
        self.cells
    }

    /// Recipe that draws them.
    #[must_use]
    pub const fn recipe(&self) -> &SurfaceRecipe {
        &self.recipe
    }

    /// Cells `[rows, columns]`; as many as samples, since the surfaces are periodic.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// `[dx, dy]`, length units per cell.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Approximate number of features of random slopes of a surface; `None` if it is no structure.
    pub(crate) fn random_features(&self) -> Option<f64> {
        let before = match &self.recipe {
            SurfaceRecipe::Eroded(eroded) => eroded.before(),
            drawn => drawn,
        };
        let surface = before.structured()?;
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let extent = [nx as f64 * dx, ny as f64 * dy];
        surface.structure().random_features(extent)
    }

    /// Moments that the slopes of its surfaces have on average; `None` if these are not known.
    #[must_use]
    pub(crate) fn expected_slope_moments(&self) -> Option<SlopeMoments> {
        match self.planned().ok()? {
            Planned::Flat(synthesis) => Some(synthesis.expected_slope_moments()),
            Planned::Smooth(synthesis) => Some(synthesis.expected_slope_moments()),
            Planned::Fields(_) => None,
        }
    }

    /// The surfaces of the same tile with about `scale` times the spacing, as whole cells allow; `None` if the grid
    /// cannot be. `insist`: even if it resolves them no more.
    #[must_use]
    pub(crate) fn respaced(&self, scale: f64, insist: bool) -> Option<Self> {
        let (shape, spacing) = (self.shape, self.spacing);
        let cells = shape.map(|n| (n as f64 / scale).round().max(2.0) as usize);
        // Spacing is that of columns, then of rows; shape the number of rows, then of columns.
        let spacing = [0, 1].map(|i| spacing[i] * shape[1 - i] as f64 / cells[1 - i] as f64);
        Self::new(self.cells, self.recipe.clone(), cells, spacing, insist).ok()
    }

    /// The surfaces of the same tile with exactly `scale` times the spacing, which must divide it.
    pub(crate) fn scaled(&self, scale: f64) -> Result<Self, SynthesisError> {
        let shape = self.shape.map(|n| (n as f64 / scale) as usize);
        let spacing = self.spacing.map(|d| d * scale);
        Self::new(self.cells, self.recipe.clone(), shape, spacing, false)
    }

    /// The surface of a seed and number, drawn in the memory given unless `gives_up` returns `true`.
    ///
    /// # Errors
    /// Same as [`Synthesis::draw`].
    pub fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<Shape, SynthesisError> {
        Ok(match self.planned()? {
            Planned::Flat(recipe) => {
                Shape::height_field(recipe.draw_into(seed, number, memory, gives_up)?)
            }
            Planned::Smooth(recipe) => {
                Shape::smooth(recipe.draw_into(seed, number, memory, gives_up)?)
            }
            Planned::Fields(recipe) => {
                let field = recipe.draw_into(seed, number, memory, gives_up)?;
                match self.cells {
                    Cells::Flat => Shape::height_field(field),
                    Cells::Smooth => Shape::smooth(SplineSurface::through(&field)),
                }
            }
        })
    }

    /// Bytes that a program holds at the peak of drawing one of them.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        match self.planned() {
            Ok(Planned::Flat(synthesis)) => synthesis.peak_bytes(),
            Ok(Planned::Smooth(synthesis)) => synthesis.peak_bytes(),
            // A spline takes as many as the heights, and is made while these are there.
            Ok(Planned::Fields(synthesis)) => {
                let [ny, nx] = self.shape;
                synthesis.peak_bytes()
                    + match self.cells {
                        Cells::Flat => 0,
                        Cells::Smooth => (ny + 3) * (nx + 3) * size_of::<f64>(),
                    }
            }
            Err(_) => usize::MAX,
        }
    }

    /// Slopes of equal areas of one surface as light meets it: of its facets, or of places of its smooth cells.
    ///
    /// # Errors
    /// Same as [`Synthesis::draw`].
    pub fn slope_samples(
        &self,
        seed: u64,
        realisation: u64,
    ) -> Result<Vec<[f64; 2]>, SynthesisError> {
        let whole = [1, 1];
        let samples = match self.planned()? {
            Planned::Flat(synthesis) => synthesis.draw(seed, realisation)?.slope_samples(whole),
            Planned::Smooth(synthesis) => synthesis.draw(seed, realisation)?.slope_samples(whole),
            Planned::Fields(synthesis) => {
                let field = synthesis.draw(seed, realisation)?;
                match self.cells {
                    Cells::Flat => field.slope_samples(whole),
                    Cells::Smooth => SplineSurface::through(&field).slope_samples(whole),
                }
            }
        };
        Ok(samples.concat())
    }

    /// Heights of two surfaces that no run uses, drawn by the first call; empty for Gaussian surfaces, whose distribution is known.
    ///
    /// # Errors
    /// Same as [`Synthesis::draw`].
    pub fn height_blocks(&self) -> Result<Arc<[HeightBlocks]>, SynthesisError> {
        if let Some(known) = self.height_blocks.get() {
            return Ok(known.clone());
        }
        let numbers = if self.recipe.gaussian().is_some() {
            0..0
        } else {
            0..2
        };
        let draw = |number| {
            Ok(HeightBlocks::of(&self.heights(
                u64::MAX,
                number,
                &|| false,
            )?))
        };
        let drawn: Result<_, SynthesisError> = numbers.map(draw).collect();
        let drawn = drawn?;
        Ok(self.height_blocks.get_or_init(|| drawn).clone())
    }

    /// Heights of one surface, for a picture, unless `gives_up` returns `true`: those of its grid, or of one up to four times as fine where
    /// cells are smooth, of at most 512 samples per side.
    ///
    /// # Errors
    /// Same as [`Synthesis::draw`].
    pub fn heights(
        &self,
        seed: u64,
        realisation: u64,
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let memory = Vec::new();
        match self.planned()? {
            Planned::Flat(synthesis) => synthesis.draw_into(seed, realisation, memory, gives_up),
            Planned::Smooth(synthesis) => {
                picture(&synthesis.draw_into(seed, realisation, memory, gives_up)?)
            }
            Planned::Fields(synthesis) => {
                let field = synthesis.draw_into(seed, realisation, memory, gives_up)?;
                match self.cells {
                    Cells::Flat => Ok(field),
                    Cells::Smooth => picture(&SplineSurface::through(&field)),
                }
            }
        }
    }
}

/// Heights of smooth cells on a grid up to four times as fine, of at most 512 samples per side.
fn picture(spline: &SplineSurface) -> Result<HeightField, SynthesisError> {
    let [columns, rows] = spline.cells();
    let per_cell = (512 / columns.max(rows)).clamp(1, 4);
    Ok(spline.tessellated(per_cell)?)
}

/// Two recipes are equal if they draw the same surfaces.
impl PartialEq for RandomSurfaces {
    fn eq(&self, other: &Self) -> bool {
        self.cells == other.cells
            && self.recipe == other.recipe
            && self.shape == other.shape
            && self.spacing == other.spacing
    }
}

impl From<Synthesis> for RandomSurfaces {
    fn from(synthesis: Synthesis) -> Self {
        Self {
            cells: Cells::Flat,
            recipe: synthesis.recipe().clone(),
            shape: synthesis.shape(),
            spacing: synthesis.spacing(),
            planned: Arc::new(Planned::Flat(synthesis).into()),
            height_blocks: Arc::default(),
        }
    }
}

impl From<SplineSynthesis> for RandomSurfaces {
    fn from(synthesis: SplineSynthesis) -> Self {
        Self {
            cells: Cells::Smooth,
            recipe: synthesis.recipe().clone(),
            shape: synthesis.shape(),
            spacing: synthesis.spacing(),
            planned: Arc::new(Planned::Smooth(synthesis).into()),
            height_blocks: Arc::default(),
        }
    }
}
