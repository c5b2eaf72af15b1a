//! Transforms against those of rustfft, and their independence.

use std::f64::consts::TAU;

use rustfft::FftPlanner;

use super::unit_root::unit_root;
use super::*;
use crate::fnv1a;

/// Numbers without order, between -1 and 1.
fn jumble(seed: usize, length: usize) -> Vec<Complex<f64>> {
    let part = |i: usize| {
        let mixed = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        ((mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 11) as f64
            / (1_u64 << 52) as f64
            - 1.0
    };
    let places = (0..length).map(|i| 2 * (i + (seed << 24)));
    places.map(|i| Complex::new(part(i), part(i + 1))).collect()
}

/// Small lengths, and some of many factors, of large ones, and primes.
fn lengths() -> impl Iterator<Item = usize> {
    (1..=300).chain([
        509, 512, 720, 999, 1000, 1001, 1021, 1024, 1500, 1616, 2042, 3003, 4096, 4099,
    ])
}

/// Asserts that numbers agree, relative to the largest: each of some `log2(length)` sums rounds by half a unit in the last place, and a
/// convolution is of two transforms.
fn assert_near(found: &[Complex<f64>], expected: &[Complex<f64>], length: usize) {
    assert_eq!(found.len(), expected.len());
    let norms = expected.iter().map(|value| value.norm());
    let errors = found.iter().zip(expected).map(|(a, b)| (a - b).norm());
    let (largest, error) = (norms.fold(0.0, f64::max), errors.fold(0.0, f64::max));
    let bound = f64::EPSILON * (2.0 + (length as f64).log2()) * largest;
    assert!(error <= bound, "length {length}: {error:e} above {bound:e}");
}

/// Transforms of two lines by ours.
fn transformed(transform: &FourierTransform, lines: [&[Complex<f64>]; 2]) -> Vec<Complex<f64>> {
    let mut scratch = transform.scratch();
    let pairs = lines[0].iter().zip(lines[1]);
    let pairs = pairs.map(|(a, b)| ComplexPair::new([*a, *b]));
    let mut found = vec![Complex::default(); lines.concat().len()];
    write(transform.transform(pairs, &mut scratch), &mut found);
    found
}

/// Half the spectra of two real lines by ours.
fn half_spectra(transform: &RealFourierTransform, lines: [&[f64]; 2]) -> Vec<ComplexPair> {
    let mut scratch = transform.scratch();
    let mut spectra = transform.spectra();
    transform.forward(lines, &mut spectra, &mut scratch);
    spectra
}

#[test]
fn complex_transforms_match_those_of_rustfft() {
    let mut planner = FftPlanner::new();
    for length in lengths() {
        let lines = [jumble(1, length), jumble(2, length)];
        for (ours, theirs) in [
            (
                FourierTransform::forward(length),
                planner.plan_fft_forward(length),
            ),
            (
                FourierTransform::inverse(length),
                planner.plan_fft_inverse(length),
            ),
        ] {
            let mut expected = lines.concat();
            theirs.process(&mut expected);
            let found = transformed(&ours, [&lines[0], &lines[1]]);
            assert_near(&found, &expected, length);
        }
    }
}

#[test]
fn real_transforms_match_complex_ones_of_rustfft() {
    let mut planner = FftPlanner::new();
    for length in lengths() {
        let ours = RealFourierTransform::new(length);
        let lines = [1, 2].map(|seed| jumble(seed, length));
        let real = lines
            .each_ref()
            .map(|line| line.iter().map(|value| value.re).collect::<Vec<_>>());
        let spectra = half_spectra(&ours, [&real[0], &real[1]]);
        let mut back = vec![0.0; 2 * length];
        let mut scratch = ours.scratch();
        let (first, second) = back.split_at_mut(length);
        ours.inverse(&spectra, [first, second], &mut scratch);
        for (i, line) in real.iter().enumerate() {
            let mut expected: Vec<Complex<f64>> = line.iter().map(|value| value.into()).collect();
            planner.plan_fft_forward(length).process(&mut expected);
            let found: Vec<_> = spectra.iter().map(|pair| pair.numbers()[i]).collect();
            assert_near(&found, &expected[..ours.waves()], length);
            let scaled = |value: &f64| Complex::from(value / length as f64);
            let found: Vec<_> = back[i * length..][..length].iter().map(scaled).collect();
            let line: Vec<_> = line.iter().map(Complex::from).collect();
            assert_near(&found, &line, length);
        }
    }
}

/// An inverse transform takes no imaginary part of waves that are their own opposites.
#[test]
fn imaginary_parts_at_the_ends_are_ignored() {
    for length in [1, 2, 5, 6, 8] {
        let ours = RealFourierTransform::new(length);
        let line = |imaginary: f64| {
            let mut spectra = vec![ComplexPair::new([Complex::new(0.3, 0.2); 2]); ours.waves()];
            spectra[0] = ComplexPair::new([Complex::new(1.0, imaginary); 2]);
            if length.is_multiple_of(2) {
                spectra[length / 2] = ComplexPair::new([Complex::new(-2.0, 3.0 * imaginary); 2]);
            }
            let mut line = vec![0.0; length];
            let mut scratch = ours.scratch();
            ours.inverse(&spectra, [&mut line, &mut []], &mut scratch);
            line
        };
        assert_eq!(line(0.0), line(7.0), "length {length}");
    }
}

/// Neither the place of a line nor the other one changes a bit.
#[test]
fn lines_do_not_depend_on_each_other() {
    for length in [1, 4, 30, 37, 64, 211, 1021] {
        let lines = [1, 2, 3].map(|seed| jumble(seed, length));
        let transform = FourierTransform::inverse(length);
        let first = transformed(&transform, [&lines[0], &lines[1]]);
        let second = transformed(&transform, [&lines[2], &lines[0]]);
        assert_eq!(first[..length], second[length..], "length {length}");
        let real = lines.map(|line| line.iter().map(|value| value.re).collect::<Vec<_>>());
        let transform = RealFourierTransform::new(length);
        let first = half_spectra(&transform, [&real[0], &real[1]]);
        let second = half_spectra(&transform, [&real[2], &real[0]]);
        let alone = half_spectra(&transform, [&real[0], &[]]);
        for ((first, second), alone) in first.iter().zip(&second).zip(&alone) {
            assert_eq!(first.numbers()[0], second.numbers()[1], "length {length}");
            assert_eq!(first.numbers()[0], alone.numbers()[0], "length {length}");
        }
    }
}

/// Bits that must be the same on every machine: radices, any odd factor, and a convolution.
#[test]
fn bits_of_transforms_stay() {
    let mut bytes = Vec::new();
    for length in [4096, 1500, 37 * 7, 1021] {
        let lines = [1, 2].map(|seed| jumble(seed, length));
        let found = transformed(&FourierTransform::forward(length), [&lines[0], &lines[1]]);
        let numbers = found.iter().flat_map(|value| [value.re, value.im]);
        bytes.extend(numbers.flat_map(f64::to_le_bytes));
    }
    assert_eq!(fnv1a(bytes), 3_033_996_860_848_491_648);
}

/// Three roundings of the angle, and one of the function.
#[test]
fn roots_are_those_of_one() {
    for n in (1..=100).chain([1021, 4096]) {
        for k in 0..n {
            let angle = TAU * k as f64 / n as f64;
            let error = (unit_root(k, n) - Complex::new(angle.cos(), -angle.sin())).norm();
            assert!(error < 6.0 * f64::EPSILON, "{k} / {n}: {error:e}");
            assert!((unit_root(k, n).norm() - 1.0).abs() < 2.0 * f64::EPSILON);
        }
    }
    let quarters = [0, 1, 2, 3].map(|k| unit_root(5 * k, 20));
    assert_eq!(
        quarters,
        [(1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0)].map(|(re, im)| Complex::new(re, im))
    );
}

#[test]
fn grids_match_transforms_of_their_columns_and_rows() {
    let mut planner = FftPlanner::new();
    for shape @ [ny, nx] in [
        [1, 1],
        [1, 6],
        [5, 1],
        [2, 2],
        [7, 10],
        [24, 15],
        [31, 33],
        [64, 30],
    ] {
        let grid: Vec<f64> = jumble(4, nx * ny).iter().map(|value| value.re).collect();
        let fill = |iy: usize, row: &mut [f64]| row.copy_from_slice(&grid[iy * nx..][..nx]);
        let plane = HalfPlane::of(shape, fill);

        let mut expected: Vec<Complex<f64>> = grid.iter().map(Complex::from).collect();
        planner.plan_fft_forward(nx).process(&mut expected);
        let mut expected = crate::columns(&expected, nx);
        planner.plan_fft_forward(ny).process(&mut expected);
        assert_near(&plane.columns, &expected[..ny * (nx / 2 + 1)], nx * ny);

        let mut powers: Vec<_> = expected
            .iter()
            .map(|value| value.norm_sqr().into())
            .collect();
        planner.plan_fft_inverse(ny).process(&mut powers);
        let mut powers = crate::columns(&powers, ny);
        planner.plan_fft_inverse(nx).process(&mut powers);
        let found = plane.circular_autocorrelation();
        let found: Vec<_> = found.iter().map(Complex::from).collect();
        assert_near(&found, &powers, nx * ny);
    }
}
