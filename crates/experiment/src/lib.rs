//! Experiments: from a typed configuration to results with errors.
//!
//! [`trace`] and [`trace_mesh`] send light onto one surface; [`verify`] draws fresh surfaces, sends light onto each,
//! and compares what comes out with statistical models. Threads, seeds and progress live here and
//! nowhere else.
//!
//! # Random streams
//! Every block of rays has its own stream, keyed by (seed, realisation, block), and results are
//! reduced in the order of their index. The same configuration gives the same bytes, whatever the
//! number of threads.

mod blocks;
mod case;
mod cases;
mod config;
mod csv;
mod ensemble;
mod estimator;
mod figures;
mod known;
mod limits;
mod method;
mod number;
mod pilot;
mod progress;
mod report;
mod sharing;
mod stopping;
mod stream;
mod summary;
mod tables;
mod trace;
mod values;
mod verify;

pub use blocks::RaySettings;
pub use case::Case;
pub use cases::check_sides;
pub use config::{
    Azimuth, CompareConfig, ConfigError, Incident, LightConfig, MaterialConfig, MaterialKind,
    OutputConfig, RunConfig, SurfaceConfig, VerifyConfig,
};
pub use estimator::Estimator;
pub use figures::{Light, Surroundings, height_map_figure};
pub use limits::{RunError, check_memory};
pub use number::{parse_count, parse_number, parse_order, parse_seconds};
pub use progress::{Deadline, Progress, Silent};
pub use report::{ReportError, trace_report, verify_report, verify_summary};
pub use stopping::{Aim, PilotFigures, StoppedBy, Stopping, Target};
pub use summary::{Summary, SummaryWork};
pub use tables::{energy_table, lost_warning, verify_table, work_line};
pub use trace::{TraceOutcome, trace, trace_mesh};
pub use values::{Count, Number, OneOrMany, PerAxis, Seconds};
pub use verify::{CaseOutcome, ModelOutcome, VerifyError, VerifyOutcome, verify};
