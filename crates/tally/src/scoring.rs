//! Scoring: tallies, which sum the flux and the rays of batches.

pub(crate) mod closing;
pub(crate) mod control_variate;
pub(crate) mod joint;
pub(crate) mod layout;

use std::ops::AddAssign;

use asperity_numerics::elementary::{exp2, log2, sin};

use crate::binning::BinFinder;
use crate::binning::aperture_windows::ApertureWindows;
use crate::binning::exit_columns::ExitColumns;
use crate::binning::in_plane::InPlaneSlice;
use crate::spec::filters::Half;
use crate::spec::offsets::{BinOffsets, Target};
use crate::{Aperture, Component, Exit, Loss, Score, Side, TallySpec, TallyValues};
use closing::close;
use control_variate::ControlVariate;

/// Direction from which the azimuths of exits are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Azimuth {
    /// The horizontal component of the light *travels* towards this azimuth, radians: that of `wi`
    /// plus half a turn.
    From(f64),
    /// No direction: every azimuth is as likely as any other, for example where light falls vertically on
    /// surfaces without a preferred direction. The azimuths of exits are ignored.
    ///
    /// When the tally is closed, the flux of a ring is spread evenly over its azimuths, and each half
    /// of the in-plane slice gets its fraction of the full turn. The number of rays is spread alike, so
    /// that a bin's is a fraction of its ring's and need not be whole.
    Free,
}

/// The largest weight in high parts of a contribution, of which each is [`LOW`] units. That makes `2^75` units, so that 128 bits hold the
/// sum of `2^51` contributions to an entry, of a block of `2^18` rays `2^33` per ray.
const HIGH: f64 = (1_u64 << 13) as f64;

/// Units in a high part, so that high and low parts fit into 64 bits.
const LOW: f64 = (1_u64 << LOW_DIGITS) as f64;
const LOW_DIGITS: u32 = 62;

/// Sums over one batch of rays.
///
/// Fluxes are added as integers of 128 bits, in units of `2^-75` of the largest weight of a path. Such sums are exact: no order of
/// rays and no division of a batch into parts, which `+=` joins again, changes a bit of them.
///
/// Under a [`ControlVariate`] it holds the difference: visible light that is
/// scattered once counts with one minus its visible fraction, and light that would be scattered
/// so but is shadowed or masked counts with minus that fraction. [`ControlVariate::complete`] adds the
/// mean of what was subtracted. Apertures have no part in it: all light that is visible counts in full.
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
    spec: TallySpec,
    control_variate: Option<&'c ControlVariate>,
    finder: BinFinder,
    /// `None` where the azimuth is free.
    slice: Option<InPlaneSlice>,
    windows: ApertureWindows,
    /// Exact sums of all batches, in units of flux: those of one entry side by side, since paths that start side by side often end in
    /// the same bin.
    sums: Vec<i128>,
    /// High parts in a flux of one.
    scale: f64,
    /// Units in a ray that is counted.
    hit: i128,
    /// Number of batches, and of the one that is added to.
    batches: usize,
    batch: usize,
}

