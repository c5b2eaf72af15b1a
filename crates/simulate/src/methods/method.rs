//! Method: estimates a case by path starts, branching, a control variate, and folding of bins.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_analysis::{ModelError, SlopeMixture, control_variate};
use asperity_optics::{Incidence, Material};
use asperity_synthesis::SurfaceRecipe;
use asperity_tally::{
    ControlVariate, Mirror, Polarimetry, RayErrors, TallyResult, TallySpec, TallyValues,
};
use asperity_tracer::{Illumination, PathSettings, Sampling, Starts, Window};
use serde::{Deserialize, Serialize};

use crate::error::SimulateError;
use crate::input::case::{Case, Light};
use crate::input::estimator::Estimator;
use crate::input::settings::{Effort, Settings};

/// Method of a case: path starts, branching, control variate, and folding of bins.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    pub(crate) starts: Starts,
    pub(crate) paths: PathSettings,
    pub(crate) control_variate: Option<(ControlVariate, ControlVariateMean)>,
    /// Averages bins on either side of the plane of incidence, where the light on both is the same on average.
    pub(crate) mirror: Option<Mirror>,
}

/// Source of the mean of a control variate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ControlVariateMean {
    /// The integral over Gaussian slopes: it removes noise of rays and of surfaces, and the mesh error,
    /// of unshadowed single scattering.
    GaussianSlopes,
    /// The integral over a mixture of Gaussian slopes.
    SlopeMixture,
    /// The sum over the facets of the one surface that is traced: it removes noise of rays alone.
    FacetsOfSurface,
}

/// Variance of the weights of points on a surface up to which they are taken: beyond, rays from above
/// are worth more than what their first segment costs.
const MOST_WEIGHT_VARIANCE: f64 = 0.25;

/// The probability of tracing into the shadow is at least `2^-HALVINGS`.
const HALVINGS: i32 = 6;

pub(crate) const UNPOLARISED_LIGHT: &str =
    "knows unpolarised incident light alone; with --stokes take auto or plain";

pub(crate) const SPECULAR_FACETS: &str =
    "knows facets that reflect as mirrors or refract; these are Lambertian, so take auto or plain";

const KNOWN_SLOPES: &str =
    "needs the distribution of slopes, which is not known for these surfaces; take auto or plain";

impl Method {
    /// Rays from above, and nothing else, on paths that no pilot run has chosen.
    pub(crate) const fn plain(settings: &Settings) -> Self {
        Self {
            starts: Starts::FromAbove,
            paths: settings.paths.without_pilot(),
            control_variate: None,
            mirror: None,
        }
    }

    /// Other methods that may serve a case better, on the paths that it has and on others: rays from above where these start on the
    /// surface, and the other way about; and no control variate, if the choice of the estimator is free.
    pub(crate) fn alternatives(&self, settings: &Settings, material: Material) -> Vec<Self> {
        if self.control_variate.is_none() {
            return Vec::new();
        }
        let from_elsewhere = Self {
            starts: match self.starts {
                Starts::FromAbove => Starts::OnSurface,
                Starts::OnSurface => Starts::FromAbove,
            },
            ..self.clone()
        };
        let mut found = Vec::new();
        if !needs_equal_weights(settings) {
            found.push(from_elsewhere);
        }
        if settings.estimator == Estimator::Auto {
            let plain = Self {
                mirror: self.mirror,
                ..Self::plain(settings)
            };
            let others = settings.paths.alternatives(material);
            found.extend(others.into_iter().map(|paths| plain.on(paths)));
            found.push(plain);
        }
        found
    }

    /// The method on other paths.
    pub(crate) fn on(&self, paths: PathSettings) -> Self {
        Self {
            paths,
            ..self.clone()
        }
    }

    /// The method for a case of random surfaces. `known_slopes`: their distribution, where it is known.
    pub(crate) fn of_random(
        case: &Case,
        recipe: &SurfaceRecipe,
        known_slopes: Option<&SlopeMixture>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        let mirror = if settings.fold {
            symmetry(&case.light, recipe, &settings.spec_of(case))
        } else {
            None
        };
        let method = Self::with_any_control(case, known_slopes, settings)?;
        Ok(Self { mirror, ..method })
    }

