use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};

use asperity_optics::Incidence;
use asperity_surface::HeightField;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, Facet, Geometry, Horizons, Surface, Visibility,
    trace_visibility,
};

use super::*;

fn direction(cotangent: f64, azimuth: f64) -> Incidence {
    let theta = cotangent.recip().atan().to_degrees();
    Incidence::from_degrees(theta, azimuth.to_degrees()).unwrap()
}

fn all_samples(surface: &Surface, azimuth: f64) -> Vec<Point<Facet>> {
    chunks(surface)
        .into_iter()
        .flat_map(|chunk| samples(surface, azimuth, chunk))
        .collect()
}

/// Samples that light from `cot(theta)` reaches, asked by rays and by horizons, which must agree at each.
fn lit(surface: &Surface, azimuth: f64, cotangent: f64) -> Vec<bool> {
    let light = direction(cotangent, azimuth);
    // Degrees and back: as exact as the azimuth that a run has.
    let azimuth = light.phi();
    let samples = all_samples(surface, azimuth);
    let horizons = Horizons::new(surface, azimuth, 0.9 * cotangent).unwrap();
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let mut seen = Vec::new();
    let facing = |sample: &Point<Facet>| sample.ray.direction.dot(light.wi()) > 0.0;
    samples
        .iter()
        .map(|sample| {
            if !facing(sample) {
                return false;
            }
            let rays = [surface.ray_along(sample, &light)];
            trace_visibility(surface, &*accelerator, &rays, &mut seen);
            let horizon = horizons.of(sample.facet, sample.ray.origin);
            let free = horizon.beyond <= light.theta().tan().recip();
            let is_free = seen[0] == Visibility::Visible;
            assert_eq!(is_free, free, "{azimuth} {cotangent} {:?}", sample.facet);
            free
        })
        .collect()
}

fn rough(sigma: f64, shape: [usize; 2], spacing: [f64; 2], border: Border) -> Surface {
    let psd = Psd::gaussian(sigma, 6.0).unwrap();
    let recipe = Synthesis::new(psd, shape, spacing, true).unwrap();
    Surface::new(recipe.draw(7, 0).unwrap().with_border(border))
}

#[test]
fn a_sample_belongs_to_the_facet_into_which_its_ray_points() {
    for (border, spacing) in [
        (Border::Periodic, [1.0, 1.0]),
        (Border::Periodic, [1.0, 2.3]),
        (Border::Open, [1.0, 0.6]),
    ] {
        let surface = rough(3.0, [9, 70], spacing, border);
        let [cx, cy] = surface.extent();
        for azimuth in (0..24).map(|i| 0.13 + f64::from(i) * PI / 12.0) {
            let found = all_samples(&surface, azimuth);
            let expected = if border == Border::Open {
                7 * 68
            } else {
                9 * 70
            };
            assert_eq!(found.len(), expected);
            let mut places = Vec::new();
            for sample in found {
                // A hundredth of a cell on, in the tile.
                let o = sample.ray.origin;
                let on = [
                    o.x + 0.01 * azimuth.cos(),
                    o.y + 0.01 * azimuth.sin() * surface.aspect(),
                ];
                let (facet, _) = surface
                    .over(on[0].rem_euclid(cx), on[1].rem_euclid(cy))
                    .unwrap();
                assert_eq!(sample.facet, facet, "{azimuth}");
                let place = [o.x, o.y].map(|place| place as usize);
                assert_eq!(o.z, surface.z(place[0], place[1]));
                assert_eq!([o.x, o.y], place.map(|place| place as f64));
                places.push([place[0] % cx as usize, place[1] % cy as usize]);
            }
            // Each once.
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), expected);
        }
    }
}

/// A wave of period eight, up and down by `0, 1, 2, 3, 4, 3, 2, 1`, over 16 x 16 cells.
fn wave(of: impl Fn(usize, usize) -> usize) -> Surface {
    let height = |i: usize| 4.0 - (4.0 - (of(i % 16, i / 16) % 8) as f64).abs();
    let heights = (0..256).map(height).collect();
    Surface::new(HeightField::new(heights, [16, 16], [1.0, 1.0]).unwrap())
}

