//! Exposure: the factor from radiance to the brightness of a picture.

use asperity_io::Picture;

/// Upper limit of the white level over the median pixel. Beyond it a few highlights would leave everything else black.
const MAX_OVER_MEDIAN: f64 = 4.0;

/// The factor from radiance to brightness, where one is white: nine tenths of white at the 99th percentile of the
/// pixels that show the surface, or of all pixels if none does, or at four times their median, if that
/// is less and not zero. One for a picture without light.
#[must_use]
pub fn exposure(picture: &Picture) -> f64 {
    let sorted = sorted(picture);
    let (median, highlights) = (percentile(&sorted, 50), percentile(&sorted, 99));
    let white = match median > 0.0 {
        true => highlights.min(MAX_OVER_MEDIAN * median),
        false => highlights,
    };
    factor(0.9, white)
}

/// The exposure that brings a radiance to a level; one where the radiance is zero, or so weak that the factor overflows.
pub(crate) fn factor(level: f64, radiance: f64) -> f64 {
    Some(level / radiance)
        .filter(|factor| factor.is_finite() && *factor > 0.0)
        .unwrap_or(1.0)
}

/// Largest of the channels of a colour.
pub(crate) fn largest(rgb: [f64; 3]) -> f64 {
    rgb.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The values that a tone curve takes: radiance, or the largest channel of a colour.
pub(crate) fn shown_values(picture: &Picture) -> impl Iterator<Item = f64> {
    let colour = picture.colour.as_deref();
    let radiance = picture.radiance.iter().enumerate();
    radiance.map(move |(i, radiance)| colour.map_or(*radiance, |colour| largest(colour[i])))
}

/// Value of the brightest pixel, zero or more.
pub(crate) fn brightest(picture: &Picture) -> f64 {
    shown_values(picture).fold(0.0, f64::max)
}

/// 99th percentile of the pixels that show the surface, or of all pixels if none does; zero or more.
pub(crate) fn highlights(picture: &Picture) -> f64 {
    percentile(&sorted(picture), 99).max(0.0)
}

/// Values of the pixels that show the surface, or of all pixels if none does, in order.
fn sorted(picture: &Picture) -> Vec<f64> {
    let pixels = shown_values(picture).zip(&picture.coverage);
    let mut shown: Vec<f64> = pixels
        .filter(|(_, coverage)| **coverage >= 0.5)
        .map(|(value, _)| value)
        .collect();
    if shown.is_empty() {
        shown = shown_values(picture).collect();
    }
    shown.sort_unstable_by(f64::total_cmp);
    shown
}

fn percentile(sorted: &[f64], n: usize) -> f64 {
    sorted.get(sorted.len() * n / 100).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 200 pixels that show the surface, three of them `bright`, next to one of sky.
    fn with_highlights(bright: f64) -> Picture {
        let mut radiance = vec![0.5; 200];
        radiance[..3].fill(bright);
        radiance.push(1e6);
        let mut coverage = vec![1.0; 200];
        coverage.push(0.0);
        Picture {
            size: [201, 1],
            error: vec![0.0; 201],
            radiance,
            coverage,
            colour: None,
        }
    }

    #[test]
    fn white_is_at_the_highlights_or_at_four_times_the_median() {
        assert_eq!(exposure(&with_highlights(0.8)), 0.9 / 0.8);
        assert_eq!(exposure(&with_highlights(100.0)), 0.9 / 2.0);
        assert_eq!(brightest(&with_highlights(100.0)), 1e6);
    }

    #[test]
    fn darkness_has_an_exposure_of_one() {
        for radiance in [0.0, 1e-310] {
            assert_eq!(factor(0.9, radiance), 1.0);
        }
    }
}
