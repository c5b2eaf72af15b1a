//! How rays are divided, traced and added until an error is reached.
//!
//! [`simulation`] is the entry point. It puts cases with equal surface sources into a [`group`]: an [`ensemble`] of surfaces, which are
//! drawn by recipes ([`draw`]), given, or regions of a given one, or one given surface ([`given`]). Both run [`rounds`] of batches, which are
//! surfaces in [`surfaces`], and [`ray_blocks`] in [`given_run`]; [`blocks`] divides the rays of one surface, [`block_run`] traces them, and
//! [`built_surface`] is what they are traced on. [`pilot`] and [`random_plan`] plan the effort that a target error takes, [`spacings`] chooses
//! the spacing, [`path_trial`] and
//! [`random_paths`] the paths; [`watch`] shows how near the run has come. [`draft`] turns what was found of a case into
//! its outcome. [`explanation`] says what is about to be traced, and why.

pub(crate) mod block_run;
pub(crate) mod blocks;
pub(crate) mod built_surface;
pub(crate) mod context;
pub(crate) mod draft;
pub(crate) mod draw;
pub(crate) mod ensemble;
pub(crate) mod ensemble_rounds;
mod explanation;
pub(crate) mod given;
pub(crate) mod given_run;
pub(crate) mod group;
pub(crate) mod path_trial;
pub(crate) mod pilot;
pub(crate) mod random_paths;
pub(crate) mod random_plan;
pub(crate) mod ray_blocks;
pub(crate) mod ready_group;
pub(crate) mod rounds;
pub(crate) mod simulation;
pub(crate) mod spacings;
pub(crate) mod surfaces;
pub(crate) mod tallies;
pub(crate) mod traced_case;
pub(crate) mod watch;