#[test]
fn samples_of_a_wave_are_lit_as_counted_by_hand() {
    // Light from +x whose cotangent is 0.4: before samples 0 to 3 the surface rises by one a step. Sample 7,
    // at height 1, has the next ridge 3 above it and 5 away, which hides it; 6 has it 2 above and 6 away,
    // 5 has it 1 above and 7 away, and 4 is a ridge.
    let onward = [4, 5, 6];
    // Light from -x: the same, seen in a mirror at the ridge.
    let back = [4, 3, 2];
    let all = [0, 1, 2, 3, 4, 5, 6, 7];
    let along_x = |x: usize, _: usize| x;
    let along_y = |_: usize, y: usize| y;
    // Ridges along the diagonals of the cells, and steps of a root of a half across them.
    let across = |x: usize, y: usize| 16 + x - y;
    // Oblique light goes further for each step.
    let oblique = |azimuth: f64| 0.4 * azimuth.cos().abs();
    for (azimuth, of, cotangent, expected) in [
        (
            0.0,
            &along_x as &dyn Fn(usize, usize) -> usize,
            0.4,
            &onward[..],
        ),
        (PI, &along_x, 0.4, &back),
        (FRAC_PI_2, &along_x, 0.4, &all),
        (3.0 * FRAC_PI_2, &along_x, 0.4, &all),
        (FRAC_PI_4, &along_x, 0.4 * FRAC_1_SQRT_2, &onward),
        (0.3, &along_x, oblique(0.3), &onward),
        (1.2, &along_x, oblique(1.2), &onward),
        (1.9, &along_x, oblique(1.9), &back),
        (3.4, &along_x, oblique(3.4), &back),
        (4.3, &along_x, oblique(4.3), &back),
        (5.5, &along_x, oblique(5.5), &onward),
        (FRAC_PI_2, &along_y, 0.4, &onward),
        (3.0 * FRAC_PI_2, &along_y, 0.4, &back),
        (0.0, &along_y, 0.4, &all),
        (PI, &along_y, 0.4, &all),
        (7.0 * FRAC_PI_4, &across, 0.4 * SQRT_2, &onward),
        (3.0 * FRAC_PI_4, &across, 0.4 * SQRT_2, &back),
        (FRAC_PI_4, &across, 0.4, &all),
        (5.0 * FRAC_PI_4, &across, 0.4, &all),
    ] {
        let surface = wave(of);
        let found = lit(&surface, azimuth, cotangent);
        // Samples come row by row.
        for (number, lit) in found.into_iter().enumerate() {
            let place = of(number % 16, number / 16) % 8;
            assert_eq!(lit, expected.contains(&place), "{azimuth} {place}");
        }
    }
}

#[test]
fn along_rows_and_columns_the_samples_that_follow_decide() {
    let [nx, ny] = [48, 40];
    let surface = rough(4.0, [ny, nx], [1.0, 1.3], Border::Periodic);
    let mut counts = [0; 2];
    for (azimuth, [jx, jy], step) in [
        (0.0, [1, 0], 1.0),
        (PI, [nx - 1, 0], 1.0),
        (FRAC_PI_2, [0, 1], 1.3),
        (3.0 * FRAC_PI_2, [0, ny - 1], 1.3),
    ] {
        for cotangent in [1.0, 0.4, 0.1] {
            let found = lit(&surface, azimuth, cotangent);
            for (number, lit) in found.into_iter().enumerate() {
                let (ix, iy) = (number % nx, number / nx);
                // A period holds all rises that there are; later ones are gentler.
                let rises = (1..=nx.max(ny)).map(|n| {
                    let later = surface.z((ix + n * jx) % nx, (iy + n * jy) % ny);
                    (later - surface.z(ix, iy)) / (n as f64 * step)
                });
                assert_eq!(lit, rises.fold(-1.0, f64::max) <= cotangent);
                counts[usize::from(lit)] += 1;
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 5000), "{counts:?}");
}

#[test]
fn rays_and_horizons_agree_sample_by_sample() {
    for (border, spacing) in [(Border::Periodic, [1.0, 1.0]), (Border::Open, [1.0, 1.3])] {
        let surface = rough(5.0, [40, 56], spacing, border);
        for azimuth in [0.0, 0.6, FRAC_PI_4, 1.2, 1.9, PI, 3.7, 4.3, 5.0, 5.9] {
            for cotangent in [1.5, 0.5, 0.1, 0.02] {
                // Each sample is asked both ways in here.
                let found = lit(&surface, azimuth, cotangent);
                assert!(found.contains(&true) && found.contains(&false));
            }
        }
    }
}

#[test]
fn points_are_spread_evenly_over_the_mean_plane_and_differ_from_chunk_to_chunk() {
    let field = HeightField::new(vec![0.0; 64 * 128], [64, 128], [1.0, 1.0]).unwrap();
    let surface = Surface::new(field);
    assert_eq!(chunks(&surface).len(), 2);
    let of = |chunk| -> Vec<[f64; 2]> {
        points(&surface, 3, 5, chunk)
            .map(|point| [point.ray.origin.x.fract(), point.ray.origin.y.fract()])
            .collect()
    };
    let places = [of(0), of(1)];
    assert_ne!(places[0], places[1]);
    // Mean 1/2 and mean square 1/3 of n uniform numbers: deviations of 0.289 and 0.298 over root n.
    let all = places.concat();
    let root = (all.len() as f64).sqrt();
    for axis in [0, 1] {
        let mean = |power: i32| {
            all.iter().map(|place| place[axis].powi(power)).sum::<f64>() / all.len() as f64
        };
        assert!((mean(1) - 0.5).abs() < 4.0 * 0.289 / root);
        assert!((mean(2) - 1.0 / 3.0).abs() < 4.0 * 0.298 / root);
    }
}
