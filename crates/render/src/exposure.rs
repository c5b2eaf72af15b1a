//! Exposure: the factor from radiance to the brightness of a picture.

use asperity_io::Picture;

/// Upper limit of the white level over the median pixel. Beyond it a few highlights would leave everything else black.
const MAX_OVER_MEDIAN: f64 = 4.0;

/// The factor from radiance to brightness, where one is white: nine tenths of white at the 99th percentile of the
/// pixels that show the surface, or of all pixels if none does, or at four times their median, if that
/// is less and not zero. One for a picture without light.
#[must_use]
pub fn exposure(picture: &Picture) -> f64 {
    factor(0.9, highlights(picture))
}

/// The exposure that brings a radiance to a level; one where the radiance is zero, or so weak that the factor overflows.
pub(crate) fn factor(level: f64, radiance: f64) -> f64 {
    Some(level / radiance)
        .filter(|factor| factor.is_finite())
        .unwrap_or(1.0)
}

/// Radiance of the brightest pixel, zero or more.
pub(crate) fn brightest(picture: &Picture) -> f64 {
    picture.radiance.iter().copied().fold(0.0, f64::max)
}

/// Radiance of highlights of the surface, apart from the few brightest.
fn highlights(picture: &Picture) -> f64 {
    let pixels = picture.radiance.iter().zip(&picture.coverage);
    let mut shown: Vec<f64> = pixels
        .filter(|(_, coverage)| **coverage >= 0.5)
        .map(|(radiance, _)| *radiance)
        .collect();
    if shown.is_empty() {
        shown.clone_from(&picture.radiance);
    }
    shown.sort_unstable_by(f64::total_cmp);
    let percentile = |n: usize| shown.get(shown.len() * n / 100).copied().unwrap_or(0.0);
    let (median, highlights) = (percentile(50), percentile(99));
    match median > 0.0 {
        true => highlights.min(MAX_OVER_MEDIAN * median),
        false => highlights.max(0.0),
    }
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
