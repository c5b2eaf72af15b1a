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
mod store;
mod stream;
mod text;

pub use engine::random::MESH_ALLOWANCE;
pub use engine::simulation::{Simulation, simulate};
pub use error::SimulateError;
pub use errors::budget::{ErrorBudget, Errors};
pub use errors::refinement::Refinement;
pub use input::case::{Case, Light};
pub use input::estimator::Estimator;
pub use input::layer::{BottomSurface, LayerBelow, SearchedSurface, layer_folder, layer_name};
pub use input::limits::{
    check_grazing, check_memory, check_results, hierarchy_bytes, meshes_bytes, traced_bytes,
};
pub use input::settings::{Effort, Settings};
pub use input::surface_source::{Shape, SurfaceSource};
pub use input::target::{Quantity, Target, TargetError};
pub use methods::method::ControlMean;
pub use observer::{Deadline, Observer, Silent, StoppedBy};
pub use output::outcome::{ErrorSource, Outcome};
pub use output::stopping::{PilotFigures, Stopping};
pub use output::work::SummaryWork;
pub use slopes::slopes;
pub use store::{SavedSurface, Stage, SurfaceKey, SurfaceStore};
pub use stream::{convergence_stream, picture_stream, point_stream, ray_stream};
pub use text::{error_in_short, short};
