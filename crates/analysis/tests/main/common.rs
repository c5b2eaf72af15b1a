//! Helpers that several tests share.

use asperity_analysis::{BsdfModel, SlopeCovariance};
use asperity_optics::Material;

/// The closed form of that name for an isotropic surface of smoothness `s`.
pub(crate) fn closed_form(name: &str, s: f64, material: Material) -> Box<dyn BsdfModel> {
    let slopes = SlopeCovariance::isotropic(s).unwrap();
    asperity_analysis::closed_form(name, slopes, material).unwrap()
}

/// The closed form of that name for slopes of variances 1 to 0.4 times `variance`, principal directions
/// along no axis.
pub(crate) fn correlated(name: &str, variance: f64, material: Material) -> Box<dyn BsdfModel> {
    let (s, c) = f64::sin_cos(0.4);
    let (long, short) = (variance, 0.4 * variance);
    let slopes = SlopeCovariance::new(
        long * c * c + short * s * s,
        long * s * s + short * c * c,
        (long - short) * s * c,
    );
    asperity_analysis::closed_form(name, slopes.unwrap(), material).unwrap()
}
