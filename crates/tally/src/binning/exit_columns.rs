//! Exit columns: light that left, field by field, collected from many paths before it is added to a tally.

use glam::DVec3;

use crate::spec::filters::Half;
use crate::spec::offsets::{BinOffsets, Target};
use crate::{EventPath, Exit, Polarimetry, Side};

/// Light that left the surface, field by field, so that bins are found by loops that take vector instructions.
///
/// [`crate::Tallies::locate`] finds the bins, and [`crate::Tallies::add_located`] adds the light to them.
///
/// # Examples
/// ```
/// use asperity_optics::from_spherical;
/// use asperity_tally::{
///     Azimuth, Component, Event, EventPath, Exit, ExitColumns, Side, Tallies, Tally, TallyResult, TallySpec,
/// };
///
/// let mut exits = ExitColumns::default();
/// let exit = Exit {
///     side: Side::Reflected,
///     wo: from_spherical(0.3, 0.0),
///     flux: 1.0,
///     path: EventPath::default().then(Event::Reflection),
///     scatterings: 0,
/// };
/// exits.push(&exit, 1);
/// let tally = Tally::new(TallySpec::default(), Azimuth::From(0.0));
/// let mut tallies = Tallies::new(tally, 2);
/// tallies.locate(&mut exits);
/// tallies.add_located(&mut exits);
/// assert!(exits.is_empty());
/// let fractions = tallies.into_fractions(1);
/// let single = [0, 1].map(|batch: usize| fractions[batch].flux(Side::Reflected, Component::Single));
/// assert_eq!(single, [0.0, 1.0]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct ExitColumns {
    pub(crate) wo: [Vec<f64>; 3],
    pub(crate) flux: Vec<f64>,
    pub(crate) side: Vec<Side>,
    pub(crate) path: Vec<EventPath>,
    pub(crate) scatterings: Vec<u32>,
    pub(crate) is_masked: Vec<bool>,
    /// Number of the batch among those that are traced together.
    pub(crate) batch: Vec<u32>,
    /// Measures over the flux, as many as are kept.
    pub(crate) measures: Vec<Vec<f64>>,
    /// Rings, sectors, halves of the in-plane slice, entries and apertures (a bit for each; empty without any) that [`crate::Tallies::locate`] has found.
    pub(crate) ring: Vec<u32>,
    pub(crate) sector: Vec<u32>,
    pub(crate) slice: Vec<InSlice>,
    pub(crate) targets: Vec<Target>,
    pub(crate) windows: Vec<u8>,
}

/// Exits that are about to be written: the fields of [`Exit`].
#[derive(Debug)]
pub struct ExitRows<'a> {
    /// Directions, `[x, y, z]`.
    pub wo: [&'a mut [f64]; 3],
    /// Fluxes.
    pub flux: &'a mut [f64],
    /// Sides.
    pub side: &'a mut [Side],
    /// Interactions.
    pub path: &'a mut [EventPath],
    /// Scatterings in the medium below.
    pub scatterings: &'a mut [u32],
    /// Numbers of the batches among those that are traced together.
    pub batch: &'a mut [u32],
    /// Measures over the flux: those of [`crate::Polarimetry`], in the order of their numbers.
    pub measures: Vec<&'a mut [f64]>,
}

/// Half of the in-plane slice that contains a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum InSlice {
    Neither,
    Forward,
    Backward,
    /// An edge is near: angles decide.
    Unsure,
}

impl InSlice {
    /// The half; `None` where there is none, or where it is not decided.
    #[inline(always)]
    pub(crate) const fn half(self) -> Option<Half> {
        match self {
            Self::Forward => Some(Half::Forward),
            Self::Backward => Some(Half::Backward),
            Self::Neither | Self::Unsure => None,
        }
    }
}

impl ExitColumns {
    /// No exits, whose light has such measures.
    #[must_use]
    pub fn new(polarimetry: Polarimetry) -> Self {
        Self {
            measures: vec![Vec::new(); polarimetry.len()],
            ..Self::default()
        }
    }

    /// Computes the entries of all exits from their rings and sectors.
    #[inline(always)]
    pub(crate) fn find_targets(&mut self, offsets: &BinOffsets) {
        let n = self.len();
        self.targets.resize(n, Target::default());
        let (sides, paths) = (&self.side[..n], &self.path[..n]);
        let (rings, sectors) = (&self.ring[..n], &self.sector[..n]);
        for (i, target) in self.targets.iter_mut().enumerate() {
            *target = offsets.target(sides[i], paths[i], rings[i], sectors[i]);
        }
    }