impl<'c> Tally<'c> {
    /// An empty tally.
    ///
    /// # Panics
    /// If the azimuth is free and an aperture lies off the vertical.
    #[must_use]
    pub fn new(spec: TallySpec, azimuth: Azimuth) -> Self {
        let forward = match azimuth {
            Azimuth::From(forward) => forward,
            Azimuth::Free => 0.0,
        };
        let is_vertical = |one: Aperture| sin(one.theta).abs() < 1e-9;
        assert!(
            azimuth != Azimuth::Free || spec.apertures().iter().all(is_vertical),
            "apertures off the vertical need an azimuth"
        );
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
            windows: ApertureWindows::new(&spec, forward),
            sums: vec![0; spec.len()],
            scale: HIGH,
            hit: units(1.0, HIGH),
            batches: 1,
            batch: 0,
        }
    }

    /// Returns a tally under a control variate of the same spec, where there is one.
    #[must_use]
    pub fn with_control_variate(self, control_variate: Option<&'c ControlVariate>) -> Self {
        Self {
            control_variate,
            ..self
        }
    }

    /// Returns a tally of contributions of at most `weight`, in place of one. It holds the sum of `2^51` of them, each to less than `2^-74` of
    /// the weight.
    ///
    /// # Panics
    /// Unless `weight` is positive and finite.
    #[must_use]
    pub fn with_largest_weight(self, weight: f64) -> Self {
        assert!(
            weight > 0.0 && weight.is_finite(),
            "a largest weight of {weight}"
        );
        let scale = HIGH / exp2(log2(weight).ceil());
        Self {
            scale,
            hit: units(1.0, scale),
            ..self
        }
    }

    /// Returns `true` if light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.spec.records(side)
    }

    /// The control variate, under which shadowed and masked light counts too.
    #[must_use]
    pub const fn control_variate(&self) -> Option<&'c ControlVariate> {
        self.control_variate
    }

    /// This tally without sums and batches.
    fn clone_empty(&self) -> Self {
        Self {
            finder: self.finder.clone(),
            windows: self.windows.clone(),
            sums: Vec::new(),
            batches: 0,
            batch: 0,
            ..*self
        }
    }

    /// Adds light that left the surface: to its bins, or, on a side that is not recorded, to the flux
    /// that went there.
    pub fn add_exit(&mut self, exit: &Exit) {
        let at = self.direction(exit);
        self.book_apertures(self.windows.of(exit.side, exit.wo), exit);
        self.book(exit, self.weight(exit, at.ring) * exit.flux, &at);
    }

    /// Adds exits as [`Tally::add_exit`] does, whatever their batches, and removes them. Bins are found in loops that take the vector
    /// instructions of the function that calls this one.
    #[inline(always)]
    pub fn add_exits(&mut self, exits: &mut ExitColumns) {
        self.locate(exits);
        (0..exits.len()).for_each(|i| self.add_located(exits, i));
        exits.clear();
    }

    /// Finds the bins of exits, in loops that take the vector instructions of the function that calls this one.
    #[inline(always)]
    fn locate(&self, exits: &mut ExitColumns) {
        self.finder.locate(exits, self.slice.is_some());
        if let Some(slice) = &self.slice {
            slice.locate(exits);
        }
        self.windows.locate(exits);
        exits.find_targets(&self.spec.offsets());
    }

    /// Adds exit number `i` to the bins that [`Tally::locate`] has found: as [`Tally::add_exit`] does, or subtracted where it is masked.
    #[inline(always)]
    fn add_located(&mut self, exits: &ExitColumns, i: usize) {
        let exit = exits.exit(i);
        let ring = exits.ring[i] as usize;
        let weight = if exits.is_masked[i] {
            self.masked_weight(&exit, ring)
        } else {
            self.weight(&exit, ring)
        };
        let at = Direction::located(exits, i);
        self.book_apertures(exits.windows_of(i), &exit);
        self.book(&exit, weight * exit.flux, &at);
        if !exits.measures.is_empty() && !exits.is_masked[i] {
            self.book_measures(&exit, &exits.measures, i, &at);
        }
    }

    /// The factor with which light that left through a ring counts.
    #[inline(always)]
    fn weight(&self, exit: &Exit, ring: usize) -> f64 {
        match self.control_variate {
            Some(one) if exit.path.order() == 1 => 1.0 - one.fraction(exit.side, ring),
            _ => 1.0,
        }
    }

    /// The factor with which shadowed or masked light counts.
    #[inline(always)]
    fn masked_weight(&self, exit: &Exit, ring: usize) -> f64 {
        match self.control_variate {
            Some(one) if is_away(exit) => -one.fraction(exit.side, ring),
            _ => 0.0,
        }
    }

    /// Finds the ring, the half of the in-plane slice and the entries of an exit.
    fn direction(&self, exit: &Exit) -> Direction {
        let ring = self.finder.ring(exit.side, exit.wo);
        // Without azimuths the first bin counts for its ring until the tally is closed.
        let (sector, half) = match &self.slice {
            None => (0, None),
            Some(slice) => (self.finder.sector(exit.side, exit.wo), slice.half(exit.wo)),
        };
        let offsets = self.spec.offsets();
        Direction {
            ring,
            half,
            target: offsets.target(exit.side, exit.path, ring as u32, sector as u32),
        }
    }

    /// Adds `flux` to all entries that `exit` belongs to.
    #[inline(always)]
    fn book(&mut self, exit: &Exit, flux: f64, at: &Direction) {
        // Where the control variate cancels all of it, no ray of the bin is left either.
        if flux == 0.0 {
            return;
        }
        self.book_units(exit, self.units(flux), self.hit, at);
    }

    /// Adds a flux, and the rays that carry it, to all entries that `exit` belongs to.
    #[inline(always)]
    fn book_units<U: Units>(&mut self, exit: &Exit, flux: U, hit: impl Units, at: &Direction) {
        let spec = self.spec;
        if !spec.records(exit.side) {
            self.add_units_of_loss(Loss::NotRecorded, flux);
            return;
        }
        let (target, offsets) = (at.target, spec.offsets());
        let bin = target.bin as usize;
        self.add(target.order as usize, flux);
        self.add(target.path as usize, flux);
        self.add(target.ring as usize, flux);
        if self.slice.is_some() {
            self.add(bin, flux);
        }
        self.add(bin - offsets.bins(0) + offsets.hits(0), hit);
        if let Some(entry) = at.in_plane_entry(&spec, exit) {
            self.add(entry, flux);
        }
        if !spec.components().is_empty() {
            self.book_components(exit, flux, hit, at);
        }
    }

    /// Adds light to the apertures it falls into, of which `windows` has a bit for each that it may enter. No control variate has a part in them.
    #[inline(always)]
    fn book_apertures(&mut self, mut windows: u8, exit: &Exit) {
        if windows == 0 {
            return;
        }
        let (start, whole) = (self.spec.offsets().apertures_start(), self.units(exit.flux));
        while windows != 0 {
            let number = windows.trailing_zeros() as usize;
            windows &= windows - 1;
            let units = match self.windows.weight(number, exit.wo) {
                1.0 => whole,
                weight => self.units(weight * exit.flux),
            };
            self.add(start + number, units);
        }
    }

    /// Adds `flux` to the entries of each component kept in full that `exit` belongs to.
    fn book_components<U: Units>(&mut self, exit: &Exit, flux: U, hit: impl Units, at: &Direction) {
        let (offsets, grid) = (self.spec.offsets(), self.spec.grid());
        let side = exit.side.index();
        let bin = at.bin(&self.spec, exit);
        let ring = side * grid.n_theta() + at.ring;
        let in_plane = at.in_plane(&self.spec, exit.side);
        for (number, component) in self.spec.components().iter().enumerate() {
            if !component.accepts(exit) {
                continue;
            }
            let start = |score| offsets.of_component(number, score);
            self.add(start(Score::Flux) + side, flux);
            self.add(start(Score::RingFlux) + ring, flux);
            self.add(start(Score::BinHits) + bin, hit);
            if self.slice.is_some() {
                self.add(start(Score::BinFlux) + bin, flux);
            }
            if let Some(i) = in_plane {
                self.add(
                    start(Score::InPlaneFlux) + side * 2 * grid.n_theta() + i,
                    flux,
                );
            }
        }
    }

    /// Adds the measures of exit number `i`, which no control variate has a part in.
    fn book_measures(&mut self, exit: &Exit, measures: &[Vec<f64>], i: usize, at: &Direction) {
        let starts = self.measure_entries(exit, at);
        for (measure, column) in measures.iter().enumerate() {
            let units = self.units(column[i] * exit.flux);
            for start in starts.into_iter().flatten() {
                self.add(start + measure, units);
            }
        }
    }

    /// Entries of the first measure of an exit.
    fn measure_entries(&self, exit: &Exit, at: &Direction) -> [Option<usize>; 4] {
        let spec = self.spec;
        if !spec.records(exit.side) {
            return [None; 4];
        }
        let offsets = spec.offsets();
        let group = Component::order_group(exit.path.order()) as usize;
        let all_light = offsets.bins(2);
        let bin = self
            .slice
            .is_some()
            .then(|| all_light + at.bin(&spec, exit));
        let start = |flux| offsets.measures_at(offsets.bin_position(flux));
        [
            Some(offsets.measures_at(BinOffsets::flux_position(exit.side, group))),
            Some(start(at.target.ring as usize)),
            at.in_plane_entry(&spec, exit).map(start),
            bin.map(start),
        ]
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
        self.add_units_of_loss(loss, self.units(flux));
    }

    #[inline(always)]
    fn add_units_of_loss<U: Units>(&mut self, loss: Loss, flux: U) {
        let budget = TallySpec::BUDGET;
        match loss {
            Loss::Absorbed => self.add(budget.absorbed.0, flux),
            Loss::Truncated => self.add(budget.truncated.0, flux),
            Loss::Lost => self.add(budget.lost.0, flux),
            Loss::LeftPatch => {
                self.add(budget.truncated.0, flux);
                self.add(budget.left_patch.0, flux);
            }
            Loss::NotRecorded => {
                self.add(budget.truncated.0, flux);
                self.add(budget.not_recorded.0, flux);
            }
        }
    }

    /// A flux in units, of which sums are made.
    #[inline(always)]
    fn units(&self, flux: f64) -> i128 {
        units(flux, self.scale)
    }

    /// Adds units to the sum of an entry.
    #[inline(always)]
    fn add<U: Units>(&mut self, entry: usize, units: U) {
        units.add_to(&mut self.sums[entry * self.batches + self.batch..]);
    }

    /// Closes the tally: fractions of the incident flux, for a batch of `rays` rays of flux one.
    #[must_use]
    pub fn into_fractions(self, rays: u64) -> TallyValues {
        self.fractions_of_batch(0, rays)
    }

    /// Fractions of the incident flux in one of several batches.
    fn fractions_of_batch(&self, batch: usize, rays: u64) -> TallyValues {
        let sums = self.sums[batch..].iter().step_by(self.batches);
        let unit = 1.0 / (self.scale * LOW * rays as f64);
        let fractions = sums.map(|&sum| sum as f64 * unit).collect();
        close(self.spec, self.slice.is_none(), fractions)
    }
}

