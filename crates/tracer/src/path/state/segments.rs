//! Segments: path segments as a structure of arrays, so that stages over many of them take vector instructions.

use std::ops::Range;

use asperity_tally::EventPath;
use glam::{DVec2, DVec3};

use crate::path::state::light_state::LightState;
use crate::path::state::path_state::{PathState, turned};
use crate::periodic::Heading;
use crate::ray::{HalfSpace, RayColumns};
use crate::sampling::Start;
use crate::settings::Polarisation;
use crate::vector::Stage;

/// Quantities that paths keep besides their rays and their flux.
#[derive(Clone, Copy)]
pub(crate) struct Kept {
    /// The light comes from any azimuth, and exits are turned back.
    pub(crate) turn: bool,
    /// Polarisation that paths carry.
    pub(crate) polarisation: Polarisation,
    /// Rows of a table that holds the light of several conductors, or numbers of given rays.
    pub(crate) slot: bool,
}

impl Kept {
    pub(crate) const NOTHING: Self = Self {
        turn: false,
        polarisation: Polarisation::Averaged,
        slot: false,
    };
}

/// State that all starts share, before they are turned by their azimuths.
pub(crate) struct IncidentState {
    /// Unit vector in physical lengths, before it is turned by the azimuth of a start.
    pub(crate) direction: DVec3,
    pub(crate) half_space: HalfSpace,
    pub(crate) state: LightState,
}

/// Path segments: rays, and what their paths carry.
///
/// Columns are longer than `len`: their length is a power of two, by which [`gather_column`] gathers.
pub(crate) struct Segments {
    pub(crate) len: usize,
    /// Tile coordinates.
    pub(crate) origin: [Vec<f64>; 3],
    /// Unit vectors in physical lengths, mirrored with the tile.
    pub(crate) direction: [Vec<f64>; 3],
    /// Sign of the half space.
    pub(crate) side: Vec<f64>,
    /// Throughput; zero where a path has ended.
    pub(crate) flux: Vec<f64>,
    /// Cosine and sine of what exit directions are turned by; without rows where the azimuth of the light is fixed.
    pub(crate) turn: [Vec<f64>; 2],
    /// Interactions with interfaces, and their kinds as in [`EventPath::code`].
    pub(crate) order: Vec<u32>,
    pub(crate) events: Vec<u32>,
    pub(crate) scatterings: Vec<u32>,
    /// Number of the path in its batch.
    pub(crate) ray: Vec<u32>,
    /// Row of a path among those of several conductors, from its first interaction on, or number of its given ray; without rows for
    /// other light.
    pub(crate) slot: Vec<u32>,
    /// Axes that are mirrored against the world, a bit each.
    pub(crate) mirrored: Vec<u32>,
    /// The numbers of [`LightState`], as many as are kept.
    pub(crate) light: Vec<Vec<f64>>,
    pub(crate) kept: Kept,
}

impl Default for Segments {
    fn default() -> Self {
        Self::new(Kept::NOTHING)
    }
}

impl Segments {
    /// No segments.
    pub(crate) fn new(kept: Kept) -> Self {
        let columns = || [const { Vec::new() }; 3];
        Self {
            len: 0,
            origin: columns(),
            direction: columns(),
            side: Vec::new(),
            flux: Vec::new(),
            turn: [const { Vec::new() }; 2],
            order: Vec::new(),
            events: Vec::new(),
            scatterings: Vec::new(),
            ray: Vec::new(),
            slot: Vec::new(),
            mirrored: Vec::new(),
            light: vec![Vec::new(); LightState::len(kept.polarisation)],
            kept,
        }
    }

    /// Makes room for `len` segments in all.
    pub(crate) fn make_room(&mut self, len: usize) {
        if self.flux.len() >= len {
            return;
        }
        let room = len.next_power_of_two();
        for column in self.floats_mut() {
            column.resize(room, 0.0);
        }
        for column in self.integers_mut() {
            column.resize(room, 0);
        }
    }

    /// All columns of numbers that have rows.
    #[inline(always)]
    fn floats(&self) -> impl Iterator<Item = &Vec<f64>> {
        let turns = if self.kept.turn { 2 } else { 0 };
        let rays = self.origin.iter().chain(&self.direction);
        let rays = rays.chain([&self.side, &self.flux]);
        rays.chain(self.turn.iter().take(turns)).chain(&self.light)
    }