    /// The method for a case of random surfaces, before its bins are folded.
    ///
    /// No control variate knows of a layer, or of several directions of light. The result of one surface alone is reported as it is, without the
    /// mean of others, unless the estimator is named.
    fn with_any_control(
        case: &Case,
        known_slopes: Option<&SlopeMixture>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        let one_surface = matches!(settings.effort, Effort::Rays { surfaces: 1, .. });
        let is_plain = match settings.estimator {
            Estimator::Auto => one_surface,
            named => named == Estimator::Plain,
        };
        if is_plain || !case.layers.is_empty() || case.light.spread.is_some() {
            return Ok(Self::plain(settings));
        }
        if case.material.is_diffuse() {
            return Self::uncontrolled(settings, SPECULAR_FACETS);
        }
        if case.light.is_polarised() {
            return Self::uncontrolled(settings, UNPOLARISED_LIGHT);
        }
        let Some(slopes) = known_slopes else {
            return Self::uncontrolled(settings, KNOWN_SLOPES);
        };
        let incidence = case.light.incidence;
        match control_variate(slopes, case.material, incidence, &settings.spec_of(case)) {
            Ok(control_variate) => {
                let mean = match slopes.components() {
                    [_] => ControlVariateMean::GaussianSlopes,
                    _ => ControlVariateMean::SlopeMixture,
                };
                Self::with_control_variate(settings, control_variate, mean, slopes, incidence)
            }
            // Light that goes straight on through equal indices has no density to integrate.
            Err(ModelError::MatchedIndices(_)) if settings.estimator == Estimator::Auto => {
                Ok(Self::plain(settings))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// The method where there is no control variate, since it `needs` something that the case does not have.
    pub(crate) const fn uncontrolled(
        settings: &Settings,
        needs: &'static str,
    ) -> Result<Self, SimulateError> {
        match settings.estimator {
            Estimator::Auto | Estimator::Plain => Ok(Self::plain(settings)),
            Estimator::Controlled => Err(SimulateError::NoControlVariate { needs }),
        }
    }

    /// The method that makes best use of a control variate, or of none if the choice is free and none pays.
    pub(crate) fn with_control_variate(
        settings: &Settings,
        control_variate: ControlVariate,
        mean: ControlVariateMean,
        slopes: &SlopeMixture,
        incidence: Incidence,
    ) -> Result<Self, SimulateError> {
        let wi = incidence.wi();
        let seen: f64 = control_variate.expected().budget().total();
        let worth = Worth::new(seen, slopes.lambda(wi));
        if seen == 0.0 || settings.estimator == Estimator::Auto && worth.time >= 1.0 {
            return Ok(Self::plain(settings));
        }
        let slopes = slopes.covariance()?;
        let [x, y] = [wi.x / wi.z, wi.y / wi.z];
        let weight_variance = slopes.xx() * x * x + 2.0 * slopes.xy() * x * y + slopes.yy() * y * y;
        Ok(Self {
            starts: if weight_variance <= MOST_WEIGHT_VARIANCE && !needs_equal_weights(settings) {
                Starts::OnSurface
            } else {
                Starts::FromAbove
            },
            paths: settings.paths.without_pilot(),
            control_variate: Some((
                control_variate
                    .weakened(worth.weight)
                    .with_shadow_probability(worth.shadow_probability),
                mean,
            )),
            mirror: None,
        })
    }

    /// The light of a case, as it is sampled by this method.
    pub(crate) const fn illumination(&self, light: &Light, sampling: Sampling) -> Illumination {
        Illumination {
            incidence: light.incidence,
            spread: light.spread,
            any_azimuth: light.random_azimuth,
            sampling,
            starts: self.starts,
            stokes: light.stokes,
            window: Window::WHOLE,
        }
    }

    /// The control variate, if there is one.
    pub(crate) fn control_variate(&self) -> Option<&ControlVariate> {
        self.control_variate
            .as_ref()
            .map(|(control_variate, _)| control_variate)
    }

    /// Source of the mean of the control variate.
    pub(crate) fn control_variate_mean(&self) -> Option<ControlVariateMean> {
        self.control_variate.as_ref().map(|(_, mean)| *mean)
    }

    /// Errors below which no mean of `rays` rays is reported, by the number of rays that carry it. `squares`: of the standard errors by the
    /// scatter of rays.
    pub(crate) fn least_errors(
        &self,
        light: &Light,
        means: &TallyValues,
        squares: &TallyValues,
        rays: u64,
    ) -> TallyValues {
        RayErrors {
            means,
            squares,
            rays,
            forward_azimuth: light.incidence.phi() + PI,
            folded: self.mirror.is_some(),
            control_variate: self.control_variate(),
        }
        .least()
    }

    /// The name of the estimator that this is.
    pub(crate) const fn estimator(&self) -> Estimator {
        match self.control_variate {
            Some(_) => Estimator::Controlled,
            None => Estimator::Plain,
        }
    }
}

/// Returns `true` if paths should not start on the surface: their weights add up to one only on average, and no control variate takes that
/// scatter from the elements of Mueller matrices.
fn needs_equal_weights(settings: &Settings) -> bool {
    settings.tally.polarimetry() == Polarimetry::Mueller
}

/// The plane of incidence, if light and random surfaces are symmetric about it on average, and bins are mirrored onto bins.
///
/// Light of random azimuth on isotropic surfaces is; light of fixed azimuth along an axis of the samples that is also an axis
/// of the spectrum. Off the axes, tiles repeat in other directions on the one side than on the other. Polarised light is symmetric
/// without U and V.
fn symmetry(light: &Light, recipe: &SurfaceRecipe, spec: &TallySpec) -> Option<Mirror> {
    let azimuth = light.incidence.phi();
    let quarters = azimuth / FRAC_PI_2;
    let along_axis = (quarters - quarters.round()).abs() < 1e-9;
    let is_symmetric = if light.random_azimuth {
        recipe.is_isotropic()
    } else {
        along_axis && recipe.is_mirror_symmetric()
    };
    let [_, u, v] = light.stokes;
    (is_symmetric && [u, v] == [0.0; 2])
        .then(|| Mirror::about(azimuth, &spec.grid()))
        .flatten()
}

/// Gain by a control variate that is expected for rays from above.
///
/// A ray hits one facet and passes `lambda` others in its shadow, on average. The light that leaves the first
/// is not masked with probability `v`. If what is subtracted has the weight `b`, and shadows are traced
/// with probability `q`, the variance is `1 - 2 v b + b^2 (1 + lambda / q)` of what it is without, least
/// at `b = v / (1 + lambda / q)`. The time rises to about `1 + q lambda`, since a facet in the shadow
/// costs about as much as a path does. With all shadows, `b` is the fraction of facets facing the light
/// that are lit and visible.
struct Worth {
    /// Best probability of tracing into the shadow.
    shadow_probability: f64,
    /// Weight then, over that with all shadows.
    weight: f64,
    /// Time for the same error, over that without a control variate.
    time: f64,
}

impl Worth {
    fn new(seen: f64, lambda: f64) -> Self {
        let with = |shadow_probability: f64| {
            let spread = 1.0 + lambda / shadow_probability;
            Self {
                shadow_probability,
                weight: (1.0 + lambda) / spread,
                time: (1.0 + shadow_probability * lambda) * (1.0 - seen * seen / spread),
            }
        };
        // The minimum is flat.
        (1..=HALVINGS)
            .map(|k| with(0.5_f64.powi(k)))
            .fold(
                with(1.0),
                |best, other| {
                    if other.time < best.time { other } else { best }
                },
            )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_control_variate_pays_where_most_is_visible_and_never_costs_much() {
        assert!(Worth::new(1.0, 0.0).time < 1e-12);
        assert!(Worth::new(0.98, 1e-4).time < 0.05);
        assert!(Worth::new(0.3, 1.5).time > 1.0);
        for i in 0..=100 {
            for k in 0..=120 {
                let worth = Worth::new(0.01 * f64::from(i), 0.1 * f64::from(k));
                assert!(worth.time < 1.2, "{i} {k} {}", worth.time);
                assert!(worth.weight <= 1.0);
            }
        }
    }
}
