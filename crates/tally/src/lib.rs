//! Where light went: hemispherical histograms, batch statistics and the energy budget.
//!
//! A [`Record`] collects what one batch of rays did: every [`Exit`] goes into the bins of a
//! [`HemisphereGrid`], the in-plane profile, the list of orders and the list of event paths. All
//! quantities are *flux fractions*: shares of the flux that falls on the mean plane, so that they
//! add up. [`Layout`] says where in the record a quantity stands, and [`BatchStatistics`] turns
//! independent batches into means and standard errors.

mod control;
mod events;
mod finder;
mod grid;
mod history;
mod layout;
mod record;
mod sides;
mod statistics;
mod wedge;

pub use control::{Control, UnshadowedFluxes, VisibleShares};
pub use events::{Event, EventPath};
pub use grid::{Bin, HemisphereGrid, HemisphereGridError, Side};
pub use history::History;
pub use layout::{Layout, LayoutError, MAX_LISTED_ORDER, MAX_LISTED_PATH, OrderClass, Share};
pub use record::{Azimuth, Exit, Loss, Record};
pub use sides::Sides;
pub use statistics::{BatchStatistics, Estimate};
