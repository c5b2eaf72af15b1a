//! Spline surfaces pass through their samples, smoothly, and converge to smooth surfaces.

use std::f64::consts::TAU;

use asperity_surface::{
    Border, HeightField, LengthUnit, Psd, SplineSurface, SplineSynthesis, Synthesis, SynthesisError,
};

const BORDERS: [Border; 3] = [Border::Periodic, Border::Mirrored, Border::Open];

/// Heights without any order, between -1 and 1.
fn jumble([ny, nx]: [usize; 2], border: Border) -> HeightField {
    let heights = (0..nx * ny)
        .map(|i| ((i * i) as f64 * 0.37 + i as f64).sin())
        .collect();
    HeightField::new(heights, [ny, nx], [0.5, 2.0])
        .expect("a valid grid")
        .with_border(border)
        .with_unit(LengthUnit::Micrometre)
}

/// Each line's solution rounds to some `eps` of the largest height, twice.
#[test]
fn spline_passes_through_all_samples() {
    for border in BORDERS {
        for shape in [
            [2, 2],
            [2, 3],
            [3, 2],
            [5, 4],
            [66, 9],
            [17, 130],
            [200, 150],
        ] {
            let field = jumble(shape, border);
            let surface = SplineSurface::through(&field);
            let [dx, dy] = field.spacing();
            for iy in 0..=surface.cells()[1] {
                for ix in 0..=surface.cells()[0] {
                    let found = surface.height(ix as f64 * dx, iy as f64 * dy);
                    let expected = field.height(ix, iy);
                    assert!(
                        (found - expected).abs() < 1e-14,
                        "{border} {shape:?} ({ix}, {iy}): {found} against {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn spline_keeps_grid_unit_and_border() {
    for border in BORDERS {
        let field = jumble([5, 8], border);
        let surface = SplineSurface::through(&field);
        assert_eq!(surface.cells(), field.cells());
        assert_eq!(surface.extent(), field.extent());
        assert_eq!(surface.spacing(), field.spacing());
        assert_eq!(surface.unit(), LengthUnit::Micrometre);
        assert_eq!(surface.border(), border);
        assert_eq!(surface.provenance(), None);
        let [cx, cy] = surface.cells();
        assert_eq!(surface.stride(), cx + 3);
        assert_eq!(surface.coefficients().len(), (cy + 3) * (cx + 3));
    }
}

/// Coefficients beyond the grid points are those of the period or of the mirror image, bit by bit. At an
/// open border they go on linearly, to rounding.
#[test]
fn coefficients_continue_beyond_the_border() {
    let check = |n: usize, border: Border, at: &dyn Fn(usize) -> f64| match border {
        Border::Periodic => {
            assert_eq!([at(0), at(1), at(2)], [at(n), at(n + 1), at(n + 2)]);
        }
        Border::Mirrored => assert_eq!([at(0), at(n + 1)], [at(2), at(n - 1)]),
        Border::Open => {
            for i in [1, n] {
                let bend = at(i - 1) - 2.0 * at(i) + at(i + 1);
                assert!(bend.abs() < 1e-14, "{bend}");
            }
        }
    };
    for border in BORDERS {
        for shape in [[2, 2], [4, 7]] {
            let [ny, nx] = shape;
            let surface = SplineSurface::through(&jumble(shape, border));
            let at = |ix: usize, iy: usize| surface.coefficients()[iy * surface.stride() + ix];
            let [cx, cy] = surface.cells();
            for iy in 0..cy + 3 {
                check(nx, border, &|ix| at(ix, iy));
            }
            for ix in 0..cx + 3 {
                check(ny, border, &|iy| at(ix, iy));
            }
        }
    }
}

/// Halving the spacing lowers an error of fourth order by 16, to corrections of `(k d)^2`. At 64 samples
/// per period the error is about `(2 pi / 64)^4 / 384 = 2e-7`, far above rounding.
#[test]
fn spline_of_a_sine_converges_with_fourth_order() {
    let at = |x: f64, y: f64| (TAU * (2.0 * x + y)).sin();
    let worst = |n: usize| {
        let d = 1.0 / n as f64;
        let heights = (0..n * n)
            .map(|i| at((i % n) as f64 * d, (i / n) as f64 * d))
            .collect();
        let field = HeightField::new(heights, [n, n], [d, d]).unwrap();
        let surface = SplineSurface::through(&field);
        (0..97 * 97)
            .map(|i| [(i % 97) as f64 / 97.0, (i / 97) as f64 / 97.0])
            .map(|[x, y]| (surface.height(x, y) - at(x, y)).abs())
            .fold(0.0, f64::max)
    };
    let errors = [32, 64, 128].map(worst);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((14.5..17.5).contains(&ratio), "{errors:?}");
    }
}

/// Drawn on the same grid, heights differ from the sum of the waves by the images of these at
/// `k + 2 pi m / d` alone, of fourth order in the spacing. The reference between grid points is the one
/// drawn on a finer grid, exact to the power beyond the Nyquist wave number, `erfc(2 pi)`.
#[test]
fn drawn_spline_converges_to_the_sum_of_the_waves_with_fourth_order() {
    let psd = Psd::anisotropic_gaussian(1.0, 8.0, 6.0, 0.4).unwrap();
    let fine = Synthesis::new(psd, [192, 256], [0.25, 0.25], true).unwrap();
    let fine = fine.draw(5, 2).unwrap();
    let worst = |n: usize| {
        let shape = [192 / n, 256 / n];
        let d = 0.25 * n as f64;
        let splines = SplineSynthesis::new(psd, shape, [d, d], true).unwrap();
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
    let splines = SplineSynthesis::new(psd, shape, spacing, false).unwrap();
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
    let reused = splines.draw_into(3, 4, room).unwrap();
    assert_eq!(reused, drawn);
    assert_eq!(reused.coefficients().as_ptr(), place);
}

#[test]
fn splines_need_fewer_spacings_per_correlation_length_than_facets() {
    let psd = Psd::gaussian(1.0, 2.5).unwrap();
    assert!(SplineSynthesis::new(psd, [32, 32], [1.0, 1.0], false).is_ok());
    assert!(Synthesis::new(psd, [32, 32], [1.0, 1.0], false).is_err());
    let coarse = SplineSynthesis::new(psd, [32, 32], [1.0, 1.01], false).unwrap_err();
    assert!(matches!(
        coarse,
        SynthesisError::Unresolved {
            axis: 'y',
            largest_spacing: 1.0,
            ..
        }
    ));
    assert!(SplineSynthesis::new(psd, [32, 32], [1.0, 2.0], true).is_ok());
    let small = SplineSynthesis::new(psd, [32, 19], [1.0, 1.0], false);
    assert!(matches!(
        small,
        Err(SynthesisError::TooSmallTile { axis: 'x', .. })
    ));
    let high = Psd::gaussian(1e120, 4.0).unwrap();
    let high = SplineSynthesis::new(high, [32, 32], [1.0, 1.0], false).unwrap();
    assert!(matches!(
        high.draw(1, 0),
        Err(SynthesisError::HeightField(_))
    ));
}
