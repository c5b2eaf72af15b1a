//! Tally spec: which quantities a tally keeps, for which components, over which bins.
//!
//! The order of the entries is private to this crate: see `spec/offsets.rs`.

pub(crate) mod apertures;
pub(crate) mod budget;
pub(crate) mod component;
pub(crate) mod edges;
pub(crate) mod entry;
pub(crate) mod filters;
pub(crate) mod grid;
pub(crate) mod offsets;
pub(crate) mod polarimetry;

use std::ops::Range;

use serde::{Deserialize, Deserializer, Serialize};

use crate::{EventPath, Side, Sides};
use apertures::Apertures;
use budget::Budget;
use component::{Component, MAX_LISTED_ORDER};
use entry::{Entries, Entry, Score};
use filters::{BinFilter, InPlaneFilter, RingFilter};
use grid::HemisphereGrid;
use offsets::{BinOffsets, MAX_LISTED_PATH, PATH_ENTRIES};
use polarimetry::{Measure, Polarimetry};

/// Reason for which a tally spec is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpecError {
    /// The half width of the in-plane slice is out of range.
    #[error("the in-plane half width is {0} deg; it must be above 0 and at most 90 deg")]
    BadHalfWidth(f64),
}

/// Tally spec: the quantities that a tally keeps, filtered by side, component and direction.
///
/// | score | filters |
/// |---|---|
/// | budget: [`Budget`] | - |
/// | flux | side; all, multiple, four and above, and each order up to [`MAX_LISTED_ORDER`], the last for that and above |
/// | flux by event path | side; all strings up to [`MAX_LISTED_PATH`], one entry for longer ones |
/// | flux into bins | side; single, multiple, all; `[n_theta, n_phi]` |
/// | flux into rings | side; [`Component::ORDERS`], all; `[n_theta]` |
/// | flux into in-plane bins | side; [`Component::ORDERS`], all; `[2 n_theta]` |
/// | rays in bins | side; single, multiple; `[n_theta, n_phi]` |
/// | flux into apertures | [`Apertures`], of all light |
///
/// Each of [`TallySpec::components`] has flux, bins, rays, rings and in-plane bins besides. Entries of a
/// side that is not recorded keep their positions and stay zero.
///
/// # Examples
/// ```
/// use asperity_tally::{Component, HemisphereGrid, Side, Sides, TallySpec};
///
/// let grid = HemisphereGrid::new(18, 36)?;
/// let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH)?.with_sides(Sides::Reflected);
/// assert!(spec.records(Side::Reflected) && !spec.records(Side::Transmitted));
/// assert_eq!(spec.bin_filter(Side::Reflected).shape(), [18, 36]);
/// assert_eq!(spec.bin_entries(Side::Reflected, Component::Multiple).len(), 18 * 36);
/// assert_eq!(spec.in_plane_filter(Side::Reflected).theta_deg(35), [85.0, 90.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TallySpec {
    grid: HemisphereGrid,
    in_plane_half_width: f64,
    sides: Sides,
    #[serde(deserialize_with = "components_by_name")]
    components: &'static [Component],
    polarimetry: Polarimetry,
    apertures: Apertures,
}

/// Reads the names of components that a spec of this crate keeps: none, or those of the medium.
fn components_by_name<'de, D: Deserializer<'de>>(
    source: D,
) -> Result<&'static [Component], D::Error> {
    let names = Vec::<String>::deserialize(source)?;
    let known: [&'static [Component]; 2] = [&[], &Component::MEDIUM];
    let found = known.into_iter().find(|known| {
        let known = known.iter().map(|component| component.name());
        known.eq(names.iter().map(String::as_str))
    });
    found.ok_or_else(|| {
        serde::de::Error::custom(format!(
            "this program has no tally of the components {names:?}"
        ))
    })
}

impl TallySpec {
    /// Default half width of the in-plane slice, radians (5 degrees).
    pub const DEFAULT_HALF_WIDTH: f64 = 5.0 * std::f64::consts::PI / 180.0;

    /// Entries of the budget, which all specs share.
    pub const BUDGET: Budget<Entry> = Budget {
        reflected: Entry(0),
        transmitted: Entry(1),
        absorbed: Entry(2),
        truncated: Entry(3),
        lost: Entry(4),
        left_patch: Entry(5),
        not_recorded: Entry(6),
    };

