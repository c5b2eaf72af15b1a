//! Tally: collects what one batch of rays did.

use std::f64::consts::TAU;

use crate::component::{FIRST_GROUPED_ORDER, MAX_LISTED_ORDER};
use crate::exit::{Exit, Loss};
use crate::exit_columns::{ExitColumns, InSlice};
use crate::filters::Half;
use crate::finder::BinFinder;
use crate::in_plane::InPlaneSlice;
use crate::target::Target;
use crate::values::TallyValues;
use crate::{Component, ControlVariate, Side, TallySpec};

/// What the azimuths of exits are counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Azimuth {
    /// The horizontal component of the light *travels* towards this azimuth, radians: that of `wi`
    /// plus half a turn.
    From(f64),
    /// From nothing: every azimuth is as likely as any other, as where light falls vertically on
    /// surfaces without a preferred direction. The azimuths of exits are ignored.
    ///
    /// When the tally is closed, the flux of a ring is spread evenly over its azimuths, and each half
    /// of the in-plane slice gets its fraction of the full turn. The number of rays is spread alike, so
    /// that a bin's is a fraction of its ring's and need not be whole.
    Free,
}

/// Sums over one batch of rays.
///
/// Under a [`ControlVariate`] it holds what is left when that is subtracted: visible light that is
/// scattered once counts with what its visible fraction leaves of it, and light that would be scattered
/// so but is shadowed or masked counts with minus that fraction. [`ControlVariate::complete`] adds the
/// mean of what was subtracted.
///
/// # Examples
/// ```
/// use asperity_optics::from_spherical;
/// use asperity_tally::{
///     Azimuth, Component, Event, EventPath, Exit, Loss, Side, Tally, TallyResult, TallySpec,
/// };
///
/// let mut tally = Tally::new(TallySpec::default(), Azimuth::From(0.0));
/// tally.add_exit(&Exit {
///     side: Side::Reflected,
///     wo: from_spherical(0.3, 0.0),
///     flux: 1.0,
///     path: EventPath::default().then(Event::Reflection),
///     scatterings: 0,
/// });
/// tally.add_loss(Loss::Absorbed, 1.0);
/// let fluxes = tally.into_fractions(2);
/// assert_eq!(fluxes.flux(Side::Reflected, Component::Single), 0.5);
/// assert_eq!(fluxes.budget().absorbed, 0.5);
/// // 0.3 rad lies in the fourth ring of 5 degrees.
/// assert_eq!(fluxes.rings(Side::Reflected, Component::All).get(3), 0.5);
/// ```
#[derive(Clone, Debug)]
pub struct Tally<'c> {
    pub(crate) spec: TallySpec,
    control_variate: Option<&'c ControlVariate>,
    finder: BinFinder,
    /// `None` where the azimuth is free.
    pub(crate) slice: Option<InPlaneSlice>,
    /// Sums of all batches: those of one entry side by side, since paths that start side by side often end in the same bin.
    pub(crate) values: Vec<f64>,
    /// Number of batches, and of the one that is added to.
    batches: usize,
    batch: usize,
}

impl<'c> Tally<'c> {
    /// An empty tally.
    #[must_use]
    pub fn new(spec: TallySpec, azimuth: Azimuth) -> Self {
        Self {
            spec,
            control_variate: None,
            finder: BinFinder::new(spec.grid()),
            slice: match azimuth {
                Azimuth::From(forward) => {
                    Some(InPlaneSlice::new(forward, spec.in_plane_half_width()))
                }
                Azimuth::Free => None,
            },
            values: vec![0.0; spec.len()],
            batches: 1,
            batch: 0,
        }
    }

    /// The same under a control variate of the same spec, where there is one.
    #[must_use]
    pub fn with_control_variate(self, control_variate: Option<&'c ControlVariate>) -> Self {
        Self {
            control_variate,
            ..self
        }
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.spec.records(side)
    }

