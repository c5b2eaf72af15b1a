//! Plan: light on given surfaces, checked and ready to be traced.

use asperity_simulate::{
    Case, CoreSlopes, LightPaths, Lobe, Settings, SimulateError, SurfaceSource,
};
use serde_json::Value;

use super::comparison::PlannedComparison;
use super::description::Surfaces;
use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;
use crate::config::trace::TraceConfig;
use crate::error::StudyError;
use crate::given::{GivenSurface, GivenSurfaces};
use crate::report::appearance::coherent_warning;
use crate::surface_lengths::SurfaceLengths;
use crate::validity::{Validity, wavelength_warnings};

/// Correlation lengths of the section over which single rays are followed.
const SECTION: f64 = 8.0;

/// One case on given surfaces, checked and ready to be traced.
pub struct PlannedTrace {
    /// The configuration.
    pub config: TraceConfig,
    /// Names of the surfaces.
    pub name: String,
    /// Name of the first of them.
    pub(super) first: String,
    /// `true` if +y is its north, and -y otherwise.
    pub(super) y_is_north: bool,
    /// Lengths of the surfaces against the wavelength, where its unit is known.
    pub validity: Option<Validity>,
    pub(super) case: Case,
    pub(super) settings: Settings,
    pub(super) lobes: [Option<Lobe>; 2],
    pub(super) comparison: Option<PlannedComparison>,
    pub(super) warnings: Vec<String>,
    /// Correlation length of the surfaces, where there is one.
    tau: Option<f64>,
    /// The configuration as summary.json holds it.
    pub(super) described: Value,
}

/// The surfaces, and what all cases need to know of them, which is measured once.
struct Given<'a> {
    tops: &'a GivenSurfaces,
    bottom: Option<&'a GivenSurface>,
    surface: SurfaceSource,
    slopes: Option<CoreSlopes>,
    /// Where they are compared with a wavelength, or a section is as long as some of them.
    lengths: Option<SurfaceLengths>,
    of_bottom: Option<SurfaceLengths>,
}

impl PlannedTrace {
    /// Plans every combination of the lists of a configuration, and checks everything that can be before a ray is traced.
    ///
    /// # Errors
    /// [`StudyError`] if the configuration makes no sense on these surfaces.
    pub(super) fn all(
        config: &TraceConfig,
        tops: &GivenSurfaces,
        bottom: Option<GivenSurface>,
    ) -> Result<Vec<Self>, StudyError> {
        for surface in tops.iter().filter(|_| config.run.refine) {
            surface.height_map("--refine")?;
        }
        if config.output.absorbed_map {
            check_absorbed_map(tops)?;
        }
        let cells = config.surface.cells.of_given();
        let lowest = config.medium.as_ref().map_or(0, MediumConfig::lowest);
        let surface =
            SurfaceSource::Given(tops.clone().simulated(bottom.clone(), lowest, cells)?);
        let are_needed =
            config.output.paths.is_some() || SurfaceLengths::are_comparable(tops.first.unit);
        let given = Given {
            slopes: CoreSlopes::of_source(&surface),
            lengths: are_needed.then(|| tops.lengths()),
            of_bottom: bottom
                .as_ref()
                .filter(|_| are_needed)
                .map(GivenSurface::lengths),
            surface,
            tops,
            bottom: bottom.as_ref(),
        };
        let singles = config.singles()?.into_iter();
        let planned = |single: TraceConfig| Self::new(single, &given);
        singles.map(planned).collect()
    }

    /// Plans a case of a configuration without lists.
    fn new(config: TraceConfig, given: &Given<'_>) -> Result<Self, StudyError> {
        let &Given {
            tops,
            bottom,
            slopes,
            ..
        } = given;
        let case = config.case(given.surface.clone(), slopes, tops.first.unit)?;
        let settings = config.ray_settings()?;
        let mut warnings = tops.warnings();
        let description = Surfaces::of(tops, bottom, &config);
        let wavelength = config.light.wavelength_nm();
        let is_named = config.material.media().is_some();
        warnings.extend(wavelength_warnings(wavelength, is_named, tops.first.unit));
        warnings.extend(coherent_warning(config.output.coherent, &case));
        let validity = given.lengths.as_ref().and_then(|lengths| {
            let bottom = given.of_bottom.as_ref();
            Validity::new(lengths, bottom, &case, &settings.tally, wavelength)
        });
        let comparison = PlannedComparison::new(&config, tops, &case, &settings)?;
        let of_comparison = comparison.as_ref().map(|planned| planned.warnings.clone());
        warnings.extend(of_comparison.into_iter().flatten());
        Ok(Self {
            described: description.config(&config, &case),
            config,
            name: tops.name(),
            y_is_north: tops.first.y_is_north,
            first: tops.first.name.clone(),
            validity,
            lobes: Lobe::of_slopes(&case, slopes),
            case,
            settings,
            comparison,
            warnings,
            tau: given.lengths.as_ref().and_then(|lengths| lengths.tau),
        })
    }

    /// Paths of single rays over a section of the first surface, if they are requested.
    pub(super) fn light_paths(&self) -> Result<Option<LightPaths>, SimulateError> {
        let Some(count) = self.config.output.paths else {
            return Ok(None);
        };
        let length = self.tau.map_or(f64::INFINITY, |tau| SECTION * tau);
        LightPaths::of(&self.case, &self.settings, length, count)
    }
}

/// Refuses surfaces of which there is no map of absorbed light.
fn check_absorbed_map(surfaces: &GivenSurfaces) -> Result<(), StudyError> {
    if !surfaces.others.is_empty() {
        let reason =
            "maps one given surface; trace each of several by itself, or leave out absorbed_map";
        return Err(ConfigError::unsuitable("absorbed_map", reason).into());
    }
    surfaces.first.height_map("--absorbed-map")?;
    Ok(())
}
