//! Wide search: many rays through the pyramid at a time, one ray per lane: `scalar.rs` with selections for branches.
//!
//! Every lane does its own steps: down a level where its ray may come under the bound of its node, on
//! to the next node where it cannot, up a level where it passes from one parent to the next. Lanes
//! whose rays have ended get new ones. In f32, with bounds on what rounding may do: a ray that comes
//! nearer to a decision than that is left to `quadtree.rs`, which this search is to agree with.

use super::bounds::{Bounds, MAX_LEVELS};
use super::rays::{Answers, Code, ROUNDING, Rays};
use crate::vector::lanes::{Floats, Integers, Lanes, Mask, Task};

/// Steps from node to node per test of cells: rays take some nine of those and three of these.
const STEPS: usize = 3;

/// The search of all rays, for any lanes.
pub(super) struct SearchAll<'a> {
    pub(super) bounds: &'a Bounds,
    pub(super) rays: &'a mut Rays,
}

impl Task for SearchAll<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        Search::new(lanes, self.bounds).run(self.rays);
    }
}

/// What is the same for all rays.
struct Search<'b, L: Lanes> {
    lanes: L,
    bounds: &'b Bounds,
    /// First node and row length by level, as tables of sixteen.
    first: [i32; 16],
    width: [i32; 16],
}

/// The rays that are in the lanes.
#[derive(Clone, Copy)]
struct State<L: Lanes> {
    /// See [`Rays`] for these.
    x: L::F,
    y: L::F,
    z: L::F,
    dx: L::F,
    dy: L::F,
    dz: L::F,
    inverse_dx: L::F,
    inverse_dy: L::F,
    side: L::F,
    /// 1 if x (y) grows along the ray, otherwise 0.
    ahead_x: L::I,
    ahead_y: L::I,
    /// Where it passes the corner's column and row: `-x / dx` and `-y / dy`.
    corner_x: L::F,
    corner_y: L::F,
    /// `1 / |dx|`, `1 / |dy|`, and their sum.
    slow_x: L::F,
    slow_y: L::F,
    slow: L::F,
    /// How far, in columns, rounding may move it per unit of `t`.
    drift: L::F,
    /// By how many bits the bound of its half space is shifted in a word.
    half: L::I,
    first_x: L::I,
    first_y: L::I,
    place: L::I,
    /// What is known of it: the column of the cell that it meets, or a negative word.
    answer: L::I,
    /// Which facet of the cell.
    code: L::I,
    /// How far the ray has come.
    t: L::F,
    /// The cell that it is in there.
    ix: L::I,
    iy: L::I,
    /// The level at which it is searched; 0 is the cell itself.
    level: L::I,
    /// Whether the ray continues.
    active: L::M,
    /// Whether there is a ray, or the answer to one.
    occupied: L::M,
}

impl<L: Lanes> State<L> {
    /// How fast the heights of the rays above planes of slopes `a` and `b` grow.
    #[inline(always)]
    fn rate(&self, a: L::F, b: L::F) -> L::F {
        self.dz.minus_times(a, self.dx).minus_times(b, self.dy)
    }
}

/// Where rays leave the nodes that they are in.
struct Exit<L: Lanes> {
    t: L::F,
    /// Whether through the edge across x.
    across_x: L::M,
    /// The edges ahead, in cells of the tile.
    edge_x: L::I,
    edge_y: L::I,
    /// How far, in columns, rounding may have moved the point.
    rounding: L::F,
    /// The same in `t`: more than that where a steep ray leaves through an edge that it runs along.
    late: L::F,
    /// Whether rounding decides which of the edges across x and y comes first.
    tied: L::M,
}

