//! Spline cells: cells of a smooth surface, tested by the Bernstein coefficients of a ray's height above the patch.
//!
//! Along a ray these are weighted means of the sixteen coefficients, so rounding is that of the coefficients: over the six mixtures,
//! the products and the ray's own height some 62 roundings of 2^-24 of the largest one, which 2^-18 covers; a hundredth of the
//! margin is the most seen (`margin_tests.rs`). A ray is clear
//! of the patch if all are positive, and passes it if they change sign once; one that begins on the surface has its
//! first coefficient there, which is left out.

use super::bounds::{Bounds, Table};
use super::cells::{Exit, SearchedGrid, Test, least};
#[cfg(target_arch = "x86_64")]
use super::lane_state::{CellsMet, LanesExit, State};
use super::rays::Ray;
use crate::geometry::grid::Grid;
use crate::geometry::smooth::SmoothSurface;
#[cfg(target_arch = "x86_64")]
use crate::vector::lanes::{Floats, Integers, Lanes};

impl SearchedGrid for SmoothSurface {
    const LOWEST_LEVEL: usize = 0;

    fn diagonals(&self) -> [bool; 2] {
        [false; 2]
    }

    /// The coefficients.
    fn table(&self) -> Table {
        Table {
            values: self.coefficients().map(|z| z as f32).collect(),
            stride: self.spline().stride(),
            rows: 4,
            rounding: 2_f32.powi(-18),
            turned: Vec::new(),
        }
    }

    fn bound_lowest(&self, bounds: &mut Bounds) {
        bounds.bound_cells(|iy, ranges| self.row_ranges(iy, ranges));
    }

