//! Studies: from a document of settings to results with errors, as tables and figures.
//!
//! A [`Study`] is planned, run and judged. [`VerifyStudy`] simulates light on random surfaces and compares it with statistical models;
//! [`ConvergeStudy`] measures run time against error; [`MapStudy`] says over a grid of cases where models are within tolerance;
//! [`GonioStudy`] measures BRDF and BTDF, direction by direction; [`AlbedoStudy`] tabulates directional albedos; [`TraceStudy`] traces given surfaces, and [`AttenuationStudy`] measures
//! shadowing and masking.

mod albedo;
mod attenuation;
mod comparison;
mod config;
mod converge;
mod engine;
mod error;
mod export;
mod generate;
mod given;
mod gonio;
mod inspect;
mod map;
mod materials;
mod mesh;
mod model;
mod output;
mod render;
mod report;
pub mod settings;
mod shards;
mod study;
mod surface_lengths;
mod trace;
mod validity;
mod verify;
mod work_plan;

pub use albedo::{
    AlbedoConfig, AlbedoLight, AlbedoOutcome, AlbedoOutput, AlbedoPoint, AlbedoRun, AlbedoSlopes,
    AlbedoStudy, AlbedoTable,
};
pub use attenuation::{
    AttenuationConfig, AttenuationDirections, AttenuationOutcome, AttenuationOutput,
    AttenuationRow, AttenuationRun, AttenuationStudy, AttenuationSurface, AttenuationWork,
    Demarcation, ShadowShares, SurveyedSurface, VisibilityRow,
};

pub use comparison::judgement::Judgement;
pub use comparison::models::{ComparedComponent, ModelOutcome};
pub use comparison::peak::PeakDifference;
pub use comparison::side_difference::SideDifference;
pub use config::case_model::CaseModel;
pub use config::cases::{check_estimator, check_sides};
pub use config::error::ConfigError;
pub use config::filtering::FilteringError;
pub use config::measured::{MeasuredConfig, UnitError};
pub use config::medium::{BottomKind, BottomShape, Interactions, MediumConfig, PhaseKind};
pub use config::structure::{
    CrackFeatures, Features, GrooveFeatures, PyramidFeatures, ScratchFeatures, SegmentFeatures,
    StructureConfig,
};
pub use config::trace::{CellsConfig, TraceConfig};
pub use config::values::{Auto, Count, Number, OneOrMany, OrAuto, PerAxis, Seconds};
pub use config::{
    Azimuth, Coherent, CompareConfig, GaussianName, HeightsChoice, Incident, LightConfig,
    MaterialConfig, OutputConfig, Roughness, RunConfig, SecondScale, Spectrum, SurfaceConfig,
    SurfaceFileError, SurfaceFiles, VerifyConfig,
};
pub use converge::{
    ConvergeConfig, ConvergeOutcome, ConvergePlan, ConvergeRun, ConvergeStudy, ConvergeWork,
    ConvergedCase, ConvergenceConfig, Efficiency, Fit, Measurement, Method, MethodOutcome,
    Reference, RepeatedError, SecondsTo,
};
pub use engine::{ChosenEngine, gpu_list};
pub use error::StudyError;
pub use export::{ExportConfig, ExportError, Exported, labelled_results};
pub use generate::{GeneratePlan, GeneratedSurface};
pub use given::{
    ComparedSurfaceError, FileProblem, GivenError, GivenShape, GivenSurface, GivenSurfaces,
    ReadHeightMap,
};
pub use gonio::{
    Direction, GonioConfig, GonioLight, GonioOutcome, GonioOutput, GonioStudy, LightDirections,
    PatchBasis, PlotScale, Sample,
};
pub use inspect::{
    InspectConfig, InspectLight, InspectReport, Inspection, Statistics, inspection_files,
    names_folder,
};
pub use map::{
    CellDistances, CellModel, CellResults, CellSide, CellVerdict, ComparedLight, Interval, Judged,
    JudgedCell, MapCell, MapConfig, MapOutcome, MapStudy, ModelSummary, ToleranceConfig,
};
pub use materials::{
    ListedMaterial, MaterialSheet, MaterialsConfig, MaterialsError, material_list,
    material_list_text,
};
pub use mesh::{FinenessConfig, MeshConfig, MeshedSurface};
pub use model::{
    AttenuationFileError, Evaluation, EvaluationError, ListedModel, ModelConfig, Resolution,
    SlopeFileError, evaluate_model, model_list, single_model,
};
pub use output::{EstimateWithLimit, wrapped};
pub use render::{
    CameraConfig, CameraKind, LightingConfig, PictureConfig, RenderConfig, RenderPlan, RenderRun,
    RenderedPicture, ViewConfig,
};
pub use report::energies::energy_table;
pub use report::error::ReportError;
pub use report::figures::model_colour;
pub use report::flux_basis::FluxBasis;
pub use report::summary::Summary;
pub use report::views::Views;
pub use shards::{ShardFolders, TracedShard, is_plan_only, open_results, share_of, trace_shard};
pub use study::{Findings, PlannedRow, Study, time_limit};
pub use surface_lengths::SurfaceLengths;
pub use trace::{PlannedTrace, TraceComparison, TraceOutcome, TraceOutcomes, TraceStudy};
pub use validity::{DEFAULT_WAVELENGTH_NM, LARGE, Validity};
pub use verify::plan::Plan;
pub use verify::{VerifyOutcome, VerifyStudy};
pub use work_plan::WorkPlan;
