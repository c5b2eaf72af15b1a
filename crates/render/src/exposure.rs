//! Exposure: the factor from radiance to the brightness of a picture.

use asperity_io::Picture;

/// The factor from radiance to brightness, where one is white: nine tenths of white at the 99th percentile of the
/// pixels that show the surface, or of all pixels if none does. One for a picture without light.
#[must_use]
pub fn exposure(picture: &Picture) -> f64 {
    let pixels = picture.radiance.iter().zip(&picture.coverage);
    let mut shown: Vec<f64> = pixels
        .filter(|(_, coverage)| **coverage >= 0.5)
        .map(|(radiance, _)| *radiance)
        .collect();
    if shown.is_empty() {
        shown.clone_from(&picture.radiance);
    }
    shown.sort_unstable_by(f64::total_cmp);
    let brightest = shown.get(shown.len() * 99 / 100).copied().unwrap_or(0.0);
    if brightest > 0.0 {
        0.9 / brightest
    } else {
        1.0
    }
}