    /// A spec over `grid` whose in-plane bins take directions within `half_width` radians of the plane
    /// of incidence. It records both sides, and no component of the medium.
    ///
    /// # Errors
    /// [`SpecError::BadHalfWidth`] unless `0 < half_width <= pi / 2`.
    pub fn new(grid: HemisphereGrid, half_width: f64) -> Result<Self, SpecError> {
        if !(half_width > 0.0 && half_width <= std::f64::consts::FRAC_PI_2) {
            return Err(SpecError::BadHalfWidth(half_width.to_degrees()));
        }
        Ok(Self {
            grid,
            in_plane_half_width: half_width,
            ..Self::default()
        })
    }

    /// Returns a spec of these quantities over other bins, in an in-plane slice of at most `half_width` radians.
    ///
    /// # Panics
    /// Unless `half_width > 0`.
    #[must_use]
    pub fn with_bins(self, grid: HemisphereGrid, half_width: f64) -> Self {
        assert!(half_width > 0.0, "an in-plane half width of {half_width}");
        Self {
            grid,
            in_plane_half_width: self.in_plane_half_width.min(half_width),
            ..self
        }
    }

    /// Returns a spec of these entries, of which those of `sides` alone are filled.
    #[must_use]
    pub const fn with_sides(self, sides: Sides) -> Self {
        Self { sides, ..self }
    }

    /// Returns a spec of these entries, followed by those of each of `components`, which replace any given before.
    #[must_use]
    pub const fn with_components(self, components: &'static [Component]) -> Self {
        Self { components, ..self }
    }

    /// Returns a spec of these entries, followed by those of [`Component::MEDIUM`].
    #[must_use]
    pub const fn with_medium(self) -> Self {
        self.with_components(&Component::MEDIUM)
    }

    /// Returns a spec of these entries, followed by measures of polarised light: of flux, rings and in-plane bins of [`Component::RINGS`], and of
    /// bins of all light.
    #[must_use]
    pub const fn with_polarimetry(self, polarimetry: Polarimetry) -> Self {
        Self {
            polarimetry,
            ..self
        }
    }

    /// Returns a spec of these entries and the flux into apertures, which replace any given before.
    #[must_use]
    pub const fn with_apertures(self, apertures: Apertures) -> Self {
        Self { apertures, ..self }
    }

    /// Apertures whose flux is kept.
    #[must_use]
    pub const fn apertures(&self) -> &Apertures {
        &self.apertures
    }

    /// Flux into each aperture, in their order.
    #[must_use]
    pub const fn aperture_entries(&self) -> Entries {
        Entries::new(self.offsets().apertures_start(), self.apertures.len())
    }

    /// Measures kept of polarised light.
    #[must_use]
    pub const fn polarimetry(&self) -> Polarimetry {
        self.polarimetry
    }

    /// A measure of polarised light that goes with a flux entry; `None` if it is not kept there.
    #[must_use]
    pub fn measure_entry(&self, flux: Entry, measure: Measure) -> Option<Entry> {
        let index = self.polarimetry.index(measure)?;
        Some(Entry(self.offsets().measures_of(flux)? + index))
    }

