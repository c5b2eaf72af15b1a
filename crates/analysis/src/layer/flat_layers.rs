//! Flat layers model: names, parameters and validation.

use asperity_optics::{Bottom, Layer, Material, MaterialError, PhaseFunction};
use asperity_tally::Sides;
use serde::Serialize;

/// The paths through flat layers that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerPaths {
    /// Paths of the paper, without inner reflection. Unscattered light is reflected at the top or passes all
    /// faces. Light scattered once passes the faces on its way in and on its way out, and is reflected at none.
    HanrahanKrueger,
    /// All paths of unscattered light and of light scattered once, with all inner reflections.
    All,
}

impl LayerPaths {
    /// Both, in the order of [`FlatLayers::NAMES`].
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
                "flat layers, unscattered light and single scattering inside, no reflection at inner faces (Hanrahan and Krueger 1993, Eqs. 18 to 21)"
            }
            Self::All => {
                "flat layers, unscattered light and single scattering inside, all reflections at their faces"
            }
        }
    }

    /// One sentence on where the model is meant to hold, and what it leaves out.
    #[must_use]
    pub const fn valid_range(self) -> &'static str {
        match self {
            Self::HanrahanKrueger => {
                "flat faces, thin or absorbing media; all of light scattered once in a half space or one layer over an absorbing bottom, elsewhere without what inner faces reflect; no mirror, metal or Lambertian bottom"
            }
            Self::All => {
                "flat faces, thin or absorbing media; exact for light scattered once and never, without what is scattered more often; no Lambertian bottom"
            }
        }
    }
}

/// Layers between flat faces, exact for light scattered at most once inside or as Hanrahan and Krueger have it.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatLayers {
    /// Faces from above, as light from above meets them: one more than layers.
    pub(super) faces: Vec<Material>,
    /// Media between the faces, from above.
    pub(super) media: Vec<FlatMedium>,
    /// Indices of the medium above, of the layers, and of the medium beyond if light gets there; relative to the first.
    pub(super) indices: Vec<f64>,
    /// `true` if the bottom is open, which does not count as an interaction.
    pub(super) is_open: bool,
    pub(super) paths: LayerPaths,
}

/// The medium of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlatMedium {
    /// Optical thickness, zero to infinity.
    pub(super) tau: f64,
    pub(super) albedo: f64,
    pub(super) phase: PhaseFunction,
}

/// Error on making a model of layers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlatLayersError {
    /// Invalid index of the top face.
    #[error(transparent)]
    Index(#[from] MaterialError),
    /// A layer that no light enters.
    #[error(
        "the model {model} needs a clear face above layer {layer}, through which light enters it"
    )]
    Dark {
        /// Name of the model.
        model: &'static str,
        /// Number of the layer from above, from one.
        layer: usize,
    },
    /// A bottom that the model does not describe.
    #[error("the model {model} {reason}")]
    Bottom {
        /// Name of the model.
        model: &'static str,
        /// Reason, and another choice.
        reason: &'static str,
    },
}

impl FlatLayers {
    /// The names of all models.
    pub const NAMES: [&'static str; 2] =
        [LayerPaths::HanrahanKrueger.name(), LayerPaths::All.name()];

    /// `layers`, from above, below a flat face of the material `top`, whose index may be one.
    ///
    /// # Errors
    /// [`FlatLayersError`] for an invalid index, layers below a face that transmits no light, a Lambertian bottom, and
    /// a mirror or a metal under [`LayerPaths::HanrahanKrueger`].
    pub fn new(
        top: Material,
        layers: &[Layer],
        paths: LayerPaths,
    ) -> Result<Self, FlatLayersError> {
        if let Material::Dielectric { eta } = top {
            Material::dielectric(eta)?;
        }
        let mut stack = Self {
            faces: vec![top],
            media: Vec::with_capacity(layers.len()),
            indices: vec![1.0],
            is_open: false,
            paths,
        };
        stack.indices.extend(top.transmitting_index());
        for layer in layers {
            stack.add(layer)?;
        }
        stack.check_bottom()?;
        Ok(stack)
    }

    /// Adds a layer below the lowest face.
    fn add(&mut self, layer: &Layer) -> Result<(), FlatLayersError> {
        let index = self.indices.get(self.faces.len()).copied();
        let index = index.filter(|_| !self.is_open);
        let index = index.ok_or_else(|| FlatLayersError::Dark {
            model: self.paths.name(),
            layer: self.faces.len(),
        })?;
        let medium = layer.medium();
        let (tau, bottom) = match layer.end() {
            Some(slab) => (medium.extinction() * slab.thickness, slab.bottom),
            None if medium.is_clear() => (0.0, Bottom::Open),
            // No light returns from infinite depth.
            None => (f64::INFINITY, Bottom::ABSORBING),
        };
        self.media.push(FlatMedium {
            tau,
            albedo: medium.albedo(),
            phase: medium.phase(),
        });
        self.faces.push(bottom.material());
        let beyond = bottom.index_beyond().map(|beyond| index * beyond);
        self.indices.extend(beyond);
        self.is_open = bottom == Bottom::Open;
        Ok(())
    }

    fn check_bottom(&self) -> Result<(), FlatLayersError> {
        let [.., bottom] = self.faces.as_slice() else {
            return Ok(());
        };
        let reason = match (bottom, self.paths) {
            (Material::Lambertian { reflectance: 0.0 }, _) => return Ok(()),
            (Material::Lambertian { .. }, _) => {
                "requires light to keep its angle between the faces, which a Lambertian bottom does not; use another bottom"
            }
            (_, LayerPaths::HanrahanKrueger) if self.sides() == Sides::Reflected => {
                "leaves out the light reflected by a mirror or a metal at the bottom; use flat-layer"
            }
            _ => return Ok(()),
        };
        Err(FlatLayersError::Bottom {
            model: self.paths.name(),
            reason,
        })
    }

    /// The paths that count.
    #[must_use]
    pub const fn paths(&self) -> LayerPaths {
        self.paths
    }

    /// Optical thickness of all layers, the sum of `sigma_t d`; infinite with a half space.
    #[must_use]
    pub fn optical_thickness(&self) -> f64 {
        self.media.iter().map(|medium| medium.tau).sum()
    }

    /// The sides that light leaves on.
    #[must_use]
    pub fn sides(&self) -> Sides {
        match self.index_beyond() {
            Some(_) => Sides::Both,
            None => Sides::Reflected,
        }
    }

    /// Index of the medium below the layers, relative to that above, if light gets there.
    pub(super) fn index_beyond(&self) -> Option<f64> {
        self.indices.get(self.faces.len()).copied()
    }
}
