//! Tone: the curve from radiance to the brightness of a picture, and its pixels for viewing.

use asperity_io::{Picture, Pixels};
use asperity_numerics::elementary::{log10, pow};
use asperity_optics::srgb_encoded;

use crate::exposure::{brightest, exposure, factor, highlights, largest, shown_values};

/// Decades of radiance from black to white of [`Tone::Log`].
pub const LOG_DECADES: i32 = 3;

/// Tone curve: brightness, linear light from 0 to 1, of the exposed radiance `x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// `x (1 + x/w^2) / (1 + x)`, where `w` is the exposed radiance of white: that of the brightest pixel, or 1 if that is more, by
    /// which the curve is a straight line. No pixel is clipped.
    ///
    /// # Source
    /// E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, Photographic tone reproduction for digital images, ACM Trans. Graph. 21 (3),
    /// 267 (2002), Eq. 4.
    Reinhard,
    /// `x`, clipped at 1.
    Linear,
    /// Stored grey levels in proportion to the logarithm of `x`, from [`LOG_DECADES`] below white, which is black, to `x = 1`.
    Log,
}

/// A tone with its exposure and the radiance of white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneCurve {
    /// Shape of the curve.
    pub tone: Tone,
    /// Factor from radiance to exposed radiance, above 0.
    pub exposure: f64,
    /// Radiance of white; more is clipped.
    pub white: f64,
}

impl ToneCurve {
    /// The curve for a picture. Unless the exposure is given, it is that of [`exposure`], and for [`Tone::Log`] white is the 99th percentile.
    #[must_use]
    pub fn new(tone: Tone, picture: &Picture, given: Option<f64>) -> Self {
        let exposure = given.unwrap_or_else(|| match tone {
            Tone::Reinhard | Tone::Linear => exposure(picture),
            Tone::Log => factor(1.0, highlights(picture)),
        });
        let white = match tone {
            Tone::Reinhard => (1.0 / exposure).max(brightest(picture)),
            Tone::Linear | Tone::Log => 1.0 / exposure,
        };
        Self {
            tone,
            exposure,
            white,
        }
    }

    /// Radiance of black.
    #[must_use]
    pub fn black(&self) -> f64 {
        match self.tone {
            Tone::Reinhard | Tone::Linear => 0.0,
            Tone::Log => self.white * 10f64.powi(-LOG_DECADES),
        }
    }

    /// Grey level of a radiance as it is stored, by the curve of sRGB: 0 up to black, 1 from white on.
    #[must_use]
    pub fn stored(&self, radiance: f64) -> f64 {
        match self.tone {
            Tone::Log => self.log(radiance),
            Tone::Reinhard | Tone::Linear => srgb_encoded(self.brightness(radiance)),
        }
    }

    fn log(&self, radiance: f64) -> f64 {
        let decades = log10((self.exposure * radiance).max(f64::MIN_POSITIVE));
        (1.0 + decades / f64::from(LOG_DECADES)).clamp(0.0, 1.0)
    }

    /// Brightness of a radiance as linear light, `[0, 1]`.
    fn brightness(&self, radiance: f64) -> f64 {
        let x = self.exposure * radiance.max(0.0);
        let value = match self.tone {
            Tone::Reinhard => {
                let over_white = x / (self.exposure * self.white).powi(2);
                x * (1.0 + over_white) / (1.0 + x)
            }
            Tone::Linear => x,
            Tone::Log => srgb_decoded(self.log(radiance)),
        };
        value.min(1.0)
    }

    /// Linear light of a colour: all channels are scaled as the largest is, so that hues stay. Negative channels, of colours outside of sRGB,
    /// become zero.
    fn light(&self, rgb: [f64; 3]) -> [f64; 3] {
        let largest = largest(rgb);
        match largest > 0.0 {
            true => {
                rgb.map(|channel| (channel * self.brightness(largest) / largest).clamp(0.0, 1.0))
            }
            false => [0.0; 3],
        }
    }

    /// Fraction of the pixels whose radiance, or largest channel, is above white, and clipped.
    #[must_use]
    pub fn clipped(&self, picture: &Picture) -> f64 {
        // Rounding of the reciprocal exposure clips nothing.
        let white = self.white * (1.0 + 1e-9);
        let clipped = shown_values(picture).filter(|value| *value > white);
        clipped.count() as f64 / picture.radiance.len() as f64
    }

    /// The pixels of a picture, grey or in colour.
    #[must_use]
    pub fn pixels(&self, picture: &Picture) -> Pixels {
        let byte = |stored: f64| (255.0 * stored).round() as u8;
        let bytes = match &picture.colour {
            None => {
                let greys = picture.radiance.iter();
                greys.map(|radiance| byte(self.stored(*radiance))).collect()
            }
            Some(colour) => {
                let light = colour.iter().flat_map(|rgb| self.light(*rgb));
                light.map(|light| byte(srgb_encoded(light))).collect()
            }
        };
        Pixels {
            size: picture.size,
            is_rgb: picture.colour.is_some(),
            bytes,
        }
    }
}

