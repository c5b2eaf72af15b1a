//! Cases and runs that several tests have in common.

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Deadline, Effort, Light, Outcome, Quantity, RandomSurfaces, Settings, Silent,
    SurfaceSource, Target, simulate,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::HalfSpace;

/// Isotropic random surfaces with a Gaussian autocorrelation.
#[derive(Clone, Copy)]
pub(crate) struct Rough {
    pub(crate) sigma: f64,
    pub(crate) tau: f64,
    /// Samples a side, one length unit apart.
    pub(crate) size: usize,
}

impl Rough {
    /// Surfaces of a smoothness `tau / sigma`.
    pub(crate) fn smooth(smoothness: f64, tau: f64, size: usize) -> Self {
        Self {
            sigma: tau / smoothness,
            tau,
            size,
        }
    }

    /// Light of random azimuth on them.
    pub(crate) fn case(self, material: Material, theta: f64) -> Case {
        self.case_on([self.size; 2], [1.0; 2], material, theta)
    }

    /// The surfaces on another grid.
    pub(crate) fn case_on(
        self,
        [ny, nx]: [usize; 2],
        spacing: [f64; 2],
        material: Material,
        theta: f64,
    ) -> Case {
        let psd = Psd::gaussian(self.sigma, self.tau).unwrap();
        let synthesis = Synthesis::new(psd, [ny, nx], spacing, false).unwrap();
        lit(synthesis, material, theta)
    }
}

/// Light of random azimuth on random surfaces.
pub(crate) fn lit(surfaces: impl Into<RandomSurfaces>, material: Material, theta: f64) -> Case {
    let light = Light {
        incidence: Incidence::from_degrees(theta, 0.0).unwrap(),
        from: HalfSpace::Above,
        spread: None,
        random_azimuth: true,
        stokes: [0.0; 3],
    };
    Case::new(SurfaceSource::random(surfaces), material, light)
}

/// Settings with this number of surfaces, and of rays on all of them together.
pub(crate) fn effort(surfaces: u64, rays: u64) -> Settings {
    Settings {
        effort: Effort::Rays {
            total: rays,
            surfaces,
        },
        ..Settings::default()
    }
}

pub(crate) fn glass() -> Material {
    Material::dielectric(1.5).unwrap()
}

pub(crate) fn target(error: f64, of: Quantity) -> Effort {
    Effort::TargetError(Target::new(error, of).unwrap())
}

/// The outcome of one case.
pub(crate) fn run(case: Case, settings: &Settings) -> Outcome {
    simulate(&[case], settings, &Silent).unwrap().remove(0)
}

/// The outcome of one case that is given some seconds.
pub(crate) fn run_for(seconds: f64, case: Case, settings: &Settings) -> Outcome {
    let time = std::time::Duration::from_secs_f64(seconds);
    let deadline = Deadline::new(&Silent, Some(time));
    simulate(&[case], settings, &deadline).unwrap().remove(0)
}