    /// Number of exits.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.flux.len()
    }

    /// Returns `true` if there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.flux.is_empty()
    }

    /// Adds light of batch number `batch` for [`crate::Tally::add_exit`].
    #[inline]
    pub fn push(&mut self, exit: &Exit, batch: u32) {
        self.push_as(exit, batch, false, &[]);
    }

    /// Adds light with its measures over the flux, of which there are at least as many as are kept.
    #[inline]
    pub fn push_measured(&mut self, exit: &Exit, batch: u32, measures: &[f64]) {
        self.push_as(exit, batch, false, measures);
    }

    /// Adds light of batch number `batch` that a facet would send away if nothing were in its way, but that is shadowed or masked, to be
    /// subtracted under a control variate. A direction that leads into the surface is no exit of the control variate.
    #[inline]
    pub fn push_masked(&mut self, exit: &Exit, batch: u32) {
        self.push_as(exit, batch, true, &[]);
    }

    #[inline(always)]
    fn push_as(&mut self, exit: &Exit, batch: u32, is_masked: bool, measures: &[f64]) {
        for (column, w) in self.wo.iter_mut().zip(exit.wo.to_array()) {
            column.push(w);
        }
        self.flux.push(exit.flux);
        self.side.push(exit.side);
        self.path.push(exit.path);
        self.scatterings.push(exit.scatterings);
        self.is_masked.push(is_masked);
        self.batch.push(batch);
        for (i, column) in self.measures.iter_mut().enumerate() {
            column.push(measures.get(i).copied().unwrap_or_default());
        }
    }

    /// Adds `count` exits, whose fields are about to be written.
    pub fn add_rows(&mut self, count: usize) -> ExitRows<'_> {
        let first = self.len();
        let len = first + count;
        self.wo
            .iter_mut()
            .for_each(|column| column.resize(len, 0.0));
        self.flux.resize(len, 0.0);
        self.side.resize(len, Side::Reflected);
        self.path.resize(len, EventPath::default());
        self.scatterings.resize(len, 0);
        self.is_masked.resize(len, false);
        self.batch.resize(len, 0);
        ExitRows {
            wo: self.wo.each_mut().map(|column| &mut column[first..]),
            flux: &mut self.flux[first..],
            side: &mut self.side[first..],
            path: &mut self.path[first..],
            scatterings: &mut self.scatterings[first..],
            batch: &mut self.batch[first..],
            measures: self
                .measures
                .iter_mut()
                .map(|column| {
                    column.resize(len, 0.0);
                    &mut column[first..]
                })
                .collect(),
        }
    }

    /// Exit number `i`.
    #[inline(always)]
    pub(crate) fn exit(&self, i: usize) -> Exit {
        Exit {
            side: self.side[i],
            wo: self.wo(i),
            flux: self.flux[i],
            path: self.path[i],
            scatterings: self.scatterings[i],
        }
    }

    /// Apertures that exit number `i` may enter, a bit for each; none of a masked one.
    #[inline(always)]
    pub(crate) fn windows_of(&self, i: usize) -> u8 {
        match self.is_masked[i] {
            true => 0,
            false => self.windows.get(i).copied().unwrap_or(0),
        }
    }

    /// Direction of exit number `i`.
    #[inline(always)]
    pub(crate) fn wo(&self, i: usize) -> DVec3 {
        let [x, y, z] = &self.wo;
        DVec3::new(x[i], y[i], z[i])
    }

    /// Removes all exits, and hands each over with the number of its batch, in their order.
    pub fn drain(&mut self, mut take: impl FnMut(u32, &Exit)) {
        for (i, &batch) in self.batch.iter().enumerate() {
            take(batch, &self.exit(i));
        }
        self.clear();
    }

    pub(crate) fn clear(&mut self) {
        self.wo.iter_mut().for_each(Vec::clear);
        self.flux.clear();
        self.side.clear();
        self.path.clear();
        self.scatterings.clear();
        self.is_masked.clear();
        self.batch.clear();
        self.measures.iter_mut().for_each(Vec::clear);
        self.ring.clear();
        self.sector.clear();
        self.slice.clear();
        self.targets.clear();
        self.windows.clear();
    }
}
