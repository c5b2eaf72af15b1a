//! One surface, ready to be traced: its meshes, as an engine has prepared them.

use std::sync::Arc;

use asperity_optics::{BottomSurface, Layer, Material};
use asperity_surface::{Border, SlopeMoments};
use asperity_tracer::{
    AcceleratorKind, Engine, HalfSpace, PreparedSurface, Shape, Surface, TracedPaths,
};

use crate::engine::prepare::case_run::CaseRun;
use crate::engine::trace::block_run::LitMesh;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::check_shape;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::output::work::Used;

/// The meshes of one surface, the one whose results are reported first: the given one alone; or, if it is refined, the finer
/// one, the given one, and, if its number of cells is even, the coarser one.
pub(crate) struct Meshes(Vec<Shape>);

impl Meshes {
    /// The mesh `given`, with a finer and a coarser one if it is to be refined. Smooth cells and triangles have none.
    pub(crate) fn new(given: Shape, refine: bool) -> Result<Self, SimulateError> {
        match given {
            Shape::HeightField { top, below } if refine => {
                let bottoms = below.into_iter().enumerate();
                let bottoms = bottoms.filter_map(|(layer, bottom)| Some((layer, bottom?)));
                bottoms
                    .into_iter()
                    .try_fold(Self::refined(top)?, |meshes, (layer, bottom)| {
                        Ok(meshes.over(layer, Self::refined(bottom)?))
                    })
            }
            given => Ok(Self(vec![given])),
        }
    }

    fn refined(given: Arc<Surface>) -> Result<Self, SimulateError> {
        let finer = given.field().refined()?;
        let coarser = given.field().coarsened().ok();
        let below = Vec::new();
        let given = Shape::HeightField { top: given, below };
        let mut meshes = vec![Shape::height_field(finer), given];
        meshes.extend(coarser.map(Shape::height_field));
        Ok(Self(meshes))
    }

    /// Several, in the order in which they are held.
    pub(crate) const fn of_several(meshes: Vec<Shape>) -> Self {
        Self(meshes)
    }

    /// The meshes over those of the bottom of a layer. A coarser mesh is left out if either has none.
    pub(crate) fn over(self, layer: usize, Self(bottoms): Self) -> Self {
        let pairs = self.0.into_iter().zip(bottoms);
        let over = pairs.filter_map(|(top, bottom)| top.over(layer, bottom));
        Self(over.collect())
    }

    /// Moments of the slopes of the given mesh; `None` for triangles.
    pub(crate) fn slope_moments(&self) -> Option<SlopeMoments> {
        match &self.0[place_of_given(self.0.len())] {
            Shape::HeightField { top, .. } => Some(top.field().slope_moments()),
            Shape::Smooth { top, .. } => Some(top.spline().slope_moments()),
            Shape::TriangleMesh { .. } => None,
        }
    }
}

/// Place of the given mesh among so many.
fn place_of_given(meshes: usize) -> usize {
    usize::from(meshes > 1)
}

/// One surface, ready to be traced.
pub(crate) struct BuiltSurface {
    meshes: Vec<BuiltMesh>,
}

struct BuiltMesh {
    shape: Shape,
    prepared: Box<dyn PreparedSurface>,
    /// The surface and its layers turned over, for layers that are lit from below; by the shapes of their bottoms.
    turned_over: Vec<(Vec<BottomSurface>, Box<dyn PreparedSurface>)>,
}

impl BuiltMesh {
    fn build(
        shape: Shape,
        cases: &[CaseRun],
        kind: AcceleratorKind,
        engine: &dyn Engine,
    ) -> Result<Self, SimulateError> {
        let mut turned_over: Vec<(Vec<BottomSurface>, Box<dyn PreparedSurface>)> = Vec::new();
        for case in cases.iter().map(|run| &run.case) {
            let bottoms = bottoms(case);
            if case.is_turned_over() && turned_over.iter().all(|(other, _)| *other != bottoms) {
                let turned = shape.turned_over(&case.layers);
                turned_over.push((bottoms, engine.prepare(&turned, kind)?));
            }
        }
        Ok(Self {
            prepared: engine.prepare(&shape, kind)?,
            shape,
            turned_over,
        })
    }

