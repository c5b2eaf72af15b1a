//! Figures of the project: height maps, maps of cells, polar lobes, in-plane curves, grids of them, hemispheres, plain curves, errors over
//! run time, validity maps, and diagrams.
//!
//! Every figure takes plain numbers and returns a [`Figure`], which renders to an SVG string or to the bytes of
//! a PNG file. Nothing here opens a file, needs a font of the system or a C library: the font is embedded, and
//! equal input gives equal bytes.
//!
//! | figure | input | shows |
//! |---|---|---|
//! | [`HeightMapFigure`] | heights `[ny, nx]`, row-major | the surface from above, with a colour bar |
//! | [`CellMapFigure`] | fractions by cell `[ny, nx]`, row-major | a quantity over the surface from above, in colours from zero |
//! | [`BrightnessScale`] | a function from values to grey levels | what brightness means in a picture |
//! | [`PolarLobes`] | [`Series`] over signed angles | reflected and transmitted lobes around the surface |
//! | [`InPlaneCurves`] | [`Series`] over signed angles | linear and logarithmic curves, residuals |
//! | [`ValidityMap`] | [`MappedCell`]s: distances and verdicts | where models hold, over roughness and angle |
//! | [`Hemispheres`] | [`Hemisphere`]s: values of bins | light over whole hemispheres, in rows and columns |
//! | [`ProfileGrid`] | [`ProfileComponent`]s: [`Point`]s per panel | components of light in the plane of incidence |
//! | [`AngleGrid`] | [`AnglePanel`]s: [`Curve`]s per panel | several quantities in the plane of incidence, in rows and columns |
//! | [`Curves`] | [`Curve`]s: points with errors, lines | anything over two linear axes |
//! | [`LogCurves`] | [`Curve`]s: points with errors, lines | anything over two logarithmic axes |
//! | [`Diagram`] | [`DiagramPath`]s and [`DiagramLabel`]s | lines, arrows and words, to scale |
//! | [`ErrorOverTime`] | [`TimedMethod`]s: seconds and errors | what each method costs, fitted slopes |
//!
//! # Conventions
//! Angles are in degrees here (this is the user's edge) and *signed*: measured from the normal of the side on
//! which the light leaves, positive in the forward direction, that is towards +x for light which travels
//! towards +x. Lobes and curves show the cosine-weighted BSDF f |cos θₒ| in 1/sr: it
//! stays finite at grazing angles, where f itself may not.
//!
//! # Example
//! ```
//! use asperity_plot::{InPlaneCurves, Point, Series, Side};
//!
//! let lobe = |theta: f64| 0.8 * (-(theta / 20.0).powi(2)).exp();
//! let simulated = (-44..=44).map(|i| {
//!     let x = 2.0 * f64::from(i);
//!     Point { x, y: 1.02 * lobe(x), se: Some(0.01), x_range: Some([x - 1.0, x + 1.0]) }
//! });
//! let model = (-180..=180).map(|i| Point::exact(0.5 * f64::from(i), lobe(0.5 * f64::from(i))));
//! let figure = InPlaneCurves {
//!     title: "Transmitted light".into(),
//!     subtitle: "n = 1.4, s = 3, θᵢ = 30°".into(),
//!     side: Side::Transmitted,
//!     flat_direction_deg: Some(20.9),
//!     least: None,
//!     series: vec![
//!         Series::explicit("explicit surface", 0, Side::Transmitted, simulated.collect()),
//!         Series::model("Gaussian lobe", 0, Side::Transmitted, model.collect()),
//!     ],
//! }
//! .draw()?;
//! let svg: String = figure.svg()?;
//! let png: Vec<u8> = figure.png()?;
//! # assert!(svg.contains("Gaussian lobe") && png.starts_with(b"\x89PNG"));
//! # Ok::<(), asperity_plot::PlotError>(())
//! ```

mod elements;
mod error;
mod figures;

pub use elements::curve::{Colour, Curve, Point, Style};
pub use elements::curve_axis::CurveAxis;
pub use elements::disc_bins::DiscBins;
pub use elements::render::Figure;
pub use elements::series::{Series, Side, Source};
pub use elements::theme::model_colour;
pub use elements::verdict::MapVerdict;
pub use error::PlotError;
pub use figures::angle_grid::{AngleGrid, AnglePanel};
pub use figures::brightness_scale::BrightnessScale;
pub use figures::cell_map::CellMapFigure;
pub use figures::curves::Curves;
pub use figures::diagram::{Diagram, DiagramLabel, DiagramPanel, DiagramPath, Stroke};
pub use figures::error_over_time::{ErrorOverTime, PowerLaw, TimedError, TimedMethod};
pub use figures::height_map::HeightMapFigure;
pub use figures::hemispheres::{Hemisphere, Hemispheres, SharedColours};
pub use figures::in_plane_curves::InPlaneCurves;
pub use figures::log_curves::LogCurves;
pub use figures::polar_lobes::{PolarLobes, Sides};
pub use figures::profile_grid::{ProfileComponent, ProfileGrid};
pub use figures::reliefs::{Relief, Reliefs};
pub use figures::validity_map::{MappedCell, ValidityMap};
