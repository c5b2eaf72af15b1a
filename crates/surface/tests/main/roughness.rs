//! Roughness of surfaces whose parameters are known in closed form, or on average.

use std::f64::consts::{PI, SQRT_2};

use asperity_surface::{Border, Form, HeightField, Roughness, Triangle};
use asperity_synthesis::{DrawnRoughness, Psd, Synthesis};

fn field(shape: [usize; 2], spacing: [f64; 2], f: impl Fn(usize, usize) -> f64) -> HeightField {
    let [ny, nx] = shape;
    let heights = (0..nx * ny).map(|i| f(i % nx, i / nx)).collect();
    HeightField::new(heights, shape, spacing).expect("a valid grid")
}

fn assert_relative(name: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{name}: {found} against {expected}"
    );
}

/// One period of a sine of amplitude 1 on `n` samples, n divisible by 4: the sums of its powers over
/// the samples are exact, mean square 1/2, mean fourth power 3/8, mean magnitude
/// `(2/n) cot(pi/n)`. Its mesh has the slope `(2/dx) sin(pi/n) cos(...)`. Offsets and scales change
/// nothing but the rounding of the heights themselves.
#[test]
fn sine_has_its_parameters_at_any_offset_and_scale() {
    let n = 48;
    for (scale, offset) in [
        (1.0, 0.0),
        (1e-9, 0.0),
        (1e9, 0.0),
        (1.0, 1e6),
        (1e-9, 1e-3),
    ] {
        let [dx, dy] = [0.25 * scale, 0.5 * scale];
        let sine = |ix: usize| (2.0 * PI * ix as f64 / n as f64).sin();
        let surface = field([7, n], [dx, dy], |ix, _| offset + scale * sine(ix));
        let r = Roughness::of(&surface);
        let tolerance = 1e-12 + 4e-16 * offset / scale * 10.0;
        assert!((r.mean - offset).abs() <= tolerance * scale, "{}", r.mean);
        assert_relative("sq", r.sq, scale / SQRT_2, tolerance);
        let sa = 2.0 / n as f64 / (PI / n as f64).tan();
        assert_relative("sa", r.sa, scale * sa, tolerance);
        assert_relative("sp", r.sp, scale, tolerance);
        assert_relative("sv", r.sv, scale, tolerance);
        assert_relative("sz", r.sz, 2.0 * scale, tolerance);
        assert!(r.ssk.unwrap().abs() < tolerance, "{:?}", r.ssk);
        assert_relative("sku", r.sku.unwrap(), 1.5, tolerance);
        let sdq = SQRT_2 * (PI / n as f64).sin() / 0.25;
        // Differences of heights lose n / (2 pi) more digits than the heights.
        let tolerance = tolerance * 10.0;
        assert_relative("sdq", r.sdq, sdq, tolerance);
        assert_relative("slopes", r.slope_variance[0], sdq * sdq, 2.0 * tolerance);
        assert!(r.slope_variance[1] == 0.0 && r.equivalent_tau_y.is_none());
        assert!(r.slope_mean[0].abs() < tolerance);
        assert_relative("s", r.equivalent_smoothness.unwrap(), 2.0 / sdq, tolerance);
        let equivalent = r.equivalent_tau_x.unwrap();
        assert_relative("equivalent tau", equivalent, scale / sdq, tolerance);
        // The autocorrelation is a cosine, which is 1/e at acos(1/e); interpolation within a step
        // of 2 pi / 48 is good to (2 pi / 48)^2 / 8 = 0.2 %. Along y it never falls.
        let tau_x = (-1.0_f64).exp().acos() / (2.0 * PI) * n as f64 * dx;
        assert_relative("tau_x", r.tau_x.unwrap(), tau_x, 2e-3);
        assert_relative("l_x", r.l_x.unwrap() * SQRT_2, r.tau_x.unwrap(), 1e-15);
        assert!(r.tau_y.is_none() && r.tau.is_none() && r.l_y.is_none());
    }
}

#[test]
fn flat_surface_has_no_shape() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let r = Roughness::of(&field([5, 6], [1.0, 1.0], |_, _| 0.1).with_border(border));
        assert_eq!((r.sq, r.sa, r.sz, r.sdq), (0.0, 0.0, 0.0, 0.0));
        assert_eq!(r.mean, 0.1);
        assert!(r.ssk.is_none() && r.sku.is_none() && r.tau_x.is_none() && r.tau.is_none());
        assert!(r.equivalent_tau_x.is_none() && r.equivalent_smoothness.is_none());
        assert_eq!((r.steepest.slope, r.steepest.angle_degrees), (0.0, 0.0));
    }
}

/// An open tilted plane: its slopes have a mean and no variance, and its gradient counts in `sdq`.
#[test]
fn tilt_is_a_mean_slope_not_a_variance() {
    let plane = field([9, 11], [0.5, 0.25], |ix, iy| 3.0 * ix as f64 - iy as f64);
    let r = Roughness::of(&plane.clone().with_border(Border::Open));
    assert_eq!(r.slope_mean, [6.0, -4.0]);
    assert_eq!(r.slope_variance, [0.0, 0.0]);
    assert_relative("sdq", r.sdq, 52.0_f64.sqrt(), 1e-15);
    assert_eq!(r.extent, [5.0, 2.0]);
    let levelled = Form::Plane.remove(plane.with_border(Border::Open)).unwrap();
    assert!(Roughness::of(&levelled).sdq < 1e-13);
}