/// Adds the sums of the same batches, of which these rays were not yet a part.
///
/// # Panics
/// If the tallies are of different specs, batches or largest weights.
impl AddAssign<&Self> for Tally<'_> {
    fn add_assign(&mut self, other: &Self) {
        let key = |tally: &Self| (tally.sums.len(), tally.batches, tally.scale);
        assert_eq!(key(self), key(other), "sums of different tallies");
        let pairs = self.sums.iter_mut().zip(&other.sums);
        pairs.for_each(|(sum, other)| *sum += other);
    }
}

/// Returns `true` if an exit leads away from the surface on its side.
const fn is_away(exit: &Exit) -> bool {
    match exit.side {
        Side::Reflected => exit.wo.z > 0.0,
        Side::Transmitted => exit.wo.z < 0.0,
    }
}

/// A flux in units, with `scale` high parts in a flux of one: what is below one unit is cut off.
///
/// # Panics
/// If it is no number, or `2^49` times the largest weight.
#[inline(always)]
fn units(flux: f64, scale: f64) -> i128 {
    let scaled = flux * scale;
    assert!(scaled.abs() < LOW, "a flux of {flux}");
    let high = scaled as i64;
    let low = ((scaled - high as f64) * LOW) as i64;
    (i128::from(high) << LOW_DIGITS) + i128::from(low)
}

