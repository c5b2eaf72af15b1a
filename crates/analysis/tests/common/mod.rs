//! What several tests share.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use asperity_analysis::{BsdfModel, SlopeCovariance};
use asperity_optics::Material;

/// The closed form of that name for an isotropic surface of smoothness `s`.
pub(crate) fn closed_form(name: &str, s: f64, material: Material) -> Box<dyn BsdfModel> {
    let slopes = SlopeCovariance::isotropic(s).unwrap();
    asperity_analysis::closed_form(name, slopes, material).unwrap()
}
