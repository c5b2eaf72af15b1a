//! Spline surfaces pass through their samples, smoothly, and converge to smooth surfaces.

mod drawn;
mod roughness;

use std::f64::consts::TAU;

use asperity_surface::{Border, HeightField, HeightFieldError, LengthUnit, SplineSurface};

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

/// The four basis functions sum to 1, and their derivatives to 0: at any offset, heights move by it and
/// gradients stay, to the rounding of the heights that are given, 1e-10, and of sums of 16.
#[test]
fn an_offset_moves_heights_and_leaves_gradients() {
    for border in BORDERS {
        let field = jumble([9, 12], border);
        let raised = field.heights().iter().map(|h| h + 1e6).collect();
        let raised = SplineSurface::through(&field.with_heights(raised).unwrap());
        let surface = SplineSurface::through(&field);
        let [x, y] = surface.extent();
        for i in 0..=50 {
            for j in 0..=50 {
                let [x, y] = [x * f64::from(i) / 50.0, y * f64::from(j) / 50.0];
                let moved = raised.height(x, y) - surface.height(x, y);
                assert!((moved - 1e6).abs() < 3e-9, "{border}: {moved}");
                let [a, b] = [raised.gradient(x, y), surface.gradient(x, y)];
                assert!((a[0] - b[0]).abs() < 1e-8 && (a[1] - b[1]).abs() < 1e-8);
            }
        }
    }
}

/// Height, slope and curvature at an end of the cell, by the cubic through four places within it at
/// distances `e`, `2 e`, `3 e` and `4 e` from that end, in units of `e`.
fn one_sided(h: impl Fn(f64) -> f64) -> [f64; 3] {
    let h = [1.0, 2.0, 3.0, 4.0].map(h);
    let sum = |weights: [f64; 4]| weights.iter().zip(h).map(|(w, h)| w * h).sum();
    [
        sum([4.0, -6.0, 4.0, -1.0]),
        sum([-13.0 / 3.0, 9.5, -7.0, 11.0 / 6.0]),
        sum([3.0, -8.0, 7.0, -2.0]),
    ]
}

/// On both sides of the edges between cells, and of the border if it is periodic. Each cell is a cubic, so
/// the one-sided values are exact; rounding of the heights, some 1e-15, enters up to 20 times.
#[test]
fn height_slope_and_curvature_are_continuous() {
    for border in BORDERS {
        let surface = SplineSurface::through(&jumble([7, 9], border));
        let ([cx, cy], [dx, dy], extent) = (surface.cells(), surface.spacing(), surface.extent());
        let along_x = |at: f64, y: f64| surface.height(at * dx, y);
        let along_y = |at: f64, x: f64| surface.height(x, at * dy);
        let check = |cells: usize, along: &dyn Fn(f64, f64) -> f64, across: f64| {
            for edge in 1..=cells {
                let behind = if edge < cells { edge } else { 0 } as f64;
                let before = one_sided(|e| along(edge as f64 - 0.25 * e, across));
                let behind = one_sided(|e| along(behind + 0.25 * e, across));
                // Slopes count away from the edge.
                let jumps = [
                    before[0] - behind[0],
                    before[1] + behind[1],
                    before[2] - behind[2],
                ];
                if edge < cells || border == Border::Periodic {
                    let smooth = jumps.iter().all(|jump| jump.abs() < 1e-13);
                    assert!(smooth, "{border}, edge {edge}: {jumps:?}");
                }
            }
        };
        for i in 0..20 {
            check(cx, &along_x, extent[1] * f64::from(i) / 20.0);
            check(cy, &along_y, extent[0] * f64::from(i) / 20.0);
        }
    }
}

#[test]
fn gradient_is_the_slope_of_the_heights() {
    let surface = SplineSurface::through(&jumble([7, 9], Border::Open));
    let ([cx, cy], [dx, dy]) = (surface.cells(), surface.spacing());
    for i in 0..cx * cy {
        let [ix, iy] = [(i % cx) as f64, (i / cx) as f64];
        let [gx, gy] = surface.gradient(ix * dx, iy * dy);
        let slope = one_sided(|e| surface.height((ix + 0.25 * e) * dx, iy * dy))[1];
        assert!((slope / (0.25 * dx) - gx).abs() < 1e-12, "{slope} {gx}");
        let slope = one_sided(|e| surface.height(ix * dx, (iy + 0.25 * e) * dy))[1];
        assert!((slope / (0.25 * dy) - gy).abs() < 1e-12, "{slope} {gy}");
    }
}

