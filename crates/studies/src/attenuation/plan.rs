//! Plan: an attenuation run as it will be done, with lists gone through and everything checked.

use asperity_analysis::SlopeCovariance;
use asperity_optics::Incidence;
use asperity_results::Header;
use asperity_simulate::{
    Cells, RandomSurfaces, check_memory, short, smooth_traced_bytes, traced_bytes,
};
use asperity_surface::Border;
use asperity_synthesis::Psd;
use asperity_tracer::AcceleratorKind;
use serde_json::json;

use super::config::{AttenuationConfig, AttenuationDirections};
use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};
use crate::error::StudyError;

/// A configuration with its lists checked.
pub struct AttenuationStudy {
    /// The configuration.
    pub config: AttenuationConfig,
    /// Surfaces, by sigma.
    pub(super) surfaces: Vec<RoughSurfaces>,
    pub(super) lights: Vec<Incidence>,
    pub(super) views: Vec<Incidence>,
    /// Azimuths along which horizons are needed, radians: that of the lights, and that of the views where
    /// it is another and one of them is not from straight above.
    pub(super) azimuths: Vec<f64>,
    /// Numbers of the sigma at which models are drawn.
    pub(super) models_at: Vec<usize>,
    /// Numbers of the lights that are drawn over sigma.
    pub(super) over_sigma_at: Vec<usize>,
}

/// Random surfaces of one sigma.
pub(super) struct RoughSurfaces {
    /// Root mean square height, length units.
    pub(super) sigma: f64,
    /// Slopes of the continuous surface.
    pub(super) slopes: SlopeCovariance,
    /// Recipe that draws them.
    pub(super) drawn: RandomSurfaces,
}

impl AttenuationStudy {
    /// Header of the results: all settings but those of the figures.
    #[must_use]
    pub(super) fn identity(&self) -> Header {
        let config = &self.config;
        let mut run = json!(config.run);
        // Surfaces are results of their own: a run with more of them goes on from one with fewer.
        if let Some(run) = run.as_object_mut() {
            run.remove("realisations");
        }
        let document = json!({
            "surface": config.surface,
            "light": config.light,
            "view": config.view,
            "run": run,
        });
        Header::new("attenuation", config.run.seed, document)
    }

    /// Visibility method: a horizon per point and azimuth of flat cells, a visibility ray per point and direction of smooth ones.
    pub(super) fn method(&self) -> &'static str {
        match self.surfaces[0].drawn.cells() {
            Cells::Flat => "horizons",
            Cells::Smooth => "rays",
        }
    }

    /// Directions of the light, then of the view.
    pub(super) fn directions(&self) -> impl Iterator<Item = &Incidence> {
        self.lights.iter().chain(&self.views)
    }

    /// Refuses what does not fit into memory.
    fn check_size(&self) -> Result<(), StudyError> {
        let run = &self.config.run;
        let drawn = &self.surfaces[0].drawn;
        // Two facets and a sample per cell; a horizon takes 16 bytes, and the demarcation sorts two copies of
        // the halves of those of facets.
        let sorted = usize::from(run.demarcation);
        let [ny, nx] = drawn.shape();
        let cells = nx.saturating_mul(ny);
        let (traced, horizons) = match drawn.cells() {
            Cells::Flat => (
                traced_bytes([ny, nx], AcceleratorKind::Auto),
                self.azimuths.len(),
            ),
            Cells::Smooth => (smooth_traced_bytes([ny, nx], AcceleratorKind::Auto), 0),
        };
        let bytes = traced.saturating_add(cells.saturating_mul((48 + 8) * horizons + 32 * sorted));
        check_memory("measuring one surface", bytes.max(drawn.peak_bytes()))?;
        let results = self.surfaces.len() as f64
            * self.lights.len() as f64
            * (self.views.len() as f64 + 8.0)
            * run.realisations.0 as f64;
        if results > MAX_RESULTS {
            return Err(ConfigError::unsuitable(
                format!("{results:.1e} counts to keep"),
                format!("must be at most {MAX_RESULTS:.0e}: take fewer directions or surfaces"),
            )
            .into());
        }
        Ok(())
    }
}