    fn test(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> Test {
        let gaps = gaps(bounds, ray, cell, t, exit);
        let margin = exit.margin;
        if gaps[0] + margin <= 0.0 {
            return Test::Unknown;
        }
        let lowest = gaps[2..]
            .iter()
            .fold(gaps[1], |lowest, gap| least(lowest, *gap));
        let changes_once = gaps[6] + margin < 0.0
            && (1..6).all(|k| gaps[k] > margin || gaps[k + 1] + margin < 0.0);
        if changes_once {
            Test::Met
        } else if lowest > margin {
            Test::Clear(lowest - margin)
        } else {
            Test::Unknown
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn test_lanes<L: Lanes>(
        lanes: L,
        bounds: &Bounds,
        state: &State<L>,
        exit: &LanesExit<L>,
    ) -> CellsMet<L> {
        let (zero, none, margin) = (lanes.splat(0.0), lanes.splat_i(0), exit.margin);
        let stride = bounds.table.stride as i32;
        let cell = state.iy.times(lanes.splat_i(stride)) + state.ix;
        // Lanes that are not at cells touch no memory of their own.
        let at_cell = lanes.equal_i(state.level, none);
        let first = lanes.select_i(at_cell, cell, none);
        let u = state.x - lanes.to_float(state.ix - state.first_x);
        let v = state.y - lanes.to_float(state.iy - state.first_y);
        let (t, t_out) = (state.t, exit.t);
        let along_x = LaneWeights::new(
            lanes,
            t.times_plus(state.dx, u),
            t_out.times_plus(state.dx, u),
        );
        let along_y = LaneWeights::new(
            lanes,
            t.times_plus(state.dy, v),
            t_out.times_plus(state.dy, v),
        );
        // Without closures, which would not be compiled for the instructions of the lanes
        let values = &bounds.table.values;
        let [r0, r1, r2, r3] = [
            along_x.between(lanes.gather_four(values, first)),
            along_x.between(lanes.gather_four(values, first + lanes.splat_i(stride))),
            along_x.between(lanes.gather_four(values, first + lanes.splat_i(2 * stride))),
            along_x.between(lanes.gather_four(values, first + lanes.splat_i(3 * stride))),
        ];
        let columns = [
            along_y.between([r0[0], r1[0], r2[0], r3[0]]),
            along_y.between([r0[1], r1[1], r2[1], r3[1]]),
            along_y.between([r0[2], r1[2], r2[2], r3[2]]),
            along_y.between([r0[3], r1[3], r2[3], r3[3]]),
        ];
        let heights = product(lanes, columns);
        let from = t.times_plus(state.dz, state.z);
        let sixth = lanes.splat(1.0 / 6.0) * (exit.z - from);
        let mut gaps = [from; 7];
        let mut above = [at_cell; 7];
        let mut below = [at_cell; 7];
        for k in 0..7 {
            let z = lanes.splat(k as f32).times_plus(sixth, from);
            gaps[k] = z.minus_times(heights[k], state.side);
            above[k] = lanes.less(margin, gaps[k]);
            below[k] = lanes.less(gaps[k] + margin, zero);
        }
        let comes = lanes.less(zero, gaps[0] + margin);
        let changes_once = below[6]
            & (above[1] | below[2])
            & (above[2] | below[3])
            & (above[3] | below[4])
            & (above[4] | below[5])
            & (above[5] | below[6]);
        let lowest = gaps[1]
            .min(gaps[2])
            .min(gaps[3].min(gaps[4]))
            .min(gaps[5].min(gaps[6]));
        CellsMet {
            met: comes & changes_once,
            gap: lanes.select(comes, lowest - margin, zero),
        }
    }
}

/// Bernstein coefficients of the height of a ray above a patch, from `t` to where it leaves the cell.
pub(super) fn gaps(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> [f32; 7] {
    let (u, v) = (
        ray.x - (cell[0] - ray.cell[0]) as f32,
        ray.y - (cell[1] - ray.cell[1]) as f32,
    );
    let along_x = Weights::new(u + t * ray.dx, u + exit.t * ray.dx);
    let along_y = Weights::new(v + t * ray.dy, v + exit.t * ray.dy);
    let Table { values, stride, .. } = &bounds.table;
    let first = cell[1] as usize * stride + cell[0] as usize;
    let rows = [0, 1, 2, 3].map(|row| {
        let start = first + row * stride;
        along_x.between([0, 1, 2, 3].map(|i| values[start + i] * ray.side))
    });
    let columns = [0, 1, 2, 3].map(|k| along_y.between(rows.map(|row| row[k])));
    let at = |k: usize, l: usize| columns[k][l];
    let heights = [
        at(0, 0),
        0.5 * (at(0, 1) + at(1, 0)),
        0.2 * (at(0, 2) + at(2, 0)) + 0.6 * at(1, 1),
        0.05 * (at(0, 3) + at(3, 0)) + 0.45 * (at(1, 2) + at(2, 1)),
        0.2 * (at(1, 3) + at(3, 1)) + 0.6 * at(2, 2),
        0.5 * (at(2, 3) + at(3, 2)),
        at(3, 3),
    ];
    let (from, to) = (ray.z + t * ray.dz, exit.z);
    let sixth = (to - from) * (1.0 / 6.0);
    std::array::from_fn(|k| from + k as f32 * sixth - heights[k])
}

/// Weights by which the B-spline coefficients along an axis are mixed into Bernstein coefficients from `a` to `b`: see
/// `geometry/smooth/patch.rs`.
struct Weights {
    thirds: [[f32; 3]; 2],
    halves: [[f32; 2]; 2],
    ends: [f32; 2],
}

impl Weights {
    fn new(a: f32, b: f32) -> Self {
        const THIRD: f32 = 1.0 / 3.0;
        Self {
            thirds: [a, b].map(|x| [(x + 2.0) * THIRD, (x + 1.0) * THIRD, x * THIRD]),
            halves: [a, b].map(|x| [0.5 * x + 0.5, 0.5 * x]),
            ends: [a, b],
        }
    }

    fn between(&self, c: [f32; 4]) -> [f32; 4] {
        let mix = |a: f32, b: f32, x: f32| a + x * (b - a);
        let thirds = |[low, middle, high]: [f32; 3]| {
            [
                mix(c[0], c[1], low),
                mix(c[1], c[2], middle),
                mix(c[2], c[3], high),
            ]
        };
        let halves =
            |of: [f32; 3], [low, high]: [f32; 2]| [mix(of[0], of[1], low), mix(of[1], of[2], high)];
        let ends = |of: [f32; 2], x: f32| mix(of[0], of[1], x);
        let [of_a, of_b] = self.thirds.map(thirds);
        let mixed = halves(of_a, self.halves[1]);
        [
            ends(halves(of_a, self.halves[0]), self.ends[0]),
            ends(mixed, self.ends[0]),
            ends(mixed, self.ends[1]),
            ends(halves(of_b, self.halves[1]), self.ends[1]),
        ]
    }
}

/// [`Weights`] in lanes.
#[cfg(target_arch = "x86_64")]
struct LaneWeights<F> {
    thirds: [[F; 3]; 2],
    halves: [[F; 2]; 2],
    ends: [F; 2],
}

#[cfg(target_arch = "x86_64")]
impl<F: Floats> LaneWeights<F> {
    #[inline(always)]
    fn new<L: Lanes<F = F>>(lanes: L, a: F, b: F) -> Self {
        let (half, third) = (lanes.splat(0.5), lanes.splat(1.0 / 3.0));
        let two_thirds = lanes.splat(2.0 / 3.0);
        Self {
            thirds: [
                [
                    a.times_plus(third, two_thirds),
                    a.times_plus(third, third),
                    a * third,
                ],
                [
                    b.times_plus(third, two_thirds),
                    b.times_plus(third, third),
                    b * third,
                ],
            ],
            halves: [
                [a.times_plus(half, half), a * half],
                [b.times_plus(half, half), b * half],
            ],
            ends: [a, b],
        }
    }

    #[inline(always)]
    fn between(&self, c: [F; 4]) -> [F; 4] {
        let [thirds_a, thirds_b] = self.thirds;
        let [halves_a, halves_b] = self.halves;
        let [a, b] = self.ends;
        let of_a = three(c, thirds_a);
        let of_b = three(c, thirds_b);
        let [low, high] = two(of_a, halves_a);
        let [low_mixed, high_mixed] = two(of_a, halves_b);
        let [low_b, high_b] = two(of_b, halves_b);
        [
            mixed(low, high, a),
            mixed(low_mixed, high_mixed, a),
            mixed(low_mixed, high_mixed, b),
            mixed(low_b, high_b, b),
        ]
    }
}

/// Bernstein coefficients of degree six, from those along x and y: see `geometry/smooth/patch.rs`.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn product<L: Lanes>(lanes: L, at: [[L::F; 4]; 4]) -> [L::F; 7] {
    let (half, fifth) = (lanes.splat(0.5), lanes.splat(0.2));
    let (most, little) = (lanes.splat(0.6), lanes.splat(0.05));
    let rest = lanes.splat(0.45);
    [
        at[0][0],
        half * (at[0][1] + at[1][0]),
        fifth.times_plus(at[0][2] + at[2][0], most * at[1][1]),
        little.times_plus(at[0][3] + at[3][0], rest * (at[1][2] + at[2][1])),
        fifth.times_plus(at[1][3] + at[3][1], most * at[2][2]),
        half * (at[2][3] + at[3][2]),
        at[3][3],
    ]
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn three<F: Floats>(c: [F; 4], [low, middle, high]: [F; 3]) -> [F; 3] {
    [
        mixed(c[0], c[1], low),
        mixed(c[1], c[2], middle),
        mixed(c[2], c[3], high),
    ]
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn two<F: Floats>([a, b, c]: [F; 3], [low, high]: [F; 2]) -> [F; 2] {
    [mixed(a, b, low), mixed(b, c, high)]
}

/// `a` where `x` is 0, `b` where it is 1.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn mixed<F: Floats>(a: F, b: F, x: F) -> F {
    x.times_plus(b - a, a)
}