impl<'b, L: Lanes> Search<'b, L> {
    #[inline(always)]
    fn new(lanes: L, bounds: &'b Bounds) -> Self {
        let mut tables = [[0; 16]; 2];
        tables[0][..=MAX_LEVELS].copy_from_slice(&bounds.first);
        tables[1][..=MAX_LEVELS].copy_from_slice(&bounds.width);
        Self {
            lanes,
            bounds,
            first: tables[0],
            width: tables[1],
        }
    }

    #[inline(always)]
    fn run(&self, rays: &mut Rays) {
        let empty = self.empty();
        let (mut a, mut b) = (empty, empty);
        let mut next = 0;
        // Two loads of lanes in turn: while one waits for memory, the other is processed.
        loop {
            let more_a = self.keep_busy(&mut a, rays, &mut next);
            let more_b = self.keep_busy(&mut b, rays, &mut next);
            if !(more_a || more_b) {
                break;
            }
            for _ in 0..STEPS {
                self.step(&mut a);
                self.step(&mut b);
            }
            self.test_cells(&mut a);
            self.test_cells(&mut b);
        }
    }

    /// Lanes without rays.
    #[inline(always)]
    fn empty(&self) -> State<L> {
        let lanes = self.lanes;
        let zero = lanes.splat(0.0);
        let none = lanes.splat_i(0);
        State {
            x: zero,
            y: zero,
            z: zero,
            dx: zero,
            dy: zero,
            dz: zero,
            inverse_dx: zero,
            inverse_dy: zero,
            side: zero,
            ahead_x: none,
            ahead_y: none,
            corner_x: zero,
            corner_y: zero,
            slow_x: zero,
            slow_y: zero,
            slow: zero,
            drift: zero,
            half: none,
            first_x: none,
            first_y: none,
            place: none,
            answer: none,
            code: none,
            t: zero,
            ix: none,
            iy: none,
            level: none,
            active: lanes.mask(0),
            occupied: lanes.mask(0),
        }
    }

    /// Takes the answers out of idle lanes once there are some, and puts the next rays into them;
    /// false if no lane has a ray any more.
    #[inline(always)]
    fn keep_busy(&self, state: &mut State<L>, rays: &mut Rays, next: &mut usize) -> bool {
        let all = ((1_u64 << L::COUNT) - 1) as u32;
        let idle = all & !state.active.bits();
        let left = rays.len() - *next;
        if idle.count_ones() as usize * 8 >= L::COUNT && (left > 0 || idle == all) {
            self.note_answers(state, &mut rays.answers);
            if left == 0 {
                return false;
            }
            self.refill(state, rays, idle, next);
        }
        true
    }

    /// Puts the next rays into idle lanes.
    #[inline(always)]
    fn refill(&self, state: &mut State<L>, rays: &Rays, idle: u32, next: &mut usize) {
        let lanes = self.lanes;
        // Where fewer rays are left than lanes are idle, the first lanes get them.
        let mut filled = idle;
        while filled.count_ones() as usize > rays.len() - *next {
            filled &= !(1 << filled.ilog2());
        }
        let mask = lanes.mask(filled);
        let from = *next;
        macro_rules! load {
            ($field:ident) => {
                state.$field = lanes.refill(mask, &rays.$field[from..], state.$field)
            };
        }
        load!(x);
        load!(y);
        load!(z);
        load!(dx);
        load!(dy);
        load!(dz);
        load!(inverse_dx);
        load!(inverse_dy);
        load!(side);
        let zero = lanes.splat(0.0);
        let below = lanes.less(state.side, zero);
        state.half = lanes.select_i(below, lanes.splat_i(16), lanes.splat_i(0));
        let (none, one) = (lanes.splat_i(0), lanes.splat_i(1));
        state.ahead_x = lanes.select_i(lanes.less(state.dx, zero), none, one);
        state.ahead_y = lanes.select_i(lanes.less(state.dy, zero), none, one);
        state.corner_x = zero - state.x * state.inverse_dx;
        state.corner_y = zero - state.y * state.inverse_dy;
        (state.slow_x, state.slow_y) = (state.inverse_dx.abs(), state.inverse_dy.abs());
        state.slow = state.slow_x + state.slow_y;
        state.drift = lanes.splat(ROUNDING) * (state.dx.abs() + state.dy.abs());
        state.first_x = lanes.refill_i(mask, &rays.cell_x[from..], state.first_x);
        state.first_y = lanes.refill_i(mask, &rays.cell_y[from..], state.first_y);
        state.place = lanes.refill_i(mask, &rays.place[from..], state.place);
        state.answer = lanes.select_i(mask, lanes.splat_i(Code::DOUBTFUL_WORD), state.answer);
        state.t = lanes.select(mask, zero, state.t);
        state.ix = lanes.select_i(mask, state.first_x, state.ix);
        state.iy = lanes.select_i(mask, state.first_y, state.iy);
        // A ray from the highest point is far from everything, one from a facet is not.
        let high = lanes.less(lanes.splat(0.999 * self.bounds.reach), state.z);
        let first = Bounds::FIRST_LEVEL.min(self.bounds.top as i32);
        let level = lanes.select_i(high, lanes.splat_i(first), none);
        state.level = lanes.select_i(mask, level, state.level);
        state.active = state.active | mask;
        state.occupied = state.active;
        *next += filled.count_ones() as usize;
    }

