//! The engine: from cases and settings to tallies with errors.
//!
//! [`simulate`] is the entry point. A [`Case`] has one value each: a surface source, a material, perhaps a layer below,
//! and the light. [`Settings`] say how all cases are simulated and how much is traced. Each case gives an
//! [`Outcome`]: tallies with errors by where they come from, the work done, and how the run ended. An [`Observer`]
//! is told of progress and may stop the run. A [`Simulation`] resumes from the finished parts that a
//! [`SurfaceStore`] has kept.
//!
//! Folders: `input` (what is simulated, apertures, and limits), `bins` (bins that refine around narrow lobes), `methods` (how a case is estimated), `engine`
//! (prepare, draw, plan, trace, reduce), `errors` (budget, mesh error, refinement), `output`.
//!
//! # Random streams
//! Random numbers are functions of seed, surface, path and step, and results are reduced in the order of their number. The same cases and settings give the same bytes, whatever the number of threads.

mod absorbed_map;
mod bins;
mod engine;
mod error;
mod errors;
mod input;
mod light_paths;
mod methods;
mod observer;
mod output;
mod slopes;
mod store;
mod stream;
mod text;

pub use absorbed_map::AbsorbedMap;
pub use asperity_optics::BottomSurface;
pub use asperity_tracer::{SearchedSurface, Shape};
pub use bins::core_slopes::CoreSlopes;
pub use bins::lobe::{Lobe, MAX_SHORTFALL};
pub use engine::plan::planned_work::PlannedWork;
pub use engine::reduce::run::MESH_ALLOWANCE;
pub use engine::simulation::{Simulation, planned_rays, simulate};
pub use error::SimulateError;
pub use errors::budget::{ErrorBudget, Errors};
pub use errors::refinement::Refinement;
pub use input::apertures::{CLEAR_DEG, CaseApertures, SPECULAR_DEG, STRAIGHT_DEG};
pub use input::case::{Case, CaseBins, Light};
pub use input::case_words::{CaseColumn, CaseGroup, CasePart, GGX_ALPHA, bottom_text};
pub use input::cells::Cells;
pub use input::coordinates::{Coordinate, Coordinates};
pub use input::described_shape::{DescribedShape, DescribedSurface, corners_hash, heights_hash};
pub use input::estimator::Estimator;
pub use input::limits::{
    check_height, check_memory, check_results, check_shape, check_shape_memory,
    smooth_traced_bytes, traced_bytes,
};
pub use input::path_choice::PathChoice;
pub use input::random_surfaces::RandomSurfaces;
pub use input::regions::Regions;
pub use input::settings::{Effort, Settings};
pub use input::share::{Division, Share, Slice};
pub use input::surface_source::{SurfaceSource, smooth_shape};
pub use input::target::{Quantity, Target, TargetError};
pub use light_paths::{LightPath, LightPaths};
pub use methods::method::ControlVariateMean;
pub use observer::{Deadline, GRACE, Observer, Silent, TIME_OF_FIRST};
pub use output::chosen_paths::{ChosenPaths, PathStrategy, TriedPaths};
pub use output::outcome::{ErrorSource, Outcome};
pub use output::stopped_by::StoppedBy;
pub use output::stopping::{PilotFigures, Stopping};
pub use output::surface_tallies::SurfaceTallies;
pub use output::work::{MachineWork, SummaryWork};
pub use slopes::{slope_distribution, slopes};
pub use store::{Stage, SurfaceKey, SurfaceStore};
pub use stream::{convergence_stream, picture_stream, point_stream};
pub use text::{counted, error_in_short, short, three_digits};
