//! Drawn spline surfaces are those of their waves.

use std::f64::consts::TAU;

use asperity_surface::{Border, HeightField, Length, SplineSurface};
use asperity_synthesis::{
    MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH, NEVER, Psd, SplineSynthesis, Synthesis,
    SynthesisError,
};

use super::{BORDERS, jumble};

/// Drawn on the same grid, heights differ from the sum of the waves by the images of these at
/// `k + 2 pi m / d` alone, of fourth order in the spacing. The reference between grid points is the one
/// drawn on a finer grid, exact to the power beyond the Nyquist wave number, `erfc(2 pi)`.
#[test]
fn drawn_spline_converges_to_the_sum_of_the_waves_with_fourth_order() {
    let psd = Psd::anisotropic_gaussian(1.0, 8.0, 6.0, 0.4).unwrap();
    let fine = Synthesis::new(psd.clone(), [192, 256], [0.25, 0.25], true).unwrap();
    let fine = fine.draw(5, 2).unwrap();
    let worst = |n: usize| {
        let shape = [192 / n, 256 / n];
        let d = 0.25 * n as f64;
        let splines = SplineSynthesis::new(psd.clone(), shape, [d, d], true).unwrap();
        let surface = splines.draw(5, 2).unwrap();
        assert_eq!(surface.provenance(), fine.provenance());
        assert_eq!(surface.border(), Border::Periodic);
        let differences = (0..192 * 256).map(|i| {
            let (ix, iy) = (i % 256, i / 256);
            let found = surface.height(0.25 * ix as f64, 0.25 * iy as f64);
            (found - fine.height(ix, iy)).abs()
        });
        differences.fold(0.0, f64::max)
    };
    let errors = [8, 4, 2].map(worst);
    println!("largest differences {errors:?}");
    let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
    assert!(
        ratios.iter().all(|r| (14.0..22.0).contains(r)),
        "{errors:?} {ratios:?}"
    );
}

/// Mean squares `[of dh/dx, of dh/dy]` over the tile, by four Gauss points per cell and axis, exact for
/// polynomials up to degree 7; those of squared slopes have 6 at most.
fn mean_squared_slopes(surface: &SplineSurface) -> [f64; 2] {
    let points = [
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let points: Vec<[f64; 2]> = points
        .into_iter()
        .flat_map(|(x, w)| [[0.5 * (1.0 - x), 0.5 * w], [0.5 * (1.0 + x), 0.5 * w]])
        .collect();
    let ([cx, cy], [dx, dy]) = (surface.cells(), surface.spacing());
    let mut sums = [0.0; 2];
    for i in 0..cx * cy {
        for [u, wu] in &points {
            for [v, wv] in &points {
                let [x, y] = [(i % cx) as f64 + u, (i / cx) as f64 + v];
                let [sx, sy] = surface.gradient(x * dx, y * dy);
                sums[0] += wu * wv * sx * sx;
                sums[1] += wu * wv * sy * sy;
            }
        }
    }
    sums.map(|sum| sum / (cx * cy) as f64)
}

/// `|H|^2` of the waves of a field by wave number `[ky][kx]`, by direct summation.
fn powers(field: &HeightField) -> Vec<Vec<f64>> {
    let [ny, nx] = field.shape();
    let turn = |i: usize, n: usize| (TAU * i as f64 / n as f64).sin_cos();
    // Sums along x first, `[iy][kx]`
    let rows: Vec<Vec<[f64; 2]>> = (0..ny)
        .map(|iy| {
            let sum = |kx: usize| {
                (0..nx).fold([0.0; 2], |[re, im], ix| {
                    let (sin, cos) = turn(kx * ix % nx, nx);
                    let h = field.height(ix, iy);
                    [re + h * cos, im - h * sin]
                })
            };
            (0..nx).map(sum).collect()
        })
        .collect();
    let power = |kx: usize, ky: usize| {
        let [re, im] = (0..ny).fold([0.0; 2], |[re, im], iy| {
            let (sin, cos) = turn(ky * iy % ny, ny);
            let [a, b] = rows[iy][kx];
            [re + a * cos + b * sin, im + b * cos - a * sin]
        });
        (re * re + im * im) / ((nx * ny) as f64).powi(2)
    };
    (0..ny)
        .map(|ky| (0..nx).map(|kx| power(kx, ky)).collect())
        .collect()
}

/// Sum of `(a / (a + 2 pi m))^power` over all images `m` of a wave that turns by `a` per spacing.
fn images(a: f64, power: i32) -> f64 {
    (-300..=300)
        .map(|m| (a / (a + TAU * f64::from(m))).powi(power))
        .sum()
}

/// The slope variance of a drawn spline is that of its waves, `sum k^2 |H|^2`, and of their images, whose
/// amplitude is the fourth power of `a / (a + 2 pi m)` per axis: exactly, realisation by realisation. At 4
/// spacings per correlation length the images add some 1e-5.
#[test]
fn slope_variance_of_a_drawn_spline_is_that_of_its_waves_and_their_images() {
    let psd = Psd::gaussian(1.0, 4.0).unwrap();
    let (shape, spacing) = ([40, 36], [1.0, 0.9]);
    let splines = SplineSynthesis::new(psd.clone(), shape, spacing, false).unwrap();
    let samples = Synthesis::new(psd, shape, spacing, false).unwrap();
    for realisation in 0..3 {
        let found = mean_squared_slopes(&splines.draw(1, realisation).unwrap());
        let powers = powers(&samples.draw(1, realisation).unwrap());
        // Radians per spacing, from -pi to pi
        let angle = |i: usize, n: usize| {
            let signed = if 2 * i <= n {
                i as f64
            } else {
                i as f64 - n as f64
            };
            TAU * signed / n as f64
        };
        let (mut waves, mut with_images) = ([0.0; 2], [0.0; 2]);
        for (iy, row) in powers.iter().enumerate() {
            for (ix, power) in row.iter().enumerate() {
                let a = [angle(ix, shape[1]), angle(iy, shape[0])];
                let image = |axis: usize, power| {
                    if a[axis] == 0.0 {
                        1.0
                    } else {
                        images(a[axis], power)
                    }
                };
                for axis in 0..2 {
                    let term = power * (a[axis] / spacing[axis]).powi(2);
                    waves[axis] += term;
                    with_images[axis] += term * image(axis, 6) * image(1 - axis, 8);
                }
            }
        }
        for axis in 0..2 {
            let difference = found[axis] / with_images[axis] - 1.0;
            assert!(difference.abs() < 1e-12, "{difference:e}");
            let added = found[axis] / waves[axis] - 1.0;
            println!("realisation {realisation}, axis {axis}: images add {added:e}");
            assert!((1e-6..1e-4).contains(&added), "images add {added:e}");
        }
    }
}

#[test]
fn bytes_do_not_depend_on_threads_or_on_reused_memory() {
    let psd = Psd::anisotropic_gaussian(1.0, 8.0, 6.0, 0.4).unwrap();
    let splines = SplineSynthesis::new(psd, [130, 200], [1.0, 1.0], false).unwrap();
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let drawn = splines.draw(3, 4).unwrap();
            let through = BORDERS.map(|border| SplineSurface::through(&jumble([130, 70], border)));
            (drawn, through)
        })
    };
    let (drawn, through) = with_threads(1);
    assert_eq!(with_threads(2), (drawn.clone(), through));
    let room = splines.draw(3, 5).unwrap().into_coefficients();
    let place = room.as_ptr();
    let reused = splines.draw_into(3, 4, room, NEVER).unwrap();
    assert_eq!(reused, drawn);
    assert_eq!(reused.coefficients().as_ptr(), place);
}

