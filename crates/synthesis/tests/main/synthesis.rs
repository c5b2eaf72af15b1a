//! Random surfaces have the requested statistics, and the bytes that their seed determines.

use std::f64::consts::PI;

use asperity_surface::{Border, HeightField, HeightFieldError};
use asperity_synthesis::{
    Erosion, FieldSynthesis, GivesUp, NEVER, Provenance, Psd, Resolution, Slip, SplineSynthesis,
    Synthesis, SynthesisError,
};

fn assert_close(found: &HeightField, expected: &HeightField, tolerance: f64) {
    let worst = found
        .heights()
        .iter()
        .zip(expected.heights())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(
        worst < tolerance,
        "largest difference {worst}, allowed {tolerance}"
    );
}

/// Both paths add the same numbers in another order. The direct sum's rounding is of the order of
/// `N eps sigma = 1e3 * 1e-16`, the FFT's less.
#[test]
fn fft_matches_direct_summation() {
    for (tau_x, tau_y, azimuth, shape, spacing) in [
        (1.0, 1.0, 0.0, [32, 32], [0.25, 0.25]),
        (1.0, 1.0, 0.0, [33, 40], [0.25, 0.25]),
        (1.0, 2.0, 0.0, [37, 35], [0.25, 0.5]),
        (1.0, 1.3, 0.7, [44, 41], [0.25, 0.25]),
        (1.0, 1.3, -0.7, [44, 42], [0.25, 0.25]),
        (1.0, 1.3, 2.0, [41, 31], [0.25, 0.35]),
    ] {
        let psd = Psd::anisotropic_gaussian(0.3, tau_x, tau_y, azimuth).unwrap();
        let synthesis = Synthesis::new(psd, shape, spacing, true).unwrap();
        let quick = synthesis.draw(7, 1).unwrap();
        assert_close(&quick, &synthesis.draw_directly(7, 1).unwrap(), 0.3e-12);
        assert_eq!(quick.border(), Border::Periodic);
        let provenance = Provenance::of(quick.provenance()).unwrap();
        assert_eq!((provenance.seed, provenance.realisation), (7, 1));
        let mean = quick.heights().iter().sum::<f64>() / quick.heights().len() as f64;
        assert!(mean.abs() < 0.3e-14, "mean {mean}");
    }
}

/// With a correlation length below one spacing, the filter is far from zero at the Nyquist wave
/// number, where a sloppy treatment shows.
#[test]
fn fft_matches_direct_summation_when_power_reaches_nyquist() {
    for shape in [
        [2, 2],
        [2, 3],
        [3, 2],
        [8, 8],
        [8, 9],
        [9, 8],
        [6, 10],
        [7, 5],
    ] {
        let psd = Psd::anisotropic_gaussian(1.0, 0.9, 0.4, 0.5).unwrap();
        let synthesis = Synthesis::new(psd, shape, [1.0, 0.8], true).unwrap();
        let quick = synthesis.draw(3, 0).unwrap();
        assert_close(&quick, &synthesis.draw_directly(3, 0).unwrap(), 1e-12);
    }
}

/// Mean over realisations of a quantity, its standard error, and its distance from the expected
/// value in standard errors.
fn z(values: &[f64], expected: f64) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean - expected) / (variance / n).sqrt()
}

/// Mean of `f(h(x), h(x + lag))` over a periodic tile.
fn mean_of_pairs(field: &HeightField, lag: [usize; 2], f: impl Fn(f64, f64) -> f64) -> f64 {
    let (nx, ny) = (field.nx(), field.ny());
    let mut sum = 0.0;
    for iy in 0..ny {
        for ix in 0..nx {
            sum += f(field.height(ix, iy), field.height(ix + lag[0], iy + lag[1]));
        }
    }
    sum / (nx * ny) as f64
}

