//! Field synthesis: draws random surfaces of any recipe as heights on a grid.

mod centred;
mod curve;
mod hermite;
mod structured;
mod student;
mod transformed;

use std::sync::Arc;

use self::structured::StructuredSynthesis;
use self::student::StudentSynthesis;
use self::transformed::TransformedSynthesis;
use super::error::SynthesisError;
use super::limits::MIN_SPACINGS_PER_CORRELATION_LENGTH;
use super::splines::MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH;
use super::synthesis::Synthesis;
use crate::{Provenance, SlopeMixture, SpectrumMismatch, SurfaceRecipe};
use asperity_surface::HeightField;

/// Resolution that a grid must have for the surfaces drawn on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// For facets: as [`Synthesis`] requires.
    Facets,
    /// For a spline through the heights: as [`SplineSynthesis`](crate::SplineSynthesis) requires.
    Splines,
    /// No requirement; the tile may also be too small.
    Any,
}

impl Resolution {
    /// Fewest spacings that a correlation length must span.
    const fn fewest_spacings(self) -> Option<f64> {
        match self {
            Self::Facets => Some(MIN_SPACINGS_PER_CORRELATION_LENGTH),
            Self::Splines => Some(MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH),
            Self::Any => None,
        }
    }
}

/// A generator of random periodic surfaces of any [`SurfaceRecipe`], as heights on a grid.
///
/// Heights depend on recipe, shape, spacing, seed and realisation, and not on the number of threads.
///
/// # Examples
/// ```
/// use asperity_synthesis::{FieldSynthesis, Psd, Resolution, StudentSlopes};
///
/// // GGX slopes of alpha = 2 sigma / tau = 0.25, whose amplitude varies over 4 correlation lengths
/// let recipe = StudentSlopes::new(Psd::gaussian(0.5, 4.0)?, 4.0)?.into();
/// let synthesis = FieldSynthesis::new(recipe, [128, 128], [1.0, 1.0], Resolution::Facets)?;
/// let surface = synthesis.draw(7, 0)?;
/// assert_eq!(surface, synthesis.draw(7, 0)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FieldSynthesis {
    recipe: SurfaceRecipe,
    drawer: Drawer,
}

/// Generator of the surfaces of a recipe, by kind.
#[derive(Clone, Debug)]
enum Drawer {
    Gaussian(Box<Synthesis>),
    Transformed(Box<TransformedSynthesis>),
    StudentSlopes(Box<StudentSynthesis>),
    Structured(Box<StructuredSynthesis>),
}

impl FieldSynthesis {
    /// Plans surfaces of `recipe`.
    ///
    /// `shape`: `[ny, nx]`, at least `[2, 2]`. `spacing`: `[dx, dy]`, length units per sample.
    ///
    /// # Errors
    /// Errors of [`Synthesis::new`], for the correlation lengths of the recipe; [`SynthesisError::Unreachable`] if transformed heights cannot
    /// have the spectrum.
    pub fn new(
        recipe: SurfaceRecipe,
        shape: [usize; 2],
        spacing: [f64; 2],
        resolution: Resolution,
    ) -> Result<Self, SynthesisError> {
        let fewest = resolution.fewest_spacings();
        let drawer = match &recipe {
            SurfaceRecipe::Gaussian(psd) => {
                let synthesis = Synthesis::of_heights(psd.clone(), shape, spacing, fewest)?;
                Drawer::Gaussian(Box::new(synthesis))
            }
            SurfaceRecipe::Transformed(transformed) => {
                let drawer = TransformedSynthesis::new(transformed, shape, spacing, fewest)?;
                Drawer::Transformed(Box::new(drawer))
            }
            SurfaceRecipe::StudentSlopes(student) => {
                let drawer = StudentSynthesis::new(student, shape, spacing, fewest)?;
                Drawer::StudentSlopes(Box::new(drawer))
            }
            SurfaceRecipe::Structured(surface) => {
                let drawer = StructuredSynthesis::new(surface, shape, spacing, fewest)?;
                Drawer::Structured(Box::new(drawer))
            }
        };
        Ok(Self { recipe, drawer })
    }

    /// Recipe of the surfaces.
    #[must_use]
    pub const fn recipe(&self) -> &SurfaceRecipe {
        &self.recipe
    }

    /// `[ny, nx]`.
    #[must_use]
    pub fn shape(&self) -> [usize; 2] {
        match &self.drawer {
            Drawer::Gaussian(synthesis) => synthesis.shape(),
            Drawer::Transformed(transformed) => transformed.waves().shape(),
            Drawer::StudentSlopes(student) => student.base().shape(),
            Drawer::Structured(structured) => structured.structure().shape(),
        }
    }

