//! Studies: from a typed configuration to results with errors, as tables, figures and checkpoints.
//!
//! [`verify`] simulates light on random surfaces and compares it with statistical models; [`converge()`] measures what the ways of
//! computing cost, run time against error; [`map()`] says over a grid of cases where models are within tolerance; [`gonio()`]
//! measures the whole BRDF and BTDF, direction by direction.

mod attenuation;
mod config;
mod converge;
mod gonio;
mod map;
mod output;
mod report;
pub mod settings;
mod trace;
mod verify;

pub use attenuation::{
    AttenuationConfig, AttenuationError, AttenuationLight, AttenuationOutcome, AttenuationOutput,
    AttenuationRow, AttenuationRun, AttenuationSurface, AttenuationView, AttenuationWork,
    Demarcation, VisibilityMethod, VisibilityRow, attenuation, attenuation_report,
    attenuation_summary, attenuation_table,
};
pub use config::case_model::CaseModel;
pub use config::cases::{check_light, check_sides};
pub use config::error::ConfigError;
pub use config::measured::MeasuredConfig;
pub use config::medium::{BottomKind, BottomShape, MediumConfig, PhaseKind};
pub use config::trace::TraceConfig;
pub use config::values::{Count, Number, OneOrMany, PerAxis, Seconds};
pub use config::{
    Azimuth, CompareConfig, Incident, LightConfig, MaterialConfig, MaterialKind, OutputConfig,
    RunConfig, SurfaceConfig, VerifyConfig,
};
pub use converge::{
    ConvergeConfig, ConvergeError, ConvergeOutcome, ConvergeWork, ConvergedCase, ConvergenceConfig,
    Efficiency, Fit, Measurement, Method, MethodOutcome, Reference, RepeatedError, RunEffort,
    SecondsTo, converge, converge_report, converge_summary, converge_table,
};
pub use gonio::{
    Direction, DirectionResults, GonioConfig, GonioError, GonioLight, GonioOutcome, GonioOutput,
    Means, MeasuredComponent, PlotScale, Sample, Specimen, gonio, gonio_report, gonio_summary,
    gonio_table,
};
pub use map::{
    CellDistances, CellModel, CellResults, CellSide, CellVerdict, ComparedLight, Interval, Judged,
    JudgedCell, MapCell, MapConfig, MapError, MapOutcome, ModelSummary, ToleranceConfig, map,
    map_report, map_summary, map_table, summarise,
};
pub use output::{CheckpointError, SurfaceCheckpoints};
pub use report::case_report::verify_table;
pub use report::energies::{energy_table, errors_table, lost_warning, work_line};
pub use report::error::ReportError;
pub use report::expectation::{expectation_json, write_expectation};
pub use report::figures::{PlottedCase, Surroundings, height_map_figure};
pub use report::files::{trace_files, trace_report, verify_report, verify_summary};
pub use report::layer_expectation::{
    layer_energy_table, layer_expectation_json, unscattered_notes, write_layer_expectation,
};
pub use report::summary::Summary;
pub use verify::comparison::models::{ComparedComponent, ModelOutcome};
pub use verify::comparison::peak::PeakDifference;
pub use verify::comparison::side_difference::SideDifference;
pub use verify::error::VerifyError;
pub use verify::{CaseOutcome, VerifyOutcome, resume_verify, verify};
