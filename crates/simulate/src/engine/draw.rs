//! Draw: recipes of random surfaces, from which the engine gets meshes ready to be built, and their memory back.

use std::sync::Arc;

use asperity_surface::{
    FieldSynthesis, HeightField, Resolution, SlopeMoments, SplineSurface, SplineSynthesis,
    Synthesis, SynthesisError,
};
use asperity_tracer::{BuildAccelerator, SmoothSurface, Surface};

use super::built_surface::Meshes;
use crate::error::SimulateError;
use crate::input::cells::Cells;
use crate::input::random_surfaces::{Planned, RandomSurfaces};

/// A recipe of random surfaces of one kind of cells.
pub(crate) trait Draw {
    /// What random numbers give.
    type Drawn;
    /// The same as light meets it.
    type Surface: BuildAccelerator;

    /// Draws the surface of a seed and number in the memory given.
    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<Self::Drawn, SimulateError>;

    /// Moments of the slopes of a surface.
    fn slope_moments(drawn: &Self::Drawn) -> SlopeMoments;

    /// The meshes of a surface, with a finer and a coarser one if it is to be refined.
    fn meshes(drawn: Self::Drawn, refine: bool) -> Result<Meshes<Self::Surface>, SimulateError>;

    /// The memory of a surface, for the next one.
    fn into_memory(surface: Self::Surface) -> Vec<f64>;
}

/// The recipe of all surfaces of a run, planned once.
pub(crate) enum Drawer<'a> {
    /// Flat cells.
    Facets(Facets<'a>),
    /// Splines of Gaussian coefficients.
    GaussianSplines(Box<Splines<'a, SplineSynthesis>>),
    /// Splines through other heights.
    SplinesThroughFields(Box<Splines<'a, FieldSynthesis>>),
}

impl<'a> Drawer<'a> {
    /// Of surfaces that are refined or not.
    pub(crate) fn new(surfaces: &'a RandomSurfaces, refine: bool) -> Result<Self, SimulateError> {
        Ok(match surfaces.planned()? {
            Planned::Flat(recipe) => Self::Facets(Facets::OfGaussian(recipe)),
            Planned::Smooth(recipe) => {
                Self::GaussianSplines(Box::new(Splines::new(recipe, refine)?))
            }
            Planned::Fields(synthesis) => match surfaces.cells() {
                Cells::Flat => Self::Facets(Facets::OfOther(synthesis)),
                Cells::Smooth => {
                    Self::SplinesThroughFields(Box::new(Splines::new(synthesis, refine)?))
                }
            },
        })
    }
}

/// Two triangles per cell between the heights that a recipe draws.
pub(crate) enum Facets<'a> {
    /// Gaussian heights.
    OfGaussian(&'a Synthesis),
    /// Heights of any other recipe.
    OfOther(&'a FieldSynthesis),
}

impl Draw for Facets<'_> {
    type Drawn = HeightField;
    type Surface = Surface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<HeightField, SimulateError> {
        Ok(match self {
            Self::OfGaussian(recipe) => recipe.draw_into(seed, number, memory)?,
            Self::OfOther(recipe) => recipe.draw_into(seed, number, memory)?,
        })
    }

    fn slope_moments(field: &HeightField) -> SlopeMoments {
        field.slope_moments()
    }

    fn meshes(field: HeightField, refine: bool) -> Result<Meshes<Surface>, SimulateError> {
        Meshes::new(Arc::new(Surface::new(field)), refine)
    }

    fn into_memory(surface: Surface) -> Vec<f64> {
        surface.into_field().into_heights()
    }
}

/// Draws splines, and the same surfaces on grids of other spacings.
pub(crate) trait DrawSpline: Sized {
    /// That of a seed and number, in the memory given.
    fn spline(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<SplineSurface, SynthesisError>;

    /// Samples `[ny, nx]`.
    fn shape(&self) -> [usize; 2];

    /// The recipe of the same surfaces on a grid of `scale` times the spacing.
    fn respaced(&self, scale: f64) -> Result<Self, SynthesisError>;
}

/// Shape and spacing of the same tile at `scale` times the spacing.
fn respaced(shape: [usize; 2], spacing: [f64; 2], scale: f64) -> ([usize; 2], [f64; 2]) {
    (
        shape.map(|n| (n as f64 / scale) as usize),
        spacing.map(|d| d * scale),
    )
}

impl DrawSpline for SplineSynthesis {
    fn spline(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<SplineSurface, SynthesisError> {
        self.draw_into(seed, number, memory)
    }

    fn shape(&self) -> [usize; 2] {
        Self::shape(self)
    }

    fn respaced(&self, scale: f64) -> Result<Self, SynthesisError> {
        let (shape, spacing) = respaced(Self::shape(self), self.spacing(), scale);
        Self::new(self.psd().clone(), shape, spacing, false)
    }
}

impl DrawSpline for FieldSynthesis {
    fn spline(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<SplineSurface, SynthesisError> {
        let field = self.draw_into(seed, number, memory)?;
        Ok(SplineSurface::through(&field))
    }

    fn shape(&self) -> [usize; 2] {
        Self::shape(self)
    }

    fn respaced(&self, scale: f64) -> Result<Self, SynthesisError> {
        let (shape, spacing) = respaced(Self::shape(self), self.spacing(), scale);
        Self::new(self.recipe().clone(), shape, spacing, Resolution::Splines)
    }
}

/// Splines of the given spacing; if they are refined also of half of it, and of twice, if that resolves them.
pub(crate) struct Splines<'a, T> {
    finer: Option<T>,
    given: &'a T,
    coarser: Option<T>,
}

impl<'a, T: DrawSpline> Splines<'a, T> {
    fn new(given: &'a T, refine: bool) -> Result<Self, SimulateError> {
        let is_even = given.shape().iter().all(|n| n % 2 == 0);
        Ok(Self {
            finer: refine.then(|| given.respaced(0.5)).transpose()?,
            given,
            coarser: (refine && is_even)
                .then(|| given.respaced(2.0).ok())
                .flatten(),
        })
    }
}

impl<T: DrawSpline> Draw for Splines<'_, T> {
    /// The given one alone, or the finest first.
    type Drawn = Vec<SplineSurface>;
    type Surface = SmoothSurface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<Vec<SplineSurface>, SimulateError> {
        let mut drawn = Vec::new();
        if let Some(finer) = &self.finer {
            drawn.push(finer.spline(seed, number, Vec::new())?);
        }
        drawn.push(self.given.spline(seed, number, memory)?);
        if let Some(coarser) = &self.coarser {
            drawn.push(coarser.spline(seed, number, Vec::new())?);
        }
        Ok(drawn)
    }

    /// Those of the surface at the given spacing.
    fn slope_moments(drawn: &Vec<SplineSurface>) -> SlopeMoments {
        drawn[usize::from(drawn.len() > 1)].slope_moments()
    }

    /// Those drawn: a spline has no finer mesh than itself.
    fn meshes(
        drawn: Vec<SplineSurface>,
        _refine: bool,
    ) -> Result<Meshes<SmoothSurface>, SimulateError> {
        let surfaces = drawn.into_iter();
        let surfaces = surfaces.map(|spline| Arc::new(SmoothSurface::new(spline)));
        Ok(Meshes::of_several(surfaces.collect()))
    }

    fn into_memory(surface: SmoothSurface) -> Vec<f64> {
        surface.into_spline().into_coefficients()
    }
}