impl AttenuationConfig {
    /// Goes through the lists, and checks everything that can be known before a surface is drawn: values, grids, memory.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or a surface does not fit into memory.
    pub fn plan(&self) -> Result<AttenuationStudy, StudyError> {
        let (surface, run) = (&self.surface, &self.run);
        let sigmas = numbers("sigma", &surface.sigma)?;
        let tau = surface.tau.0;
        let (shape, cells) = (self.shape()?, surface.cells.of_random());
        let spacing = surface.spacing.xy().map(|spacing| spacing.0);
        let of_sigma = |&sigma: &f64| -> Result<RoughSurfaces, StudyError> {
            let psd = Psd::gaussian(sigma, tau).map_err(ConfigError::from)?;
            Ok(RoughSurfaces {
                sigma,
                drawn: RandomSurfaces::new(cells, psd, shape, spacing, surface.insist)?,
                slopes: SlopeCovariance::isotropic(tau / sigma)?,
            })
        };
        let surfaces = sigmas.iter().map(of_sigma).collect::<Result<Vec<_>, _>>()?;
        let [ny, nx] = shape;
        if surface.border == Border::Open && nx.min(ny) < 3 {
            return Err(ConfigError::unsuitable(
                format!("an open patch of {nx} x {ny} samples"),
                "must have 3 or more a side, since paper_g2 counts those inside",
            )
            .into());
        }
        let lights = directions("theta", &self.light)?;
        let views = directions("view theta", &self.view)?;
        let is_slanted = |direction: &&Incidence| !direction.is_vertical();
        let mut azimuths = vec![lights[0].phi()];
        azimuths.extend(views.iter().filter(is_slanted).map(|view| view.phi()));
        azimuths.dedup();
        if cells == Cells::Smooth && run.demarcation {
            let needed = "horizons, which are those of flat cells";
            return Err(ConfigError::missing("--demarcation", needed).into());
        }
        let thetas: Vec<f64> = lights.iter().map(|light| light.theta_deg()).collect();
        let models_at = self.output.models_at_sigma.as_ref();
        let over_sigma_at = self.output.over_sigma_at_theta.as_ref();
        let study = AttenuationStudy {
            config: self.clone(),
            models_at: chosen("models_at_sigma", models_at, &sigmas, 3)?,
            over_sigma_at: chosen("over_sigma_at_theta", over_sigma_at, &thetas, 5)?,
            surfaces,
            lights,
            views,
            azimuths,
        };
        study.check_size()?;
        Ok(study)
    }

    /// Samples `[ny, nx]`.
    fn shape(&self) -> Result<[usize; 2], StudyError> {
        let surface = &self.surface;
        let [nx, ny] = match (surface.size, surface.length) {
            (Some(size), _) => size.xy().map(|samples| Ok(samples.0 as usize)),
            (None, Some(length)) => {
                let ([x, y], [dx, dy]) = (length.xy(), surface.spacing.xy());
                [samples(x.0, dx.0), samples(y.0, dy.0)]
            }
            (None, None) => {
                return Err(ConfigError::missing("attenuation", "--size or --length").into());
            }
        };
        Ok([ny?, nx?])
    }
}

/// Most samples along a side that are told from one another.
const MAX_SAMPLES: f64 = 1e9;

/// Most counts kept in memory at 8 bytes.
const MAX_RESULTS: f64 = 1e8;

/// Samples along a side of this length.
fn samples(length: f64, spacing: f64) -> Result<usize, StudyError> {
    let samples = length / spacing;
    let whole = samples.round();
    let divides = (samples - whole).abs() <= 1e-9 * whole;
    if spacing > 0.0 && (1.0..MAX_SAMPLES).contains(&whole) && divides {
        return Ok(whole as usize);
    }
    Err(ConfigError::part_samples(spacing, length).into())
}

/// The values of a list, each of which may stand there once.
fn numbers(name: &'static str, list: &OneOrMany<Number>) -> Result<Vec<f64>, ConfigError> {
    let values: Vec<f64> = list.values(name)?.iter().map(|value| value.0).collect();
    for (i, value) in values.iter().enumerate() {
        if values[..i].contains(value) {
            return Err(ConfigError::GivenTwice {
                list: name,
                value: short(*value),
            });
        }
    }
    Ok(values)
}

fn directions(
    name: &'static str,
    of: &AttenuationDirections,
) -> Result<Vec<Incidence>, ConfigError> {
    let direction = |theta| Ok(Incidence::from_degrees(theta, of.phi.0)?);
    numbers(name, &of.theta)?
        .into_iter()
        .map(direction)
        .collect()
}

/// Numbers of the values of a list that a figure shows: those named, or, unless any is, `count` over its whole range.
fn chosen(
    name: &'static str,
    named: Option<&OneOrMany<Number>>,
    values: &[f64],
    count: usize,
) -> Result<Vec<usize>, ConfigError> {
    let Some(named) = named else {
        let (last, shown) = (values.len() - 1, count.min(values.len()));
        let place = |i: usize| if shown > 1 { i * last / (shown - 1) } else { 0 };
        return Ok((0..shown).map(place).collect());
    };
    let number = |value: f64| {
        let number = values.iter().position(|one| *one == value);
        number.ok_or_else(|| {
            let given = format!("{name} = {}", short(value));
            ConfigError::unsuitable(given, "must be among the values that are measured")
        })
    };
    numbers(name, named)?.into_iter().map(number).collect()
}
