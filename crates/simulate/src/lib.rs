//! The engine: from cases and settings to tallies with errors.
//!
//! [`trace`](engine::trace::trace) and [`trace_mesh`](engine::trace::trace_mesh) send light onto one surface; [`Sharing`] draws fresh surfaces and
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

mod engine;
mod error;
mod errors;
mod input;
mod methods;
mod observer;
mod output;
mod slopes;
mod stream;
mod text;

pub use engine::blocks::{LitMesh, RaySettings};
pub use engine::ensemble::{Ensemble, Group, Seconds};
pub use engine::sharing::{MESH_ALLOWANCE, RunPlan, Sharing, Traced};
pub use engine::trace::{Scene, TraceOutcome, trace, trace_mesh};
pub use error::SimulateError;
pub use errors::budget::{ErrorBudget, Errors};
pub use errors::mesh_error::{MeshErrors, Refinement, finer};
pub use input::case::Case;
pub use input::estimator::Estimator;
pub use input::layer::{BottomSurface, layer_folder, layer_name, substrate};
pub use input::limits::{
    RunError, check_grazing, check_memory, check_results, hierarchy_bytes, meshes_bytes,
    traced_bytes,
};
pub use input::target::{Quantity, Target, TargetError};
pub use methods::method::{ControlMean, Method, with_least_errors};
pub use observer::{Deadline, Observer, Silent, StoppedBy};
pub use output::stopping::{PilotFigures, Stopping};
pub use output::work::{SummaryWork, Used};
pub use slopes::slopes;
pub use stream::{convergence_stream, picture_stream, point_stream, ray_stream};
pub use text::{error_in_short, short};
