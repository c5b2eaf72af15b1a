//! An attenuation run as it will be done: lists gone through, everything checked.

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_optics::Incidence;
use asperity_simulate::{Cells, check_memory, short, smooth_traced_bytes, traced_bytes};
use asperity_surface::{Border, Psd, SplineSynthesis, Synthesis, SynthesisError};
use asperity_tracer::{AcceleratorKind, HorizonError};

use super::AttenuationError;
use super::config::{AttenuationConfig, AttenuationRun, VisibilityMethod};
use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};
use crate::report::flux_support::patches;

/// A configuration with its lists checked.
pub(super) struct Plan {
    pub(super) sigmas: Vec<f64>,
    pub(super) tau: f64,
    /// `[ny, nx]`.
    pub(super) shape: [usize; 2],
    pub(super) spacing: [f64; 2],
    pub(super) border: Border,
    pub(super) lights: Vec<Incidence>,
    pub(super) views: Vec<Incidence>,
    /// Either rays or horizons.
    pub(super) method: VisibilityMethod,
    pub(super) recipes: Recipes,
    /// Their slopes, as those of the continuous surface.
    pub(super) slopes: Vec<SlopeCovariance>,
    pub(super) models_at: Vec<f64>,
    pub(super) over_sigma_at: Vec<f64>,
}

/// Recipes of the surfaces, one per sigma.
pub(super) enum Recipes {
    Flat(Vec<Synthesis>),
    Smooth(Vec<SplineSynthesis>),
}

impl Recipes {
    /// What the cells of the surfaces are.
    pub(super) const fn cells(&self) -> Cells {
        match self {
            Self::Flat(_) => Cells::Flat,
            Self::Smooth(_) => Cells::Smooth,
        }
    }

    /// Bytes at the peak of drawing one of them.
    fn peak_bytes(&self) -> usize {
        let most = match self {
            Self::Flat(recipes) => recipes.iter().map(Synthesis::peak_bytes).max(),
            Self::Smooth(recipes) => recipes.iter().map(SplineSynthesis::peak_bytes).max(),
        };
        most.unwrap_or(0)
    }
}

impl Plan {
    /// Independent points among `points` of a surface: no more than there are patches of a correlation length.
    pub(super) fn independent_points(&self, points: u64) -> f64 {
        patches(self.shape, self.spacing, [self.tau; 2]).min(points as f64)
    }

    /// Whether horizons are found at all.
    pub(super) fn needs_horizons(&self, run: &AttenuationRun) -> bool {
        self.method == VisibilityMethod::Horizons || run.demarcation
    }

    /// Azimuths along which horizons are needed, radians: that of the lights, and that of the views where
    /// it is another and one of them is not from straight above.
    pub(super) fn azimuths(&self) -> Vec<f64> {
        let mut azimuths = vec![self.lights[0].phi()];
        let slanted = self.views.iter().find(|view| !view.is_vertical());
        if let Some(view) = slanted.filter(|view| view.phi() != azimuths[0]) {
            azimuths.push(view.phi());
        }
        azimuths
    }
}

impl AttenuationConfig {
    /// Goes through the lists and checks them.
    pub(super) fn plan(&self) -> Result<Plan, AttenuationError> {
        let surface = &self.surface;
        let sigmas = numbers("sigma", &surface.sigma)?;
        let [dx, dy] = surface.spacing.xy().map(|spacing| spacing.0);
        let shape = self.shape()?;
        let recipes = self.recipes(&sigmas, shape)?;
        let mut slopes = Vec::new();
        for &sigma in &sigmas {
            let covariance = SlopeCovariance::isotropic(surface.tau.0 / sigma);
            slopes.push(covariance.map_err(|error: SlopeError| contradiction(error.to_string()))?);
        }
        if surface.border == Border::Open && shape.iter().any(|&samples| samples < 3) {
            return Err(contradiction(format!(
                "an open patch of {} x {} samples has none inside, where paper_g2 counts; take 3 or more a side",
                shape[1], shape[0],
            )));
        }
        let lights = directions("theta", &self.light.theta, self.light.phi.0)?;
        let views = directions("view theta", &self.view.theta, self.view.phi.0)?;
        let thetas: Vec<f64> = lights.iter().map(|light| light.theta_deg()).collect();
        let models_at = chosen(
            "models_at_sigma",
            self.output.models_at_sigma.as_ref(),
            &sigmas,
            MODELS_DRAWN,
        )?;
        let over_sigma_at = chosen(
            "over_sigma_at_theta",
            self.output.over_sigma_at_theta.as_ref(),
            &thetas,
            ANGLES_DRAWN,
        )?;
        let mut plan = Plan {
            method: self.run.method,
            sigmas,
            tau: surface.tau.0,
            shape,
            spacing: [dx, dy],
            border: surface.border,
            lights,
            views,
            recipes,
            slopes,
            models_at,
            over_sigma_at,
        };
        if plan.recipes.cells() == Cells::Smooth {
            plan.method = self.method_of_smooth()?;
        } else if plan.method == VisibilityMethod::Auto {
            plan.method = self.quicker_method(&plan);
        }
        self.check_size(&plan)?;
        Ok(plan)
    }

