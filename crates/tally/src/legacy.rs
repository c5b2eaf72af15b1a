//! Index functions of before, until their last users are converted.
#![allow(missing_docs, reason = "goes when its last user does")]

use std::ops::{Deref, DerefMut, Index, IndexMut, Range};

use serde::Serialize;

use crate::entry::Entry;
use crate::spec::TallySpec;
use crate::values::TallyValues;
use crate::{Component, EventPath, Side, TallyResult, TallyStatistics};

pub type Layout = TallySpec;
pub type LayoutError = crate::SpecError;
pub type Record<'c> = crate::Tally<'c>;
pub type Control = crate::ControlVariate;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderClass {
    First,
    Second,
    Third,
    FourthOrMore,
    All,
}

impl OrderClass {
    pub const ALL: [Self; 5] = [
        Self::First,
        Self::Second,
        Self::Third,
        Self::FourthOrMore,
        Self::All,
    ];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    Single,
    Multiple,
    Total,
}

impl Share {
    pub const ALL: [Self; 3] = [Self::Single, Self::Multiple, Self::Total];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum History {
    Unscattered,
    Once,
    More,
}

impl History {
    pub const ALL: [Self; 3] = [Self::Unscattered, Self::Once, Self::More];

    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unscattered => "unscattered",
            Self::Once => "once",
            Self::More => "more",
        }
    }

    const fn component(self) -> Component {
        Component::MEDIUM[self as usize]
    }
}

impl TallySpec {
    pub const REFLECTED: usize = 0;
    pub const TRANSMITTED: usize = 1;
    pub const ABSORBED: usize = 2;
    pub const TRUNCATED: usize = 3;
    pub const LOST: usize = 4;
    pub const LEFT_PATCH: usize = 5;
    pub const NOT_ASKED: usize = 6;

    #[must_use]
    pub const fn multiple(&self, side: Side) -> usize {
        7 + side.index()
    }
    #[must_use]
    pub const fn with_histories(self) -> Self {
        self.with_medium()
    }
    #[must_use]
    pub fn has_histories(&self) -> bool {
        self.has_medium()
    }
    #[must_use]
    pub const fn asks(&self, side: Side) -> bool {
        self.records(side)
    }
    #[must_use]
    pub const fn asked_bins(&self) -> Range<usize> {
        self.recorded_bins()
    }
    #[must_use]
    pub fn order(&self, side: Side, order: usize) -> usize {
        self.order_entry(side, order).0
    }
    #[must_use]
    pub fn path(&self, side: Side, path: EventPath) -> usize {
        self.event_path_entry(side, path).0
    }
    #[must_use]
    pub fn longer_paths(&self, side: Side) -> usize {
        self.longer_paths_entry(side).0
    }
    #[must_use]
    pub const fn bins(&self, share: Share) -> Range<usize> {
        let start = self.bins_start(share as usize);
        start..start + self.grid().len()
    }
    #[must_use]
    pub const fn rings(&self, side: Side, class: OrderClass) -> Range<usize> {
        let start = self.rings_start(side, class as usize);
        start..start + self.grid().n_theta()
    }
    #[must_use]
    pub const fn in_plane(&self, side: Side, class: OrderClass) -> Range<usize> {
        let start = self.in_plane_start(side, class as usize);
        start..start + self.in_plane_len()
    }
    #[must_use]
    pub fn in_plane_edges_deg(&self, i: usize) -> [f64; 2] {
        self.in_plane_filter(Side::Reflected).theta_deg(i)
    }
    #[must_use]
    pub fn in_plane_solid_angle(&self, i: usize) -> f64 {
        self.in_plane_filter(Side::Reflected).solid_angle(i)
    }
    #[must_use]
    pub const fn hits(&self, share: Share) -> Range<usize> {
        let start = self.hits_start(matches!(share, Share::Multiple) as usize);
        start..start + self.grid().len()
    }
    #[must_use]
    pub fn history(&self, side: Side, history: History) -> usize {
        self.flux_entry(side, history.component()).0
    }
    #[must_use]
    pub fn history_bins(&self, history: History) -> Range<usize> {
        self.grid_entries(history.component()).range()
    }
    #[must_use]
    pub fn history_hits(&self, history: History) -> Range<usize> {
        self.grid_hit_entries(history.component()).range()
    }
    #[must_use]
    pub fn history_rings(&self, side: Side, history: History) -> Range<usize> {
        self.ring_entries(side, history.component()).range()
    }
    #[must_use]
    pub fn history_in_plane(&self, side: Side, history: History) -> Range<usize> {
        self.in_plane_entries(side, history.component()).range()
    }
}

impl From<usize> for Entry {
    fn from(entry: usize) -> Self {
        Self(entry)
    }
}

impl TallyStatistics {
    #[must_use]
    pub fn estimate(&self, entry: impl Into<Entry>) -> crate::Estimate {
        self.at(entry.into())
    }
}

impl TallyValues {
    #[must_use]
    pub fn legacy(spec: TallySpec, values: Vec<f64>) -> Self {
        Self::from_vec(spec, values)
    }
}

impl Deref for TallyValues {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        self.as_slice()
    }
}

impl DerefMut for TallyValues {
    fn deref_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}

macro_rules! index {
    ($($t:ty => $o:ty),*) => {$(
        impl Index<$t> for TallyValues {
            type Output = $o;
            fn index(&self, i: $t) -> &$o {
                &self.as_slice()[i]
            }
        }
        impl IndexMut<$t> for TallyValues {
            fn index_mut(&mut self, i: $t) -> &mut $o {
                &mut self.as_mut_slice()[i]
            }
        }
    )*};
}

index!(usize => f64, Range<usize> => [f64], std::ops::RangeTo<usize> => [f64], std::ops::RangeFrom<usize> => [f64], std::ops::RangeInclusive<usize> => [f64], std::ops::RangeToInclusive<usize> => [f64]);

impl History {
    #[must_use]
    pub const fn of(scatterings: u32) -> Self {
        match scatterings {
            0 => Self::Unscattered,
            1 => Self::Once,
            _ => Self::More,
        }
    }
}

impl<'c> crate::Tally<'c> {
    #[must_use]
    pub const fn asks(&self, side: Side) -> bool {
        self.records(side)
    }
    #[must_use]
    pub fn under(self, control: Option<&'c Control>) -> Self {
        self.with_control_variate(control)
    }
    #[must_use]
    pub const fn control(&self) -> Option<&'c Control> {
        self.control_variate()
    }
    pub fn add_unseen(&mut self, exit: &crate::Exit) {
        self.add_masked(exit);
    }
    pub fn add_unlit_absorbed(&mut self, flux: f64) {
        self.add_shadowed_absorbed(flux);
    }
}

#[allow(non_upper_case_globals, reason = "goes when its last user does")]
impl crate::Loss {
    pub const NotAsked: Self = Self::NotRecorded;
}

impl crate::Sides {
    #[must_use]
    pub const fn ask(self, side: Side) -> bool {
        self.includes(side)
    }
}

impl crate::ControlVariate {
    pub fn complete_slice(&self, record: &mut [f64]) {
        let mut values = TallyValues::from_vec(*self.expected().spec(), record.to_vec());
        self.complete(&mut values);
        record.copy_from_slice(values.as_slice());
    }
}

impl From<Share> for Component {
    fn from(share: Share) -> Self {
        Self::BINS[share as usize]
    }
}
