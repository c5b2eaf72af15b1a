//! Engines: the one that a run is given prepares each surface once and traces all light.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Bottom, Incidence, Layer, ParticipatingMedium, PhaseFunction};
use asperity_simulate::{
    BottomSurface, Case, Effort, Estimator, Light, Quantity, Regions, Settings, Shape, Silent,
    Simulation, SurfaceSource,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{ControlVariate, Tallies, TallySpec};
use asperity_tracer::{
    AcceleratorKind, BatchTracer, BatchedRays, BuildError, CpuEngine, Engine, Illumination,
    PathStream, PreparedSurface, TracedLayerError, TracedPaths, Work,
};

use crate::resuming::numbers;
use crate::support::{Rough, effort, glass, target};

/// Surfaces that were prepared, rays of all cases, and rays that were traced for them.
#[derive(Debug, Default)]
pub(crate) struct Counts([AtomicU64; 3]);

impl Counts {
    pub(crate) fn get(&self) -> [u64; 3] {
        self.0.each_ref().map(|count| count.load(Ordering::Relaxed))
    }
}

/// A part of an engine, and what it counts.
#[derive(Debug)]
pub(crate) struct Counted<T>(pub(crate) T, pub(crate) Arc<Counts>);

impl Engine for Counted<CpuEngine> {
    fn prepare(
        &self,
        shape: &Shape,
        accelerator: AcceleratorKind,
    ) -> Result<Box<dyn PreparedSurface>, BuildError> {
        let Self(engine, counts) = self;
        counts.0[0].fetch_add(1, Ordering::Relaxed);
        let prepared = engine.prepare(shape, accelerator)?;
        Ok(Box::new(Counted(prepared, counts.clone())))
    }
}

impl PreparedSurface for Counted<Box<dyn PreparedSurface>> {
    fn accelerator(&self) -> AcceleratorKind {
        self.0.accelerator()
    }

    fn instructions(&self) -> Option<String> {
        self.0.instructions()
    }

    fn tracer(
        &self,
        paths: &TracedPaths<'_>,
    ) -> Result<Box<dyn BatchTracer + '_>, TracedLayerError> {
        let tracer = self.0.tracer(paths)?;
        Ok(Box::new(Counted(tracer, self.1.clone())))
    }
}

impl BatchTracer for Counted<Box<dyn BatchTracer + '_>> {
    fn batches<'c>(
        &self,
        illumination: &Illumination,
        rays: &BatchedRays,
        spec: TallySpec,
        controls: &[Option<&'c ControlVariate>],
        stream: PathStream,
        gives_up: &dyn Fn() -> bool,
    ) -> Option<Vec<(Tallies<'c>, Work)>> {
        let found = self
            .0
            .batches(illumination, rays, spec, controls, stream, gives_up)?;
        for (number, (_, work)) in found.iter().enumerate() {
            self.1.0[1].fetch_add(work.rays, Ordering::Relaxed);
            let traced = if number == 0 { work.rays } else { 0 };
            self.1.0[2].fetch_add(traced, Ordering::Relaxed);
        }
        Some(found)
    }
}

/// Random surfaces, over bottoms of their own too; one given surface, refined, in regions and up to a target error.
#[test]
fn the_given_engine_prepares_each_surface_once_and_traces_all_rays() {
    let medium =
        ParticipatingMedium::from_mean_free_path(20.0, 0.9, PhaseFunction::Isotropic).unwrap();
    let layer = Layer::slab(medium, 40.0, Bottom::MIRROR).unwrap();
    let rough = Rough::smooth(2.0, 4.0, 32);
    let over = vec![layer.on(BottomSurface::Independent)];
    let random = [Vec::new(), over].map(|layers| Case {
        layers,
        ..rough.case(glass(), 30.0)
    });
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
    let surface = SurfaceSource::height_field(synthesis.draw(1, 0).unwrap());
    let given = [10.0, 50.0].map(|theta| {
        let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
        Case::new(surface.clone(), glass(), light)
    });
    let refined = Settings {
        refine: true,
        ..effort(1, 4000)
    };
    let in_regions = Settings {
        regions: Some(Regions {
            columns: 3,
            rows: 2,
        }),
        estimator: Estimator::Plain,
        ..effort(1, 4000)
    };
    let to_target = Settings {
        effort: target(1e-2, Quantity::Rings),
        ..Settings::default()
    };
    for (cases, settings, meshes, surfaces) in [
        (&random, effort(3, 3000), 1, 3),
        (&given, refined, 3, 1),
        (&given, in_regions, 1, 1),
        (&given, to_target, 1, 1),
    ] {
        let counts = Arc::new(Counts::default());
        let engine = Arc::new(Counted(CpuEngine, counts.clone()));
        let simulation = Simulation::new(cases, &settings).unwrap();
        let expected = simulation.clone().run(&Silent).unwrap();
        let found = simulation.on(engine).run(&Silent).unwrap();
        assert!(numbers(&found) == numbers(&expected), "other numbers");
        let [prepared, traced, _] = counts.get();
        assert_eq!(prepared, surfaces * meshes);
        let rays: u64 = found.iter().map(|one| one.work.rays).sum();
        // A pilot run has rays of its own.
        if matches!(settings.effort, Effort::Rays { .. }) {
            assert_eq!(traced, rays * meshes);
        } else {
            assert!(traced > rays, "{traced} {rays}");
        }
    }
}