    /// The recipe of each sigma, for surfaces of that many samples `[ny, nx]`.
    fn recipes(&self, sigmas: &[f64], shape: [usize; 2]) -> Result<Recipes, AttenuationError> {
        let surface = &self.surface;
        let spacing = surface.spacing.xy().map(|spacing| spacing.0);
        let psds = sigmas.iter().map(|&sigma| {
            let psd = Psd::gaussian(sigma, surface.tau.0);
            psd.map_err(|error| AttenuationError::from(ConfigError::from(error)))
        });
        let insist = surface.insist;
        Ok(match surface.cells.of_random() {
            Cells::Flat => Recipes::Flat(
                psds.map(|psd| Ok(Synthesis::new(psd?, shape, spacing, insist)?))
                    .collect::<Result<_, AttenuationError>>()?,
            ),
            Cells::Smooth => Recipes::Smooth(
                psds.map(|psd| Ok(SplineSynthesis::new(psd?, shape, spacing, insist)?))
                    .collect::<Result<_, AttenuationError>>()?,
            ),
        })
    }

    /// Rays, since horizons are those of facets.
    fn method_of_smooth(&self) -> Result<VisibilityMethod, AttenuationError> {
        if self.run.method == VisibilityMethod::Horizons || self.run.demarcation {
            return Err(contradiction(
                "horizons, and --demarcation which needs them, are for flat cells; with smooth cells take --method rays"
                    .to_owned(),
            ));
        }
        Ok(VisibilityMethod::Rays)
    }

    /// Horizons where they are needed in any case, or where many directions share their azimuths.
    fn quicker_method(&self, plan: &Plan) -> VisibilityMethod {
        let slanted = |directions: &[Incidence]| {
            let slanted = directions.iter().filter(|one| !one.is_vertical());
            slanted.count()
        };
        let rays = plan.sigmas.len() * (slanted(&plan.lights) + slanted(&plan.views));
        if self.run.demarcation || rays >= RAYS_WORTH_A_HORIZON * plan.azimuths().len() {
            VisibilityMethod::Horizons
        } else {
            VisibilityMethod::Rays
        }
    }

    /// Refuses what does not fit into memory.
    fn check_size(&self, plan: &Plan) -> Result<(), AttenuationError> {
        let [ny, nx] = plan.shape;
        let horizons = if plan.needs_horizons(&self.run) {
            plan.azimuths().len()
        } else {
            0
        };
        // Two facets and a sample per cell; a horizon takes 16 bytes, and the demarcation sorts two copies of
        // the halves of those of facets.
        let sorted = usize::from(self.run.demarcation);
        let cells = nx.saturating_mul(ny);
        let traced = match plan.recipes.cells() {
            Cells::Flat => traced_bytes(plan.shape, AcceleratorKind::Auto),
            Cells::Smooth => smooth_traced_bytes(plan.shape, AcceleratorKind::Auto),
        };
        let bytes = traced.saturating_add(cells.saturating_mul((48 + 8) * horizons + 32 * sorted));
        let bytes = bytes.max(plan.recipes.peak_bytes());
        check_memory("measuring one surface", bytes)?;
        let results = plan.sigmas.len() as f64
            * plan.lights.len() as f64
            * (plan.views.len() as f64 + 8.0)
            * self.run.realisations.0 as f64;
        if results > MOST_RESULTS {
            return Err(contradiction(format!(
                "{results:.1e} counts would be kept, {MOST_RESULTS:.0e} is the most: take fewer directions or surfaces",
            )));
        }
        Ok(())
    }

