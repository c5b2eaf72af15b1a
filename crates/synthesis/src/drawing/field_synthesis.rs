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
use crate::gives_up::{GivesUp, NEVER};
use crate::recipe::DrawnMoments;
use crate::{ErodedSurface, Erosion, Provenance, SlopeMixture, SpectrumMismatch, SurfaceRecipe};
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
    Eroded(Box<FieldSynthesis>, Vec<Erosion>),
}

impl FieldSynthesis {
    /// Plans surfaces of `recipe`.
    ///
    /// `shape`: `[ny, nx]`, at least `[2, 2]`. `spacing`: `[dx, dy]`, length units per sample.
    ///
    /// # Errors
    /// Errors of [`Synthesis::new`], for the correlation lengths of the recipe; [`SynthesisError::Unreachable`] if transformed heights cannot
    /// have the spectrum; [`SynthesisError::Erosion`] if surfaces cannot be eroded on the grid.
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
            SurfaceRecipe::Eroded(surface) => {
                let erosion = surface.erosion().to_vec();
                erosion
                    .iter()
                    .try_for_each(|process| process.check(spacing))?;
                let before = Self::new(surface.before().clone(), shape, spacing, resolution)?;
                Drawer::Eroded(Box::new(before), erosion)
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
            Drawer::Eroded(before, _) => before.shape(),
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
            Drawer::Eroded(before, _) => before.spacing(),
        }
    }

    /// Bytes that a program holds at the peak of [`FieldSynthesis::new`], beyond those that it holds afterwards.
    #[must_use]
    pub fn planning_bytes(recipe: &SurfaceRecipe, shape: [usize; 2]) -> usize {
        match recipe {
            SurfaceRecipe::Transformed(_) => TransformedSynthesis::planning_bytes(shape),
            SurfaceRecipe::Eroded(surface) => Self::planning_bytes(surface.before(), shape),
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
            // A process holds the heights twice beside those that were drawn
            Drawer::Eroded(before, _) => {
                let [ny, nx] = before.shape();
                before.peak_bytes() + 2 * ny * nx * size_of::<f64>()
            }
        }
    }

    /// Deviation from the spectrum requested: above rounding if heights are transformed and no Gaussian surface has the spectrum that
    /// they would need.
    #[must_use]
    pub fn spectrum_mismatch(&self) -> SpectrumMismatch {
        match &self.drawer {
            Drawer::Transformed(transformed) => transformed.spectrum_mismatch(),
            Drawer::Eroded(before, _) => before.spectrum_mismatch(),
            Drawer::Gaussian(_) | Drawer::StudentSlopes(_) | Drawer::Structured(_) => {
                SpectrumMismatch::default()
            }
        }
    }

    /// The distribution of the slopes at a point of the continuous surfaces that waves on this grid make; `None` of structured and eroded
    /// ones, of which it is not known.
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
            Drawer::Structured(_) | Drawer::Eroded(..) => None,
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
            _ => Ok(None),
        }
    }

    /// The recipe of these surfaces after processes of erosion, with height and slopes measured on two of them.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`], and [`SynthesisError::Erosion`] if surfaces cannot be eroded on this grid.
    pub fn eroded(
        &self,
        erosion: Vec<Erosion>,
        gives_up: GivesUp<'_>,
    ) -> Result<ErodedSurface, SynthesisError> {
        let moments = DrawnMoments::of(|seed, number| {
            let drawn = self.draw_into(seed, number, Vec::new(), gives_up)?;
            worn(drawn, &erosion, gives_up)
        })?;
        Ok(ErodedSurface::new(self.recipe.clone(), erosion, moments))
    }

    /// Draws one periodic surface: heights of mean zero before any erosion, shape `[ny, nx]`, in the unit of the recipe, provenance recorded.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`].
    pub fn draw(&self, seed: u64, realisation: u64) -> Result<HeightField, SynthesisError> {
        self.draw_into(seed, realisation, Vec::new(), NEVER)
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
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let field = match &self.drawer {
            Drawer::Gaussian(synthesis) => {
                return synthesis.draw_into(seed, realisation, room, gives_up);
            }
            Drawer::Transformed(transformed) => {
                transformed.draw_into(seed, realisation, room, gives_up)?
            }
            Drawer::StudentSlopes(student) => {
                student.draw_into(seed, realisation, room, gives_up)?
            }
            Drawer::Structured(structured) => structured.draw(seed, realisation, gives_up)?,
            Drawer::Eroded(before, erosion) => {
                let drawn = before.draw_into(seed, realisation, room, gives_up)?;
                worn(drawn, erosion, gives_up)?
            }
        };
        Ok(field.with_provenance(Some(Arc::new(Provenance {
            recipe: self.recipe.clone(),
            seed,
            realisation,
        }))))
    }
}

