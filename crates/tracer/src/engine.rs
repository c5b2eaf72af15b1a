//! Engine: the seam at which batches of paths are traced, on the processor or elsewhere.
//!
//! Everything above it knows surfaces by their [`Shape`] and tracers by these traits. A second engine is a crate of its own that
//! implements the three.

use std::fmt::Debug;
use std::sync::Arc;

use asperity_optics::{Layer, Material};
use asperity_tally::{ControlVariate, Tallies, TallySpec};

use crate::accelerators::accelerator::BuildError;
use crate::accelerators::chooser::BuildAccelerator;
use crate::accelerators::kind::AcceleratorKind;
use crate::accelerators::{Accelerator, SearchedSurface};
use crate::geometry::Geometry;
use crate::geometry::shape::Shape;
use crate::interaction::stack::{TracedLayerError, TracedStack};
use crate::path::{Illumination, Tracer, Work};
use crate::random::PathStream;
use crate::ray::HalfSpace;
use crate::sampling::BatchedRays;
use crate::settings::PathSettings;

/// Prepares surfaces for light. Called from any thread, for several surfaces at a time.
pub trait Engine: Debug + Send + Sync {
    /// Prepares a surface, and those below it that have a shape of their own, for any number of cases.
    ///
    /// Clones of `shape` are dropped with what is returned: the memory of a surface serves the next one.
    ///
    /// # Errors
    /// [`BuildError`] if there is no accelerator of this kind for this surface.
    fn prepare(
        &self,
        shape: &Shape,
        accelerator: AcceleratorKind,
    ) -> Result<Box<dyn PreparedSurface>, BuildError>;
}

/// A surface that an engine has prepared.
pub trait PreparedSurface: Send + Sync {
    /// The accelerator that was built.
    fn accelerator(&self) -> AcceleratorKind;

    /// The instructions with which it searches, where there is a choice.
    fn instructions(&self) -> Option<String>;

    /// The tracer of a case, or of cases that differ in a conductor alone.
    ///
    /// # Errors
    /// [`TracedLayerError`] if the layers do not fit below the surface.
    fn tracer(&self, case: &TracedPaths<'_>)
    -> Result<Box<dyn BatchTracer + '_>, TracedLayerError>;
}

/// Materials that paths meet on a surface, and the settings by which paths are followed.
#[derive(Clone, Copy, Debug)]
pub struct TracedPaths<'a> {
    /// The material of the interface; its indices are relative to the medium that the light comes from. Or several conductors, up
    /// to [`MAX_CONDUCTORS`](crate::MAX_CONDUCTORS), which are traced together, and over no layers.
    pub materials: &'a [Material],
    /// The half space that the light comes from.
    pub incident: HalfSpace,
    /// Branching, limits, and polarisation of paths.
    pub settings: PathSettings,
    /// The layers below the surface, from above.
    pub layers: &'a [Layer],
    /// Scatterings inside layers after which a path is truncated.
    pub max_scatterings: u32,
}

/// Traces batches of paths on one surface, of one case or of cases that differ in a conductor alone. Called from any thread, for several groups of batches at a time.
pub trait BatchTracer: Sync {
    /// Traces rays of several batches together, as [`Tracer::batches_of_each`]: sums in a tally of each batch, and the work done, for each
    /// material under its control variate; `None` once `gives_up` returns `true`, which is to be asked several times a second.
    ///
    /// Equal arguments give the bytes of [`Tracer::batches`] for each material, whatever is traced at the same time: random numbers are
    /// functions of `stream`, path and step, and hits are those of brute force. Counts of work are part of that, since
    /// the effort of runs is planned by them.
    fn batches<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        controls: &[Option<&'c ControlVariate>],
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<Vec<(Tallies<'c>, Work)>>;
}

impl<G: Geometry> BatchTracer for Tracer<'_, G> {
    fn batches<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        controls: &[Option<&'c ControlVariate>],
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<Vec<(Tallies<'c>, Work)>> {
        self.batches_of_each(illumination, rays, spec, controls, stream, gives_up)
    }
}

/// The engine of this crate: a [`Tracer`] on the threads that call it.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpuEngine;

impl Engine for CpuEngine {
    fn prepare(
        &self,
        shape: &Shape,
        accelerator: AcceleratorKind,
    ) -> Result<Box<dyn PreparedSurface>, BuildError> {
        match shape {
            Shape::HeightField { top, below } => prepared(top, below, accelerator),
            Shape::Smooth { top, below } => prepared(top, below, accelerator),
            Shape::TriangleMesh { top, below } => prepared(top, below, accelerator),
        }
    }
}

/// A surface with its accelerator.
struct Searched<G> {
    geometry: Arc<G>,
    accelerator: Box<dyn Accelerator<G>>,
}

/// A surface, and the bottoms of the layers below it where they have a shape of their own.
struct OnCpu<G> {
    top: Searched<G>,
    below: Vec<Option<Searched<G>>>,
}

fn prepared<G: BuildAccelerator + 'static>(
    top: &Arc<G>,
    below: &[Option<Arc<G>>],
    kind: AcceleratorKind,
) -> Result<Box<dyn PreparedSurface>, BuildError> {
    let searched = |geometry: &Arc<G>| {
        Ok(Searched {
            geometry: geometry.clone(),
            accelerator: geometry.accelerator(kind)?,
        })
    };
    Ok(Box::new(OnCpu {
        top: searched(top)?,
        below: below
            .iter()
            .map(|bottom| bottom.as_ref().map(searched).transpose())
            .collect::<Result<_, _>>()?,
    }))
}

impl<G: Geometry> Searched<G> {
    fn get(&self) -> SearchedSurface<'_, G> {
        SearchedSurface {
            geometry: &self.geometry,
            accelerator: &*self.accelerator,
        }
    }
}

impl<G: Geometry> PreparedSurface for OnCpu<G> {
    fn accelerator(&self) -> AcceleratorKind {
        self.top.accelerator.kind()
    }

    fn instructions(&self) -> Option<String> {
        self.top.accelerator.instructions()
    }

    fn tracer(
        &self,
        case: &TracedPaths<'_>,
    ) -> Result<Box<dyn BatchTracer + '_>, TracedLayerError> {
        let top = self.top.get();
        let TracedPaths {
            materials,
            incident,
            settings,
            ..
        } = *case;
        let below: Vec<_> = self
            .below
            .iter()
            .map(|bottom| bottom.as_ref().map(Searched::get))
            .collect();
        let stack = TracedStack::new(top, case.layers, &below, case.max_scatterings)?;
        let tracer = Tracer::of_each(top.geometry, top.accelerator, materials, incident, settings);
        Ok(Box::new(tracer.over(stack)))
    }
}