    /// The control variate, under which shadowed and masked light counts too.
    #[must_use]
    pub const fn control_variate(&self) -> Option<&'c ControlVariate> {
        self.control_variate
    }

    /// Adds light that left the surface: to its bins, or, on a side that is not recorded, to the flux
    /// that went there.
    pub fn add_exit(&mut self, exit: &Exit) {
        let at = self.direction(exit);
        self.book(exit, self.weight(exit, at.ring) * exit.flux, &at);
    }

    /// Subtracts, under a control variate, light that a facet would send away if nothing were in its
    /// way, but that is shadowed or masked. A direction that leads into the surface is no exit of the
    /// control variate.
    pub fn add_masked(&mut self, exit: &Exit) {
        let at = self.direction(exit);
        self.book(exit, self.masked_weight(exit, at.ring) * exit.flux, &at);
    }

    /// Finds the bins of exits, in loops that take the vector instructions of the function that calls this one.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns) {
        self.finder.locate(exits, self.slice.is_some());
        if let Some(slice) = &self.slice {
            slice.locate(exits);
        }
        exits.find_targets(&self.spec.places());
    }

    /// Adds exit number `i` to the bins that [`Tally::locate`] has found: as [`Tally::add_exit`] and [`Tally::add_masked`] do.
    #[inline(always)]
    pub(crate) fn add_located(&mut self, exits: &ExitColumns, i: usize) {
        let exit = exits.exit(i);
        let ring = exits.ring[i] as usize;
        let weight = if exits.is_masked[i] {
            self.masked_weight(&exit, ring)
        } else {
            self.weight(&exit, ring)
        };
        let half = match exits.slice.get(i) {
            Some(InSlice::Forward) => Some(Half::Forward),
            Some(InSlice::Backward) => Some(Half::Backward),
            _ => None,
        };
        let at = Direction {
            ring,
            half,
            target: exits.target(i),
        };
        self.book(&exit, weight * exit.flux, &at);
        if !exits.measures.is_empty() && !exits.is_masked[i] {
            self.book_measures(&exit, &exits.measures, i, &at);
        }
    }

    /// The factor with which light that left through a ring counts.
    #[inline(always)]
    fn weight(&self, exit: &Exit, ring: usize) -> f64 {
        match self.control_variate {
            Some(control) if exit.path.order() == 1 => 1.0 - control.fraction(exit.side, ring),
            _ => 1.0,
        }
    }

    /// The factor with which shadowed or masked light counts.
    #[inline(always)]
    fn masked_weight(&self, exit: &Exit, ring: usize) -> f64 {
        let is_away = match exit.side {
            Side::Reflected => exit.wo.z > 0.0,
            Side::Transmitted => exit.wo.z < 0.0,
        };
        match self.control_variate {
            Some(control) if is_away => -control.fraction(exit.side, ring),
            _ => 0.0,
        }
    }

    /// Where an exit counts.
    fn direction(&self, exit: &Exit) -> Direction {
        let ring = self.finder.ring(exit.side, exit.wo);
        // Without azimuths the first bin counts for its ring until the tally is closed.
        let (sector, half) = match &self.slice {
            None => (0, None),
            Some(slice) => (self.finder.sector(exit.side, exit.wo), slice.half(exit.wo)),
        };
        let places = self.spec.places();
        let side = exit.side.index() as u32;
        Direction {
            ring,
            half,
            target: places.target(side, exit.path, ring as u32, sector as u32),
        }
    }

    /// Adds `flux` to all entries that `exit` belongs to.
    #[inline(always)]
    fn book(&mut self, exit: &Exit, flux: f64, at: &Direction) {
        // Where the control variate cancels all of it, no ray of the bin is left either.
        if flux == 0.0 {
            return;
        }
        let spec = self.spec;
        if !spec.records(exit.side) {
            self.add_loss(Loss::NotRecorded, flux);
            return;
        }
        let target = at.target;
        let bin = target.bin as usize;
        self.add(target.order as usize, flux);
        self.add(target.path as usize, flux);
        self.add(target.ring as usize, flux);
        if self.slice.is_some() {
            self.add(bin, flux);
        }
        self.add(spec.places().hits_of_bin(bin), 1.0);
        if let Some(in_plane) = at.in_plane(&spec, exit.side) {
            let group = Component::order_group(exit.path.order());
            let start = spec.places().in_plane_start(exit.side, group);
            self.add(start + in_plane, flux);
        }
        if !spec.components().is_empty() {
            self.book_components(exit, flux, at);
        }
    }

    /// Adds `flux` to the entries of each component kept in full that `exit` belongs to.
    fn book_components(&mut self, exit: &Exit, flux: f64, at: &Direction) {
        let spec = self.spec;
        let side = exit.side;
        let bin = at.bin(&spec, exit);
        let in_plane = at.in_plane(&spec, side);
        for (place, component) in spec.components().iter().enumerate() {
            if !component.accepts(exit) {
                continue;
            }
            let start = spec.places().component_start(place);
            self.add(start + side.index(), flux);
            self.add(
                spec.places().rings_of_component(start, side) + at.ring,
                flux,
            );
            let bins = start + 2;
            self.add(bins + spec.grid().len() + bin, 1.0);
            if self.slice.is_some() {
                self.add(bins + bin, flux);
            }
            if let Some(i) = in_plane {
                self.add(spec.places().in_plane_of_component(start, side) + i, flux);
            }
        }
    }

    /// Adds flux that was absorbed at the first interaction.
    pub fn add_first_absorbed(&mut self, flux: f64) {
        let fraction = self.absorbed_fraction();
        self.add_loss(Loss::Absorbed, (1.0 - fraction) * flux);
    }

    /// Subtracts, under a control variate, flux that a shadowed facet would absorb if it were lit.
    pub fn add_shadowed_absorbed(&mut self, flux: f64) {
        let fraction = self.absorbed_fraction();
        self.add_loss(Loss::Absorbed, -fraction * flux);
    }

    fn absorbed_fraction(&self) -> f64 {
        self.control_variate
            .map_or(0.0, ControlVariate::absorbed_fraction)
    }

    /// Adds flux that ended without an exit.
    pub fn add_loss(&mut self, loss: Loss, flux: f64) {
        const BUDGET: crate::Budget<crate::Entry> = TallySpec::BUDGET;
        match loss {
            Loss::Absorbed => self.add(BUDGET.absorbed.0, flux),
            Loss::Truncated => self.add(BUDGET.truncated.0, flux),
            Loss::Lost => self.add(BUDGET.lost.0, flux),
            Loss::LeftPatch => {
                self.add(BUDGET.truncated.0, flux);
                self.add(BUDGET.left_patch.0, flux);
            }
            Loss::NotRecorded => {
                self.add(BUDGET.truncated.0, flux);
                self.add(BUDGET.not_recorded.0, flux);
            }
        }
    }

    /// Adds to the sum of an entry.
    #[inline(always)]
    pub(crate) fn add(&mut self, entry: usize, value: f64) {
        self.values[entry * self.batches + self.batch] += value;
    }

    /// The same for several batches: an empty tally of each.
    pub(crate) fn for_batches(self, batches: usize) -> Self {
        Self {
            values: vec![0.0; self.spec.len() * batches],
            batches,
            ..self
        }
    }

    /// Has what follows added to the sums of a batch.
    #[inline(always)]
    pub(crate) fn turn_to(&mut self, batch: usize) {
        assert!(batch < self.batches, "no tally of batch {batch}");
        self.batch = batch;
    }

    /// The tally of one of several batches.
    pub(crate) fn of_batch(&self, batch: usize) -> Self {
        Self {
            spec: self.spec,
            control_variate: self.control_variate,
            finder: self.finder.clone(),
            slice: self.slice,
            values: self.values[batch..]
                .iter()
                .step_by(self.batches)
                .copied()
                .collect(),
            batches: 1,
            batch: 0,
        }
    }

    /// Closes the tally: fractions of the incident flux, for a batch of `rays` rays of flux one.
    #[must_use]
    pub fn into_fractions(mut self, rays: u64) -> TallyValues {
        let spec = self.spec;
        if self.slice.is_none() {
            for side in spec.sides() {
                for ring in 0..spec.grid().n_theta() {
                    self.spread(side, ring);
                    for place in 0..spec.components().len() {
                        self.spread_component(side, ring, spec.places().component_start(place));
                    }
                }
            }
        }
        for side in Side::BOTH {
            self.sum_orders(side);
            for i in 0..spec.ring_filter(side).len() {
                self.sum_groups(|group| spec.places().rings_start(side, group) + i);
            }
            for i in 0..spec.in_plane_filter(side).len() {
                self.sum_groups(|group| spec.places().in_plane_start(side, group) + i);
            }
        }
        for i in 0..spec.grid().len() {
            let [single, multiple, all] =
                [0, 1, 2].map(|place| spec.places().bins_start(place) + i);
            self.values[all] = self.values[single] + self.values[multiple];
        }
        self.sum_measures();
        let per_ray = 1.0 / rays as f64;
        self.values.iter_mut().for_each(|v| *v *= per_ray);
        TallyValues::from_vec(spec, self.values)
    }

    /// Spreads one ring evenly over its bins and over the in-plane slice.
    fn spread(&mut self, side: Side, ring: usize) {
        let spec = self.spec;
        let fluxes = [0, 1, 2, 3].map(|group| {
            let flux = self.values[spec.places().rings_start(side, group) + ring];
            self.spread_in_plane(side, ring, spec.places().in_plane_start(side, group), flux);
            flux
        });
        let [first, second, third, more] = fluxes;
        for (place, flux) in [(0, first), (1, second + third + more)] {
            let [bins, hits] = [
                spec.places().bins_start(place),
                spec.places().hits_start(place),
            ];
            self.spread_over_bins(side, ring, [bins, hits], flux);
        }
    }

    /// The same for the component whose first entry is `start`.
    fn spread_component(&mut self, side: Side, ring: usize, start: usize) {
        let spec = self.spec;
        let flux = self.values[spec.places().rings_of_component(start, side) + ring];
        self.spread_in_plane(
            side,
            ring,
            spec.places().in_plane_of_component(start, side),
            flux,
        );
        let bins = start + 2;
        self.spread_over_bins(side, ring, [bins, bins + spec.grid().len()], flux);
    }

    /// Gives each half of the in-plane slice its fraction of the `flux` of a ring.
    fn spread_in_plane(&mut self, side: Side, ring: usize, start: usize, flux: f64) {
        // Each half of the slice is twice its half width wide.
        let fraction = 2.0 * self.spec.in_plane_half_width() / TAU;
        for half in Half::BOTH {
            let i = self.spec.in_plane_filter(side).number(ring, half);
            self.values[start + i] = fraction * flux;
        }
    }

    /// Gives each bin of a ring the part of its azimuths of the ring's `flux` and of its rays, which its first bin holds.
    fn spread_over_bins(&mut self, side: Side, ring: usize, [bins, hits]: [usize; 2], flux: f64) {
        let grid = self.spec.grid();
        let n_phi = grid.n_phi();
        let first = (side.index() * grid.n_theta() + ring) * n_phi;
        let rays = self.values[hits + first];
        for (start, of_ring) in [(bins, flux), (hits, rays)] {
            let values = self.values[start + first..][..n_phi].iter_mut();
            for (sector, value) in values.enumerate() {
                *value = grid.part_of_ring(side, sector, of_ring);
            }
        }
    }

    /// Sets the flux of a side, and that of it which was scattered more than once, from its orders.
    fn sum_orders(&mut self, side: Side) {
        let spec = self.spec;
        let orders = &self.values[spec.order_entries(side).range()];
        let multiple: f64 = orders[1..MAX_LISTED_ORDER].iter().sum();
        let all = orders[0] + multiple;
        self.values[spec.flux_entry(side, Component::All).0] = all;
        self.values[spec.flux_entry(side, Component::Multiple).0] = multiple;
        let first = usize::from(FIRST_GROUPED_ORDER) - 1;
        let grouped = self.values[spec.order_entries(side).range()][first..]
            .iter()
            .sum();
        let component = Component::OrderAndAbove(FIRST_GROUPED_ORDER);
        self.values[spec.flux_entry(side, component).0] = grouped;
    }

    /// Sets the entry of all orders to the sum of those of the groups.
    pub(crate) fn sum_groups(&mut self, entry: impl Fn(usize) -> usize) {
        let [first, second, third, more, all] = [0, 1, 2, 3, 4].map(entry);
        self.values[all] =
            self.values[first] + self.values[second] + self.values[third] + self.values[more];
    }
}

/// Where an exit counts: its ring, the half of the in-plane slice that holds it, and its entries.
#[derive(Clone, Copy)]
pub(crate) struct Direction {
    pub(crate) ring: usize,
    pub(crate) half: Option<Half>,
    pub(crate) target: Target,
}

impl Direction {
    /// Number of its bin among those of both sides.
    pub(crate) fn bin(&self, spec: &TallySpec, exit: &Exit) -> usize {
        let multiple = usize::from(exit.path.order() > 1);
        self.target.bin as usize - spec.places().bins_start(multiple)
    }

    /// Number of its in-plane bin, if it has one.
    pub(crate) fn in_plane(&self, spec: &TallySpec, side: Side) -> Option<usize> {
        let number = |half| spec.in_plane_filter(side).number(self.ring, half);
        self.half.map(number)
    }
}

#[cfg(test)]
mod tests;
