//! Wide search: many rays through the pyramid at a time, one ray per lane: `scalar.rs` with selections for branches.
//!
//! Every lane does its own steps: down a level where its ray may come under the bound of its node, on
//! to the next node where it cannot, up a level where it passes from one parent to the next. Lanes
//! whose rays have ended get new ones. In f32, with bounds on what rounding may do: a ray that comes
//! nearer to a decision than that is left to `quadtree.rs`, which this search is to agree with.

use std::marker::PhantomData;

use super::bounds::{Bounds, MAX_LEVELS};
use super::cells::SearchedGrid;
use super::lane_state::{LanesExit, State};
use super::rays::{Answers, DOUBTFUL, NOTHING, Rays};
use crate::vector::Stage;
use crate::vector::interleaved::Interleaved;
use crate::vector::lanes::{Floats, Integers, Lanes, Mask};

/// The search of all rays by `lanes`.
pub(super) struct SearchAll<'a, L, S> {
    pub(super) lanes: L,
    pub(super) bounds: &'a Bounds,
    pub(super) rays: &'a mut Rays,
    pub(super) cells: PhantomData<S>,
}

impl<L: Lanes, S: SearchedGrid> Stage for SearchAll<'_, L, S> {
    #[inline(always)]
    fn run(self) {
        let lanes = self.lanes;
        if S::LOWEST_LEVEL == 0 {
            // A test of twice as many lanes would not fit into registers
            Search::new(lanes, self.bounds).run::<S>(self.rays);
        } else {
            Search::new(Interleaved(lanes), self.bounds).run::<S>(self.rays);
        }
    }
}

