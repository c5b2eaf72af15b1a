//! Flat layer model: names, parameters, validation, and the Fresnel terms of its bottom.

use asperity_optics::{Bottom, Fresnel, Layer, Material, MaterialError, PhaseFunction};
use asperity_tally::Sides;
use serde::Serialize;

/// The paths through a layer that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerPaths {
    /// Paths of the paper, without inner reflection. Unscattered light is reflected at the top or passes both
    /// faces. Light scattered once passes a face on its way in and a face on its way out, and meets none between.
    HanrahanKrueger,
    /// All paths of unscattered light and of light scattered once, with all inner reflections.
    All,
}

impl LayerPaths {
    /// Both, in the order of [`FlatLayer::NAMES`].
    pub const ALL: [Self; 2] = [Self::HanrahanKrueger, Self::All];

    /// The model of this name, if there is one.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|paths| paths.name() == name)
    }

    /// The name of the model.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => "hanrahan-krueger",
            Self::All => "flat-layer",
        }
    }

    /// One line about the model and its source.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => {
                "flat layer, unscattered light and single scattering inside, no reflection at inner faces (Hanrahan and Krueger 1993, Eqs. 18 to 21)"
            }
            Self::All => {
                "flat layer, unscattered light and single scattering inside, all reflections at its faces"
            }
        }
    }

    /// One sentence on where the model is meant to hold, and what it leaves out.
    #[must_use]
    pub const fn valid_range(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => {
                "flat faces, thin or absorbing media; all of light scattered once over half spaces and absorbing bottoms, elsewhere without what inner faces reflect; no mirror or Lambertian bottom"
            }
            Self::All => {
                "flat faces, thin or absorbing media; exact for light scattered once and never, without what is scattered more often; no Lambertian bottom"
            }
        }
    }
}

/// A flat layer, exact for light scattered at most once inside or as Hanrahan and Krueger have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatLayer {
    pub(super) eta: f64,
    /// Zero to infinity.
    pub(super) tau: f64,
    pub(super) albedo: f64,
    pub(super) phase: PhaseFunction,
    pub(super) bottom: Bottom,
    pub(super) paths: LayerPaths,
}

/// Error on making a model of a layer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlatLayerError {
    /// Invalid index of the top face.
    #[error(transparent)]
    Index(#[from] MaterialError),
    /// A bottom that the model does not describe.
    #[error("the model {model} {reason}")]
    Bottom {
        /// Name of the model.
        model: &'static str,
        /// Reason, and another choice.
        reason: &'static str,
    },
}

impl FlatLayer {
    /// The names of all models.
    pub const NAMES: [&'static str; 2] =
        [LayerPaths::HanrahanKrueger.name(), LayerPaths::All.name()];

    /// `layer` below a flat face of index `eta`, n_layer / n_above, which may be one.
    ///
    /// # Errors
    /// [`FlatLayerError`] for an invalid index, a Lambertian bottom, and a mirror under
    /// [`LayerPaths::HanrahanKrueger`].
    pub fn new(eta: f64, layer: &Layer, paths: LayerPaths) -> Result<Self, FlatLayerError> {
        Material::dielectric(eta)?;
        let medium = layer.medium();
        let (tau, bottom) = match layer.end() {
            Some(slab) => (medium.extinction() * slab.thickness, slab.bottom),
            None if medium.is_clear() => (0.0, Bottom::Open),
            // No light returns from infinite depth.
            None => (f64::INFINITY, Bottom::ABSORBING),
        };
        let reason = match (bottom, paths) {
            (Bottom::Face(Material::Lambertian { reflectance }), _) if reflectance > 0.0 => {
                "requires light to keep its angle between the faces, which a Lambertian bottom does not; use another bottom"
            }
            (Bottom::MIRROR, LayerPaths::HanrahanKrueger) => {
                "leaves out the light reflected by a mirror at the bottom; use flat-layer"
            }
            _ => "",
        };
        if !reason.is_empty() {
            let model = paths.name();
            return Err(FlatLayerError::Bottom { model, reason });
        }
        Ok(Self {
            eta,
            tau,
            albedo: medium.albedo(),
            phase: medium.phase(),
            bottom,
            paths,
        })
    }

    /// The paths that count.
    #[must_use]
    pub const fn paths(&self) -> LayerPaths {
        self.paths
    }

    /// Optical thickness `sigma_t d`; infinite for a half space.
    #[must_use]
    pub const fn optical_thickness(&self) -> f64 {
        self.tau
    }

    /// The sides that light leaves on.
    #[must_use]
    pub const fn sides(&self) -> Sides {
        match self.bottom.index_beyond() {
            Some(_) => Sides::Both,
            None => Sides::Reflected,
        }
    }

    /// Fresnel terms of the bottom at the cosine `mu`; absorbed light counts as transmitted.
    pub(super) fn bottom_face(&self, mu: f64) -> Fresnel {
        self.bottom.material().fresnel(mu)
    }
}