    #[inline(always)]
    fn floats_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let turns = if self.kept.turn { 2 } else { 0 };
        let rays = self.origin.iter_mut().chain(&mut self.direction);
        let rays = rays.chain([&mut self.side, &mut self.flux]);
        let turn = self.turn.iter_mut().take(turns);
        rays.chain(turn).chain(&mut self.light)
    }

    /// All columns of integers that have rows.
    #[inline(always)]
    fn integers(&self) -> impl Iterator<Item = &Vec<u32>> {
        let slot = self.kept.slot.then_some(&self.slot);
        let columns = [
            &self.order,
            &self.events,
            &self.scatterings,
            &self.ray,
            &self.mirrored,
        ];
        columns.into_iter().chain(slot)
    }

    #[inline(always)]
    fn integers_mut(&mut self) -> impl Iterator<Item = &mut Vec<u32>> {
        let slot = self.kept.slot.then_some(&mut self.slot);
        let columns = [
            &mut self.order,
            &mut self.events,
            &mut self.scatterings,
            &mut self.ray,
            &mut self.mirrored,
        ];
        columns.into_iter().chain(slot)
    }

    /// All rays, as physical directions over a tile of the given aspect ratio.
    #[inline(always)]
    pub(crate) fn rays(&self, aspect: f64) -> RayColumns<'_> {
        RayColumns {
            origin: rows_of(&self.origin, 0..self.len),
            direction: rows_of(&self.direction, 0..self.len),
            side: &self.side[..self.len],
            aspect,
        }
    }

    /// Heading with which segment `i` begins.
    pub(crate) fn heading(&self, i: usize) -> Heading {
        let at = |[x, y, z]: &[Vec<f64>; 3]| DVec3::new(x[i], y[i], z[i]);
        Heading {
            origin: at(&self.origin),
            direction: at(&self.direction),
            mirrored: [1, 2].map(|axis| self.mirrored[i] & axis != 0),
        }
    }

    /// The half space of segment `i`.
    pub(crate) fn half_space(&self, i: usize) -> HalfSpace {
        HalfSpace::from_sign(self.side[i])
    }

    /// State of the path of segment `i`.
    pub(crate) fn state(&self, i: usize) -> PathState {
        PathState {
            flux: self.flux[i],
            events: EventPath::from_code(self.order[i], self.events[i]),
            scatterings: self.scatterings[i],
            ray: self.ray[i],
            slot: if self.kept.slot { self.slot[i] } else { 0 },
            turn: if self.kept.turn {
                DVec2::new(self.turn[0][i], self.turn[1][i])
            } else {
                DVec2::X
            },
            light: self.light_state(i),
        }
    }

    /// Polarisation of the light of segment `i`.
    pub(crate) fn light_state(&self, i: usize) -> LightState {
        let mut state = LightState::NONE;
        for (number, column) in state.0.iter_mut().zip(&self.light) {
            *number = column[i];
        }
        state
    }

    /// Adds a segment.
    pub(crate) fn push(&mut self, heading: &Heading, half_space: HalfSpace, state: &PathState) {
        let i = self.len;
        self.make_room(i + 1);
        self.len += 1;
        self.set_heading(i, heading);
        self.side[i] = half_space.sign();
        self.flux[i] = state.flux;
        self.order[i] = state.events.order();
        self.events[i] = state.events.code();
        self.scatterings[i] = state.scatterings;
        self.ray[i] = state.ray;
        if self.kept.slot {
            self.slot[i] = state.slot;
        }
        if self.kept.turn {
            (self.turn[0][i], self.turn[1][i]) = (state.turn.x, state.turn.y);
        }
        self.set_light_state(i, &state.light);
    }

    /// Adds a path per start, with a flux of one and nothing behind it, and returns their numbers. Where each begins is left
    /// to be set.
    #[inline(always)]
    pub(crate) fn add_starts(&mut self, starts: &[Start], light: &IncidentState) -> Range<usize> {
        let rows = self.len..self.len + starts.len();
        self.make_room(rows.end);
        self.len = rows.end;
        for (column, d) in self.direction.iter_mut().zip(light.direction.to_array()) {
            column[rows.clone()].fill(d);
        }
        if self.kept.turn {
            let [dx, dy, _] = &mut self.direction;
            let [cos, sin] = &mut self.turn;
            let columns = [dx, dy, cos, sin];
            let [dx, dy, cos, sin] = columns.map(|column| &mut column[rows.clone()]);
            for (i, start) in starts.iter().enumerate() {
                let turn = start.turn();
                let direction = turned(light.direction, turn);
                (dx[i], dy[i]) = (direction.x, direction.y);
                // Light that leaves is turned back
                (cos[i], sin[i]) = (turn.x, -turn.y);
            }
        }
        self.side[rows.clone()].fill(light.half_space.sign());
        self.flux[rows.clone()].fill(1.0);
        for (column, number) in self.light.iter_mut().zip(light.state.0) {
            column[rows.clone()].fill(number);
        }
        for column in [
            &mut self.order,
            &mut self.events,
            &mut self.scatterings,
            &mut self.mirrored,
        ] {
            column[rows.clone()].fill(0);
        }
        for (ray, start) in self.ray[rows.clone()].iter_mut().zip(starts) {
            *ray = start.ray;
        }
        rows
    }

    /// Changes how the light of segment `i` is polarised.
    pub(crate) fn set_light_state(&mut self, i: usize, light: &LightState) {
        for (column, number) in self.light.iter_mut().zip(light.0) {
            column[i] = number;
        }
    }

    /// Changes where segment `i` begins and goes.
    pub(crate) fn set_heading(&mut self, i: usize, heading: &Heading) {
        for axis in 0..3 {
            self.origin[axis][i] = heading.origin[axis];
            self.direction[axis][i] = heading.direction[axis];
        }
        let [x, y] = heading.mirrored.map(u32::from);
        self.mirrored[i] = x | y << 1;
    }

    /// Adds copies of those of its own first `n` segments whose numbers are in `which`, but for direction, side, flux and
    /// polarisation, behind these `n`. There must be room.
    #[inline(always)]
    pub(crate) fn copy_paths(&mut self, which: &[u32]) {
        let n = self.len;
        let end = n + which.len();
        self.len = end;
        for column in self.origin.iter_mut().chain(&mut self.turn) {
            if let Some((from, rows)) = column.split_at_mut_checked(n) {
                copy_column(&mut rows[..end - n], from, which);
            }
        }
        for column in self.integers_mut() {
            let (from, rows) = column.split_at_mut(n);
            copy_column(&mut rows[..end - n], from, which);
        }
    }
}

