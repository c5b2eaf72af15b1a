//! Cases that share surfaces.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Incidence, Material};
use asperity_simulate::{Case, Effort, Light, Observer, Settings, Silent, SurfaceSource, simulate};
use asperity_synthesis::{Psd, Synthesis};

/// Counts drawings.
#[derive(Default)]
pub(crate) struct Drawings(pub(crate) AtomicU64);

impl Observer for Drawings {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn surface_drawn(&self, _number: u64) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// Three directions on surfaces of one kind and one direction on those of another.
pub(crate) fn cases() -> Vec<Case> {
    let case = |sigma: f64, theta: f64| {
        let psd = Psd::gaussian(sigma, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
        let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
        let glass = Material::dielectric(1.5).unwrap();
        Case::new(SurfaceSource::random(synthesis), glass, light)
    };
    vec![
        case(1.0, 0.0),
        case(2.0, 30.0),
        case(1.0, 30.0),
        case(1.0, 60.0),
    ]
}

pub(crate) fn settings() -> Settings {
    Settings {
        effort: Effort::Rays {
            total: 6000,
            surfaces: 6,
        },
        ..Settings::default()
    }
}

#[test]
fn cases_of_equal_surfaces_share_every_drawing() {
    let drawings = Drawings::default();
    let together = simulate(&cases(), &settings(), &drawings).unwrap();
    assert_eq!(drawings.0.into_inner(), 2 * 6);
    for (case, outcome) in cases().into_iter().zip(&together) {
        let alone = simulate(&[case], &settings(), &Silent).unwrap();
        assert_eq!(alone[0].surfaces, outcome.surfaces);
    }
}
