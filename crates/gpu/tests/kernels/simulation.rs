//! Simulation: whole runs of the default settings on the kernels, which give the numbers of the CPU engine and hand nothing to it.

use std::sync::Arc;

use asperity_gpu::GpuEngine;
use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, Light, Outcome, Settings, Silent, Simulation, SurfaceSource,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::TallyResult;

use crate::host::Host;

/// All numbers of outcomes, as text.
fn numbers(outcomes: &[Outcome]) -> String {
    let of_one = |one: &Outcome| {
        let entries = one.statistics.spec().entries();
        let errors: Vec<_> = entries.map(|entry| one.errors.at(entry)).collect();
        let work = (one.work.rays, one.work.segments, one.work.scatterings);
        format!(
            "{:?} {errors:?} {work:?} {:?}",
            one.statistics, one.stopping
        )
    };
    outcomes.iter().map(of_one).collect()
}

#[test]
fn whole_runs_have_the_same_numbers() {
    let Some(host) = Host::get() else { return };
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
    let field = synthesis.draw(1, 0).unwrap();
    let sources = [
        SurfaceSource::random(synthesis),
        SurfaceSource::height_field(field),
    ];
    let glass = Material::dielectric(1.5).unwrap();
    let metals =
        [(0.21, 3.27), (2.9, 3.0)].map(|(eta, kappa)| Material::conductor(eta, kappa).unwrap());
    let settings = Settings {
        effort: Effort::Rays {
            total: 4000,
            surfaces: 2,
        },
        ..Settings::default()
    };
    for source in sources {
        let case = |material: Material, theta: f64| {
            let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
            Case::new(source.clone(), material, light)
        };
        let [gold, iron] = metals;
        let cases = [
            case(glass, 30.0),
            case(glass, 70.0),
            case(gold, 50.0),
            case(iron, 50.0),
        ];
        let engine = GpuEngine::new(host.clone());
        let effort = match &source {
            SurfaceSource::Given(_) => Effort::Rays {
                total: 4000,
                surfaces: 1,
            },
            _ => settings.effort,
        };
        let settings = Settings { effort, ..settings };
        let simulation = Simulation::new(&cases, &settings).unwrap();
        let expected = simulation.clone().run(&Silent).unwrap();
        let found = simulation
            .on(Arc::new(engine.clone()))
            .run(&Silent)
            .unwrap();
        assert!(numbers(&found) == numbers(&expected), "other numbers");
        let usage = engine.usage();
        assert!(usage.on_device > 0 && usage.on_cpu == 0, "{usage:?}");
    }
}