    /// Components kept in full in addition to the surface's orders: [`Component::MEDIUM`] with a medium.
    #[must_use]
    pub const fn components(&self) -> &'static [Component] {
        self.components
    }

    /// Returns `true` if [`Component::MEDIUM`] is recorded.
    #[must_use]
    pub fn has_medium(&self) -> bool {
        self.components.iter().any(|c| c.is_of_medium())
    }

    /// Components that all light is split into, which add up to it: by scatterings in the medium where these are recorded, otherwise by
    /// interactions with the surface.
    #[must_use]
    pub fn split(&self) -> &'static [Component] {
        if self.has_medium() {
            &Component::MEDIUM
        } else {
            &Component::SURFACE
        }
    }

    /// Returns `true` if light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.sides.includes(side)
    }

    /// The sides that are recorded, in the order of the bins.
    pub fn sides(&self) -> impl Iterator<Item = Side> + Clone + use<> {
        let sides = self.sides;
        Side::BOTH
            .into_iter()
            .filter(move |&side| sides.includes(side))
    }

    /// The grid of bins.
    #[must_use]
    pub const fn grid(&self) -> HemisphereGrid {
        self.grid
    }

    /// Half width of the in-plane slice, radians.
    #[must_use]
    pub const fn in_plane_half_width(&self) -> f64 {
        self.in_plane_half_width
    }

    /// Geometry of the bins of `side`.
    #[must_use]
    pub const fn bin_filter(&self, side: Side) -> BinFilter {
        BinFilter {
            grid: self.grid,
            side,
        }
    }

    /// Geometry of the rings of `side`.
    #[must_use]
    pub const fn ring_filter(&self, side: Side) -> RingFilter {
        RingFilter {
            grid: self.grid,
            side,
        }
    }

    /// Geometry of the in-plane bins of `side`.
    #[must_use]
    pub const fn in_plane_filter(&self, side: Side) -> InPlaneFilter {
        InPlaneFilter {
            grid: self.grid,
            half_width: self.in_plane_half_width,
            side,
        }
    }

    /// Number of in-plane bins per side.
    #[must_use]
    pub const fn in_plane_len(&self) -> usize {
        2 * self.grid.n_theta()
    }

    pub(crate) const fn offsets(&self) -> BinOffsets {
        BinOffsets {
            grid: self.grid,
            components: self.components,
            polarimetry: self.polarimetry,
            apertures: self.apertures.len(),
        }
    }

    /// Number of entries.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.offsets().len()
    }

    /// Returns `false`: a spec has at least its budget.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// All entries.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = Entry> + Clone + use<> {
        Entries::new(0, self.len()).iter()
    }

    /// Returns `true` if `score` is kept for `component`.
    #[must_use]
    pub fn keeps(&self, score: Score, component: Component) -> bool {
        let found = self.offsets().find(score, Side::Reflected, component);
        found.is_some()
    }

    /// Entries of a component that left on `side`: one of flux, and as many as there are bins, rings or in-plane bins.
    ///
    /// With [`crate::Azimuth::Free`] every bin of a ring has the same part of the ring's rays, which need not be a whole number of rays.
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn component_entries(&self, score: Score, side: Side, component: Component) -> Entries {
        match self.offsets().find(score, side, component) {
            Some(entries) => entries,
            None => panic!("the tally keeps no {score} of the component {component}"),
        }
    }

    /// Flux of a component that left on `side`.
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn flux_entry(&self, side: Side, component: Component) -> Entry {
        self.component_entries(Score::Flux, side, component).get(0)
    }

    /// Flux of each order of scattering that left on `side`; the last is that of
    /// [`MAX_LISTED_ORDER`] and above.
    #[must_use]
    pub const fn order_entries(&self, side: Side) -> Entries {
        BinOffsets::orders(side)
    }

    /// Flux of one order of scattering that left on `side`: orders above [`MAX_LISTED_ORDER`] share its
    /// entry.
    #[must_use]
    pub fn order_entry(&self, side: Side, order: usize) -> Entry {
        self.order_entries(side)
            .get(order.clamp(1, MAX_LISTED_ORDER) - 1)
    }

    /// Flux of one event path; paths longer than [`MAX_LISTED_PATH`] share an entry.
    #[must_use]
    pub fn event_path_entry(&self, side: Side, path: EventPath) -> Entry {
        let order = path.order() as usize;
        let entry = if (1..=MAX_LISTED_PATH).contains(&order) {
            (1 << order) - 2 + path.code() as usize
        } else {
            PATH_ENTRIES - 1
        };
        BinOffsets::paths(side).get(entry)
    }

    /// All event paths with an entry of their own.
    pub fn listed_paths(&self) -> impl Iterator<Item = EventPath> + use<> {
        (1..=MAX_LISTED_PATH as u32)
            .flat_map(|order| (0..1 << order).map(move |code| EventPath::from_code(order, code)))
    }

    /// Entry of all event paths of `side` longer than [`MAX_LISTED_PATH`].
    #[must_use]
    pub fn longer_paths_entry(&self, side: Side) -> Entry {
        BinOffsets::paths(side).get(PATH_ENTRIES - 1)
    }

    /// Flux into the bins of `side`, in the order of [`BinFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn bin_entries(&self, side: Side, component: Component) -> Entries {
        self.component_entries(Score::BinFlux, side, component)
    }

    /// Rays per incident ray that reached the bins of `side`.
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn hit_entries(&self, side: Side, component: Component) -> Entries {
        self.component_entries(Score::BinHits, side, component)
    }

    /// Flux into the bins of both sides, in the order of [`HemisphereGrid`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn grid_entries(&self, component: Component) -> Entries {
        let start = self.bin_entries(Side::Reflected, component).start;
        Entries::new(start, self.grid.len())
    }

    /// Flux into the bins of the sides that are recorded, in the order of [`HemisphereGrid`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn recorded_entries(&self, component: Component) -> Entries {
        let bins = self.recorded_bins();
        let start = self.grid_entries(component).start;
        Entries::new(start + bins.start, bins.len())
    }

    /// Numbers of the grid's bins on the sides that are recorded.
    #[must_use]
    pub const fn recorded_bins(&self) -> Range<usize> {
        let of_a_side = self.grid.bins_per_side();
        match self.sides {
            Sides::Both => 0..2 * of_a_side,
            Sides::Reflected => 0..of_a_side,
            Sides::Transmitted => of_a_side..2 * of_a_side,
        }
    }

    /// Flux into the rings of `side`, in the order of [`RingFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn ring_entries(&self, side: Side, component: Component) -> Entries {
        self.component_entries(Score::RingFlux, side, component)
    }

    /// Flux into the in-plane bins of `side`, in the order of [`InPlaneFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn in_plane_entries(&self, side: Side, component: Component) -> Entries {
        self.component_entries(Score::InPlaneFlux, side, component)
    }
}

