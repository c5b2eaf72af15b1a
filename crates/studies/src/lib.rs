//! Experiments: from a typed configuration to results with errors.
//!
//! [`verify`] draws fresh surfaces, sends light onto each,
//! and compares what comes out with statistical models; [`converge()`] measures what the ways of
//! computing cost, run time against error; [`map()`] says over a grid of cases where models hold; [`gonio()`]
//! measures the whole BRDF and BTDF, direction by direction.

mod attenuation;
mod case_model;
mod case_report;
mod cases;
mod compared;
mod comparison_json;
mod conclusion;
mod config;
mod config_error;
mod converge;
mod energies;
mod expectation;
mod figures;
mod flux_tables;
mod gonio;
mod layer_expectation;
mod map;
mod medium;
mod models;
mod number;
mod output;
mod peak;
mod report;
mod report_error;
pub mod settings;
mod side_difference;
mod summary;
mod sweep;
mod sweep_case;
mod trace_config;
mod values;
mod verify;

pub use attenuation::{
    AttenuationConfig, AttenuationError, AttenuationLight, AttenuationOutcome, AttenuationOutput,
    AttenuationRow, AttenuationRun, AttenuationSurface, AttenuationView, AttenuationWork,
    Demarcation, VisibilityRow, Way, attenuation, attenuation_report, attenuation_summary,
    attenuation_table,
};
pub use case_model::CaseModel;
pub use case_report::verify_table;
pub use cases::{check_light, check_sides};
pub use config::{
    Azimuth, CompareConfig, Incident, LightConfig, MaterialConfig, MaterialKind, OutputConfig,
    RunConfig, SurfaceConfig, VerifyConfig,
};
pub use config_error::ConfigError;
pub use converge::{
    ConvergeConfig, ConvergeError, ConvergeOutcome, ConvergeWork, ConvergedCase, ConvergenceConfig,
    Efficiency, Effort, Fit, Measurement, Method, MethodOutcome, Reference, RepeatedError,
    SecondsTo, converge, converge_report, converge_summary, converge_table,
};
pub use energies::{energy_table, errors_table, lost_warning, work_line};
pub use expectation::{expectation_json, write_expectation};
pub use figures::{Light, Surroundings, height_map_figure};
pub use gonio::{
    Direction, DirectionResults, GonioConfig, GonioError, GonioLight, GonioOutcome, GonioOutput,
    Means, MeasuredComponent, MeasuredConfig, PlotScale, Sample, Setting, gonio, gonio_report,
    gonio_summary, gonio_table,
};
pub use layer_expectation::{
    layer_energy_table, layer_expectation_json, unscattered_notes, write_layer_expectation,
};
pub use map::{
    CellDistances, CellModel, CellResults, CellSide, CellVerdict, ComparedLight, Interval, Judged,
    JudgedCell, MapCell, MapConfig, MapError, MapOutcome, ModelSummary, ToleranceConfig, map,
    map_report, map_summary, map_table, summarise,
};
pub use medium::{BottomKind, BottomShape, MediumConfig, PhaseKind};
pub use models::{ComparedComponent, ModelOutcome};
pub use output::{CheckpointError, Resuming, SurfaceCheckpoints};
pub use peak::PeakDifference;
pub use report::{trace_files, trace_report, verify_report, verify_summary};
pub use report_error::ReportError;
pub use side_difference::SideDifference;
pub use summary::Summary;
pub use trace_config::TraceConfig;
pub use values::{Count, Number, OneOrMany, PerAxis, Seconds};
pub use verify::{CaseOutcome, VerifyError, VerifyOutcome, verify};
