//! Exposure: the factor from radiance to the brightness of a picture.

use asperity_io::Picture;

/// Upper limit of the white level over the median pixel. Beyond it a few highlights would leave everything else black.
const MAX_OVER_MEDIAN: f64 = 4.0;

/// The factor from radiance to brightness, where one is white: nine tenths of white at the 99th percentile of the
/// pixels that show the surface, or of all pixels if none does, or at four times their median, if that
/// is less and not zero. One for a picture without light.
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
    let percentile = |n: usize| shown.get(shown.len() * n / 100).copied().unwrap_or(0.0);
    let (median, highlights) = (percentile(50), percentile(99));
    let brightest = match median > 0.0 {
        true => highlights.min(MAX_OVER_MEDIAN * median),
        false => highlights,
    };
    if brightest > 0.0 {
        0.9 / brightest
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exposure of 200 pixels that show the surface, three of them `bright`, next to one of sky.
    fn with_highlights(bright: f64) -> f64 {
        let mut radiance = vec![0.5; 200];
        radiance[..3].fill(bright);
        radiance.push(1e6);
        let mut coverage = vec![1.0; 200];
        coverage.push(0.0);
        exposure(&Picture {
            size: [201, 1],
            error: vec![0.0; 201],
            radiance,
            coverage,
        })
    }

    #[test]
    fn white_is_at_the_highlights_or_at_four_times_the_median() {
        assert_eq!(with_highlights(0.8), 0.9 / 0.8);
        assert_eq!(with_highlights(100.0), 0.9 / 2.0);
    }
}