    /// `[dx, dy]`, length units per sample.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        match &self.drawer {
            Drawer::Gaussian(synthesis) => synthesis.spacing(),
            Drawer::Transformed(transformed) => transformed.waves().spacing(),
            Drawer::StudentSlopes(student) => student.base().spacing(),
            Drawer::Structured(structured) => structured.structure().spacing(),
        }
    }

    /// Bytes that a program holds at the peak of [`FieldSynthesis::new`], beyond those that it holds afterwards.
    #[must_use]
    pub const fn planning_bytes(recipe: &SurfaceRecipe, shape: [usize; 2]) -> usize {
        match recipe {
            SurfaceRecipe::Transformed(_) => TransformedSynthesis::planning_bytes(shape),
            SurfaceRecipe::Gaussian(_)
            | SurfaceRecipe::StudentSlopes(_)
            | SurfaceRecipe::Structured(_) => 0,
        }
    }

    /// Bytes that a program holds at the peak of planning and drawing.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        match &self.drawer {
            Drawer::Gaussian(synthesis) => synthesis.peak_bytes(),
            Drawer::Transformed(transformed) => transformed.peak_bytes(),
            Drawer::StudentSlopes(student) => student.peak_bytes(),
            Drawer::Structured(structured) => structured.peak_bytes(),
        }
    }

    /// Deviation from the spectrum requested: above rounding if heights are transformed and no Gaussian surface has the spectrum that
    /// they would need.
    #[must_use]
    pub fn spectrum_mismatch(&self) -> SpectrumMismatch {
        match &self.drawer {
            Drawer::Transformed(transformed) => transformed.spectrum_mismatch(),
            Drawer::Gaussian(_) | Drawer::StudentSlopes(_) | Drawer::Structured(_) => {
                SpectrumMismatch::default()
            }
        }
    }

    /// The distribution of the slopes at a point of the continuous surfaces that waves on this grid make; `None` of structured ones,
    /// of which it is not known.
    ///
    /// For GGX slopes it includes what the amplitude's own slope adds.
    #[must_use]
    pub fn slope_mixture(&self) -> Option<SlopeMixture> {
        match &self.drawer {
            Drawer::Gaussian(synthesis) => {
                Some(SlopeMixture::gaussian(synthesis.psd().slope_covariance()))
            }
            Drawer::Transformed(transformed) => Some(transformed.slope_mixture()),
            Drawer::StudentSlopes(student) => student.slope_mixture(),
            Drawer::Structured(_) => None,
        }
    }

    /// Returns whether facets are the surface itself, for structures without roughness; `None` for all others. The first call takes a
    /// surface of `seed` to find out, and no more memory than [`FieldSynthesis::draw`]; further calls know.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::heights`](crate::StructureSynthesis::heights).
    pub fn is_exact_structure(&self, seed: u64) -> Result<Option<bool>, SynthesisError> {
        match &self.drawer {
            Drawer::Structured(structured) => structured.is_exact(seed),
            Drawer::Gaussian(_) | Drawer::Transformed(_) | Drawer::StudentSlopes(_) => Ok(None),
        }
    }

    /// Draws one periodic surface: heights of mean zero, shape `[ny, nx]`, in the unit of the recipe, provenance recorded.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`].
    pub fn draw(&self, seed: u64, realisation: u64) -> Result<HeightField, SynthesisError> {
        self.draw_into(seed, realisation, Vec::new())
    }

    /// Draws the same surface as [`FieldSynthesis::draw`], reusing the memory of `room` if it is large enough. Its contents do
    /// not matter.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`].
    pub fn draw_into(
        &self,
        seed: u64,
        realisation: u64,
        room: Vec<f64>,
    ) -> Result<HeightField, SynthesisError> {
        let field = match &self.drawer {
            Drawer::Gaussian(synthesis) => return synthesis.draw_into(seed, realisation, room),
            Drawer::Transformed(transformed) => transformed.draw_into(seed, realisation, room)?,
            Drawer::StudentSlopes(student) => student.draw_into(seed, realisation, room)?,
            Drawer::Structured(structured) => structured.draw(seed, realisation)?,
        };
        Ok(field.with_provenance(Some(Arc::new(Provenance {
            recipe: self.recipe.clone(),
            seed,
            realisation,
        }))))
    }
}
