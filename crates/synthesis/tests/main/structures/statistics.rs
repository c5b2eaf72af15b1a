//! Means over seeds against closed forms.

use std::f64::consts::PI;

use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
};

use super::{CRACKS, GROOVES, PYRAMIDS, SCRATCHES, SEGMENTS, planned};

const SAMPLES: usize = 256;

/// Mean over surfaces, and its standard error.
fn mean_and_error(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    [mean, (squares / (n * (n - 1.0))).sqrt()]
}

fn means_of_surfaces(structure: Structure, of: impl Fn(u64) -> f64) -> [f64; 2] {
    let values: Vec<f64> = (0..40).map(of).collect();
    let [mean, error] = mean_and_error(&values);
    println!("{structure:?}: {mean} +- {error}");
    [mean, error]
}

/// Fraction of the samples that are not on the plane.
fn coverage(structure: Structure, spacing: f64, seed: u64) -> f64 {
    let heights = planned(structure, SAMPLES, spacing)
        .heights(seed, 0)
        .unwrap();
    let off = heights.iter().filter(|h| **h != 0.0).count();
    off as f64 / heights.len() as f64
}

/// Mean square of the steps along x and along y.
///
/// A step over an edge is off in proportion to the spacing, so that twice the value of half the spacing less that of the spacing
/// is free of this error.
fn mean_square_slope(structure: Structure, seed: u64) -> f64 {
    let with = |n: usize, spacing: f64| {
        let heights = planned(structure, n, spacing).heights(seed, 0).unwrap();
        let mut sum = 0.0;
        for iy in 0..n {
            for ix in 0..n {
                let here = heights[iy * n + ix];
                let right = heights[iy * n + (ix + 1) % n];
                let up = heights[(iy + 1) % n * n + ix];
                sum += (right - here).powi(2) + (up - here).powi(2);
            }
        }
        sum / (spacing * spacing * (n * n) as f64)
    };
    2.0 * with(2 * SAMPLES, 0.5) - with(SAMPLES, 1.0)
}

fn separate(segments: SphericalSegments) -> SphericalSegments {
    SphericalSegments {
        arrangement: Arrangement::Separate,
        ..segments
    }
}

/// Samples are as good as points at random, since places are: the expectation is exact. Of 7, one is beyond 4 standard errors, of
/// Student's t of 39 degrees of freedom, once in 500 sets of seeds.
#[test]
fn coverage_is_the_closed_form() {
    let rounded = SphericalSegments {
        edge_radius: 2.0,
        ..SEGMENTS
    };
    let wide = Cracks {
        density: 1.0,
        edge_radius: 2.0,
        ..CRACKS
    };
    for structure in [
        Structure::Pits(SEGMENTS),
        Structure::Pits(rounded),
        Structure::Caps(separate(SEGMENTS)),
        Structure::Scratches(SCRATCHES),
        Structure::Cracks(CRACKS),
        Structure::Cracks(wide),
        Structure::Pyramids(PYRAMIDS),
    ] {
        let expected = planned(structure, SAMPLES, 1.0)
            .expected()
            .coverage
            .unwrap();
        let [mean, error] = means_of_surfaces(structure, |seed| coverage(structure, 1.0, seed));
        println!("expected {expected}");
        // Cells of a periodic tile are correlated with themselves: a relative error of the order of exp(-number)
        assert!(
            (mean - expected).abs() < 4.0 * error + 1e-9,
            "{structure:?}"
        );
    }
}

/// The error left of second order in the spacing over the width, `1 / 256` here, has factors of some units: 2 % are allowed.
#[test]
fn mean_square_slope_is_the_closed_form() {
    let flat = SphericalSegments {
        depth: 1.0,
        ..SEGMENTS
    };
    for structure in [
        Structure::Pits(SphericalSegments {
            density: 1.5,
            ..flat
        }),
        Structure::Pits(separate(flat)),
        Structure::Scratches(Scratches {
            width: 16.0,
            depth: 4.0,
            ..SCRATCHES
        }),
        Structure::Cracks(Cracks {
            width: 16.0,
            ..CRACKS
        }),
        Structure::Inverted(PYRAMIDS),
        Structure::Grooves(Grooves {
            randomness: 0.4,
            ..GROOVES
        }),
        Structure::Grooves(Grooves {
            randomness: 0.4,
            profile: GrooveProfile::Sine,
            ..GROOVES
        }),
        Structure::Grooves(Grooves {
            randomness: 0.4,
            profile: GrooveProfile::Blazed,
            ..GROOVES
        }),
    ] {
        let synthesis = planned(structure, SAMPLES, 1.0);
        let expected = synthesis.expected().mean_square_slope.unwrap();
        let [mean, error] = means_of_surfaces(structure, |seed| mean_square_slope(structure, seed));
        println!("expected {expected}");
        let allowed = 4.0 * error + 0.02 * expected;
        assert!((mean - expected).abs() < allowed, "{structure:?}");
    }
}

/// A spherical segment of depth `d` and opening radius `r` has the volume `pi d (3 r^2 + d^2) / 6`; of sizes uniform within `1 ± q`
/// the mean cube is `1 + q^2`. Samples count volume as exactly as points at random.
#[test]
fn separate_pits_have_the_volume_of_their_number() {
    let pits = separate(SphericalSegments {
        randomness: 0.5,
        density: 0.3,
        ..SEGMENTS
    });
    let (d, r, q) = (pits.depth, 0.5 * pits.width, pits.randomness);
    let area = (SAMPLES * SAMPLES) as f64;
    let number = (pits.density * area / (PI * r * r * (1.0 + q * q / 3.0))).round();
    let volume = PI * d * (3.0 * r * r + d * d) / 6.0 * (1.0 + q * q);
    let expected = -number * volume / area;
    let structure = Structure::Pits(pits);
    let [mean, error] = means_of_surfaces(structure, |seed| {
        let heights = planned(structure, SAMPLES, 1.0).heights(seed, 0).unwrap();
        heights.iter().sum::<f64>() / area
    });
    assert!(
        (mean - expected).abs() < 4.0 * error,
        "{mean} {expected} {error}"
    );
}

/// Random sizes do not change the angle of facets: the mean square slope stays that of the coverage.
#[test]
fn facets_of_random_pyramids_have_one_angle() {
    let pyramids = Pyramids {
        randomness: 0.8,
        ..PYRAMIDS
    };
    let structure = Structure::Pyramids(pyramids);
    let [slope, error] = means_of_surfaces(structure, |seed| {
        mean_square_slope(structure, seed) / coverage(structure, 1.0, seed)
    });
    let expected = pyramids.slope().powi(2);
    // Edges of the smallest pyramids, 3 spacings wide, are off by more than a percent
    assert!(
        (slope - expected).abs() < 4.0 * error + 0.03 * expected,
        "{slope} {expected}"
    );
}
