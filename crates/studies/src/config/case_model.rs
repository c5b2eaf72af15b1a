//! The model of a case by its name: of the surface, or of what lies below it.

use asperity_analysis::{
    BsdfModel, Expectation, FlatLayers, LayerPaths, MODEL_NAMES, ModelError, SamplingEffort,
    ScatteringModel, Scope, SlopeCovariance, SlopeDistribution, SlopeError, create_model,
    expect_unless,
};
use asperity_optics::{Incidence, Layer, Material};
use asperity_simulate::{Case, Observer, SimulateError, slope_distribution};
use asperity_tally::{Azimuth, Component, Sides, TallySpec};

use crate::config::error::ConfigError;

/// Surface that a model is made for.
#[derive(Clone, Debug)]
pub(crate) struct ModelledSurface {
    /// Its slopes, if they have a density.
    pub(crate) slopes: Result<SlopeDistribution, SlopeError>,
    /// `true` if models of isotropic surfaces take the mean of the slope variances along both axes, which differ by no more than their
    /// errors.
    pub(crate) is_nearly_isotropic: bool,
    pub(crate) material: Material,
    /// The layers below.
    pub(crate) layers: Vec<Layer>,
}

impl ModelledSurface {
    /// Surface of a case on random surfaces; `None` for a given surface.
    pub(crate) fn of(case: &Case) -> Option<Self> {
        let slopes = slope_distribution(case.surface.recipe()?);
        let (material, layers) = case.towards_light()?;
        Some(Self {
            slopes,
            is_nearly_isotropic: false,
            material,
            layers,
        })
    }

    /// Returns the surface with Gaussian slopes of this covariance.
    pub(crate) fn with_slopes(&self, slopes: SlopeCovariance) -> Self {
        Self {
            slopes: Ok(SlopeDistribution::Gaussian(slopes)),
            ..self.clone()
        }
    }

    /// The model of that name of the bare surface.
    fn model(&self, name: &str) -> Result<Box<dyn ScatteringModel>, ModelError> {
        let slopes = self.slopes.clone()?;
        match create_model(name, slopes.clone(), self.material) {
            Err(error) if error.is_anisotropic() && self.is_nearly_isotropic => {
                let covariance = slopes.covariance();
                let mean = 0.5 * (covariance.xx() + covariance.yy());
                let isotropic = SlopeDistribution::from(SlopeCovariance::new(mean, mean, 0.0)?);
                create_model(name, isotropic, self.material)
            }
            model => model,
        }
    }
}

/// A model for a case.
pub enum CaseModel {
    /// Model of a rough surface with nothing below that scatters.
    Surface(Box<dyn ScatteringModel>),
    /// Model of layers between flat faces.
    Layer(Box<FlatLayers>),
}

impl CaseModel {
    /// The model of that name for a surface, its material and the medium below.
    pub(crate) fn of(name: &str, surface: &ModelledSurface) -> Result<Self, ConfigError> {
        let of_other_layers = |has_medium| ConfigError::ModelOfOtherLayers {
            name: name.to_owned(),
            has_medium,
        };
        match (surface.layers.as_slice(), LayerPaths::by_name(name)) {
            (layers @ [_, ..], Some(paths)) => {
                let model = FlatLayers::new(surface.material, layers, paths)?;
                Ok(Self::Layer(Box::new(model)))
            }
            ([_, ..], _) if MODEL_NAMES.contains(&name) => Err(of_other_layers(true)),
            ([], Some(_)) => Err(of_other_layers(false)),
            _ => match surface.model(name) {
                Ok(model) => Ok(Self::Surface(model)),
                Err(error) => Err(ConfigError::RefusedModel {
                    name: name.to_owned(),
                    error,
                }),
            },
        }
    }

    /// The name that it is requested by.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Surface(model) => model.name(),
            Self::Layer(model) => model.paths().name(),
        }
    }

    /// The light that it describes.
    #[must_use]
    pub fn scope(&self) -> Scope {
        match self {
            Self::Surface(model) => model.scope(),
            Self::Layer(_) => Scope::ScatteredInside,
        }
    }

    /// The sides whose light it describes.
    #[must_use]
    pub fn sides(&self) -> Sides {
        match self {
            Self::Surface(model) => model.sides(),
            // Nothing leaves on the other.
            Self::Layer(_) => Sides::Both,
        }
    }

    /// The density of light that the surface scattered once, if it has a closed form.
    #[must_use]
    pub fn density(&self) -> Option<&dyn BsdfModel> {
        match self {
            Self::Surface(model) => model.density(),
            Self::Layer(_) => None,
        }
    }

    /// The components of the light that it claims to describe.
    pub(crate) fn claims(&self) -> Vec<Component> {
        match self {
            Self::Surface(model) if model.scope() == Scope::AllOrders => Component::BINS.to_vec(),
            Self::Surface(_) => vec![Component::Single],
            Self::Layer(model) => match model.paths() {
                // The paper is about what the medium scatters.
                LayerPaths::HanrahanKrueger => vec![Component::ScatteredOnce],
                LayerPaths::All => [Component::Unscattered, Component::ScatteredOnce].to_vec(),
            },
        }
    }

    /// The component by which it is judged.
    pub(crate) fn judged_component(&self) -> Component {
        match self.scope() {
            Scope::AllOrders => Component::All,
            Scope::ScatteredInside => Component::ScatteredOnce,
            _ => Component::Single,
        }
    }

    /// Returns its expectation in a tally of `spec`.
    pub(crate) fn expect(
        &self,
        incidence: Incidence,
        spec: &TallySpec,
        azimuth: Azimuth,
        effort: SamplingEffort,
        observer: &dyn Observer,
    ) -> Result<Expectation, SimulateError> {
        let gives_up = || observer.gives_up_first();
        if gives_up() {
            return Err(SimulateError::Interrupted);
        }
        match self {
            Self::Surface(model) => {
                let model = model.as_ref();
                let found = expect_unless(model, incidence, spec, azimuth, effort, &gives_up);
                found.ok_or(SimulateError::Interrupted)
            }
            Self::Layer(model) => Ok(model.expect(incidence, spec, azimuth)),
        }
    }
}
