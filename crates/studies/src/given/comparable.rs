//! Comparable surfaces: the reasons for which a given surface is not compared with models.

use asperity_analysis::ModelError;
use asperity_simulate::short;

/// Reasons for which a given surface is not compared with models.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ComparedSurfaceError {
    /// There are several surfaces.
    #[error(
        "--models: models are compared with one surface, whose slopes they are made for, but {count} are given; give one, or leave out --models"
    )]
    Several {
        /// Number of surfaces.
        count: usize,
    },
    /// The heights do not lose their correlation, or are all equal.
    #[error(
        "--models: the heights of {name} are all equal, or keep their correlation over half of its width: errors by parts of a surface need parts that are independent; take away its form, if it has one (--remove plane or parabola), or leave out --models, as for grooves"
    )]
    Correlated {
        /// Name of the surface.
        name: String,
    },
    /// The surface is too small.
    #[error(
        "--models: {name} is {:.1} x {:.1} correlation lengths wide; errors by parts of a surface need {regions} parts, each {width} correlation lengths wide or more: take a larger surface, or leave out --models",
        widths[0],
        widths[1]
    )]
    FewRegions {
        /// Name of the surface.
        name: String,
        /// Its widths along x and y, in correlation lengths.
        widths: [f64; 2],
        /// Fewest parts.
        regions: u32,
        /// Least width of a part, in correlation lengths.
        width: f64,
    },
    /// The slopes of the surface are not isotropic, and a model is of isotropic ones.
    #[error(
        "--models: slope variances of {name} along its principal axes, {} and {}, differ by more than their errors: {error}",
        short(.variances[0]),
        short(.variances[1])
    )]
    Anisotropic {
        /// Name of the surface.
        name: String,
        /// The variances, the larger first.
        variances: [f64; 2],
        /// The refusal of the model.
        error: ModelError,
    },
}