/// Linear light of stored values of `[0, 1]`: the inverse of [`srgb_encoded`].
fn srgb_decoded(stored: f64) -> f64 {
    if stored <= 0.040_45 {
        stored / 12.92
    } else {
        pow((stored + 0.055) / 1.055, 2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TONES: [Tone; 3] = [Tone::Reinhard, Tone::Linear, Tone::Log];

    fn picture(radiance: &[f64]) -> Picture {
        Picture {
            size: [radiance.len(), 1],
            radiance: radiance.to_vec(),
            error: vec![0.0; radiance.len()],
            coverage: vec![1.0; radiance.len()],
            colour: None,
        }
    }

    #[test]
    fn curves_rise_from_black_to_white() {
        for tone in TONES {
            for exposure in [0.01, 2.0, 300.0] {
                let curve = ToneCurve::new(tone, &picture(&[0.1, 5.0]), Some(exposure));
                let (black, white) = (curve.black(), curve.white);
                assert_eq!(curve.stored(0.0), 0.0);
                assert!(curve.stored(black) < 1e-12 && curve.stored(1.01 * black + 1e-9) > 0.0);
                assert!((curve.stored(white) - 1.0).abs() < 1e-12, "{tone:?}");
                assert!(
                    curve.stored(0.99 * white) < 1.0 && curve.stored(9.0 * white) > 1.0 - 1e-12
                );
                let steps = (0..=100).map(|i| black + f64::from(i) / 100.0 * (white - black));
                assert!(steps.map(|r| curve.stored(r)).is_sorted_by(|a, b| a < b));
            }
        }
    }

    #[test]
    fn reinhard_compresses_highlights_and_leaves_dark_pictures_linear() {
        // x = 1, w = 4: 1 (1 + 1/16) / 2
        let curve = ToneCurve::new(Tone::Reinhard, &picture(&[0.5, 2.0]), Some(2.0));
        assert_eq!(curve.brightness(0.5), 17.0 / 32.0);
        let dim = ToneCurve::new(Tone::Reinhard, &picture(&[0.5, 2.0]), Some(0.2));
        assert!((dim.brightness(0.5) - 0.1).abs() < 1e-15);
    }

    #[test]
    fn decades_are_equal_steps_of_grey() {
        let curve = ToneCurve::new(Tone::Log, &picture(&[1.0]), Some(0.5));
        for (radiance, stored) in [
            (2.0, 1.0),
            (0.2, 2.0 / 3.0),
            (0.02, 1.0 / 3.0),
            (0.001, 0.0),
        ] {
            assert!((curve.stored(radiance) - stored).abs() < 1e-12);
            assert!((srgb_encoded(curve.brightness(radiance)) - stored).abs() < 1e-6);
        }
    }

    #[test]
    fn only_linear_pictures_are_clipped_at_the_automatic_exposure() {
        let mut radiance = vec![1.0; 98];
        radiance.extend([50.0, 90.0]);
        let bright = picture(&radiance);
        let clipped = TONES.map(|tone| ToneCurve::new(tone, &bright, None).clipped(&bright));
        assert_eq!(clipped, [0.0, 0.02, 0.0]);
    }

    #[test]
    fn pixels_follow_the_curve_of_srgb() {
        let radiance = [0.0, 0.1, 0.25, 0.5, 1.0, 2.0];
        let curve = ToneCurve::new(Tone::Linear, &picture(&radiance), Some(1.0));
        // Linear 0.1, 0.25 and 0.5 are stored as 0.3492, 0.5371 and 0.7354.
        let grey = curve.pixels(&picture(&radiance)).bytes;
        assert_eq!(grey, [0, 89, 137, 188, 255, 255]);
    }

    #[test]
    fn colours_keep_their_hue_up_to_the_brightest() {
        for tone in TONES {
            let mut bright = picture(&[0.1, 4.0]);
            bright.colour = Some(vec![[0.1; 3], [5.0, 4.0, 2.5]]);
            let curve = ToneCurve::new(tone, &bright, Some(1.0));
            for rgb in [[0.3, 0.2, 0.1], [0.8, 0.4, -0.2], [5.0, 4.0, 2.5]] {
                let light = curve.light(rgb);
                assert!((light[0] - curve.brightness(rgb[0])).abs() < 1e-12);
                assert!((light[1] / light[0] - rgb[1] / rgb[0]).abs() < 1e-12);
                assert!(light.iter().all(|channel| (0.0..=1.0).contains(channel)));
            }
            assert_eq!(curve.light([0.0; 3]), [0.0; 3]);
        }
    }
}
