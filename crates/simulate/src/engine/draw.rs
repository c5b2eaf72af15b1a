//! Drawer: gives the engine the meshes of surfaces by their number.

use asperity_surface::{
    FieldSynthesis, Resolution, SplineSurface, SplineSynthesis, Synthesis, SynthesisError,
};
use asperity_tracer::Shape;

use super::built_surface::Meshes;
use crate::error::SimulateError;
use crate::input::cells::Cells;
use crate::input::random_surfaces::{FieldSurfaces, RandomSurfaces};

/// The recipe of all surfaces of a run, planned once.
pub(crate) enum Drawer<'a> {
    /// Flat cells between Gaussian heights, which are refined or not.
    Gaussian(&'a Synthesis, bool),
    /// The same between other heights.
    Fields(&'a FieldSynthesis, bool),
    /// Splines of Gaussian coefficients.
    GaussianSplines(Box<Splines<'a, SplineSynthesis>>),
    /// Splines through other heights.
    SplinesThroughFields(Box<Splines<'a, FieldSynthesis>>),
    /// Nothing: surfaces are given, and refined or not.
    Given(&'a [Shape], bool),
}

impl<'a> Drawer<'a> {
    /// Of surfaces that are refined or not.
    pub(crate) fn new(surfaces: &'a RandomSurfaces, refine: bool) -> Result<Self, SimulateError> {
        Ok(match surfaces {
            RandomSurfaces::Flat(recipe) => Self::Gaussian(recipe, refine),
            RandomSurfaces::Smooth(recipe) => {
                Self::GaussianSplines(Box::new(Splines::new(recipe, refine)?))
            }
            RandomSurfaces::Fields(FieldSurfaces { synthesis, cells }) => match cells {
                Cells::Flat => Self::Fields(synthesis, refine),
                Cells::Smooth => {
                    Self::SplinesThroughFields(Box::new(Splines::new(synthesis, refine)?))
                }
            },
        })
    }

    /// The meshes of the surface of a seed and number, drawn in the memory given.
    pub(crate) fn draw(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<Meshes, SimulateError> {
        let (field, refine) = match self {
            Self::Gaussian(recipe, refine) => (recipe.draw_into(seed, number, memory)?, *refine),
            Self::Fields(recipe, refine) => (recipe.draw_into(seed, number, memory)?, *refine),
            Self::GaussianSplines(recipe) => return recipe.draw(seed, number, memory),
            Self::SplinesThroughFields(recipe) => return recipe.draw(seed, number, memory),
            Self::Given(shapes, refine) => {
                return Meshes::new(shapes[number as usize].clone(), *refine);
            }
        };
        Meshes::new(Shape::height_field(field), refine)
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

    /// The given one alone, or the finest first.
    fn draw(&self, seed: u64, number: u64, memory: Vec<f64>) -> Result<Meshes, SimulateError> {
        let mut drawn = Vec::new();
        if let Some(finer) = &self.finer {
            drawn.push(finer.spline(seed, number, Vec::new())?);
        }
        drawn.push(self.given.spline(seed, number, memory)?);
        if let Some(coarser) = &self.coarser {
            drawn.push(coarser.spline(seed, number, Vec::new())?);
        }
        let shapes = drawn.into_iter().map(Shape::smooth);
        Ok(Meshes::of_several(shapes.collect()))
    }
}