/// The surface after these processes, without provenance.
fn worn(
    field: HeightField,
    erosion: &[Erosion],
    gives_up: GivesUp<'_>,
) -> Result<HeightField, SynthesisError> {
    let mut field = field.with_provenance(None);
    for process in erosion {
        let worn = process.of_unless(&field, gives_up)?;
        field = worn.ok_or(SynthesisError::GivenUp)?;
    }
    Ok(field)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Etch, Psd, Slip};

    /// Surfaces with a direction, so that no mean over axes hides one.
    #[test]
    fn eroded_surfaces_are_drawn_ones_after_each_process_and_have_measured_statistics() {
        let psd = Psd::anisotropic_gaussian(2.0, 8.0, 16.0, 0.0).unwrap();
        let grid = ([128, 128], [1.0, 1.0]);
        let synthesis =
            FieldSynthesis::new(psd.clone().into(), grid.0, grid.1, Resolution::Facets).unwrap();
        let slip = Erosion::Slip(Slip {
            slope: 0.2,
            steps: 100,
        });
        let erosion = vec![slip, Erosion::Etch(Etch { depth: 2.0 })];
        let recipe = SurfaceRecipe::from(synthesis.eroded(erosion.clone(), NEVER).unwrap());
        assert!(recipe.is_valid() && recipe.is_measured());
        let eroded =
            FieldSynthesis::new(recipe.clone(), grid.0, grid.1, Resolution::Facets).unwrap();
        assert_eq!(eroded.slope_mixture(), None);
        let field = eroded.draw_into(7, 3, vec![9.0; 5], NEVER).unwrap();
        let steps = erosion.iter();
        let expected = steps.fold(synthesis.draw(7, 3).unwrap(), |field, process| {
            process.of(&field).unwrap()
        });
        assert_eq!(field.heights(), expected.heights());
        let provenance = Provenance::of(field.provenance()).unwrap();
        assert_eq!(provenance.recipe, recipe);
        // Of 128 areas of correlation: some ten per cent; before the erosion the variances are 0.125 and 0.03125
        let [xx, _, yy] = recipe.slope_covariance();
        let [found_x, _, found_y] = field.slope_moments().second;
        assert!((xx / found_x - 1.0).abs() < 0.2 && (yy / found_y - 1.0).abs() < 0.2);
        assert!(xx < 0.6 * psd.slope_covariance()[0] && xx > yy);
        assert!(recipe.sigma() < psd.sigma() && recipe.sigma() > 0.5 * psd.sigma());
        assert_eq!(recipe.correlation_lengths(), psd.correlation_lengths());
        // Lengths in another unit
        let larger = recipe.converted(&|length| 1e3 * length);
        let SurfaceRecipe::Eroded(larger) = larger else {
            panic!("{larger:?}");
        };
        assert_eq!(larger.erosion()[1], Erosion::Etch(Etch { depth: 2e3 }));
        // Etching is refused where the grid is too fine for it
        let fine = FieldSynthesis::new(recipe, grid.0, [1.0 / 64.0; 2], Resolution::Any);
        assert!(matches!(fine, Err(SynthesisError::Erosion(_))));
    }
}
