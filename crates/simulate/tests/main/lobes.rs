//! Narrow lobes: bins that refine around them tell their peaks, by every estimator.

use asperity_optics::{Incidence, Material, from_spherical, reflect};
use asperity_simulate::{
    Case, CaseBins, Effort, Estimator, Light, Lobe, Outcome, Settings, Shape, SurfaceSource,
};
use asperity_surface::{Border, HeightField};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Estimate, HemisphereGrid, Mirror, Side, TallyResult};

use crate::support::{Rough, glass, run};

const SMOOTHNESS: f64 = 40.0;
const ETA: f64 = 1.5;

fn with_own_bins(mut case: Case) -> Case {
    case.bins = CaseBins::around(Lobe::of_case(&case), HemisphereGrid::default());
    assert!(case.bins.is_some());
    case
}

/// BSDF of the bin in the middle of the lobe of a side.
fn peak(outcome: &Outcome, side: Side) -> Estimate {
    let view = outcome.statistics.bins(side, Component::All);
    let bin = middle(outcome, side);
    let per_flux = 1.0 / view.filter().projected_solid_angle(bin);
    let flux = view.get(bin);
    Estimate {
        mean: flux.mean * per_flux,
        se: flux.se.map(|se| se * per_flux),
    }
}

/// Number of that bin among those of its side.
fn middle(outcome: &Outcome, side: Side) -> usize {
    let lobe = Lobe::of_case(&outcome.case)[side.index()].unwrap();
    let grid = outcome.statistics.spec().grid();
    let [theta, phi] = [lobe.theta_deg, lobe.phi_deg].map(f64::to_radians);
    let direction = from_spherical(theta, phi);
    grid.index_of(side, direction) - side.index() * grid.bins_per_side()
}

/// Light that Gaussian facets send to the mirror direction and to the refracted one, per projected solid angle: the density of slopes at
/// zero is `s^2 / (4 pi)`. Walter et al. 2007, Eqs. 20 and 21, without shadow.
fn expected_peak(side: Side, theta: f64) -> f64 {
    let density = SMOOTHNESS * SMOOTHNESS / (4.0 * std::f64::consts::PI);
    let cos_i = theta.cos();
    let cos_t = (1.0 - (theta.sin() / ETA).powi(2)).sqrt();
    let fresnel = glass().fresnel(cos_i);
    match side {
        Side::Reflected => fresnel.reflected * density / (4.0 * cos_i * cos_i),
        Side::Transmitted => {
            let chi = ETA * ETA * cos_t / (ETA * cos_t - cos_i).powi(2);
            fresnel.transmitted * density * chi / cos_t
        }
    }
}

/// Bins of an eighth of the half width lie 0.2 % below the peak in their middle. Surfaces scatter by as much as their errors say.
#[test]
fn peaks_of_random_surfaces_are_those_of_their_density_of_slopes() {
    for (estimator, surfaces, total) in [
        (Estimator::Controlled, 4, 40_000),
        (Estimator::Plain, 48, 1_000_000),
    ] {
        for theta_deg in [0.0_f64, 30.0] {
            let case = Rough::smooth(SMOOTHNESS, 12.0, 96).case(glass(), theta_deg);
            let settings = Settings {
                estimator,
                effort: Effort::Rays { total, surfaces },
                ..Settings::default()
            };
            let outcome = run(with_own_bins(case), &settings);
            for side in Side::BOTH {
                let found = peak(&outcome, side);
                let expected = expected_peak(side, theta_deg.to_radians());
                let lobe = Lobe::of_case(&outcome.case)[side.index()].unwrap();
                let below = 0.5 * lobe.shortfall(&outcome.statistics.spec().grid());
                let se = found.se.unwrap() / expected;
                let off = found.mean / expected - 1.0;
                println!(
                    "{estimator} {theta_deg} {side}: {off:+.4} +- {se:.4}, by the bin -{below:.4}"
                );
                assert!((off + below).abs() < 4.0 * se + 0.005, "{off} {se}");
                assert!(se < 0.06 && below < 0.005);
            }
        }
    }
}

/// With bins of 5 by 10 degrees the same peaks are several times too low.
#[test]
fn bins_of_equal_angles_miss_such_peaks() {
    let case = Rough::smooth(SMOOTHNESS, 12.0, 96).case(glass(), 30.0);
    let settings = Settings {
        effort: Effort::Rays {
            total: 40_000,
            surfaces: 4,
        },
        ..Settings::default()
    };
    let outcome = run(case, &settings);
    let expected = expected_peak(Side::Transmitted, 30.0_f64.to_radians());
    assert!(peak(&outcome, Side::Transmitted).mean < 0.3 * expected);
}

