//! Light on facets under thin films: a flat surface against the equations, and the path engine against the reference where a film absorbs.

use asperity_optics::{Film, Films, Incidence, Material};
use asperity_surface::{Border, HeightField};
use asperity_tally::TallyResult;
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, Geometry, HalfSpace, PathEnd, PathIntegrator,
    PathSettings, Polarisation, Surface,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{Run, rugged, z_score};

/// Glass under two films, the first of which absorbs by `kappa`.
fn coated(kappa: f64) -> Material {
    let layers = [(2.3, kappa, 0.9), (1.38, 0.0, 1.1)];
    let films = layers.map(|(eta, kappa, phase)| Film { eta, kappa, phase });
    Material::coated(Films::new(&films).unwrap(), 1.5, 0.0).unwrap()
}

const BRANCHINGS: [Branching; 2] = [Branching::Split, Branching::Pick];
const POLARISATIONS: [Polarisation; 2] = [Polarisation::Averaged, Polarisation::Tracked];

#[test]
fn a_flat_surface_reflects_transmits_and_absorbs_as_the_equations_say() {
    let surface = Surface::new(HeightField::new(vec![0.0; 64], [8, 8], [1.0, 1.0]).unwrap());
    let accelerator = surface.accelerator(AcceleratorKind::Flat).unwrap();
    for incident in [HalfSpace::Above, HalfSpace::Below] {
        // From below the indices are relative to the medium below.
        for (material, theta_deg) in [(coated(0.3), 50.0), (coated(0.3).reversed(), 60.0)] {
            for polarisation in POLARISATIONS {
                let run = Run {
                    incident,
                    theta_deg,
                    settings: PathSettings::new(Branching::Split, 1e-6, 100)
                        .unwrap()
                        .with_polarisation(polarisation),
                    ..Run::new(&surface, &*accelerator, material)
                };
                let budget = run.go(2, 8).0.means().budget();
                let expected = material.fresnel(theta_deg.to_radians().cos());
                assert!((budget.reflected - expected.reflected).abs() < 1e-12);
                assert!((budget.transmitted - expected.transmitted).abs() < 1e-12);
                assert!((budget.absorbed - material.absorbed(&expected)).abs() < 1e-12);
                assert!(budget.absorbed > 0.05);
            }
        }
    }
}

/// Reflected, transmitted and absorbed light; 24 deviations, of which one above 4.5 has a probability below 1e-3.
#[test]
fn the_path_engine_and_the_reference_absorb_alike() {
    const BATCHES: u32 = 40;
    const STRATA: u32 = 24;
    let surface = rugged(14, 11, 0.8, 3, Border::Periodic);
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let wi = Incidence::from_degrees(30.0, 180.0).unwrap().wi();
    let ([cx, cy], [_, high]) = (surface.extent(), surface.z_range());
    for (kappa, polarisation) in [0.0, 0.3]
        .into_iter()
        .flat_map(|kappa| POLARISATIONS.map(|polarisation| (kappa, polarisation)))
    {
        let material = coated(kappa);
        let settings = PathSettings::default().with_polarisation(polarisation);
        let reference = PathIntegrator::new(&surface, &*accelerator, material, settings);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let rays = 40_000;
        let mut sums = [[0.0; 2]; 3];
        for _ in 0..rays {
            let place = [rng.random_range(0.0..cx), rng.random_range(0.0..cy)];
            let found = reference.trace(DVec3::new(place[0], place[1], high), -wi, &mut rng);
            let of = |end| if found.end == end { found.flux } else { 0.0 };
            let parts = [of(PathEnd::Above), of(PathEnd::Below), found.absorbed];
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum = [sum[0] + part, sum[1] + part * part];
            }
        }
        for branching in BRANCHINGS {
            let run = Run {
                settings: settings.with(branching, settings.roulette()),
                ..Run::new(&surface, &*accelerator, material)
            };
            let (statistics, _) = run.go(BATCHES.into(), STRATA);
            let total = statistics.means().budget().total();
            assert!((total - 1.0).abs() < 1e-12, "{total}");
            let budget = statistics.budget();
            let parts = [budget.reflected, budget.transmitted, budget.absorbed];
            for (found, [sum, squares]) in parts.into_iter().zip(sums) {
                let n = f64::from(rays);
                let mean = sum / n;
                let error = ((squares / n - mean * mean) / n).sqrt();
                let z = z_score(found, mean, error);
                println!("{kappa} {polarisation:?} {branching:?}: {found:?} {mean} z = {z:.2}");
                assert!(z.abs() < 4.5 && (mean > 0.02 || kappa == 0.0));
            }
        }
    }
}