/// Units that are added to the sums of an entry: of one batch, or of several side by side.
trait Units: Copy {
    /// Adds them to the first sums.
    fn add_to(self, sums: &mut [i128]);
}

impl Units for i128 {
    #[inline(always)]
    fn add_to(self, sums: &mut [i128]) {
        sums[0] += self;
    }
}

impl Units for &[i128] {
    #[inline(always)]
    fn add_to(self, sums: &mut [i128]) {
        let pairs = sums[..self.len()].iter_mut().zip(self);
        pairs.for_each(|(sum, units)| *sum += units);
    }
}

/// Direction of an exit: its ring, the half of the in-plane slice that holds it, and its entries.
#[derive(Clone, Copy)]
struct Direction {
    ring: usize,
    half: Option<Half>,
    target: Target,
}

impl Direction {
    /// That of exit number `i`, which [`Tally::locate`] has found.
    #[inline(always)]
    fn located(exits: &ExitColumns, i: usize) -> Self {
        Self {
            ring: exits.ring[i] as usize,
            half: exits.slice.get(i).and_then(|slice| slice.half()),
            target: exits.targets[i],
        }
    }

    /// Number of its bin among those of both sides.
    fn bin(&self, spec: &TallySpec, exit: &Exit) -> usize {
        let multiple = usize::from(exit.path.order() > 1);
        self.target.bin as usize - spec.offsets().bins(multiple)
    }

