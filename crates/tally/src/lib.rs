//! Where light went: tallies over directions and components, their statistics, and the energy budget.
//!
//! A tally is a table of *scores* (flux, rays) by *filters* (side, component of the light, direction).
//! [`TallySpec`] says what is kept, a [`Tally`] collects what one batch of rays did, and closing it gives
//! [`TallyValues`]; [`TallyStatistics`] turns those of independent batches into means and standard
//! errors. All fluxes are *flux fractions*: relative to the flux that falls on the mean plane, so that they
//! add up.
//!
//! # Shapes
//! Results are read by the views of [`TallyResult`], never by place:
//!
//! | view | shape | geometry |
//! |---|---|---|
//! | `flux(side, component)` | one value | - |
//! | `orders(side)` | `[MAX_LISTED_ORDER]`, the last for higher orders too | - |
//! | `event_path(side, path)` | one value; `listed_paths` and `longer_paths` are all there are | - |
//! | `bins(side, component)` | `[n_theta, n_phi]`, theta from +z, phi from 0 or the first edge, row by row | [`BinFilter`] |
//! | `rings(side, component)` | `[n_theta]`, from +z | [`RingFilter`] |
//! | `in_plane(side, component)` | `[2 n_theta]`, from -90 to +90 degrees | [`InPlaneFilter`] |
//! | `budget()` | seven values with names | [`Budget`] |
//!
//! [`Component`] is the one vocabulary for parts of the light; a component carries the names that tables
//! and plots show. Algorithms that treat all values alike (statistics, control variates, sums over
//! surfaces) work on [`TallyValues`] as wholes, or walk over [`Entry`]s. The order of entries in memory
//! is private.

mod budget;
mod closing;
mod component;
mod control_variate;
mod describe;
mod edge_finder;
mod edges;
mod entry;
mod events;
mod exit;
mod exit_columns;
mod few_rays;
mod filters;
mod finder;
mod grid;
mod in_plane;

mod measured_places;
mod measures;
mod mirror;
mod numbers;
mod places;
mod polarimetry;
mod result;
mod side;
mod sides;
mod spec;
mod statistics;
mod tallies;
mod tally;
mod tally_statistics;
mod target;
mod values;

pub use budget::Budget;
pub use component::{Component, ComponentFilter, MAX_LISTED_ORDER};
pub use control_variate::{ControlVariate, UnshadowedFluxes, VisibleFractions};
pub use edges::{SideEdges, SideEdgesError};
pub use entry::{Entries, Entry, EntryDescription, Score};
pub use events::{Event, EventPath};
pub use exit::{Exit, Loss};
pub use exit_columns::{ExitColumns, ExitRows};
pub use few_rays::{FEW_RAYS, RayErrors, rests_on_few_rays};
pub use filters::{BinFilter, InPlaneFilter, RingFilter};
pub use grid::{Bin, HemisphereGrid, HemisphereGridError};

pub use mirror::Mirror;
pub use numbers::Numbers;
pub use places::MAX_LISTED_PATH;
pub use polarimetry::{Measure, Polarimetry};
pub use result::{BinView, InPlaneView, RingView, TallyResult, View};
pub use side::Side;
pub use sides::Sides;
pub use spec::{SpecError, TallySpec};
pub use statistics::{BatchStatistics, Estimate};
pub use tallies::Tallies;
pub use tally::{Azimuth, Tally};
pub use tally_statistics::TallyStatistics;
pub use values::{ByEntry, SideFluxes, TallyValues};