    /// Samples `[ny, nx]`.
    fn shape(&self) -> Result<[usize; 2], AttenuationError> {
        let surface = &self.surface;
        let [dx, dy] = surface.spacing.xy().map(|spacing| spacing.0);
        let length = match (surface.size, surface.length) {
            (Some(size), None) => {
                let [nx, ny] = size.xy().map(|samples| samples.0 as usize);
                return Ok([ny, nx]);
            }
            (None, Some(length)) => length,
            _ => {
                return Err(contradiction(
                    "give either length, the side of the tile, or size, its samples".to_owned(),
                ));
            }
        };
        let samples = |length: f64, spacing: f64| {
            let samples = length / spacing;
            let whole = samples.round();
            let divides = (samples - whole).abs() <= 1e-9 * whole;
            if spacing > 0.0 && (1.0..MOST_SAMPLES).contains(&whole) && divides {
                return Ok(whole as usize);
            }
            Err(contradiction(format!(
                "the length {} of the tile is not a multiple of the spacing {}: a periodic tile holds whole samples",
                short(length),
                short(spacing),
            )))
        };
        let [x, y] = length.xy().map(|length| length.0);
        Ok([samples(y, dy)?, samples(x, dx)?])
    }
}

/// Values of sigma whose models are drawn unless they are named.
const MODELS_DRAWN: usize = 3;

/// Angles at which fractions are drawn over sigma unless they are named.
const ANGLES_DRAWN: usize = 5;

/// Visibility rays that take as long as one horizon: measured at s = 1 and up to 80 degrees.
const RAYS_WORTH_A_HORIZON: usize = 8;

/// Most samples along a side that are told from one another.
const MOST_SAMPLES: f64 = 1e9;

/// Most counts kept in memory at 8 bytes.
const MOST_RESULTS: f64 = 1e8;

fn contradiction(text: String) -> AttenuationError {
    ConfigError::Contradiction(text).into()
}

/// The values of a list, each of which may stand there once.
fn numbers(name: &'static str, list: &OneOrMany<Number>) -> Result<Vec<f64>, ConfigError> {
    let values: Vec<f64> = list.values(name)?.iter().map(|value| value.0).collect();
    for (i, value) in values.iter().enumerate() {
        if values[..i].contains(value) {
            let text = format!("{name}: {} is given twice", short(*value));
            return Err(ConfigError::Contradiction(text));
        }
    }
    Ok(values)
}

fn directions(
    name: &'static str,
    list: &OneOrMany<Number>,
    phi: f64,
) -> Result<Vec<Incidence>, ConfigError> {
    let thetas = numbers(name, list)?;
    let direction = |theta| Incidence::from_degrees(theta, phi);
    Ok(thetas
        .into_iter()
        .map(direction)
        .collect::<Result<_, _>>()?)
}

/// Values of a list that a figure shows: those named, or, unless any is, `count` over its whole range.
fn chosen(
    name: &'static str,
    named: Option<&OneOrMany<Number>>,
    values: &[f64],
    count: usize,
) -> Result<Vec<f64>, ConfigError> {
    let Some(named) = named else {
        let last = values.len() - 1;
        let shown = count.min(values.len());
        let place = |i: usize| if shown > 1 { i * last / (shown - 1) } else { 0 };
        return Ok((0..shown).map(|i| values[place(i)]).collect());
    };
    let named = numbers(name, named)?;
    match named.iter().find(|value| !values.contains(value)) {
        None => Ok(named),
        Some(stranger) => Err(ConfigError::Contradiction(format!(
            "{name}: {} is not among the values that are measured",
            short(*stranger)
        ))),
    }
}

impl From<SynthesisError> for AttenuationError {
    fn from(error: SynthesisError) -> Self {
        Self::Synthesis(error)
    }
}

impl From<HorizonError> for AttenuationError {
    fn from(error: HorizonError) -> Self {
        contradiction(error.to_string())
    }
}
