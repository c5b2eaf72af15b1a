//! Random surfaces: the recipe that draws them, by the cells that they consist of.

use asperity_surface::{
    FieldSynthesis, HeightField, Resolution, SlopeMoments, SplineSurface, SplineSynthesis,
    SurfaceRecipe, Synthesis, SynthesisError,
};

use asperity_tracer::Shape;

use super::cells::Cells;

/// Random surfaces, by the cells that they consist of.
#[derive(Clone, Debug)]
pub enum RandomSurfaces {
    /// Heights on a grid, two triangles per cell.
    Flat(Synthesis),
    /// Bicubic B-splines.
    Smooth(SplineSynthesis),
    /// Heights on a grid of a recipe that is not Gaussian, with cells of either kind.
    Fields(FieldSurfaces),
}

/// Random surfaces whose heights are drawn first, and their cells put between.
#[derive(Clone, Debug)]
pub struct FieldSurfaces {
    /// Draws the heights.
    pub(crate) synthesis: FieldSynthesis,
    /// Two triangles per cell, or the spline through the heights.
    pub(crate) cells: Cells,
}

impl RandomSurfaces {
    /// Plans surfaces of `recipe`, such as a power spectral density; the other parameters are those of [`Synthesis::new`].
    ///
    /// # Errors
    /// As [`Synthesis::new`], [`SplineSynthesis::new`] or [`FieldSynthesis::new`].
    pub fn new(
        cells: Cells,
        recipe: impl Into<SurfaceRecipe>,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        Ok(match (recipe.into(), cells) {
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
                Self::Fields(FieldSurfaces {
                    synthesis: FieldSynthesis::new(recipe, shape, spacing, resolution)?,
                    cells,
                })
            }
        })
    }

    /// What their cells are.
    #[must_use]
    pub const fn cells(&self) -> Cells {
        match self {
            Self::Flat(_) => Cells::Flat,
            Self::Smooth(_) => Cells::Smooth,
            Self::Fields(fields) => fields.cells,
        }
    }

    /// What they are drawn by.
    #[must_use]
    pub const fn recipe(&self) -> &SurfaceRecipe {
        match self {
            Self::Flat(synthesis) => synthesis.recipe(),
            Self::Smooth(synthesis) => synthesis.recipe(),
            Self::Fields(fields) => fields.synthesis.recipe(),
        }
    }

    /// Cells `[rows, columns]`; as many as samples, since the surfaces are periodic.
    #[must_use]
    pub fn shape(&self) -> [usize; 2] {
        match self {
            Self::Flat(synthesis) => synthesis.shape(),
            Self::Smooth(synthesis) => synthesis.shape(),
            Self::Fields(fields) => fields.synthesis.shape(),
        }
    }

    /// `[dx, dy]`, length units per cell.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        match self {
            Self::Flat(synthesis) => synthesis.spacing(),
            Self::Smooth(synthesis) => synthesis.spacing(),
            Self::Fields(fields) => fields.synthesis.spacing(),
        }
    }

    /// Moments that the slopes of its surfaces have on average; `None` if these are not known.
    #[must_use]
    pub(crate) fn expected_slope_moments(&self) -> Option<SlopeMoments> {
        match self {
            Self::Flat(synthesis) => Some(synthesis.expected_slope_moments()),
            Self::Smooth(synthesis) => Some(synthesis.expected_slope_moments()),
            Self::Fields(_) => None,
        }
    }

    /// The same surfaces of the same tile with about `scale` times the spacing, as whole cells allow; `None` if the grid
    /// cannot be. `insist`: even if it resolves them no more.
    #[must_use]
    pub(crate) fn respaced(&self, scale: f64, insist: bool) -> Option<Self> {
        let (shape, spacing) = (self.shape(), self.spacing());
        let cells = shape.map(|n| (n as f64 / scale).round().max(2.0) as usize);
        // Spacing is that of columns, then of rows; shape the number of rows, then of columns.
        let spacing = [0, 1].map(|i| spacing[i] * shape[1 - i] as f64 / cells[1 - i] as f64);
        Self::new(self.cells(), self.recipe().clone(), cells, spacing, insist).ok()
    }

    /// The same surfaces of the same tile with exactly `scale` times the spacing, which must divide it.
    pub(crate) fn scaled(&self, scale: f64) -> Result<Self, SynthesisError> {
        let shape = self.shape().map(|n| (n as f64 / scale) as usize);
        let spacing = self.spacing().map(|d| d * scale);
        Self::new(self.cells(), self.recipe().clone(), shape, spacing, false)
    }

    /// The surface of a seed and number, drawn in the memory given.
    pub(crate) fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<Shape, SynthesisError> {
        Ok(match self {
            Self::Flat(recipe) => Shape::height_field(recipe.draw_into(seed, number, memory)?),
            Self::Smooth(recipe) => Shape::smooth(recipe.draw_into(seed, number, memory)?),
            Self::Fields(FieldSurfaces { synthesis, cells }) => {
                let field = synthesis.draw_into(seed, number, memory)?;
                match cells {
                    Cells::Flat => Shape::height_field(field),
                    Cells::Smooth => Shape::smooth(SplineSurface::through(&field)),
                }
            }
        })
    }

    /// Bytes that a program holds at the peak of drawing one of them.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        match self {
            Self::Flat(synthesis) => synthesis.peak_bytes(),
            Self::Smooth(synthesis) => synthesis.peak_bytes(),
            Self::Fields(fields) => fields.peak_bytes(),
        }
    }

    /// Slopes of equal areas of one surface as light meets it: of its facets, or of places of its smooth cells.
    ///
    /// # Errors
    /// As [`Synthesis::draw`].
    pub fn slope_samples(
        &self,
        seed: u64,
        realisation: u64,
    ) -> Result<Vec<[f64; 2]>, SynthesisError> {
        let whole = [1, 1];
        let samples = match self {
            Self::Flat(synthesis) => synthesis.draw(seed, realisation)?.slope_samples(whole),
            Self::Smooth(synthesis) => synthesis.draw(seed, realisation)?.slope_samples(whole),
            Self::Fields(fields) => {
                let field = fields.synthesis.draw(seed, realisation)?;
                match fields.cells {
                    Cells::Flat => field.slope_samples(whole),
                    Cells::Smooth => SplineSurface::through(&field).slope_samples(whole),
                }
            }
        };
        Ok(samples.concat())
    }

    /// Heights of one surface, for a picture: those of its grid, or of one up to four times as fine where cells are smooth, of at
    /// most 512 samples per side.
    ///
    /// # Errors
    /// As [`Synthesis::draw`].
    pub fn heights(&self, seed: u64, realisation: u64) -> Result<HeightField, SynthesisError> {
        match self {
            Self::Flat(synthesis) => synthesis.draw(seed, realisation),
            Self::Smooth(synthesis) => picture(&synthesis.draw(seed, realisation)?),
            Self::Fields(fields) => {
                let field = fields.synthesis.draw(seed, realisation)?;
                match fields.cells {
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

impl FieldSurfaces {
    /// Bytes at the peak of drawing one; a spline takes as many as the heights, and is made while these are there.
    fn peak_bytes(&self) -> usize {
        let bytes = self.synthesis.peak_bytes();
        let [ny, nx] = self.synthesis.shape();
        match self.cells {
            Cells::Flat => bytes,
            Cells::Smooth => bytes + (ny + 3) * (nx + 3) * size_of::<f64>(),
        }
    }
}

/// Two recipes are equal if they draw the same surfaces.
impl PartialEq for RandomSurfaces {
    fn eq(&self, other: &Self) -> bool {
        self.cells() == other.cells()
            && self.recipe() == other.recipe()
            && self.shape() == other.shape()
            && self.spacing() == other.spacing()
    }
}

impl From<Synthesis> for RandomSurfaces {
    fn from(synthesis: Synthesis) -> Self {
        Self::Flat(synthesis)
    }
}

impl From<SplineSynthesis> for RandomSurfaces {
    fn from(synthesis: SplineSynthesis) -> Self {
        Self::Smooth(synthesis)
    }
}