#[test]
fn skewness_counts_peaks_positive() {
    let peak = field([8, 8], [1.0, 1.0], |ix, iy| {
        f64::from(u8::from((ix, iy) == (3, 4)))
    });
    let r = Roughness::of(&peak);
    // Bernoulli with p = 1/64
    let p = 1.0 / 64.0_f64;
    let q = 1.0 - p;
    assert_relative(
        "ssk",
        r.ssk.unwrap(),
        (1.0 - 2.0 * p) / (p * q).sqrt(),
        1e-12,
    );
    assert_relative(
        "sku",
        r.sku.unwrap(),
        3.0 + (1.0 - 6.0 * p * q) / (p * q),
        1e-12,
    );
    // The peak is corner 01 of cell (3, 3), whose upper triangle rises to it along y and falls from
    // it along x; and corner 10 of cell (2, 4), whose lower triangle is as steep but comes later.
    assert_relative("steepest", r.steepest.slope, SQRT_2, 1e-15);
    assert_relative(
        "angle",
        r.steepest.angle_degrees,
        54.735_610_317_245_35,
        1e-14,
    );
    assert_eq!((r.steepest.ix, r.steepest.iy), (3, 3));
    assert_eq!(r.steepest.triangle, Triangle::Upper);
}

/// Requested values, and the scatter claimed for the realised ones, against `n` realisations. A mean
/// is then known to `deviation / sqrt n`, and a deviation to the fraction
/// `sqrt((1 + excess / 2) / (2 n))`, where `excess` is the kurtosis of the quantity above 3. With
/// `m = pi tau_x tau_y / A = 0.019` at most, the sum over the grid of `(W dk^2)^p` is
/// `sigma^(2p) m^(p-1) / p`. So the variance, a sum of independent squares, has excess `12 m` = 0.22,
/// which is 6 % in the last formula; and the mean set to zero takes `2 m` off the square of its
/// deviation, 2 % off the deviation itself. Of the slopes it takes nothing, but their mesh takes a
/// term of order `dx^2 / (2 tau^2)`, another 2 % at most.
#[test]
fn realised_values_scatter_as_claimed() {
    let n = 600;
    for (tau_x, tau_y, azimuth, shape) in [(4.0, 4.0, 0.0, [52, 54]), (4.0, 5.0, 0.5, [60, 56])] {
        let psd = Psd::anisotropic_gaussian(0.7, tau_x, tau_y, azimuth).unwrap();
        let synthesis = Synthesis::new(psd.clone(), shape, [1.0, 1.0], false).unwrap();
        let drawn: Vec<_> = (0..n)
            .map(|realisation| {
                let surface = synthesis.draw(31, realisation).unwrap();
                DrawnRoughness::of(&surface).realised.unwrap()
            })
            .collect();
        let bias = PI * tau_x * tau_y / (shape[0] * shape[1]) as f64;
        for (name, pick, lowered) in [
            ("variance", 0, bias),
            ("slopes along x", 1, 0.0),
            ("slopes along y", 2, 0.0),
        ] {
            let compared = |i: usize| {
                let r = &drawn[i];
                [r.variance, r.slope_variance_x, r.slope_variance_y][pick]
            };
            let values: Vec<f64> = (0..drawn.len())
                .map(|i| compared(i).realised.unwrap())
                .collect();
            let requested = compared(0).requested * (1.0 - lowered);
            let claimed = compared(0).expected_deviation.unwrap();
            let mean = values.iter().sum::<f64>() / n as f64;
            let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
            let deviation = (squares / (n - 1) as f64).sqrt();
            let z_mean = (mean - requested) / (deviation / (n as f64).sqrt());
            let off = deviation / claimed - 1.0;
            println!("{name}: z of the mean {z_mean:.2}, deviation off by {off:.3}");
            assert!(z_mean.abs() < 4.0, "{name}: z = {z_mean}");
            let allowed = 4.0 * 1.06 / (2.0 * n as f64).sqrt() + 0.02;
            assert!(off.abs() < allowed, "{name}: {deviation} against {claimed}");
        }
        assert_eq!(drawn[0].sigma.requested, 0.7);
        let [length_x, length_y] = psd.axis_correlation_lengths();
        assert_eq!(drawn[0].tau_x.requested, length_x);
        assert_eq!(drawn[0].tau_y.requested, length_y);
    }
}

/// On a tile of 64 x 48 correlation lengths a realised correlation length is within a few per cent
/// of that requested, each axis its own; the tolerance is four times the scatter of the variance,
/// `sqrt(pi / (64 48)) = 3.2 %`, which the lag of a given fraction of it does not exceed.
#[test]
fn correlation_lengths_are_found_along_their_axes() {
    let psd = Psd::anisotropic_gaussian(1.0, 1.0, 3.0, 0.0).unwrap();
    let synthesis = Synthesis::new(psd, [576, 256], [0.25, 0.25], false).unwrap();
    let surface = synthesis.draw(8, 0).unwrap();
    for border in [Border::Periodic, Border::Open] {
        let r = Roughness::of(&surface.clone().with_border(border));
        assert_relative("tau_x", r.tau_x.unwrap(), 1.0, 0.13);
        assert_relative("tau_y", r.tau_y.unwrap(), 3.0, 0.13);
        assert_relative("tau", r.tau.unwrap(), 3.0_f64.sqrt(), 0.13);
        assert_relative("equivalent", r.equivalent_tau_x.unwrap(), 1.0, 0.13);
        assert_relative("equivalent", r.equivalent_tau_y.unwrap(), 3.0, 0.13);
    }
}

#[test]
fn thread_count_changes_no_number() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [140, 90], [1.0, 1.0], false).unwrap();
    let surface = synthesis.draw(1, 0).unwrap();
    let measure = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| {
                let level = Form::Parabola.remove(surface.clone()).unwrap();
                (Roughness::of(&surface), Roughness::of(&level))
            })
    };
    let one = measure(1);
    assert_eq!(one, measure(2));
    assert_eq!(one, measure(3));
}