impl Default for TallySpec {
    /// The default grid, an in-plane half width of 5 degrees, both sides, and no medium.
    fn default() -> Self {
        Self {
            grid: HemisphereGrid::default(),
            in_plane_half_width: Self::DEFAULT_HALF_WIDTH,
            sides: Sides::Both,
            components: &[],
            polarimetry: Polarimetry::Nothing,
            apertures: Apertures::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_paths_and_high_orders_share_the_last_entry() {
        let spec = TallySpec::default();
        let long = EventPath::from_code(MAX_LISTED_PATH as u32 + 1, 0);
        let side = Side::Reflected;
        assert_eq!(
            spec.event_path_entry(side, long),
            spec.longer_paths_entry(side)
        );
        assert_eq!(
            spec.order_entry(side, 1000),
            spec.order_entry(side, MAX_LISTED_ORDER)
        );
        let last = Component::OrderAndAbove(MAX_LISTED_ORDER as u8);
        assert_eq!(spec.flux_entry(side, last), spec.order_entry(side, 1000));
    }

    #[test]
    fn sides_that_are_not_recorded_keep_their_entries() {
        for sides in [Sides::Both, Sides::Reflected, Sides::Transmitted] {
            let spec = TallySpec::default().with_sides(sides);
            assert!(spec.sides().all(|side| spec.records(side)));
            assert_eq!(spec.len(), TallySpec::default().len());
            let grid = spec.grid();
            let recorded = (0..grid.len()).filter(|&i| spec.records(grid.bin(i).side));
            assert!(spec.recorded_bins().eq(recorded), "{sides}");
            let entries = spec
                .sides()
                .flat_map(|s| spec.bin_entries(s, Component::All).iter());
            assert!(spec.recorded_entries(Component::All).iter().eq(entries));
        }
        let one = TallySpec::default().with_sides(Sides::Transmitted);
        assert!(one.sides().eq([Side::Transmitted]));
    }

    #[test]
    fn a_component_is_kept_where_the_table_says() {
        let plain = TallySpec::default();
        let [first, .., fourth] = Component::ORDERS;
        assert!(plain.keeps(Score::RingFlux, fourth) && !plain.keeps(Score::BinFlux, fourth));
        assert!(plain.keeps(Score::BinFlux, first));
        assert!(!plain.keeps(Score::InPlaneFlux, Component::Multiple));
        for score in [
            Score::Flux,
            Score::BinFlux,
            Score::BinHits,
            Score::RingFlux,
            Score::InPlaneFlux,
        ] {
            assert!(!plain.keeps(score, Component::ScatteredOnce));
            assert!(plain.with_medium().keeps(score, Component::ScatteredOnce));
        }
    }
}
