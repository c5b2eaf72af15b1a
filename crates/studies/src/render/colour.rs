//! Colour: one picture of those at several wavelengths.

use asperity_io::Picture;
use asperity_optics::{ColourObserver, colour_weights, linear_srgb};

use crate::config::error::ConfigError;

const OBSERVER: ColourObserver = ColourObserver::Cie1931;

/// Weights `[X, Y, Z]` of wavelengths, nm, for lights with the spectrum of D65; see [`colour_weights`].
///
/// # Errors
/// [`ConfigError`] if they do not cover visible light.
pub(super) fn weights(wavelengths_nm: &[f64]) -> Result<Vec<[f64; 3]>, ConfigError> {
    colour_weights(wavelengths_nm, OBSERVER).ok_or_else(|| {
        let given = format!("{} wavelengths", wavelengths_nm.len());
        let reason = "a picture takes one, or in colour those from 400 to 700 nm in increasing steps of at most 20 nm";
        ConfigError::unsuitable(given, reason)
    })
}

/// Adds pictures of one size at several wavelengths, each with its weight `[X, Y, Z]`.
///
/// Errors add up, as those that are fully correlated: all wavelengths share their random numbers.
pub(super) fn add(sum: Option<Picture>, picture: Picture, xyz: [f64; 3]) -> Picture {
    let rgb = linear_srgb(xyz, OBSERVER);
    let colours = |radiance: &f64| rgb.map(|weight| weight * radiance);
    let colour = picture.radiance.iter().map(colours).collect();
    let weighted = |values: Vec<f64>| values.into_iter().map(|value| xyz[1] * value).collect();
    let picture = Picture {
        colour: Some(colour),
        radiance: weighted(picture.radiance),
        error: weighted(picture.error),
        ..picture
    };
    let Some(mut sum) = sum else {
        return picture;
    };
    let into = |sums: &mut [f64], values: &[f64]| {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    };
    into(&mut sum.radiance, &picture.radiance);
    into(&mut sum.error, &picture.error);
    let colours = sum.colour.iter_mut().zip(&picture.colour);
    for (sums, values) in colours {
        into(sums.as_flattened_mut(), values.as_flattened());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_light_gives_equal_channels_and_errors_add_up() {
        let wavelengths: Vec<f64> = (19..=39).map(|i| f64::from(20 * i)).collect();
        let mut sum = None;
        for xyz in weights(&wavelengths).unwrap() {
            let one = Picture {
                size: [1, 1],
                radiance: vec![0.5],
                error: vec![0.1],
                coverage: vec![1.0],
                colour: None,
            };
            sum = Some(add(sum, one, xyz));
        }
        let sum = sum.unwrap();
        // The matrix of sRGB is rounded to four digits.
        for channel in sum.colour.unwrap()[0] {
            assert!((channel - 0.5).abs() < 1e-3, "{channel}");
        }
        assert!((sum.radiance[0] - 0.5).abs() < 1e-12);
        assert!((sum.error[0] - 0.1).abs() < 1e-12);
        assert_eq!(sum.coverage, [1.0]);
    }
}
