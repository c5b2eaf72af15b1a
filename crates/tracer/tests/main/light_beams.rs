//! Sunlight by light beams through the facets agrees with sunlight found by random walks.

use std::f64::consts::TAU;

use asperity_optics::{
    Bottom, Layer, Material, ParticipatingMedium, PhaseFunction, around, from_spherical,
};
use asperity_surface::{Border, HeightField};
use asperity_tally::BatchStatistics;
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, CameraContribution, FlightSearch, Geometry, LightBeams,
    PathEnd, PathIntegrator, PathSettings, SearchedSurface, Sunlight, Surface,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A scene with a sun.
#[derive(Clone, Copy)]
struct Case {
    border: Border,
    /// Index of the medium relative to that above.
    eta: f64,
    /// Amplitude of the heights.
    height: f64,
    /// Columns and rows.
    cells: [usize; 2],
    phase: PhaseFunction,
    mean_free_path: f64,
    rough_bottom: bool,
    lines: u32,
}

const PLAIN: Case = Case {
    border: Border::Periodic,
    eta: 1.5,
    height: 0.9,
    cells: [10, 12],
    phase: PhaseFunction::Isotropic,
    mean_free_path: 1.0,
    rough_bottom: false,
    lines: 60,
};

const BATCHES: u64 = 100;

/// Radius of the sun, so large that chance finds it often.
const COS_RADIUS: f64 = 0.85;

/// |z| that one of six differences of means of 100 batches exceeds once in 1000 times: by Sidak 1.7e-4
/// each, 3.76 of a normal distribution, and (z^3 + z) / (4 * 198) more for 198 degrees of freedom.
const BOUND: f64 = 3.85;

/// Light straight out of the layer, of a sun of radiance one, seen along lines from above.
struct Found {
    /// By beams, and by chance.
    sums: BatchStatistics,
    /// Beams that were seen.
    beams: u32,
    /// Paths that met the sun by chance, which beams stand for.
    told_apart: u32,
}

/// Sunlight by beams agrees with that by chance.
fn compare(name: &str, case: Case) {
    let Found {
        sums, told_apart, ..
    } = trace(case);
    let [by_beams, by_chance] = [0, 1].map(|i| sums.estimate(i));
    let z = crate::common::z_score(by_beams, by_chance.mean, by_chance.se.unwrap());
    println!(
        "{name}: {:.5} +- {:.5} by beams, {:.5} +- {:.5} by {told_apart} chances, z = {z:.2}",
        by_beams.mean,
        by_beams.se.unwrap(),
        by_chance.mean,
        by_chance.se.unwrap()
    );
    assert!(told_apart > 200, "{name}");
    assert!(z.abs() < BOUND, "{name}: z = {z:.2}");
}

fn trace(case: Case) -> Found {
    let Case { border, height, .. } = case;
    let surface = |seed: u64| {
        let [nx, ny] = case.cells;
        let field = crate::common::rugged(nx, ny, height, seed, border);
        let heights = field.field().heights().to_vec();
        let field = HeightField::new(heights, [ny, nx], [1.0, 0.8]).unwrap();
        Surface::new(field.with_border(border))
    };
    let (top, bottom) = (surface(5), surface(6));
    let find = |surface: &Surface| surface.accelerator(AcceleratorKind::Auto).unwrap();
    let (top_hits, bottom_hits) = (find(&top), find(&bottom));
    let medium =
        ParticipatingMedium::from_mean_free_path(case.mean_free_path, 0.9, case.phase).unwrap();
    let white = Bottom::lambertian(0.8);
    let layer = Layer::slab(medium, 2.4 * height, white).unwrap();
    let shape = if case.rough_bottom {
        Some(SearchedSurface {
            geometry: &bottom,
            accelerator: &*bottom_hits,
        })
    } else {
        None
    };
    let layer = crate::common::layer_below(&top, &layer, shape, 1000).unwrap();
    let glass = Material::dielectric(case.eta).unwrap();
    let settings = PathSettings::default();
    let integrator = PathIntegrator::new(&top, &*top_hits, glass, settings).over(layer);
    let integrator = integrator.with_flight_search(FlightSearch::Nearby);
    let sun = from_spherical(0.9, 2.0);
    let solid_angle = TAU * (1.0 - COS_RADIUS);
    let mut beams = LightBeams::new(&top, glass, sun);
    let [cx, cy] = top.extent();
    let [_, high] = top.z_range();
    let direction = -from_spherical(0.5, 4.0);

    let mut sums = BatchStatistics::new(2);
    let (mut seen_beams, mut told_apart) = (0_u32, 0_u32);
    for batch in 0..BATCHES {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        rng.set_stream(batch);
        let mut found = [0.0, 0.0];
        for _ in 0..case.lines {
            let mu = 1.0 - rng.random::<f64>() * (1.0 - COS_RADIUS);
            beams.aim(&top, around(sun, mu, rng.random()));
            let sunlight = Sunlight::new(sun, COS_RADIUS).with_beams(&top, &beams);
            let origin = DVec3::new(cx * rng.random::<f64>(), cy * rng.random::<f64>(), high);
            integrator.trace_camera_ray(origin, direction, Some(&sunlight), &mut rng, |seen| {
                match seen {
                    CameraContribution::Sun(lit) => {
                        seen_beams += 1;
                        found[0] += lit.fraction * solid_angle / f64::from(case.lines);
                    }
                    CameraContribution::Path(path) => {
                        if path.has_connected_sun && path.direction.dot(sun) > COS_RADIUS {
                            assert_eq!(path.end, PathEnd::Above);
                            found[1] += path.flux / f64::from(case.lines);
                            told_apart += 1;
                        }
                    }
                }
            });
        }
        sums.push(&found);
    }
    Found {
        sums,
        beams: seen_beams,
        told_apart,
    }
}

#[test]
fn beams_bring_what_chance_finds_near_the_surface() {
    let near = Case {
        mean_free_path: 0.2,
        ..PLAIN
    };
    compare("short flights", near);
    let phase = PhaseFunction::henyey_greenstein(0.6).unwrap();
    compare("forwards", Case { phase, ..PLAIN });
}

#[test]
fn beams_agree_with_random_paths_behind_peaks() {
    let tall = Case {
        height: 3.0,
        phase: PhaseFunction::henyey_greenstein(-0.4).unwrap(),
        mean_free_path: 6.0,
        ..PLAIN
    };
    compare("long flights", tall);
}

#[test]
fn beams_bring_what_chance_finds_over_a_bottom_and_on_a_patch() {
    let bottom = Case {
        phase: PhaseFunction::Rayleigh,
        mean_free_path: 1.5,
        rough_bottom: true,
        ..PLAIN
    };
    compare("rough bottom", bottom);
    let border = Border::Open;
    compare("open", Case { border, ..PLAIN });
}

/// Most light comes to a place through other tiles than its own; of a tile of 3 by 4 cells, beams end after
/// 48 cells.
#[test]
fn beams_bring_what_chance_finds_of_neighbouring_tiles() {
    let narrow = Case {
        cells: [3, 4],
        height: 0.5,
        mean_free_path: 3.0,
        ..PLAIN
    };
    compare("narrow tile", narrow);
}

/// Light that enters a medium of lower index may rise below the surface, out of the prisms of the facets: beams would miss it.
#[test]
fn a_medium_of_lower_index_has_no_beams() {
    let found = trace(Case {
        eta: 0.8,
        lines: 6,
        ..PLAIN
    });
    assert_eq!((found.beams, found.told_apart), (0, 0));
}