    /// Number of its in-plane bin, if it has one.
    #[inline(always)]
    fn in_plane(&self, spec: &TallySpec, side: Side) -> Option<usize> {
        let number = |half| spec.in_plane_filter(side).number(self.ring, half);
        self.half.map(number)
    }

    /// Entry of the flux of its order in its in-plane bin, if it has one.
    #[inline(always)]
    fn in_plane_entry(&self, spec: &TallySpec, exit: &Exit) -> Option<usize> {
        let group = Component::order_group(exit.path.order()) as usize;
        let start = spec.offsets().in_plane(exit.side, group);
        Some(start + self.in_plane(spec, exit.side)?)
    }
}

/// One [`Tally`] for each of several batches, all of the same spec, azimuth and control variate.
#[derive(Clone, Debug)]
pub struct Tallies<'c>(Tally<'c>);

impl<'c> Tallies<'c> {
    /// An empty tally like `empty` for each of several batches.
    #[must_use]
    pub fn new(empty: Tally<'c>, batches: usize) -> Self {
        Self(Tally {
            sums: vec![0; empty.spec.len() * batches],
            batches,
            ..empty
        })
    }

    /// Returns `true` if light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.0.records(side)
    }

    /// The control variate, under which shadowed and masked light counts too.
    #[must_use]
    pub const fn control_variate(&self) -> Option<&'c ControlVariate> {
        self.0.control_variate()
    }

    /// The tally of batch number `batch`.
    ///
    /// # Panics
    /// If there are not so many batches.
    #[inline(always)]
    pub fn of(&mut self, batch: u32) -> &mut Tally<'c> {
        let batch = batch as usize;
        assert!(batch < self.0.batches, "no tally of batch {batch}");
        self.0.batch = batch;
        &mut self.0
    }

    /// Finds the bins of exits, in loops that take the vector instructions of the function that calls this one.
    #[inline(always)]
    pub fn locate(&self, exits: &mut ExitColumns) {
        self.0.locate(exits);
    }

    /// Adds exits to the bins that [`Tallies::locate`] has found, in the tallies of their batches, and removes them: as [`Tally::add_exit`]
    /// does, or subtracted where they are masked.
    pub fn add_located(&mut self, exits: &mut ExitColumns) {
        for i in 0..exits.len() {
            self.of(exits.batch[i]).add_located(exits, i);
        }
        exits.clear();
    }

    /// Closes the tallies: fractions of the incident flux, for batches of `rays` rays of flux one each.
    #[must_use]
    pub fn into_fractions(self, rays: u64) -> Vec<TallyValues> {
        let batches = 0..self.0.batches;
        batches
            .map(|batch| self.0.fractions_of_batch(batch, rays))
            .collect()
    }
}

/// Adds the sums of other rays of the same batches, in any order.
///
/// # Panics
/// If the tallies are of different specs, batches or largest weights.
impl AddAssign<&Self> for Tallies<'_> {
    fn add_assign(&mut self, other: &Self) {
        self.0 += &other.0;
    }
}

#[cfg(test)]
mod tests;