    /// The surface with the side up that is lit in a case.
    fn lit_side_up(&self, case: &Case) -> &dyn PreparedSurface {
        let bottoms = bottoms(case);
        let turned = self.turned_over.iter();
        let mut turned = turned.filter(|(other, _)| case.is_turned_over() && *other == bottoms);
        turned
            .next()
            .map_or(&*self.prepared, |(_, turned)| &**turned)
    }
}

/// Shapes of the bottoms of all layers.
fn bottoms(case: &Case) -> Vec<BottomSurface> {
    let ends = case.layers.iter().filter_map(Layer::end);
    ends.map(|end| end.shape).collect()
}

impl BuiltSurface {
    /// Has an engine prepare all meshes for the light of `cases`.
    pub(crate) fn build(
        meshes: Meshes,
        cases: &[CaseRun],
        kind: AcceleratorKind,
        engine: &dyn Engine,
    ) -> Result<Self, SimulateError> {
        let build = |shape| BuiltMesh::build(shape, cases, kind, engine);
        let meshes = meshes.0.into_iter().map(build);
        Ok(Self {
            meshes: meshes.collect::<Result<_, SimulateError>>()?,
        })
    }

    /// Its meshes, the one whose results are reported first.
    pub(crate) fn shapes(&self) -> impl Iterator<Item = &Shape> {
        self.meshes.iter().map(|mesh| &mesh.shape)
    }

    /// The accelerator that was built.
    pub(crate) fn used(&self) -> Used {
        Used::of(&*self.meshes[0].prepared)
    }

    /// Border of the surface.
    pub(crate) fn border(&self) -> Border {
        self.meshes[0].shape.border()
    }

    /// The meshes with the light of cases that are traced together.
    pub(crate) fn lit<'a>(
        &'a self,
        runs: &[&'a CaseRun],
        settings: &Settings,
    ) -> Result<Vec<LitMesh<'a>>, SimulateError> {
        let [first, ..] = runs else {
            return Ok(Vec::new());
        };
        let case = &first.case;
        let (first_face, layers) = case.towards_light().ok_or(SimulateError::DarkBottom)?;
        let materials: Vec<Material> = match layers.as_slice() {
            [] => runs.iter().map(|run| run.case.material).collect(),
            _ => vec![first_face],
        };
        let lit = |(i, mesh): (usize, &'a BuiltMesh)| {
            check_shape(&mesh.shape, case.light.incidence)?;
            let method = first.method_on(i);
            let methods = runs.iter().map(|run| run.method_on(i));
            let paths = TracedPaths {
                materials: &materials,
                incident: match case.is_turned_over() {
                    true => HalfSpace::Above,
                    false => case.light.from,
                },
                settings: method.paths,
                layers: &layers,
                max_scatterings: settings.max_scatterings,
            };
            Ok(LitMesh {
                tracer: mesh.lit_side_up(case).tracer(&paths)?,
                spec: settings.spec_of(case),
                light: method.illumination(&case.light, settings.sampling),
                control_variates: methods.clone().map(Method::control_variate).collect(),
                mirrors: methods.map(|method| method.mirror).collect(),
            })
        };
        self.meshes.iter().enumerate().map(lit).collect()
    }

    /// The memory of the given mesh, for the next surface; none if something else holds it.
    pub(crate) fn into_memory(mut self) -> Vec<f64> {
        let given = place_of_given(self.meshes.len());
        let BuiltMesh {
            shape, prepared, ..
        } = self.meshes.swap_remove(given);
        drop(prepared);
        let memory = match shape {
            Shape::HeightField { top, .. } => {
                Arc::into_inner(top).map(|top| top.into_field().into_heights())
            }
            Shape::Smooth { top, .. } => {
                Arc::into_inner(top).map(|top| top.into_spline().into_coefficients())
            }
            Shape::TriangleMesh { .. } => None,
        };
        memory.unwrap_or_default()
    }
}
