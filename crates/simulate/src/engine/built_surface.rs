//! One surface, ready to be traced: its meshes, their accelerators, and those of the bottom below it.

use std::sync::Arc;

use asperity_tally::ControlVariate;
use asperity_tracer::{Accelerator, AcceleratorKind, BuildAccelerator, Surface, Tracer};

use super::block_run::LitMesh;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::layer::SearchedSurface;
use crate::input::limits::check_grazing;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::output::work::Used;

/// The meshes of one surface: the one whose results are reported first, then those that show its error.
///
/// The given mesh alone; or, if it is refined, the finer one, the given one, and, if its number of cells is even,
/// the coarser one.
pub(crate) struct Meshes<G> {
    surfaces: Vec<Arc<G>>,
}

impl<G> Meshes<G> {
    /// One mesh alone.
    pub(crate) fn of_one(surface: Arc<G>) -> Self {
        Self {
            surfaces: vec![surface],
        }
    }

    /// Several, in the order in which they are held.
    pub(crate) const fn of_several(surfaces: Vec<Arc<G>>) -> Self {
        Self { surfaces }
    }

    /// The given mesh back.
    fn into_given(mut self) -> Arc<G> {
        let given = usize::from(self.surfaces.len() > 1);
        self.surfaces.swap_remove(given)
    }
}

impl Meshes<Surface> {
    /// The mesh `given`, with a finer and a coarser one if it is to be refined.
    pub(crate) fn new(given: Arc<Surface>, refine: bool) -> Result<Self, SimulateError> {
        if !refine {
            return Ok(Self::of_one(given));
        }
        let finer = given.field().refined()?;
        let coarser = given.field().coarsened().ok();
        let mut surfaces = vec![Arc::new(Surface::new(finer)), given];
        surfaces.extend(coarser.map(|field| Arc::new(Surface::new(field))));
        Ok(Self { surfaces })
    }
}

/// The meshes of a surface, and of what a layer below it ends on, if that has a shape of its own.
pub(crate) struct SurfaceMeshes<G> {
    pub(crate) top: Meshes<G>,
    pub(crate) bottom: Option<Meshes<G>>,
}

/// Meshes with an accelerator each.
struct SearchedMeshes<G: BuildAccelerator> {
    meshes: Meshes<G>,
    accelerators: Vec<Box<dyn Accelerator<G>>>,
}

impl<G: BuildAccelerator> SearchedMeshes<G> {
    fn build(meshes: Meshes<G>, kind: AcceleratorKind) -> Result<Self, SimulateError> {
        let accelerators = meshes
            .surfaces
            .iter()
            .map(|surface| surface.accelerator(kind))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            meshes,
            accelerators,
        })
    }

    fn get(&self, i: usize) -> SearchedSurface<'_, G> {
        SearchedSurface {
            geometry: &self.meshes.surfaces[i],
            accelerator: &*self.accelerators[i],
        }
    }
}

/// One surface, ready to be traced.
pub(crate) struct BuiltSurface<G: BuildAccelerator> {
    top: SearchedMeshes<G>,
    /// What a layer below it ends on, if that has a shape of its own.
    bottom: Option<SearchedMeshes<G>>,
}

impl<G: BuildAccelerator> BuiltSurface<G> {
    /// Builds the accelerators.
    ///
    /// A coarser mesh is left out if either the surface or the bottom has none.
    pub(crate) fn build(
        meshes: SurfaceMeshes<G>,
        kind: AcceleratorKind,
    ) -> Result<Self, SimulateError> {
        let SurfaceMeshes {
            mut top,
            mut bottom,
        } = meshes;
        if let Some(bottom) = &mut bottom {
            let common = top.surfaces.len().min(bottom.surfaces.len());
            top.surfaces.truncate(common);
            bottom.surfaces.truncate(common);
        }
        let top = SearchedMeshes::build(top, kind)?;
        let bottom = bottom.map(|meshes| SearchedMeshes::build(meshes, kind));
        Ok(Self {
            top,
            bottom: bottom.transpose()?,
        })
    }

    /// Its meshes, the one whose results are reported first.
    pub(crate) fn meshes(&self) -> impl Iterator<Item = &G> {
        self.top.meshes.surfaces.iter().map(|surface| &**surface)
    }

    /// The accelerator that was built.
    pub(crate) fn used(&self) -> Used {
        Used::of(&*self.top.accelerators[0])
    }

    /// The meshes with the light of a case, which is estimated by the method that `method_of` gives for each
    /// mesh by its number.
    pub(crate) fn lit<'a>(
        &'a self,
        case: &Case,
        method_of: impl Fn(usize) -> &'a Method,
        settings: &Settings,
    ) -> Result<Vec<LitMesh<'a, G>>, SimulateError> {
        let (material, light) = (case.material, &case.light);
        let mesh = |i: usize| {
            let top = self.top.get(i);
            check_grazing(top.geometry, light.incidence)?;
            let SearchedSurface {
                geometry,
                accelerator,
            } = top;
            let method: &'a Method = method_of(i);
            let mut tracer = Tracer::new(geometry, accelerator, material, light.from, method.paths);
            if let Some(layer) = &case.layer {
                let bottom = self.bottom.as_ref().map(|bottom| bottom.get(i));
                tracer = tracer.over(layer.traced(top, bottom, settings.max_scatterings)?);
            }
            let control_variate: Option<&'a ControlVariate> = method.control_variate();
            Ok(LitMesh {
                tracer,
                spec: settings.spec_of(case),
                light: method.illumination(light, settings.sampling),
                control_variate,
                mirror: method.mirror,
            })
        };
        (0..self.top.accelerators.len()).map(mesh).collect()
    }

    /// The given mesh back, if nothing else holds it.
    pub(crate) fn into_given(self) -> Option<G> {
        Arc::into_inner(self.top.meshes.into_given())
    }
}
