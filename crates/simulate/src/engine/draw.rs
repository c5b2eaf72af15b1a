//! Draw: recipes of random surfaces, from which the engine gets meshes ready to be built, and their memory back.

use std::sync::Arc;

use asperity_surface::{HeightField, SplineSurface, SplineSynthesis, Synthesis};
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

    fn meshes(field: HeightField, refine: bool) -> Result<Meshes<Surface>, SimulateError> {
        Meshes::new(Arc::new(Surface::new(field)), refine)
    }

    fn into_memory(surface: Surface) -> Vec<f64> {
        surface.into_field().into_heights()
    }
}

/// The surfaces of a recipe, of every second sample along x and y.
pub(crate) struct EverySecondSample<'a>(pub(crate) &'a Synthesis);

impl Draw for EverySecondSample<'_> {
    type Drawn = HeightField;
    type Surface = Surface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<HeightField, SimulateError> {
        Ok(self.0.draw_into(seed, number, memory)?.coarsened()?)
    }

    fn meshes(field: HeightField, refine: bool) -> Result<Meshes<Surface>, SimulateError> {
        Synthesis::meshes(field, refine)
    }

    fn into_memory(surface: Surface) -> Vec<f64> {
        Synthesis::into_memory(surface)
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

    /// Smooth cells are not refined.
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