/// Realisations are independent, so the scatter of each quantity between them gives its standard
/// error. Expected are, exactly up to `exp(-8^2)`: variance `sigma^2 - m` and autocorrelation
/// `C(r) - m` with `m = sigma^2 pi tau_x tau_y / A`, the mean that was set to zero; and slope
/// variance `2 (C(0) - C(dx)) / dx^2`, from which `m` cancels. Each of the 33 values passes
/// |z| < 4 with probability 1 - 6e-5. A realisation's own variance scatters by
/// `sqrt(pi tau_x tau_y / A)`, 15 % here, so 600 of them see an error of 2.4 % in it at z = 4.
#[test]
fn ensemble_has_the_requested_statistics() {
    let realisations = 600;
    for (seed, tau_x, tau_y, azimuth, shape, spacing) in [
        (11, 5.0, 5.0, 0.0, [64, 60], [1.0, 1.0]),
        (12, 2.0, 5.0, 0.0, [75, 48], [0.5, 1.0]),
        (13, 5.0, 7.0, 0.6, [71, 65], [1.0, 1.0]),
    ] {
        let psd = Psd::anisotropic_gaussian(0.8, tau_x, tau_y, azimuth).unwrap();
        let synthesis = Synthesis::new(psd.clone(), shape, spacing, false).unwrap();
        let area = (shape[0] * shape[1]) as f64 * spacing[0] * spacing[1];
        let m = 0.64 * PI * tau_x * tau_y / area;
        let [dx, dy] = spacing;
        let nx = shape[1];
        let lags = [
            [0, 0],
            [1, 0],
            [0, 1],
            [4, 0],
            [0, 4],
            [3, 3],
            [nx - 3, 3],
            [8, 0],
            [0, 8],
        ];
        let mut products = vec![Vec::new(); lags.len()];
        let mut slopes = [Vec::new(), Vec::new()];
        for realisation in 0..realisations {
            let field = synthesis.draw(seed, realisation).unwrap();
            for (values, lag) in products.iter_mut().zip(lags) {
                values.push(mean_of_pairs(&field, lag, |a, b| a * b));
            }
            slopes[0].push(mean_of_pairs(&field, [1, 0], |a, b| ((b - a) / dx).powi(2)));
            slopes[1].push(mean_of_pairs(&field, [0, 1], |a, b| ((b - a) / dy).powi(2)));
        }
        for (values, lag) in products.iter().zip(lags) {
            let lag_x = if lag[0] == nx - 3 {
                -3.0
            } else {
                lag[0] as f64
            };
            let expected = psd.autocorrelation(lag_x * dx, lag[1] as f64 * dy) - m;
            let z = z(values, expected);
            println!("lag {lag:?}: z = {z:.2}");
            assert!(z.abs() < 4.0, "{psd:?} lag {lag:?}: z = {z}");
        }
        let [length_x, length_y] = psd.axis_correlation_lengths();
        for (values, d, length) in [(&slopes[0], dx, length_x), (&slopes[1], dy, length_y)] {
            let expected = 2.0 * 0.64 * (1.0 - (-(d / length).powi(2)).exp()) / (d * d);
            let z = z(values, expected);
            println!("slopes: z = {z:.2}");
            assert!(z.abs() < 4.0, "{psd:?} slope variance: z = {z}");
        }
    }
}

/// The mean of the normalised third and fourth moments over realisations; a linear filter of
/// Gaussian noise is Gaussian, so per point they are 0 and 3 sigma^4.
#[test]
fn heights_are_gaussian() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [48, 48], [1.0, 1.0], false).unwrap();
    let variance = synthesis.expected_variance();
    let (mut third, mut fourth) = (Vec::new(), Vec::new());
    for realisation in 0..400 {
        let field = synthesis.draw(21, realisation).unwrap();
        let n = field.heights().len() as f64;
        third.push(field.heights().iter().map(|h| h.powi(3)).sum::<f64>() / n);
        fourth.push(field.heights().iter().map(|h| h.powi(4)).sum::<f64>() / n);
    }
    let (z3, z4) = (z(&third, 0.0), z(&fourth, 3.0 * variance * variance));
    println!("third moment z = {z3:.2}, fourth z = {z4:.2}");
    assert!(z3.abs() < 4.0 && z4.abs() < 4.0, "{z3} {z4}");
}

