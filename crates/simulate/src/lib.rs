//! The engine: from cases and settings to tallies with errors.
//!
//! [`trace`](trace::trace) and [`trace_mesh`](trace::trace_mesh) send light onto one surface; [`Sharing`] draws fresh surfaces and
//! sends the light of every case that shares them onto each. Threads and the random streams of rays live here.
//!
//! # Random streams
//! Every block of rays has its own stream, keyed by (seed, realisation, block), and results are
//! reduced in the order of their index. The same configuration gives the same bytes, whatever the
//! number of threads.

#![allow(missing_docs, reason = "the public interface is about to be narrowed")]
#![allow(
    clippy::must_use_candidate,
    clippy::missing_errors_doc,
    reason = "as above"
)]

mod blocks;
mod budget;
mod case;
mod ensemble;
mod error;
mod estimator;
mod facet_control;
mod known;
mod layer;
mod limits;
mod mesh_error;
mod method;
mod pilot;
mod progress;
mod sharing;
mod slopes;
mod stopping;
mod stream;
mod target;
mod text;
mod trace;
mod work;

pub use blocks::{LitMesh, RaySettings};
pub use budget::{ErrorBudget, Errors};
pub use case::Case;
pub use ensemble::{Ensemble, Group, Seconds};
pub use error::SimulateError;
pub use estimator::Estimator;
pub use layer::{BottomSurface, layer_folder, layer_name, substrate};
pub use limits::{
    RunError, check_grazing, check_memory, check_results, hierarchy_bytes, meshes_bytes,
    traced_bytes,
};
pub use mesh_error::{MeshErrors, Refinement, finer};
pub use method::{ControlMean, Method, with_least_errors};
pub use progress::{Deadline, Progress, Silent, StoppedBy};
pub use sharing::{MESH_ALLOWANCE, RunPlan, Sharing, Traced};
pub use slopes::slopes;
pub use stopping::{PilotFigures, Stopping};
pub use stream::{convergence_stream, picture_stream, point_stream, ray_stream};
pub use target::{Aim, Target, TargetError};
pub use text::{error_in_short, short};
pub use trace::{Scene, TraceOutcome, trace, trace_mesh};
pub use work::{SummaryWork, Used};
