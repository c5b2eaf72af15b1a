//! Spline surfaces pass through their samples, smoothly, and converge to smooth surfaces.

use std::f64::consts::TAU;

use asperity_surface::{Border, HeightField, LengthUnit, SplineSurface};

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
