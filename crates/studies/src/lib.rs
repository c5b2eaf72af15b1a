//! Studies: from a typed configuration to results with errors, as tables and figures.
//!
//! [`verify`] simulates light on random surfaces and compares it with statistical models; [`converge()`] measures what the ways of
//! computing cost, run time against error; [`map()`] says over a grid of cases where models are within tolerance; [`gonio()`]
//! measures the whole BRDF and BTDF, direction by direction.

mod attenuation;
mod border;
mod comparison;
mod config;
mod converge;
mod given;
mod gonio;
mod inspect;
mod map;
mod model;
mod output;
mod report;
pub mod settings;
mod surface_lengths;
mod trace;
mod validity;
mod verify;

pub use attenuation::{
    AttenuationConfig, AttenuationDirections, AttenuationError, AttenuationOutcome,
    AttenuationOutput, AttenuationPlan, AttenuationRow, AttenuationRun, AttenuationSurface,
    AttenuationWork, Demarcation, ShadowShares, SurveyedSurface, VisibilityMethod, VisibilityRow,
    attenuation, attenuation_report, attenuation_summary, attenuation_table,
};
pub use border::{ASSUMED_BORDER, border_notes};
pub use comparison::error::CompareError;
pub use comparison::judgement::Judgement;
pub use comparison::models::{ComparedComponent, ModelOutcome};
pub use comparison::peak::PeakDifference;
pub use comparison::side_difference::SideDifference;
pub use config::case_model::CaseModel;
pub use config::cases::{check_light, check_sides};
pub use config::error::ConfigError;
pub use config::filtering::FilteringError;
pub use config::measured::{MeasuredConfig, UnitError};
pub use config::medium::{BottomKind, BottomShape, Interactions, MediumConfig, PhaseKind};
pub use config::surface_error::SurfaceError;
pub use config::trace::{CellsConfig, TraceConfig};
pub use config::values::{Auto, Count, Number, OneOrMany, OrAuto, PerAxis, Seconds};
pub use config::{
    Azimuth, CompareConfig, HeightsChoice, Incident, LightConfig, MaterialConfig, OutputConfig,
    RunConfig, SpectrumChoice, SurfaceConfig, SurfaceFileError, SurfaceFiles, VerifyConfig,
};
pub use converge::{
    ConvergeConfig, ConvergeOutcome, ConvergePlan, ConvergeRun, ConvergeWork, ConvergedCase,
    ConvergenceConfig, Efficiency, Fit, Measurement, Method, MethodOutcome, Reference,
    RepeatedError, SecondsTo, converge, converge_report, converge_summary, converge_table,
    judge_convergence,
};
pub use given::{GivenShape, GivenSurface, GivenSurfaces};
pub use gonio::{
    AboutSample, Direction, GonioConfig, GonioLight, GonioOutcome, GonioOutput, PlotScale, Sample,
    gonio, gonio_report, gonio_summary, gonio_table, judge_gonio,
};
pub use inspect::{InspectError, Texture, inspect_report, texture_files};
pub use map::{
    CellDistances, CellModel, CellResults, CellSide, CellVerdict, ComparedLight, Interval, Judged,
    JudgedCell, MapCell, MapConfig, MapOutcome, ModelSummary, ToleranceConfig, judge_map, map,
    map_report, map_summary, map_table, summarise,
};
pub use model::{
    Evaluation, EvaluationError, ModelConfig, Resolution, SlopeFileError, evaluate_model,
    model_list,
};
pub use output::wrapped;

pub use report::areal_parameters::areal_table;
pub use report::case_report::verify_table;
pub use report::energies::energy_table;
pub use report::error::ReportError;
pub use report::figures::height_map_figure;
pub use report::files::{verify_report, verify_summary};
pub use report::flux_support::FluxSupport;
pub use report::roughness::{realisation_table, roughness_table, smooth_table};
pub use report::summary::Summary;
pub use surface_lengths::SurfaceLengths;
pub use trace::{
    TraceComparison, TraceError, TraceOutcome, TracePlan, TracedSurfaces, trace, trace_report,
    trace_summary, trace_table,
};
pub use validity::{DEFAULT_WAVELENGTH_NM, LARGE, Validity};
pub use verify::error::VerifyError;
pub use verify::plan::Plan;
pub use verify::{VerifyOutcome, judge_verification, verify};