/// An open border keeps a plane. A mirrored one makes it level at the border, which is felt `i` samples
/// away by `(2 - sqrt 3)^i`, or 4e-12 at the middle of 40 cells.
#[test]
fn planes_stay_planes_but_near_a_mirrored_border() {
    let plane = |x: f64, y: f64| 0.3 * x - 0.7 * y + 2.0;
    let heights = (0..41 * 41)
        .map(|i| plane(f64::from(i % 41), f64::from(i / 41)))
        .collect();
    let field = HeightField::new(heights, [41, 41], [1.0, 1.0]).unwrap();
    let open = SplineSurface::through(&field.clone().with_border(Border::Open));
    let mirrored = SplineSurface::through(&field.with_border(Border::Mirrored));
    for i in 0..=80 {
        for j in 0..=80 {
            let [x, y] = [f64::from(i) / 2.0, f64::from(j) / 2.0];
            assert!((open.height(x, y) - plane(x, y)).abs() < 1e-13);
            let [gx, gy] = open.gradient(x, y);
            assert!((gx - 0.3).abs() < 1e-13 && (gy + 0.7).abs() < 1e-13);
        }
        let along = f64::from(i) / 2.0;
        for end in [0.0, 40.0] {
            assert!(mirrored.gradient(end, along)[0].abs() < 1e-13);
            assert!(mirrored.gradient(along, end)[1].abs() < 1e-13);
        }
    }
    assert!((mirrored.height(20.3, 19.7) - plane(20.3, 19.7)).abs() < 1e-10);
    let [gx, gy] = mirrored.gradient(20.3, 19.7);
    assert!((gx - 0.3).abs() < 1e-10 && (gy + 0.7).abs() < 1e-10);
}

#[test]
fn places_beyond_the_tile_have_the_height_of_the_nearest_within() {
    let surface = SplineSurface::through(&jumble([5, 8], Border::Open));
    let [x, y] = surface.extent();
    assert_eq!(surface.height(-1.0, 0.6), surface.height(0.0, 0.6));
    assert_eq!(surface.height(x + 9.0, y + 1e300), surface.height(x, y));
}

/// The extreme Bezier points of a wave that is highest and lowest at a third of a cell are `(k d)^2 / 18`
/// beyond it, to corrections of `(k d)^2`.
#[test]
fn range_holds_all_heights_and_is_close_to_them() {
    for border in BORDERS {
        let surface = SplineSurface::through(&jumble([6, 9], border));
        let [low, high] = surface.range();
        let fine = surface.tessellated(16).unwrap();
        assert!(fine.heights().iter().all(|h| (low..=high).contains(h)));
        let largest = |values: &[f64]| values.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        // Tighter than the coefficients
        assert!(high < largest(surface.coefficients()) - 0.1);
    }
    let k = TAU / 32.0;
    let wave = (0..4 * 32).map(|i| (k * (f64::from(i % 32) - 1.0 / 3.0)).sin());
    let wave = HeightField::new(wave.collect(), [4, 32], [1.0, 1.0]).unwrap();
    let [low, high] = SplineSurface::through(&wave).range();
    for excess in [high - 1.0, -1.0 - low] {
        assert!((excess / (k * k / 18.0) - 1.0).abs() < k * k, "{excess}");
    }
    // Of a level surface only rounding is left.
    let level = HeightField::new(vec![0.1; 12], [3, 4], [1.0, 1.0]).unwrap();
    let level = SplineSurface::through(&level);
    let [low, high] = level.range();
    assert!(high - low < 3e-15, "{low} {high}");
    let mut places = (0..400).map(|i| level.height(f64::from(i) / 100.0, f64::from(i % 7) / 3.0));
    assert!(places.all(|h| (low..=high).contains(&h)));
}

/// Midpoints of a fine grid integrate the cubic pieces to second order.
#[test]
fn mean_is_that_of_the_heights_over_the_tile() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let spline = SplineSurface::through(&jumble([7, 9], border));
        let [width, height] = spline.extent();
        let n = 400;
        let mean_of = |n: usize| {
            let at = |k: usize, size: f64| (k as f64 + 0.5) / n as f64 * size;
            let places = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let sum: f64 = places
                .map(|(i, j)| spline.height(at(i, width), at(j, height)))
                .sum();
            sum / (n * n) as f64
        };
        // Richardson's value of second order
        let expected = (4.0 * mean_of(n) - mean_of(n / 2)) / 3.0;
        assert!((spline.mean() - expected).abs() < 1e-6, "{border}");
    }
}

#[test]
fn tessellation_has_the_heights_of_the_surface() {
    for border in BORDERS {
        let field = jumble([5, 8], border);
        let surface = SplineSurface::through(&field);
        let fine = surface.tessellated(3).unwrap();
        assert_eq!(fine.cells(), field.cells().map(|cells| 3 * cells));
        assert_eq!((fine.unit(), fine.border()), (field.unit(), border));
        let [dx, dy] = fine.spacing();
        for iy in 0..fine.ny() {
            for ix in 0..fine.nx() {
                let expected = surface.height(ix as f64 * dx, iy as f64 * dy);
                assert!((fine.height(ix, iy) - expected).abs() < 1e-14);
            }
        }
        let samples = surface.samples();
        assert_eq!(
            (samples.shape(), samples.spacing()),
            (field.shape(), field.spacing())
        );
        for (found, expected) in samples.heights().iter().zip(field.heights()) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert!(surface.tessellated(0).is_err());
        assert!(matches!(
            surface.tessellated(usize::MAX),
            Err(HeightFieldError::TooLarge { .. })
        ));
    }
}