    /// Where the rays leave the nodes of their levels.
    #[inline(always)]
    fn exit(&self, state: &State<L>, level: L::I) -> Exit<L> {
        let lanes = self.lanes;
        let edge_x = (state.ix.shifted_right(level) + state.ahead_x).shifted_left(level);
        let edge_y = (state.iy.shifted_right(level) + state.ahead_y).shifted_left(level);
        let t_x = lanes
            .to_float(edge_x - state.first_x)
            .times_plus(state.inverse_dx, state.corner_x);
        let t_y = lanes
            .to_float(edge_y - state.first_y)
            .times_plus(state.inverse_dy, state.corner_y);
        let t = t_x.min(t_y);
        let rounding = t.times_plus(state.drift, lanes.splat(ROUNDING));
        let across_x = lanes.less(t_x, t_y);
        Exit {
            t,
            across_x,
            late: rounding * lanes.select(across_x, state.slow_x, state.slow_y),
            tied: lanes.less((t_x - t_y).abs(), rounding * state.slow),
            edge_x,
            edge_y,
            rounding,
        }
    }

    /// Which rays are tested against a cell.
    #[inline(always)]
    fn at_cell(&self, state: &State<L>) -> L::M {
        self.lanes.equal_i(state.level, self.lanes.splat_i(0))
    }

    /// Which rays rise.
    #[inline(always)]
    fn rising(&self, state: &State<L>) -> L::M {
        self.lanes.less(self.lanes.splat(0.0), state.dz)
    }

    /// Tests nodes above the cells: goes down a level, or on to the next node.
    #[inline(always)]
    fn step(&self, state: &mut State<L>) {
        let lanes = self.lanes;
        let above_cells = state.active & !self.at_cell(state);
        let exit = self.exit(state, state.level);
        let node = lanes.lookup(&self.first, state.level)
            + lanes
                .lookup(&self.width, state.level)
                .times(state.iy.shifted_right(state.level))
            + state.ix.shifted_right(state.level);
        let word = lanes.gather_i(&self.bounds.nodes, node);
        let steps = word.shifted_right(state.half).and(lanes.splat_i(0xffff));
        let bound = lanes.to_float(steps).times_plus(
            lanes.splat(self.bounds.step),
            lanes.splat(self.bounds.lowest),
        );
        // A rising ray is lowest where it enters, a falling one where it leaves. The bound holds all
        // over the node, so that places within it need no margin; `advance` doubts the nodes themselves.
        let early = exit.t - exit.late;
        let at = lanes.select(self.rising(state), state.t.min(early), exit.t + exit.late);
        let lowest = at.times_plus(state.dz, state.z);
        let clear = lanes.less(bound, lowest);
        let down = above_cells & !clear;
        state.level = lanes.select_i(down, state.level - lanes.splat_i(1), state.level);
        self.advance(state, above_cells & clear, &exit);
    }

