//! Drawer: gives the engine the meshes of surfaces by their number.

use std::sync::Arc;

use asperity_synthesis::GivesUp;
use asperity_tracer::Shape;

use super::built_surface::{BuiltSurface, Meshes};
use crate::error::SimulateError;
use crate::input::cells::Cells;
use crate::input::random_surfaces::RandomSurfaces;

/// Source of all surfaces of a run, planned once.
pub(crate) enum Drawer<'a> {
    /// A recipe; facets are refined or not.
    Random(&'a RandomSurfaces, bool),
    /// The recipe of smooth cells, of structures or of eroded surfaces that are refined, drawn on grids of other spacings: half the spacing,
    /// and twice the spacing where that resolves the surface. A spline has no finer mesh than itself, and edges have no spectrum.
    Respaced {
        finer: Box<RandomSurfaces>,
        given: &'a RandomSurfaces,
        coarser: Option<Box<RandomSurfaces>>,
    },
    /// Given surfaces; facets are refined or not.
    Given(&'a [Shape], bool),
    /// One that is built, for all numbers.
    Built(&'a Arc<BuiltSurface>),
}

impl<'a> Drawer<'a> {
    /// Returns the drawer of random surfaces, refined or not.
    pub(crate) fn new(given: &'a RandomSurfaces, refine: bool) -> Result<Self, SimulateError> {
        let is_measured = given.recipe().is_measured();
        if !refine || (given.cells() == Cells::Flat && !is_measured) {
            return Ok(Self::Random(given, refine));
        }
        let is_even = given.shape().iter().all(|n| n % 2 == 0);
        let coarser = is_even.then(|| given.scaled(2.0).ok()).flatten();
        Ok(Self::Respaced {
            finer: Box::new(given.scaled(0.5)?),
            given,
            coarser: coarser.map(Box::new),
        })
    }

    /// The meshes of the surface of a seed and number, drawn in the memory given.
    pub(crate) fn draw(
        &self,
        seed: u64,
        number: u64,
        memory: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<Meshes, SimulateError> {
        match self {
            Self::Random(recipe, refine) => {
                Meshes::new(recipe.draw_into(seed, number, memory, gives_up)?, *refine)
            }
            Self::Given(shapes, refine) => Meshes::new(shapes[number as usize].clone(), *refine),
            Self::Built(built) => Ok(Meshes::of_several(built.shapes().cloned().collect())),
            Self::Respaced {
                finer,
                given,
                coarser,
            } => {
                let mut meshes = vec![
                    finer.draw_into(seed, number, Vec::new(), gives_up)?,
                    given.draw_into(seed, number, memory, gives_up)?,
                ];
                if let Some(coarser) = coarser {
                    meshes.push(coarser.draw_into(seed, number, Vec::new(), gives_up)?);
                }
                Ok(Meshes::of_several(meshes))
            }
        }
    }
}