#[test]
fn thread_count_changes_no_byte() {
    let psd = Psd::anisotropic_gaussian(1.0, 5.0, 4.0, 0.3).unwrap();
    let synthesis = Synthesis::new(psd, [141, 150], [1.0, 1.0], false).unwrap();
    let draw = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| synthesis.draw(5, 2).unwrap())
    };
    let one = draw(1);
    for threads in [2, 3] {
        let bits = |field: &HeightField| -> Vec<u64> {
            field.heights().iter().map(|h| h.to_bits()).collect()
        };
        assert_eq!(bits(&one), bits(&draw(threads)), "{threads} threads");
    }
}

#[test]
fn same_seed_same_surface_other_realisation_another() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
    let surface = synthesis.draw(1, 0).unwrap();
    assert_eq!(surface, synthesis.draw(1, 0).unwrap());
    assert_ne!(surface, synthesis.draw(1, 1).unwrap());
    assert_ne!(surface, synthesis.draw(0, 1).unwrap());
}

/// Neither the earlier content of the memory nor its size matters.
#[test]
fn surface_is_the_same_in_reused_memory() {
    for (shape, tau) in [([40, 44], 1.0), ([41, 43], 4.0), ([9, 2], 0.5)] {
        let psd = Psd::gaussian(1.0, tau).unwrap();
        let synthesis = Synthesis::new(psd, shape, [1.0, 1.0], true).unwrap();
        let surface = synthesis.draw(1, 2).unwrap();
        for samples in [0, 7, 41 * 43, 50 * 50] {
            let room = vec![f64::NAN; samples];
            assert_eq!(synthesis.draw_into(1, 2, room, NEVER).unwrap(), surface);
        }
    }
}

#[test]
fn heights_that_no_arithmetic_holds_are_refused() {
    for sigma in [1e-200, 1e-51, 1e51, 1e200] {
        assert!(Psd::gaussian(sigma, 4.0).is_err(), "{sigma}");
    }
    let psd = Psd::gaussian(1e-50, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
    let surface = synthesis.draw(1, 0).unwrap();
    assert!(surface.heights().iter().any(|height| *height != 0.0));
}

/// A finer grid over the same tile has the same waves: heights agree where both grids have a sample,
/// but for the power beyond the coarse grid's Nyquist wave number, `exp(-pi^2 / 4 (tau / dx)^2)` of
/// its peak, here `exp(-62)`, or `1e-13` in height; rounding adds as much.
#[test]
fn finer_grid_has_the_same_surface() {
    let psd = Psd::anisotropic_gaussian(1.0, 5.0, 6.0, 0.4).unwrap();
    let coarse = Synthesis::new(psd.clone(), [50, 61], [1.0, 1.0], false).unwrap();
    let fine = Synthesis::new(psd, [150, 122], [0.5, 1.0 / 3.0], false).unwrap();
    let (coarse, fine) = (coarse.draw(9, 4).unwrap(), fine.draw(9, 4).unwrap());
    for iy in 0..50 {
        for ix in 0..61 {
            let difference = coarse.height(ix, iy) - fine.height(2 * ix, 3 * iy);
            assert!(difference.abs() < 1e-12, "({ix}, {iy}): {difference:e}");
        }
    }
}

/// Numbers that must stay as they are from one version to the next, but for rounding.
#[test]
fn heights_of_a_seed_stay_as_published() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [33, 40], [1.0, 1.0], false).unwrap();
    let surface = synthesis.draw(2024, 3).unwrap();
    for (ix, iy, expected) in PUBLISHED {
        let found = surface.height(ix, iy);
        assert!(
            (found - expected).abs() < 1e-9,
            "({ix}, {iy}): {found:.12} against {expected:.12}"
        );
    }
}

const PUBLISHED: [(usize, usize, f64); 4] = [
    (0, 0, 0.566_883_455_587),
    (39, 0, 0.605_915_518_496),
    (0, 32, 0.672_601_518_447),
    (17, 20, -0.945_956_673_999),
];