    /// Steps to the next nodes; ends the rays that leave the tile or have risen above it.
    #[inline(always)]
    fn advance(&self, state: &mut State<L>, moving: L::M, exit: &Exit<L>) {
        let lanes = self.lanes;
        let one = lanes.splat_i(1);
        let x = exit.t.times_plus(state.dx, state.x);
        let y = exit.t.times_plus(state.dy, state.y);
        // The coordinate along the edge says which cell comes next.
        let along = lanes.select(exit.across_x, y, x);
        let whole = along.floor();
        let within = along - whole;
        let unsure = exit.tied | lanes.less(within.min(lanes.splat(1.0) - within), exit.rounding);
        let cell = lanes.to_integer(whole);
        let ix = lanes.select_i(
            exit.across_x,
            exit.edge_x + state.ahead_x - one,
            cell + state.first_x,
        );
        let iy = lanes.select_i(
            exit.across_x,
            cell + state.first_y,
            exit.edge_y + state.ahead_y - one,
        );
        // Up a level where the edge is also that of the parent.
        let edge = lanes.select_i(exit.across_x, exit.edge_x, exit.edge_y);
        let odd = edge.shifted_right(state.level).and(one);
        let upper = lanes.less_i(state.level, lanes.splat_i(self.bounds.top as i32));
        let up = lanes.equal_i(odd, lanes.splat_i(0)) & upper & moving;
        state.level = lanes.select_i(up, state.level + one, state.level);
        state.t = lanes.select(moving, exit.t, state.t);
        state.ix = lanes.select_i(moving, ix, state.ix);
        state.iy = lanes.select_i(moving, iy, state.iy);

        let [cx, cy] = self.bounds.cells.map(|n| n as i32);
        let inside = lanes.within(ix, cx) & lanes.within(iy, cy);
        let top = lanes.splat(self.bounds.reach + self.bounds.margin);
        let risen = self.rising(state)
            & lanes.less(top, (exit.t - exit.late).times_plus(state.dz, state.z));
        let left = moving & (risen | !(unsure | inside));
        let doubtful = moving & unsure & !left;
        state.answer = lanes.select_i(left, lanes.splat_i(Code::NOTHING_WORD), state.answer);
        state.active = state.active & !(left | doubtful);
    }

