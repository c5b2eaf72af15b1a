//! Draw of fields: recipes whose heights are drawn on a grid, and the splines through them.

use std::sync::Arc;

use asperity_surface::{FieldSynthesis, HeightField, Resolution, SlopeMoments, SplineSurface};
use asperity_tracer::{SmoothSurface, Surface};

use super::built_surface::Meshes;
use super::draw::Draw;
use crate::error::SimulateError;

impl Draw for FieldSynthesis {
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

/// Splines through the heights of surfaces: of the given spacing alone, or, if they are refined, of half the spacing, of that,
/// and of twice it, if there is such a grid.
pub(crate) struct SplinesThroughFields {
    /// In the order in which their meshes are held.
    syntheses: Vec<FieldSynthesis>,
    /// Which of them has the given spacing.
    given: usize,
}

impl SplinesThroughFields {
    /// Of the recipe for the given spacing.
    pub(crate) fn new(given: &FieldSynthesis, refine: bool) -> Result<Self, SimulateError> {
        if !refine {
            return Ok(Self {
                syntheses: vec![given.clone()],
                given: 0,
            });
        }
        let respaced = |scale: f64| {
            let shape = given.shape().map(|n| (n as f64 / scale) as usize);
            let spacing = given.spacing().map(|d| d * scale);
            let recipe = given.recipe().clone();
            FieldSynthesis::new(recipe, shape, spacing, Resolution::Splines)
        };
        let mut syntheses = vec![respaced(0.5)?, given.clone()];
        let is_even = given.shape().iter().all(|n| n % 2 == 0);
        syntheses.extend(respaced(2.0).ok().filter(|_| is_even));
        Ok(Self {
            syntheses,
            given: 1,
        })
    }
}

/// Surfaces of several spacings, and which of them has the given one.
pub(crate) struct DrawnSplines {
    splines: Vec<SplineSurface>,
    given: usize,
}

impl Draw for SplinesThroughFields {
    type Drawn = DrawnSplines;
    type Surface = SmoothSurface;

    fn draw_into(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
    ) -> Result<DrawnSplines, SimulateError> {
        let mut memory = Some(memory);
        let splines = self.syntheses.iter().enumerate().map(|(i, synthesis)| {
            let room = memory.take_if(|_| i == self.given).unwrap_or_default();
            let field = synthesis.draw_into(seed, number, room)?;
            Ok(SplineSurface::through(&field))
        });
        Ok(DrawnSplines {
            splines: splines.collect::<Result<_, SimulateError>>()?,
            given: self.given,
        })
    }

    /// Those of the surface at the given spacing.
    fn slope_moments(drawn: &DrawnSplines) -> SlopeMoments {
        drawn.splines[drawn.given].slope_moments()
    }

    fn meshes(drawn: DrawnSplines, _refine: bool) -> Result<Meshes<SmoothSurface>, SimulateError> {
        let surfaces = drawn.splines.into_iter();
        let surfaces = surfaces.map(|spline| Arc::new(SmoothSurface::new(spline)));
        Ok(Meshes::of_several(surfaces.collect()))
    }

    fn into_memory(surface: SmoothSurface) -> Vec<f64> {
        surface.into_spline().into_coefficients()
    }
}
