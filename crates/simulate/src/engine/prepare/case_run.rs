//! Case run: a case, and how it is estimated.

use std::sync::Arc;

use asperity_optics::{BottomSurface, Layer};
use asperity_tracer::PathSettings;

use crate::input::case::Case;
use crate::input::share::Slice;
use crate::methods::method::Method;
use crate::output::chosen_paths::{PathStrategy, TriedPaths};
use crate::output::stopping::PilotFigures;

/// A case, how it is estimated, and the results of its pilot run.
#[derive(Clone, Debug)]
pub(crate) struct CaseRun {
    /// Number of the case among those of the run.
    pub(crate) number: usize,
    pub(crate) case: Case,
    /// One method per mesh of a given surface; one for all meshes of random surfaces.
    pub(crate) methods: Vec<Arc<Method>>,
    /// Paths that the pilot run tried; empty without a trial.
    pub(crate) tried: Vec<TriedPaths>,
    pub(crate) pilot: Option<PilotFigures>,
    /// Error added by the mesh, as estimated by the pilot run.
    pub(crate) mesh_error: Option<f64>,
    /// Surfaces, or blocks of rays, that are traced.
    pub(crate) slice: Slice,
}

impl CaseRun {
    pub(crate) const fn new(number: usize, case: Case, methods: Vec<Arc<Method>>) -> Self {
        Self {
            number,
            case,
            methods,
            tried: Vec::new(),
            pilot: None,
            mesh_error: None,
            slice: Slice::WHOLE,
        }
    }

    /// The method on the mesh whose results are reported.
    pub(crate) fn method(&self) -> &Arc<Method> {
        &self.methods[0]
    }

    pub(crate) fn method_on(&self, mesh: usize) -> &Method {
        self.methods.get(mesh).unwrap_or(self.method())
    }

    pub(crate) fn strategy(&self) -> PathStrategy {
        PathStrategy::of(self.method())
    }

    /// The case by other methods.
    pub(crate) fn by(&self, methods: Vec<Arc<Method>>) -> Self {
        Self {
            methods,
            ..self.clone()
        }
    }

    /// The case on other paths.
    pub(crate) fn on(&self, paths: PathSettings) -> Self {
        let methods = self.methods.iter().map(|method| method.on(paths));
        self.by(methods.map(Arc::new).collect())
    }
}

/// Numbers of the layers below which a bottom of its own is drawn.
pub(crate) fn independent_bottoms(cases: &[CaseRun]) -> Vec<usize> {
    let is_drawn = |case: &Case, layer: usize| {
        let end = case.layers.get(layer).and_then(Layer::end);
        end.is_some_and(|end| end.shape == BottomSurface::Independent)
    };
    let most = cases.iter().map(|run| run.case.layers.len()).max();
    let layers = 0..most.unwrap_or(0);
    layers
        .filter(|&layer| cases.iter().any(|run| is_drawn(&run.case, layer)))
        .collect()
}