/// In the middle of the edges of facets, where the wave is extreme, a facet is off by `ex^2 |h_xx| / 8`. The
/// curvature of the spline is that of the wave to `(k d)^2 / 12`, or 0.3 %. Half an edge from its extreme place, where the
/// middle of an edge may be, the wave is lower by `(k d)^2 / 8`, or 0.5 %.
#[test]
fn facets_of_a_tessellation_deviate_by_the_documented_bound() {
    let k = TAU / 32.0;
    let heights = (0..4 * 32).map(|i| (k * f64::from(i % 32)).sin()).collect();
    let field = HeightField::new(heights, [4, 32], [1.0, 1.0]).unwrap();
    let surface = SplineSurface::through(&field);
    for per_cell in [1, 2, 4] {
        let fine = surface.tessellated(per_cell).unwrap();
        let e = fine.spacing()[0];
        let off = |ix: usize| {
            let middle = 0.5 * (fine.height(ix, 0) + fine.height(ix + 1, 0));
            (surface.height((ix as f64 + 0.5) * e, 0.0) - middle).abs()
        };
        let largest = (0..fine.nx()).map(off).fold(0.0, f64::max);
        let bound = e * e * k * k / 8.0;
        assert!(
            (0.98..1.0033).contains(&(largest / bound)),
            "{largest} {bound}"
        );
        let stated = surface.deviation(per_cell);
        assert!(
            (0.99..=1.0).contains(&(largest / stated)),
            "{largest} {stated}"
        );
    }
}

/// Places within all facets, among them the middles of edges; heights without order bend and twist by turns.
#[test]
fn no_place_of_a_tessellation_is_farther_off_than_its_deviation() {
    const WEIGHTS: [[f64; 3]; 5] = [
        [0.5, 0.5, 0.0],
        [0.5, 0.0, 0.5],
        [0.0, 0.5, 0.5],
        [0.4, 0.3, 0.3],
        [0.1, 0.6, 0.3],
    ];
    for border in BORDERS {
        for shape in [[2, 2], [5, 8]] {
            let surface = SplineSurface::through(&jumble(shape, border));
            for per_cell in [1, 2, 5] {
                let fine = surface.tessellated(per_cell).unwrap();
                let [dx, dy] = fine.spacing();
                let [cx, cy] = fine.cells();
                let mut largest = 0.0_f64;
                for (ix, iy) in (0..cy).flat_map(|iy| (0..cx).map(move |ix| (ix, iy))) {
                    for corners in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
                        for weights in WEIGHTS {
                            let mean = |of: &dyn Fn(usize, usize) -> f64| -> f64 {
                                let corners = corners.iter().zip(weights);
                                corners.map(|((i, j), w)| w * of(ix + i, iy + j)).sum()
                            };
                            let (x, y) = (mean(&|i, _| i as f64 * dx), mean(&|_, j| j as f64 * dy));
                            let flat = mean(&|i, j| fine.height(i, j));
                            largest = largest.max((surface.height(x, y) - flat).abs());
                        }
                    }
                }
                let stated = surface.deviation(per_cell);
                assert!(largest <= stated, "{border} {per_cell}: {largest} {stated}");
            }
        }
    }
}

/// A saddle `h = x y` is off by a quarter of a cell's area in the middle of the diagonals of facets, all its twist.
#[test]
fn deviation_counts_twist() {
    let heights = (0..36)
        .map(|i| f64::from(i % 6) * f64::from(i / 6))
        .collect();
    let field = HeightField::new(heights, [6, 6], [0.5, 2.0]).unwrap();
    let surface = SplineSurface::through(&field.with_border(Border::Open));
    for per_cell in [1, 3] {
        let expected = 0.25 / (per_cell * per_cell) as f64;
        assert!((surface.deviation(per_cell) / expected - 1.0).abs() < 1e-10);
    }
}

#[test]
fn as_many_parts_as_a_deviation_takes_and_no_more() {
    let surface = SplineSurface::through(&jumble([5, 8], Border::Mirrored));
    let of_cells = surface.deviation(1);
    for fraction in [2.0, 1.0, 0.5, 0.25, 1e-3, 1e-9] {
        let most = fraction * of_cells;
        let per_cell = surface.per_cell_within(most).unwrap();
        assert!(surface.deviation(per_cell) <= most, "{fraction}");
        assert!(
            per_cell == 1 || surface.deviation(per_cell - 1) > most,
            "{fraction}"
        );
    }
    assert_eq!(surface.per_cell_within(1e-16), None);
    let level = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).unwrap();
    assert_eq!(
        SplineSurface::through(&level).per_cell_within(1e-300),
        Some(1)
    );
}
