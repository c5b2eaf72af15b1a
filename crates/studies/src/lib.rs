//! Experiments: from a typed configuration to results with errors.
//!
//! [`trace`] and [`trace_mesh`] send light onto one surface; [`verify`] draws fresh surfaces, sends light onto each,
//! and compares what comes out with statistical models; [`converge()`] measures what the ways of
//! computing cost, run time against error; [`map()`] says over a grid of cases where models hold; [`gonio()`]
//! measures the whole BRDF and BTDF, direction by direction. Threads, seeds and progress live here and
//! nowhere else.
//!
//! # Random streams
//! Every block of rays has its own stream, keyed by (seed, realisation, block), and results are
//! reduced in the order of their index. The same configuration gives the same bytes, whatever the
//! number of threads.

mod alone;
mod attenuation;
mod blocks;
mod budget;
mod case;
mod case_model;
mod cases;
mod conclusion;
mod config;
mod converge;
mod csv;
mod ensemble;
mod estimator;
mod expectation;
mod facet_control;
mod figures;
mod gonio;
mod known;
mod layer_expectation;
mod limits;
mod map;
mod medium;
mod mesh_error;
mod method;
mod models;
mod number;
mod part;
mod peak;
mod pilot;
mod progress;
mod render;
mod report;
mod sharing;
mod side_difference;
mod stopping;
mod store;
mod stream;
mod summary;
mod tables;
mod trace;
mod values;
mod verify;

pub use attenuation::{
    AttenuationConfig, AttenuationError, AttenuationLight, AttenuationOutcome, AttenuationOutput,
    AttenuationRow, AttenuationRun, AttenuationSurface, AttenuationView, AttenuationWork,
    Demarcation, VisibilityRow, Way, attenuation, attenuation_report, attenuation_summary,
    attenuation_table,
};
pub use blocks::RaySettings;
pub use budget::{ErrorBudget, Errors};
pub use case::Case;
pub use case_model::CaseModel;
pub use cases::{check_light, check_sides};
pub use config::{
    Azimuth, CompareConfig, ConfigError, Incident, LightConfig, MaterialConfig, MaterialKind,
    OutputConfig, RunConfig, SurfaceConfig, VerifyConfig,
};
pub use converge::{
    ConvergeConfig, ConvergeError, ConvergeOutcome, ConvergeWork, ConvergedCase, ConvergenceConfig,
    Efficiency, Effort, Fit, Measurement, Method, MethodOutcome, Reference, RepeatedError,
    SecondsTo, converge, converge_report, converge_summary, converge_table,
};
pub use estimator::Estimator;
pub use expectation::{expectation_json, write_expectation};
pub use figures::{Light, Surroundings, height_map_figure};
pub use gonio::{
    Direction, DirectionResults, GonioConfig, GonioError, GonioLight, GonioOutcome, GonioOutput,
    Means, MeasuredConfig, MeasuredPart, PlotScale, Sample, SampleShape, Setting, gonio,
    gonio_report, gonio_summary, gonio_table,
};
pub use layer_expectation::{
    layer_energy_table, layer_expectation_json, unscattered_notes, write_layer_expectation,
};
pub use limits::{RunError, check_memory};
pub use map::{
    CellDistances, CellModel, CellResults, CellSide, CellVerdict, Interval, Judged, JudgedCell,
    LightShare, MapCell, MapConfig, MapError, MapOutcome, ModelSummary, ToleranceConfig, map,
    map_report, map_summary, map_table, summarise,
};
pub use medium::{BottomKind, BottomSurface, MediumConfig, PhaseKind, layer_name};
pub use method::ControlMean;
pub use models::{ComparedShare, ModelOutcome};
pub use number::{parse_count, parse_number, parse_order, parse_seconds};
pub use part::Part;
pub use peak::PeakDifference;
pub use progress::{Deadline, Progress, Silent};
pub use render::{
    Lights, LightsError, MOST_PIXELS, Patch, Projection, RenderError, RenderOutcome,
    RenderSettings, Sun, View, ViewError, exposure, render, render_mesh,
};
pub use report::{ReportError, trace_report, verify_report, verify_summary};
pub use side_difference::SideDifference;
pub use stopping::{Aim, PilotFigures, StoppedBy, Stopping, Target};
pub use summary::{Summary, SummaryWork};
pub use tables::{energy_table, errors_table, lost_warning, verify_table, work_line};
pub use trace::{Scene, TraceOutcome, trace, trace_mesh};
pub use values::{Count, Number, OneOrMany, PerAxis, Seconds};
pub use verify::{CaseOutcome, VerifyError, VerifyOutcome, verify};