/// A smooth given surface of 128 x 128 samples.
fn given() -> HeightField {
    let psd = Psd::gaussian(12.0 / SMOOTHNESS, 12.0).unwrap();
    let synthesis = Synthesis::new(psd, [128, 128], [1.0, 1.0], false).unwrap();
    synthesis.draw(11, 0).unwrap()
}

/// Facets whose mirror direction lies in the bin, each with its weight and Fresnel's reflectance: no path is traced for this. At s = 40
/// and 30 degrees nothing is shadowed and nothing is reflected twice.
#[test]
fn the_peak_of_a_given_surface_is_that_of_its_count_of_slopes() {
    let incidence = Incidence::from_degrees(30.0, 0.0).unwrap();
    let wi = incidence.wi();
    for border in [Border::Periodic, Border::Mirrored] {
        let field = given().with_border(border);
        let shape = Shape::height_field(field.clone());
        let light = Light::from_above(incidence);
        let case = with_own_bins(Case::new(SurfaceSource::Given(vec![shape]), glass(), light));
        for estimator in [Estimator::Plain, Estimator::Controlled] {
            let settings = Settings {
                estimator,
                effort: Effort::rays(400_000),
                ..Settings::default()
            };
            let outcome = run(case.clone(), &settings);
            let grid = outcome.statistics.spec().grid();
            let bin = middle(&outcome, Side::Reflected);
            let images: &[[f64; 2]] = match border {
                Border::Mirrored => &[[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]],
                _ => &[[1.0, 1.0]],
            };
            let [cx, cy] = field.cells();
            let (mut flux, mut facets) = (0.0, 0);
            for (ix, iy) in (0..cx).flat_map(|ix| (0..cy).map(move |iy| (ix, iy))) {
                for [x, y] in field.facet_slopes(ix, iy) {
                    for [flip_x, flip_y] in images {
                        let (x, y) = (flip_x * x, flip_y * y);
                        let m = from_spherical(x.hypot(y).atan(), (-y).atan2(-x));
                        let cos = wi.dot(m);
                        facets += 1;
                        if grid.index_of(Side::Reflected, reflect(wi, m)) == bin {
                            flux += cos / (m.z * wi.z) * glass().fresnel(cos).reflected;
                        }
                    }
                }
            }
            let view = outcome.statistics.bins(Side::Reflected, Component::All);
            let expected = flux / f64::from(facets);
            let found = view.get(bin);
            let (off, se) = (found.mean / expected - 1.0, found.se.unwrap() / expected);
            println!("{border:?} {estimator}: {off:+.4} +- {se:.4}");
            assert!(off.abs() < 4.0 * se + 1e-3, "{off} {se}");
            assert!(se < 0.05);
        }
    }
}

/// Cases of several angles share their surfaces, each with bins of its own, and bins on both sides of the plane of incidence are
/// averaged; a case alone has the same bytes.
#[test]
fn cases_with_bins_of_their_own_share_surfaces_and_are_folded() {
    let surfaces = Rough::smooth(SMOOTHNESS, 8.0, 64);
    let cases: Vec<Case> = [10.0, 50.0]
        .map(|theta| with_own_bins(surfaces.case(glass(), theta)))
        .to_vec();
    assert_ne!(cases[0].bins, cases[1].bins);
    let settings = Settings {
        effort: Effort::Rays {
            total: 20_000,
            surfaces: 3,
        },
        ..Settings::default()
    };
    let both = asperity_simulate::simulate(&cases, &settings, &asperity_simulate::Silent).unwrap();
    for (case, outcome) in cases.into_iter().zip(both) {
        let grid = outcome.statistics.spec().grid();
        assert_eq!(Some(grid), case.bins.map(|bins| bins.grid));
        assert!(outcome.work.folded && Mirror::about(0.0, &grid).is_some());
        let alone = run(case, &settings);
        assert_eq!(alone.surfaces, outcome.surfaces);
        let bins = outcome.statistics.bins(Side::Reflected, Component::All);
        let sum: f64 = bins.iter().map(|bin| bin.mean).sum();
        let total = outcome
            .statistics
            .flux(Side::Reflected, Component::All)
            .mean;
        assert!((sum / total - 1.0).abs() < 1e-12);
    }
}

/// A mirror-like surface keeps bins of equal angles: no bins resolve its lobe.
#[test]
fn a_level_surface_has_no_bins_of_its_own() {
    let level = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
    let light = Light::from_above(Incidence::from_degrees(30.0, 0.0).unwrap());
    let case = Case::new(SurfaceSource::height_field(level), Material::Mirror, light);
    let lobes = Lobe::of_case(&case);
    assert!(CaseBins::around(lobes, HemisphereGrid::default()).is_none());
}
