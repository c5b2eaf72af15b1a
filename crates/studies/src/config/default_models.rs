//! Default models: those that random surfaces are compared with where none are named.

use asperity_analysis::{Heitz, LayerPaths, OrenNayar, Smith, SmithSlopes};

use crate::config::medium::{BottomKind, MediumConfig};
use crate::config::{CompareConfig, MaterialConfig, SurfaceConfig, VerifyConfig};
use crate::settings::Document;

/// Properties of a surface by which its models are chosen.
pub(crate) struct Described<'a> {
    pub(crate) surface: &'a SurfaceConfig,
    pub(crate) material: &'a MaterialConfig,
    pub(crate) medium: Option<&'a MediumConfig>,
    /// `true` if the material absorbs along the path of light inside.
    pub(crate) has_body: bool,
    /// `true` if polarised light falls on it.
    pub(crate) is_polarised: bool,
}

impl Described<'_> {
    /// The models in place of those of isotropic surfaces of mirrors or refracting facets; `None` where these hold.
    ///
    /// No model describes rough surfaces over an absorbing body.
    /// Over a medium, the layer between flat faces, or none where that ends on a Lambertian bottom. Isotropic Lambertian facets get Oren and
    /// Nayar; anisotropic ones have no default. Anisotropic surfaces of other materials get Smith and Heitz, since the model of Xu and Sun is
    /// isotropic. No model is of polarised light. Surfaces of GGX slopes get GGX with Smith's masking, once and for all orders, and Smith's model of the slopes that they have.
    fn models(&self) -> Option<Vec<String>> {
        if self.is_polarised {
            return Some(Vec::new());
        }
        let is_isotropic = self.surface.is_isotropic();
        let names: &[&str] = match (self.medium, self.material) {
            (Some(medium), _) if medium.bottom == Some(BottomKind::Lambertian) => &[],
            (Some(_), _) => &[LayerPaths::All.name()],
            (None, _) if self.has_body => &[],
            (None, MaterialConfig::Lambertian { .. }) if is_isotropic => &[OrenNayar::NAME],
            (None, MaterialConfig::Lambertian { .. }) => &[],
            (None, _) if self.surface.has_ggx_slopes() => {
                &[Smith::NAME_GGX, Heitz::NAME_GGX, SmithSlopes::NAME]
            }
            (None, _) if is_isotropic => return None,
            (None, _) => &[Smith::NAME_CORRELATED, Heitz::NAME],
        };
        Some(names.iter().map(|&name| name.to_owned()).collect())
    }

    /// Puts the default models in place, unless `document` names models.
    pub(crate) fn choose(&self, compare: &mut CompareConfig, document: &Document) {
        if !document.is_given("compare.models")
            && let Some(models) = self.models()
        {
            compare.models = models;
        }
    }
}

impl VerifyConfig {
    /// Chooses the default models unless `document` names models; after the files of the surface are read, which may give it a direction.
    pub fn choose_models(&mut self, document: &Document) {
        let described = Described {
            surface: &self.surface,
            material: &self.material,
            medium: self.medium.as_ref(),
            has_body: self.light.enters_body(&self.material),
            is_polarised: self.light.is_polarised(),
        };
        described.choose(&mut self.compare, document);
    }
}
