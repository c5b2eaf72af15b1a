//! Explicit geometric-optics simulation of light on random and measured rough surfaces: the library.
//!
//! The names that a first program needs are here; each crate that programs use is a module with all of its names.
//!
//! # Examples
//! Glass with a root mean square slope of 0.25, lit at 30 degrees:
//! ```
//! use asperity::{Case, Component, Effort, Incidence, Light, Material, Psd, Settings, Side, Silent, SurfaceSource, Synthesis,
//!     TallyResult, simulate};
//!
//! let surfaces = Synthesis::new(Psd::gaussian(1.0, 8.0)?, [64, 64], [1.0, 1.0], false)?;
//! let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
//! let case = Case::new(SurfaceSource::random(surfaces), Material::dielectric(1.5)?, light);
//! let settings = Settings { effort: Effort::Rays { total: 10_000, surfaces: 8 }, ..Settings::default() };
//! let outcome = &simulate(&[case], &settings, &Silent)?[0];
//! let transmitted = outcome.statistics.flux(Side::Transmitted, Component::All);
//! assert!((transmitted.mean - 0.95).abs() < 0.01 && transmitted.se.is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use asperity_analysis as analysis;
pub use asperity_io as io;
pub use asperity_optics as optics;
pub use asperity_page as page;
pub use asperity_plot as plot;
pub use asperity_render as render;
pub use asperity_results as results;
pub use asperity_simulate as simulation;
pub use asperity_studies as studies;
pub use asperity_surface as surface;
pub use asperity_synthesis as synthesis;
pub use asperity_tally as tally;
pub use asperity_tracer as tracer;

pub use asperity_analysis::{ScatteringModel, create_model};
pub use asperity_io::{read_height_map, read_mesh, write_height_map};
pub use asperity_optics::{Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
pub use asperity_results::{Header, ResultSet};
pub use asperity_simulate::{
    Case, Cells, Effort, Light, Observer, Outcome, RandomSurfaces, Settings, Shape, Silent,
    SurfaceSource, simulate,
};
pub use asperity_studies::settings::{Command, Document};
pub use asperity_studies::{Findings, Study};
pub use asperity_surface::{Border, HeightField, LengthUnit, Roughness};
pub use asperity_synthesis::{Psd, Synthesis};
pub use asperity_tally::{Component, Estimate, Side, TallyResult, TallySpec};