/// Adds those of other segments whose numbers are in `which`.
pub(crate) struct Gather<'a> {
    pub(crate) from: &'a Segments,
    pub(crate) which: &'a [u32],
    pub(crate) into: &'a mut Segments,
}

impl Stage for Gather<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { from, which, into } = self;
        let rows = into.len..into.len + which.len();
        into.make_room(rows.end);
        into.len = rows.end;
        for (into, from) in into.floats_mut().zip(from.floats()) {
            gather_column(&mut into[rows.clone()], from, which);
        }
        for (into, from) in into.integers_mut().zip(from.integers()) {
            gather_column(&mut into[rows.clone()], from, which);
        }
    }
}

/// Copies the entries of a column of [`Segments`] whose numbers are in `which`. Its length is a power of two, so that
/// the compiler knows that no masked number is out of bounds.
#[inline(always)]
pub(crate) fn gather_column<T: Copy>(into: &mut [T], column: &[T], which: &[u32]) {
    if column.is_empty() {
        return;
    }
    let mask = column.len() - 1;
    for (entry, &i) in into.iter_mut().zip(which) {
        *entry = column[i as usize & mask];
    }
}

/// Copies the entries of a column of any length whose numbers are in `which`.
#[inline(always)]
pub(crate) fn copy_column<T: Copy>(into: &mut [T], column: &[T], which: &[u32]) {
    for (entry, &i) in into.iter_mut().zip(which) {
        *entry = column[i as usize];
    }
}

/// Some rows of several columns.
#[inline(always)]
pub(crate) fn rows_of<const N: usize>(columns: &[Vec<f64>; N], rows: Range<usize>) -> [&[f64]; N] {
    columns.each_ref().map(|column| &column[rows.clone()])
}

/// Some rows of several columns, to be changed.
#[inline(always)]
pub(crate) fn rows_of_mut<const N: usize>(
    columns: &mut [Vec<f64>; N],
    rows: Range<usize>,
) -> [&mut [f64]; N] {
    columns.each_mut().map(|column| &mut column[rows.clone()])
}