    /// Tests the facets of cells: a hit, an unsure one, or a step to the next cell.
    #[inline(always)]
    fn test_cells(&self, state: &mut State<L>) {
        let lanes = self.lanes;
        let at_cell = state.active & self.at_cell(state);
        let exit = self.exit(state, lanes.splat_i(0));
        let stride = self.bounds.cells[0] as i32 + 1;
        let corner = state.iy.times(lanes.splat_i(stride)) + state.ix;
        let heights = &self.bounds.heights;
        let [h00, h10] = lanes.gather_pair(heights, corner);
        let [h01, h11] = lanes.gather_pair(heights, corner + lanes.splat_i(stride));
        let (h00, h10) = (h00 * state.side, h10 * state.side);
        let (h01, h11) = (h01 * state.side, h11 * state.side);
        // Place within the cell at t = 0, and which triangle the ray is over.
        let u = state.x - lanes.to_float(state.ix - state.first_x);
        let v = state.y - lanes.to_float(state.iy - state.first_y);
        let (w, dw) = (u - v, state.dx - state.dy);
        let zero = lanes.splat(0.0);
        let (w_in, w_out) = (state.t.times_plus(dw, w), exit.t.times_plus(dw, w));
        let lower_in = lanes.less(zero, w_in);
        let lower_out = lanes.less(zero, w_out);
        let crosses = lower_in ^ lower_out;
        let (lower_a, lower_b, upper_a, upper_b) = (h10 - h00, h11 - h10, h11 - h01, h01 - h00);
        let a_in = lanes.select(lower_in, lower_a, upper_a);
        let b_in = lanes.select(lower_in, lower_b, upper_b);
        let a_out = lanes.select(lower_out, lower_a, upper_a);
        let b_out = lanes.select(lower_out, lower_b, upper_b);
        // Heights above the triangles on entry, on the diagonal, and on leaving.
        let over = state.z - h00;
        let (rate_in, rate_out) = (state.rate(a_in, b_in), state.rate(a_out, b_out));
        let (first_in, first_out) = (
            over.minus_times(a_in, u).minus_times(b_in, v),
            over.minus_times(a_out, u).minus_times(b_out, v),
        );
        let across = lanes.splat(-1.0).over(dw);
        let t_diagonal = lanes.select(crosses, w * across, exit.t);
        let on_entry = state.t.times_plus(rate_in, first_in);
        let on_diagonal = t_diagonal.times_plus(rate_in, first_in);
        let on_leaving = exit.t.times_plus(rate_out, first_out);
        // What rounding may do to them: that of z, that of x and y times the slopes of two facets,
        // and, on the diagonal and on leaving, that of t times the rate.
        let slopes = lanes.splat(4.0 * self.bounds.steepest);
        let margin = exit
            .rounding
            .times_plus(slopes, lanes.splat(self.bounds.margin));
        let late = (exit.rounding * across).abs();
        let late = lanes.select(crosses, late + late, exit.late);
        let on_diagonal_margin = late.times_plus(rate_in.abs(), margin);

        let right_side = lanes.less(zero, on_entry + margin);
        let (under_diagonal, over_diagonal) = (
            lanes.less(on_diagonal + on_diagonal_margin, zero),
            lanes.less(on_diagonal_margin, on_diagonal),
        );
        let on_leaving_margin = exit.late.times_plus(rate_out.abs(), margin);
        let (under_leaving, over_leaving) = (
            lanes.less(on_leaving + on_leaving_margin, zero),
            lanes.less(on_leaving_margin, on_leaving),
        );
        let edge = exit.rounding + exit.rounding;
        let on_edge = lanes.less(w_in.abs().min(w_out.abs()), edge);
        let sure = right_side & !on_edge & !exit.tied & at_cell;
        let met = sure & (under_diagonal | (over_diagonal & under_leaving));
        let clear = sure & over_diagonal & over_leaving;
        state.answer = lanes.select_i(met, state.ix, state.answer);
        // Which facet, where it is met farther from its edges than rounding can move it.
        let clear_entry = lanes.less(margin, on_entry);
        let lower = (under_diagonal & lower_in) | (over_diagonal & lower_out);
        let code = lanes.select_i(
            lower,
            lanes.splat_i(Code::Lower as i32),
            lanes.splat_i(Code::Upper as i32),
        );
        let code = lanes.select_i(clear_entry, code, lanes.splat_i(Code::Either as i32));
        state.code = lanes.select_i(met, code, state.code);
        let doubtful = at_cell & !(met | clear);
        state.active = state.active & !(met | doubtful);
        self.advance(state, clear, &exit);
    }

    /// Writes down the answers of the rays that have ended.
    #[inline(always)]
    fn note_answers(&self, state: &mut State<L>, answers: &mut Answers) {
        let lanes = self.lanes;
        let ended = state.occupied & !state.active;
        let [places, columns, rows] = answers.next(ended.bits().count_ones() as usize);
        let row = state.iy.shifted_left(lanes.splat_i(2)) + state.code;
        lanes.store_some(ended, state.place, places);
        lanes.store_some(ended, state.answer, columns);
        lanes.store_some(ended, row, rows);
        state.occupied = state.active;
    }
}