#[test]
fn unresolved_spectra_and_small_tiles_are_refused() {
    let psd = Psd::gaussian(1.0, 3.0).unwrap();
    let coarse = Synthesis::new(psd.clone(), [64, 64], [0.5, 1.0], false).unwrap_err();
    assert!(matches!(
        coarse,
        SynthesisError::Unresolved { axis: 'y', .. }
    ));
    assert_eq!(
        coarse.to_string(),
        "the correlation length along y is 3, only 3.00 spacings of 1: \
         take a spacing of at most 0.75, or insist"
    );
    let small = Synthesis::new(psd.clone(), [100, 40], [0.5, 0.5], false).unwrap_err();
    assert!(matches!(
        small,
        SynthesisError::TooSmallTile { axis: 'x', .. }
    ));
    assert_eq!(
        small.to_string(),
        "the tile is 20 long along x, only 6.67 correlation lengths of 3: \
         take at least 48 samples along x at this spacing, or insist"
    );
    assert!(Synthesis::new(psd.clone(), [64, 64], [0.5, 1.0], true).is_ok());
    assert!(Synthesis::new(psd.clone(), [100, 40], [0.5, 0.5], true).is_ok());
    // Following the advice is enough.
    assert!(Synthesis::new(psd.clone(), [64, 64], [0.5, 0.75], false).is_ok());
    assert!(Synthesis::new(psd, [100, 48], [0.5, 0.5], false).is_ok());
    // A long ridge along the diagonal needs room along both axes.
    let ridge = Psd::anisotropic_gaussian(1.0, 20.0, 4.0, PI / 4.0).unwrap();
    assert!(matches!(
        Synthesis::new(ridge, [160, 100], [1.0, 1.0], false),
        Err(SynthesisError::TooSmallTile { axis: 'x', .. })
    ));
}

#[test]
fn refuses_sizes_beyond_memory_before_asking_for_it() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    assert!(matches!(
        Synthesis::new(psd.clone(), [1 << 40, 1 << 40], [1.0, 1.0], true),
        Err(SynthesisError::HeightField(
            HeightFieldError::TooLarge { .. }
        ))
    ));
    assert!(matches!(
        Synthesis::new(psd.clone(), [1 << 16, 1 << 16], [1.0, 1.0], false),
        Err(SynthesisError::TooManySamples { .. })
    ));
    assert!(matches!(
        Synthesis::new(psd.clone(), [1, 64], [1.0, 1.0], true),
        Err(SynthesisError::HeightField(
            HeightFieldError::TooSmall { .. }
        ))
    ));
    // A large tile is planned without being allocated, and says what it takes: 2 GiB of heights and
    // little else.
    let large = Synthesis::new(psd, [1 << 14, 1 << 14], [1.0, 1.0], false).unwrap();
    assert!(large.peak_bytes() > 2 << 30 && large.peak_bytes() < 9 << 28);
}

#[test]
fn a_surface_that_is_given_up_is_not_finished() {
    let psd = || Psd::gaussian(1.0, 4.0).unwrap();
    let (shape, spacing) = ([32, 32], [1.0, 1.0]);
    let flat = Synthesis::new(psd(), shape, spacing, false).unwrap();
    let splines = SplineSynthesis::new(psd(), shape, spacing, false).unwrap();
    let fields = FieldSynthesis::new(psd().into(), shape, spacing, Resolution::Facets).unwrap();
    let slip = Erosion::Slip(Slip {
        slope: 0.1,
        steps: 100_000,
    });
    let given_up: GivesUp<'_> = &|| true;
    for error in [
        flat.draw_into(1, 0, Vec::new(), given_up).err(),
        splines.draw_into(1, 0, Vec::new(), given_up).err(),
        fields.draw_into(1, 0, Vec::new(), given_up).err(),
        fields.eroded(vec![slip], given_up).err(),
    ] {
        assert_eq!(error, Some(SynthesisError::GivenUp));
    }
    let field = flat.draw(1, 0).unwrap();
    assert_eq!(slip.of_unless(&field, given_up), Ok(None));
}
