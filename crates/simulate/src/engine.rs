//! Engine: runs cases, in the order of the folders.
//!
//! [`simulation`] is the entry point. `prepare` puts cases with equal surface sources into a [`group`](prepare::group) and decides how each
//! [case](prepare::case_run) is estimated. `draw` makes the surfaces and has them prepared for tracing. `plan` finds the effort that a
//! target error takes, by a [pilot run](plan::pilot): [spacing](plan::spacings), [paths](plan::path_trial), surfaces and rays. `trace`
//! divides the rays of a surface into [blocks](trace::blocks), and runs [rounds](trace::rounds) of batches, which are surfaces, regions, or
//! blocks of rays on one given surface. `reduce` turns the [tallies](reduce::tallies) of a case into its outcome.

pub(crate) mod context;
pub(crate) mod draw;
pub(crate) mod plan;
pub(crate) mod prepare;
pub(crate) mod reduce;
pub(crate) mod simulation;
pub(crate) mod trace;
