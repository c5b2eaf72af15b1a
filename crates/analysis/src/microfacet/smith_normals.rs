//! Smith normals: distributions of facets with a closed form of Smith's Lambda.

use glam::DVec3;
use rand::Rng;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::ggx::Ggx;
use crate::microfacet::slope_distribution::SlopeDistribution;

/// Facets whose visible normals are sampled, and whose shadowing and masking have a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SmithNormals {
    Beckmann(Beckmann),
    Ggx(Ggx),
}

impl SmithNormals {
    /// The slopes of the facets.
    pub(crate) fn slopes(&self) -> SlopeDistribution {
        match self {
            Self::Beckmann(beckmann) => (*beckmann.slopes()).into(),
            Self::Ggx(ggx) => SlopeDistribution::Ggx {
                ggx: *ggx,
                surface: None,
                covariance: *ggx.beckmann(),
            },
        }
    }

    /// Smith's Lambda of direction `w`, up or down.
    pub(crate) fn lambda(&self, w: DVec3) -> f64 {
        match self {
            Self::Beckmann(beckmann) => beckmann.lambda(w),
            Self::Ggx(ggx) => ggx.lambda(w),
        }
    }

    /// Samples a visible facet normal, with the density `max(0, w . m) D(m)` up to a factor.
    pub(crate) fn sample_visible(&self, w: DVec3, rng: &mut impl Rng) -> DVec3 {
        match self {
            Self::Beckmann(beckmann) => beckmann.sample_visible(w, rng),
            Self::Ggx(ggx) => ggx.sample_visible(w, rng),
        }
    }
}

impl FacetNormals for SmithNormals {
    fn d(&self, m: DVec3) -> f64 {
        match self {
            Self::Beckmann(beckmann) => beckmann.d(m),
            Self::Ggx(ggx) => ggx.d(m),
        }
    }

    fn lambda(&self, w: DVec3) -> f64 {
        self.lambda(w)
    }
}