#[test]
fn splines_need_fewer_spacings_per_correlation_length_than_facets() {
    let psd = Psd::gaussian(1.0, 2.5).unwrap();
    assert!(SplineSynthesis::new(psd.clone(), [32, 32], [1.0, 1.0], false).is_ok());
    assert!(Synthesis::new(psd.clone(), [32, 32], [1.0, 1.0], false).is_err());
    let coarse = SplineSynthesis::new(psd.clone(), [32, 32], [1.0, 1.01], false).unwrap_err();
    assert!(matches!(
        coarse,
        SynthesisError::Unresolved {
            axis: 'y',
            largest_spacing: Length { value: 1.0, .. },
            ..
        }
    ));
    assert!(SplineSynthesis::new(psd.clone(), [32, 32], [1.0, 2.0], true).is_ok());
    let small = SplineSynthesis::new(psd, [32, 19], [1.0, 1.0], false);
    assert!(matches!(
        small,
        Err(SynthesisError::TooSmallTile { axis: 'x', .. })
    ));
}

/// The figures that are given for the fewest spacings, from the density of a wave along x or y,
/// `exp(-(k tau)^2 / 4)`, and its images.
#[test]
fn images_raise_the_expected_slope_variance_as_documented() {
    let raised = |spacings: f64| {
        let steps = 2000;
        let mut sums = [0.0; 4];
        for i in 0..steps {
            let a = (f64::from(i) + 0.5) * 0.5 * TAU / f64::from(steps);
            let power = (-(a * spacings / 2.0).powi(2)).exp();
            let terms = [a * a * images(a, 6), a * a, images(a, 8), 1.0];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += power * term;
            }
        }
        sums[0] / sums[1] * sums[2] / sums[3] - 1.0
    };
    let fewest = MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH;
    for (spacings, percent) in [(fewest, 0.044), (3.0, 0.010), (4.0, 0.0012)] {
        let found = 100.0 * raised(spacings);
        assert!(
            (found / percent - 1.0).abs() < 0.03,
            "{spacings}: {found} %"
        );
    }
}
