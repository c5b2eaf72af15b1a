use std::f64::consts::{PI, TAU};

use super::*;
use crate::{AxisAutocorrelation, Roughness};
use asperity_synthesis::{Psd, Synthesis};

fn uneven(shape: [usize; 2], border: Border) -> HeightField {
    let heights = (0..shape[0] * shape[1])
        .map(|i| ((i * i) as f64 * 0.37).sin() + 0.3)
        .collect();
    let field = HeightField::new(heights, shape, [0.5, 2.0]).unwrap();
    field.with_border(border)
}

/// Parseval's theorem; sums of some hundred numbers round at 1e-14.
#[test]
fn power_of_a_periodic_surface_adds_up_to_its_mean_square() {
    for shape in [[2, 2], [3, 7], [16, 5], [24, 32]] {
        let field = uneven(shape, Border::Periodic);
        let spectrum = PowerSpectrum::of(&field).unwrap();
        let rings = spectrum.rings();
        let sum: f64 = rings.iter().map(|r| r.density * r.waves as f64).sum();
        let waves: u64 = rings.iter().map(|r| r.waves).sum();
        let square = Roughness::of(&field).sq.powi(2);
        assert_eq!(waves as usize, shape[0] * shape[1] - 1, "{shape:?}");
        let power = sum * spectrum.wave_area();
        assert!((power / square - 1.0).abs() < 1e-13, "{power} {square}");
        let zero_lag = AxisAutocorrelation::of(&field);
        for found in [zero_lag.along_x[0], zero_lag.along_y[0]] {
            assert!((found / square - 1.0).abs() < 1e-13, "{found} {square}");
        }
    }
}

/// `A cos(k x)` has `A^2 / 2` in two waves, at `k` and `-k`.
#[test]
fn a_sine_wave_has_its_power_at_its_wave_vector() {
    let (amplitude, [ny, nx]) = (0.7, [12, 20]);
    let wave =
        |ix: usize, iy: usize| (TAU * (3 * ix) as f64 / 20.0 - TAU * (2 * iy) as f64 / 12.0).cos();
    let heights = (0..nx * ny).map(|i| amplitude * wave(i % nx, i / nx));
    let field = HeightField::new(heights.collect(), [ny, nx], [0.5, 0.25]).unwrap();
    let spectrum = PowerSpectrum::of(&field).unwrap();
    let expected = amplitude * amplitude / 4.0 / spectrum.wave_area();
    for place in [[3, -2], [-3, 2]] {
        assert!((spectrum.density(place) / expected - 1.0).abs() < 1e-13);
    }
    assert!(spectrum.density([3, 2]) < 1e-28 * expected);
    let [kx, ky] = [TAU * 3.0 / 10.0, TAU * 2.0 / 3.0];
    let rings = spectrum.rings();
    let fullest = rings.iter().max_by(|a, b| a.density.total_cmp(&b.density));
    let step = TAU / 3.0;
    assert!((fullest.unwrap().k - kx.hypot(ky)).abs() < step);
}

/// Each ordinate of a periodogram is exponential about the density of the spectrum, and waves are independent but for opposite ones. The mean
/// over `n` surfaces of a ring of `m` waves has the relative standard error `1 / sqrt(n m / 2)`. A Hann window makes neighbours alike: along each
/// axis as few as `1 / 1.94` of them count, the two together 1/3.78. It also smears the density over its width, by a relative
/// `tau^2 dk^2 / 2` about, `dk` being the step (second derivative of the density times the variance of the window, 1/3 of a step squared
/// per axis): below 1.2 % here. Deviations of some thirty rings stay within four standard errors.
#[test]
fn spectra_of_drawn_surfaces_average_to_the_density() {
    const SURFACES: u64 = 24;
    let (sigma, tau, side) = (0.5, 6.0, 240);
    let psd = Psd::gaussian(sigma, tau).unwrap();
    let synthesis = Synthesis::new(psd.clone(), [side, side], [1.0, 1.0], false).unwrap();
    for (border, counting, smear) in [(Border::Periodic, 1.0, 0.0), (Border::Open, 3.78, 0.012)] {
        let mut sums: Vec<SpectralRing> = Vec::new();
        for seed in 0..SURFACES {
            let heights = synthesis.draw(seed, 0).unwrap().into_heights();
            let field = HeightField::new(heights, [side, side], [1.0, 1.0]).unwrap();
            let field = field.with_border(border);
            let rings = PowerSpectrum::of(&field).unwrap().rings();
            match sums.is_empty() {
                true => sums = rings,
                false => {
                    for (sum, ring) in sums.iter_mut().zip(&rings) {
                        sum.density += ring.density;
                    }
                }
            }
        }
        // Rings of density above 1 % of the peak; the first two of an open surface lack what went with the plane.
        let first = if counting > 1.0 { 2 } else { 0 };
        let step = TAU / side as f64;
        let shown = sums.iter().enumerate().skip(first);
        let mut tested = 0;
        for (number, ring) in shown.take_while(|(_, r)| r.k * tau < 4.0) {
            let found = ring.density / SURFACES as f64;
            // Mean over the ring, from its inner to its outer radius
            let radii = [number as f64 + 0.5, number as f64 + 1.5].map(|r| r * step);
            let [inner, outer] = radii.map(|k| (-(k * tau / 2.0).powi(2)).exp());
            let area = PI * (radii[1].powi(2) - radii[0].powi(2));
            let exact = sigma * sigma * (inner - outer) / area;
            let at_mean = psd.density(ring.k, 0.0);
            // Waves of a ring are not spread evenly: between the two
            let spread = (exact / at_mean - 1.0).abs() + (step * tau).powi(2) / 2.0;
            let error = (2.0 * counting / (ring.waves as f64 * SURFACES as f64)).sqrt();
            let off = (found / at_mean - 1.0).abs();
            assert!(
                off < 4.0 * error + spread + smear,
                "{border} {}: {off} {error}",
                ring.k
            );
            tested += 1;
        }
        assert!(tested > 20, "{tested} rings");
    }
}
