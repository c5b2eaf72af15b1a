//! Tallies: flux and rays by direction and component, their statistics, and the energy budget.
//!
//! A tally is a table of *scores* (flux, rays) by *filters* (side, component of the light, direction).
//! [`TallySpec`] says what is kept, a [`Tally`] collects what one batch of rays did, and closing it gives
//! [`TallyValues`]; [`TallyStatistics`] turns those of independent batches into means and standard
//! errors. All fluxes are *flux fractions*: relative to the flux that falls on the mean plane, so that they
//! add up.
//!
//! # Shapes
//! Results are read by the views of [`TallyResult`], never by position:
//!
//! | view | shape | geometry |
//! |---|---|---|
//! | `flux(side, component)` | one value | - |
//! | `orders(side)` | `[MAX_LISTED_ORDER]`, the last for higher orders too | - |
//! | `event_path(side, path)` | one value; `listed_paths` and `longer_paths` are all there are | - |
//! | `bins(side, component)` | `[n_theta, n_phi]`, theta from +z, phi from 0 or the first edge, row by row | [`BinFilter`] |
//! | `rings(side, component)` | `[n_theta]`, from +z | [`RingFilter`] |
//! | `in_plane(side, component)` | `[2 n_theta]`, from -90 to +90 degrees | [`InPlaneFilter`] |
//! | `apertures()` | one value per aperture | [`Apertures`] |
//! | `budget()` | seven values with names | [`Budget`] |
//!
//! [`Component`] is the one vocabulary for parts of the light; a component carries the names that tables
//! and plots show. Algorithms that treat all values alike (statistics, control variates, sums over
//! surfaces) work on [`TallyValues`] as wholes, or walk over [`Entry`]s. The order of entries in memory
//! is private.

mod binning;
mod exit;
mod scoring;
mod side;
mod spec;
mod statistics;
mod values;

pub use binning::aperture_windows::ApertureWindow;
pub use binning::exit_columns::{ExitColumns, ExitRows};
pub use exit::{Event, EventPath, Exit, Loss};
pub use scoring::control_variate::{ControlVariate, UnshadowedFluxes, VisibleFractions};
pub use scoring::joint::{JointExit, JointTallies};
pub use scoring::layout::TallyLayout;
pub use scoring::{Azimuth, Tallies, Tally};
pub use side::{Side, Sides};
pub use spec::apertures::{Aperture, ApertureShape, Apertures};
pub use spec::budget::Budget;
pub use spec::component::{Component, ComponentFilter, MAX_LISTED_ORDER};
pub use spec::edges::{BinStarts, SideEdges, SideEdgesError};
pub use spec::entry::{Entries, Entry, Score};
pub use spec::filters::{BinFilter, InPlaneFilter, RingFilter};
pub use spec::grid::{Bin, HemisphereGrid, HemisphereGridError};
pub use spec::offsets::MAX_LISTED_PATH;
pub use spec::polarimetry::{Measure, Polarimetry};
pub use spec::{SpecError, TallySpec};
pub use statistics::TallyStatistics;
pub use statistics::batches::{BatchStatistics, Estimate};
pub use statistics::few_rays::{RayErrors, is_of_few_rays, zero_variance_limit};
pub use statistics::mirror::Mirror;
pub use statistics::sample_groups::FEW_RAYS;
pub use statistics::surface_counts::SurfaceCounts;
pub use values::numbers::Numbers;
pub use values::side_fluxes::SideFluxes;
pub use values::views::{BinView, InPlaneView, RingView, TallyResult, View};
pub use values::{ByEntry, TallyValues};
