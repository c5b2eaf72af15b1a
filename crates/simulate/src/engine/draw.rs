//! Draw: recipes of random surfaces, from which the engine gets meshes ready to be built, and their memory back.

use std::sync::Arc;

use asperity_surface::{HeightField, SlopeMoments, SplineSurface, SplineSynthesis, Synthesis};
use asperity_tracer::{BuildAccelerator, SmoothSurface, Surface};

use super::built_surface::Meshes;
use crate::error::SimulateError;

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

impl Draw for Synthesis {
    type Drawn = HeightField;
    type Surface = Surface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<HeightField, SimulateError> {
        Ok(self.draw_into(seed, number, memory)?)
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

impl Draw for SplineSynthesis {
    type Drawn = SplineSurface;
    type Surface = SmoothSurface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<SplineSurface, SimulateError> {
        Ok(self.draw_into(seed, number, memory)?)
    }

    fn slope_moments(spline: &SplineSurface) -> SlopeMoments {
        spline.slope_moments()
    }

    /// One alone: a spline has no finer mesh than itself.
    fn meshes(
        spline: SplineSurface,
        _refine: bool,
    ) -> Result<Meshes<SmoothSurface>, SimulateError> {
        Ok(Meshes::of_one(Arc::new(SmoothSurface::new(spline))))
    }

    fn into_memory(surface: SmoothSurface) -> Vec<f64> {
        surface.into_spline().into_coefficients()
    }
}

/// Splines through the same waves at several spacings: half the given one, that, and twice it, if that resolves them.
pub(crate) struct RefinedSplines {
    finer: SplineSynthesis,
    given: SplineSynthesis,
    coarser: Option<SplineSynthesis>,
}

impl RefinedSplines {
    /// Of the recipe for the given spacing.
    pub(crate) fn new(given: &SplineSynthesis) -> Result<Self, SimulateError> {
        let respaced = |scale: f64| {
            let shape = given.shape().map(|n| (n as f64 / scale) as usize);
            let spacing = given.spacing().map(|d| d * scale);
            SplineSynthesis::new(given.psd().clone(), shape, spacing, false)
        };
        let is_even = given.shape().iter().all(|n| n % 2 == 0);
        Ok(Self {
            finer: respaced(0.5)?,
            given: given.clone(),
            coarser: respaced(2.0).ok().filter(|_| is_even),
        })
    }
}

impl Draw for RefinedSplines {
    /// The finest first.
    type Drawn = Vec<SplineSurface>;
    type Surface = SmoothSurface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<Vec<SplineSurface>, SimulateError> {
        let mut drawn = vec![
            self.finer.draw(seed, number)?,
            self.given.draw_into(seed, number, memory)?,
        ];
        if let Some(coarser) = &self.coarser {
            drawn.push(coarser.draw(seed, number)?);
        }
        Ok(drawn)
    }

    /// Those of the surface at the given spacing.
    fn slope_moments(drawn: &Vec<SplineSurface>) -> SlopeMoments {
        drawn[1].slope_moments()
    }

    fn meshes(
        drawn: Vec<SplineSurface>,
        _refine: bool,
    ) -> Result<Meshes<SmoothSurface>, SimulateError> {
        let surfaces = drawn
            .into_iter()
            .map(|spline| Arc::new(SmoothSurface::new(spline)));
        Ok(Meshes::of_several(surfaces.collect()))
    }

    fn into_memory(surface: SmoothSurface) -> Vec<f64> {
        SplineSynthesis::into_memory(surface)
    }
}
