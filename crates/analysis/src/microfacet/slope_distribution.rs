//! Slope distribution: what a model knows of the slopes of a surface.

use std::sync::Arc;

use glam::DVec3;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::ggx::Ggx;
use crate::microfacet::slope_mixture::SlopeMixture;
use crate::microfacet::slope_table::SlopeTable;
use crate::microfacet::slopes::SlopeCovariance;

/// The slopes of a surface, as models are made for them.
///
/// Models of Gaussian slopes take the covariance of any distribution, and so the root mean square slopes.
///
/// # Examples
/// ```
/// use asperity_analysis::{SlopeCovariance, SlopeDistribution};
///
/// let slopes = SlopeDistribution::from(SlopeCovariance::isotropic(2.0)?);
/// assert!(slopes.is_isotropic() && slopes.covariance().xx() == 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum SlopeDistribution {
    /// Gaussian slopes.
    Gaussian(SlopeCovariance),
    /// A mixture of Gaussian slopes.
    Mixture {
        /// Its components.
        mixture: Arc<SlopeMixture>,
        /// The covariance of all slopes.
        covariance: SlopeCovariance,
    },
    /// GGX slopes.
    Ggx {
        /// Their distribution, whose variance is infinite.
        ggx: Ggx,
        /// The slopes of a surface that ends the tail, where they are known.
        surface: Option<Arc<SlopeMixture>>,
        /// The covariance of the slopes of such a surface.
        covariance: SlopeCovariance,
    },
    /// Slopes of any density.
    Table {
        /// The density, with its mean slope at zero.
        table: Arc<SlopeTable>,
        /// The covariance of the slopes, which a table widens by its cells.
        covariance: SlopeCovariance,
    },
}

impl SlopeDistribution {
    /// Variances and covariance of the slopes.
    #[must_use]
    pub const fn covariance(&self) -> SlopeCovariance {
        match self {
            Self::Gaussian(covariance)
            | Self::Mixture { covariance, .. }
            | Self::Ggx { covariance, .. }
            | Self::Table { covariance, .. } => *covariance,
        }
    }

    /// The table; `None` of other distributions.
    #[must_use]
    pub fn table(&self) -> Option<&SlopeTable> {
        match self {
            Self::Gaussian(_) | Self::Mixture { .. } | Self::Ggx { .. } => None,
            Self::Table { table, .. } => Some(table),
        }
    }

    /// The GGX distribution, or that of the same `alpha` as the Beckmann distribution of the covariance.
    #[must_use]
    pub const fn ggx(&self) -> Ggx {
        match self {
            Self::Ggx { ggx, .. } => *ggx,
            _ => Ggx::new(self.covariance()),
        }
    }

    /// Returns `true` if the density is known to be the same along all azimuths: that of a table is not.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Gaussian(covariance) => covariance.is_isotropic(),
            Self::Mixture { mixture, .. } => mixture.is_isotropic(),
            Self::Ggx { ggx, .. } => ggx.beckmann().is_isotropic(),
            Self::Table { .. } => false,
        }
    }

    /// Smith's Lambda, of [`Beckmann::lambda`], [`SlopeMixture::lambda`], [`Ggx::lambda`] or [`SlopeTable::lambda`].
    #[must_use]
    pub fn lambda(&self, w: DVec3) -> f64 {
        match self {
            Self::Gaussian(covariance) => Beckmann::new(*covariance).lambda(w),
            Self::Mixture { mixture, .. } => mixture.lambda(w),
            Self::Ggx { ggx, .. } => ggx.lambda(w),
            Self::Table { table, .. } => table.lambda(w),
        }
    }
}

impl From<SlopeCovariance> for SlopeDistribution {
    fn from(covariance: SlopeCovariance) -> Self {
        Self::Gaussian(covariance)
    }
}

impl FacetNormals for SlopeDistribution {
    fn d(&self, m: DVec3) -> f64 {
        match self {
            Self::Gaussian(covariance) => Beckmann::new(*covariance).d(m),
            Self::Mixture { mixture, .. } => mixture.d(m),
            Self::Ggx { ggx, .. } => ggx.d(m),
            Self::Table { table, .. } => table.d(m),
        }
    }

    fn lambda(&self, w: DVec3) -> f64 {
        self.lambda(w)
    }
}