/// Constants of a search, which are the same for all rays.
struct Search<'b, L: Lanes> {
    lanes: L,
    bounds: &'b Bounds,
    /// First node and row length by level, as tables of sixteen.
    first: [i32; 16],
    width: [i32; 16],
    zero: L::F,
    none: L::I,
    one: L::I,
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
            zero: lanes.splat(0.0),
            none: lanes.splat_i(0),
            one: lanes.splat_i(1),
        }
    }

    #[inline(always)]
    fn run<S: SearchedGrid>(&self, rays: &mut Rays) {
        let mut state = self.empty();
        let mut next = 0;
        while self.keep_busy(&mut state, rays, &mut next) {
            self.step::<S, false>(&mut state);
            if S::LOWEST_LEVEL == 0 {
                // Until most of the rays have to be tested
                let at_cells = state.active & self.at_cells::<S>(&state);
                let waiting = at_cells.bits().count_ones();
                if 8 * waiting < 5 * state.active.bits().count_ones() {
                    continue;
                }
            } else {
                // Rays take some nine steps between nodes and three through cells, which cost more.
                self.step::<S, false>(&mut state);
            }
            self.step::<S, true>(&mut state);
        }
    }

    /// Lanes without rays.
    #[inline(always)]
    fn empty(&self) -> State<L> {
        let (zero, none, nowhere) = (self.zero, self.none, self.lanes.mask(0));
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
            first_x: none,
            first_y: none,
            place: none,
            ahead_x: none,
            ahead_y: none,
            corner_x: zero,
            corner_y: zero,
            slack: zero,
            clearance_x: zero,
            clearance_y: zero,
            ceiling: zero,
            half: none,
            answer: none,
            t: zero,
            ix: none,
            iy: none,
            level: none,
            near: nowhere,
            active: nowhere,
            occupied: nowhere,
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
        state.first_x = lanes.refill_i(mask, &rays.cell_x[from..], state.first_x);
        state.first_y = lanes.refill_i(mask, &rays.cell_y[from..], state.first_y);
        state.place = lanes.refill_i(mask, &rays.place[from..], state.place);
        self.derive(state);
        state.answer = lanes.select_i(mask, lanes.splat_i(DOUBTFUL), state.answer);
        state.t = lanes.select(mask, self.zero, state.t);
        state.ix = lanes.select_i(mask, state.first_x, state.ix);
        state.iy = lanes.select_i(mask, state.first_y, state.iy);
        // A ray from the highest point is far from everything, one from a facet is not.
        let high = lanes.less(lanes.splat(0.999 * self.bounds.reach), state.z);
        let first = Bounds::FIRST_LEVEL.min(self.bounds.top as i32);
        let level = lanes.select_i(high, lanes.splat_i(first), self.none);
        state.level = lanes.select_i(mask, level, state.level);
        // A ray that begins on the surface is near to it.
        state.near = (state.near & !mask) | (mask & !high);
        state.active = state.active | mask;
        state.occupied = state.active;
        *next += filled.count_ones() as usize;
    }

    /// Computes the numbers that follow from the fields of rays.
    #[inline(always)]
    fn derive(&self, state: &mut State<L>) {
        let (lanes, bounds) = (self.lanes, self.bounds);
        let below = lanes.less(state.side, self.zero);
        state.half = lanes.select_i(below, lanes.splat_i(16), self.none);
        state.ahead_x = lanes.select_i(lanes.less(state.dx, self.zero), self.none, self.one);
        state.ahead_y = lanes.select_i(lanes.less(state.dy, self.zero), self.none, self.one);
        state.corner_x = self.zero - state.x * state.inverse_dx;
        state.corner_y = self.zero - state.y * state.inverse_dy;
        let travel = state.dx.abs() + state.dy.abs();
        state.slack = lanes.splat(bounds.slack) * travel;
        let falls = lanes
            .splat(bounds.steepest)
            .times_plus(travel, state.dz.abs());
        let late = lanes.splat(bounds.rounding_across()) * falls;
        state.clearance_x = late * state.inverse_dx.abs();
        state.clearance_y = late * state.inverse_dy.abs();
        let rises = lanes.less(self.zero, state.dz);
        let (top, never) = (bounds.reach + bounds.margin, f32::INFINITY);
        state.ceiling = lanes.select(rises, lanes.splat(top), lanes.splat(never));
    }

    /// Exits of rays from the nodes of their levels.
    #[inline(always)]
    fn exit(&self, state: &State<L>) -> LanesExit<L> {
        let (lanes, level) = (self.lanes, state.level);
        let node = [state.ix.shifted_right(level), state.iy.shifted_right(level)];
        let ahead = [node[0] + state.ahead_x, node[1] + state.ahead_y];
        let columns = lanes.to_float(ahead[0].shifted_left(level) - state.first_x);
        let rows = lanes.to_float(ahead[1].shifted_left(level) - state.first_y);
        let t_x = columns.times_plus(state.inverse_dx, state.corner_x);
        let t_y = rows.times_plus(state.inverse_dy, state.corner_y);
        let t = t_x.min(t_y);
        LanesExit {
            t,
            z: t.times_plus(state.dz, state.z),
            across_x: lanes.less(t_x, t_y),
            node,
            ahead,
            margin: t.times_plus(state.slack, lanes.splat(self.bounds.margin)),
        }
    }

    /// Heights of rays above the bounds of their nodes. Lanes at cells get anything.
    #[inline(always)]
    fn gap_over_nodes(&self, state: &State<L>, exit: &LanesExit<L>) -> L::F {
        let (lanes, bounds, level) = (self.lanes, self.bounds, state.level);
        let [column, row] = exit.node;
        let first = lanes.lookup(&self.first, level);
        let width = lanes.lookup(&self.width, level);
        let word = lanes.gather_i(&bounds.nodes, first + width.times(row) + column);
        let steps = word.shifted_right(state.half).and(lanes.splat_i(0xffff));
        let (step, lowest) = (lanes.splat(bounds.step), lanes.splat(bounds.lowest));
        let bound = lanes.to_float(steps).times_plus(step, lowest);
        let lowest = state.t.times_plus(state.dz, state.z).min(exit.z);
        lowest - exit.margin - bound
    }

    /// A step of all rays: down a level, or on to the next node; if `CELLS`, also of those that are at
    /// cells, which end there or step to the next cell.
    #[inline(always)]
    fn step<S: SearchedGrid, const CELLS: bool>(&self, state: &mut State<L>) {
        let lanes = self.lanes;
        let at_cell = self.at_cells::<S>(state);
        let exit = self.exit(state);
        let over_nodes = self.gap_over_nodes(state, &exit);
        let clear_of_nodes = lanes.less(self.zero, over_nodes);
        let above_cells = state.active & !at_cell;
        let down = above_cells & !clear_of_nodes;
        let lower = if S::LOWEST_LEVEL == 0 {
            let lowest = lanes.equal_i(state.level, self.none);
            state.near = state.near | (down & lowest);
            down & !lowest
        } else {
            down
        };
        state.level = lanes.select_i(lower, state.level - self.one, state.level);
        let (moving, gap, waiting);
        if CELLS {
            let cells = S::test_lanes(self.lanes, self.bounds, state, &exit);
            let met = state.active & at_cell & cells.met;
            state.answer = lanes.select_i(met, state.ix, state.answer);
            gap = lanes.select(at_cell, cells.gap, over_nodes);
            moving = state.active & !met & lanes.less(self.zero, gap);
            waiting = down;
        } else {
            gap = over_nodes;
            moving = above_cells & clear_of_nodes;
            waiting = down | (state.active & at_cell);
        }
        let on = self.move_on(state, moving, gap, &exit);
        state.near = state.near & !moving;
        state.active = waiting | on;
    }

    /// Which lanes are at cells that have to be tested.
    #[inline(always)]
    fn at_cells<S: SearchedGrid>(&self, state: &State<L>) -> L::M {
        if S::LOWEST_LEVEL == 0 {
            state.near
        } else {
            self.lanes.equal_i(state.level, self.none)
        }
    }

    /// Moves rays on to the next nodes, and says which of them continue there: not those that have left
    /// the tile, or have risen above it, or do not get any farther.
    #[inline(always)]
    fn move_on(&self, state: &mut State<L>, moving: L::M, gap: L::F, exit: &LanesExit<L>) -> L::M {
        let (lanes, one, level) = (self.lanes, self.one, state.level);
        // The coordinate along the edge says which cell comes next.
        let across_x = exit.across_x;
        let rate = lanes.select(across_x, state.dy, state.dx);
        let start = lanes.select(across_x, state.y, state.x);
        let along = exit.t.times_plus(rate, start).floor();
        let whole = lanes.to_integer(along);
        let behind_x = exit.ahead[0].shifted_left(level) + state.ahead_x - one;
        let behind_y = exit.ahead[1].shifted_left(level) + state.ahead_y - one;
        let ix = lanes.select_i(across_x, behind_x, whole + state.first_x);
        let iy = lanes.select_i(across_x, whole + state.first_y, behind_y);
        // Up a level where the edge is also that of the parent.
        let edge = lanes.select_i(across_x, exit.ahead[0], exit.ahead[1]);
        let even = lanes.equal_i(edge.and(one), self.none);
        let upper = lanes.less_i(level, lanes.splat_i(self.bounds.top as i32));
        state.level = lanes.select_i(even & upper & moving, level + one, level);
        let backward = lanes.less(along * rate, self.zero);
        let forward = moving & lanes.less(state.t, exit.t) & !backward;
        state.t = lanes.select(moving, exit.t, state.t);
        state.ix = lanes.select_i(moving, ix, state.ix);
        state.iy = lanes.select_i(moving, iy, state.iy);

        let [cx, cy] = self.bounds.cells.map(|n| n as i32);
        let inside_x = lanes.within(ix, cx);
        let inside = inside_x & lanes.within(iy, cy);
        let risen = lanes.less(state.ceiling, exit.z);
        let clearance = lanes.select(inside_x, state.clearance_y, state.clearance_x);
        let left = !inside & lanes.less(clearance, gap);
        let nothing = forward & (risen | left);
        state.answer = lanes.select_i(nothing, lanes.splat_i(NOTHING), state.answer);
        forward & inside & !risen
    }

    /// Writes down the answers of the rays that have ended.
    #[inline(always)]
    fn note_answers(&self, state: &mut State<L>, answers: &mut Answers) {
        let lanes = self.lanes;
        let ended = state.occupied & !state.active;
        let [places, columns, rows] = answers.next(ended.bits().count_ones() as usize);
        lanes.store_some(ended, state.place, places);
        lanes.store_some(ended, state.answer, columns);
        lanes.store_some(ended, state.iy, rows);
        state.occupied = state.active;
    }
}
