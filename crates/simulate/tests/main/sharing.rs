//! Cases that share surfaces, and surfaces that a store keeps.

use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, Light, Observer, SavedSurface, Settings, Silent, SurfaceKey, SurfaceSource,
    SurfaceStore, simulate,
};
use asperity_surface::{Psd, Synthesis};

/// Counts drawings, and keeps surfaces as text.
#[derive(Default)]
struct Keeper {
    drawn: AtomicU64,
    kept: Mutex<HashMap<SurfaceKey, String>>,
}

impl SurfaceStore for Keeper {
    fn load(&self, key: SurfaceKey) -> Option<SavedSurface> {
        let text = self.kept.lock().unwrap().get(&key).cloned()?;
        Some(serde_json::from_str(&text).unwrap())
    }
    fn save(&self, key: SurfaceKey, surface: &SavedSurface) {
        let text = serde_json::to_string(surface).unwrap();
        self.kept.lock().unwrap().insert(key, text);
    }
}

impl Observer for Keeper {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn surface_drawn(&self, _number: u64) {
        self.drawn.fetch_add(1, Ordering::Relaxed);
    }
    fn store(&self) -> Option<&dyn SurfaceStore> {
        Some(self)
    }
}

/// Three directions on surfaces of one kind and one direction on those of another.
fn cases() -> Vec<Case> {
    let case = |sigma: f64, theta: f64| {
        let psd = Psd::gaussian(sigma, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
        let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
        let glass = Material::dielectric(1.5).unwrap();
        Case::new(SurfaceSource::Random(synthesis), glass, light)
    };
    vec![
        case(1.0, 0.0),
        case(2.0, 30.0),
        case(1.0, 30.0),
        case(1.0, 60.0),
    ]
}

fn settings() -> Settings {
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
    let keeper = Keeper::default();
    let together = simulate(&cases(), &settings(), &keeper).unwrap();
    assert_eq!(keeper.drawn.into_inner(), 2 * 6);
    for (case, outcome) in cases().into_iter().zip(&together) {
        let alone = simulate(&[case], &settings(), &Silent).unwrap();
        assert_eq!(alone[0].surfaces, outcome.surfaces);
    }
}

#[test]
fn a_run_resumes_from_kept_surfaces_to_the_same_numbers() {
    let keeper = Keeper::default();
    let whole = simulate(&cases(), &settings(), &keeper).unwrap();
    // Every second surface is lost.
    let mut kept = keeper.kept.lock().unwrap();
    kept.retain(|key, _| key.surface % 2 == 0);
    drop(kept);
    keeper.drawn.store(0, Ordering::Relaxed);
    let resumed = simulate(&cases(), &settings(), &keeper).unwrap();
    assert_eq!(keeper.drawn.into_inner(), 2 * 3);
    for (whole, resumed) in whole.iter().zip(&resumed) {
        assert_eq!(whole.surfaces, resumed.surfaces);
        assert_eq!(whole.statistics.means(), resumed.statistics.means());
        assert_eq!(whole.work.rays, resumed.work.rays);
    }
}
