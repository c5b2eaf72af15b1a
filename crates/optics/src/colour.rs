//! Colour: CIE XYZ, chromaticity and sRGB of a spectrum of reflectances or transmittances under daylight D65.
//!
//! `XYZ = sum S(lambda) xyz(lambda) R(lambda) / sum S(lambda) y(lambda)` over 380 to 780 nm in steps of 5 nm, so that a perfect reflector
//! has Y = 1. Between the wavelengths of a spectrum it is interpolated linearly; beyond its ends it keeps the value of the end. Structure
//! of a spectrum between the steps of 5 nm is not seen.
//!
//! # Source
//! Sums: CIE 015:2018, Colorimetry, doi:10.25039/TR.015.2018. Tables: CIE standard illuminant D65 (doi:10.25039/CIE.DS.hjfjmt59), colour-matching
//! functions of the CIE 1931 2 degree observer (doi:10.25039/CIE.DS.xvudnb9b) and of the CIE 1964 10 degree observer
//! (doi:10.25039/CIE.DS.sqksu2n5), data sets of CIE 018:2019; the numbers as given by the Python package colour-science 0.4.7
//! (BSD-3-Clause, Copyright 2013 Colour Developers), rounded to seven digits. sRGB: IEC 61966-2-1:1999.

mod table;

use asperity_numerics::elementary::pow;
use table::TABLE;

/// Standard observer, by the angle of the field of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourObserver {
    /// CIE 1931, 2 degrees.
    Cie1931,
    /// CIE 1964, 10 degrees.
    Cie1964,
}

/// Longest first and shortest last wavelength of a spectrum that has a colour, nm.
const COVERED_NM: [f64; 2] = [400.0, 700.0];

/// Largest step of a spectrum that has a colour, nm.
const MAX_STEP_NM: f64 = 20.0;

/// Weights `[X, Y, Z]` of the values of a spectrum at these wavelengths, nm, increasing.
///
/// `X = sum of weight times value`, likewise Y and Z: errors of X follow from those of the values. Returns `None` if the wavelengths do
/// not increase, do not cover 400 to 700 nm, or have a step above 20 nm.
///
/// # Examples
/// ```
/// use asperity_optics::{Colour, ColourObserver, colour_weights};
///
/// let wavelengths: Vec<f64> = (38..=78).map(|i| f64::from(10 * i)).collect();
/// let weights = colour_weights(&wavelengths, ColourObserver::Cie1931).unwrap();
/// // A grey of reflectance 0.5 at all wavelengths
/// let grey = weights.iter().fold([0.0; 3], |sum, w| [0, 1, 2].map(|i| sum[i] + 0.5 * w[i]));
/// let colour = Colour::from_xyz(grey, ColourObserver::Cie1931);
/// assert!((colour.xyz[1] - 0.5).abs() < 1e-12 && !colour.is_clipped);
/// ```
#[must_use]
pub fn colour_weights(wavelengths_nm: &[f64], observer: ColourObserver) -> Option<Vec<[f64; 3]>> {
    let (first, last) = (*wavelengths_nm.first()?, *wavelengths_nm.last()?);
    let is_fine = wavelengths_nm
        .windows(2)
        .all(|pair| pair[1] > pair[0] && pair[1] - pair[0] <= MAX_STEP_NM);
    if !(is_fine && first <= COVERED_NM[0] && last >= COVERED_NM[1]) {
        return None;
    }
    let mut weights = vec![[0.0; 3]; wavelengths_nm.len()];
    let whole: f64 = table(observer).map(|(_, xyz)| xyz[1]).sum();
    for (wavelength, xyz) in table(observer) {
        let behind = wavelengths_nm.partition_point(|&value| value < wavelength);
        let after = behind.min(wavelengths_nm.len() - 1);
        let before = behind.saturating_sub(1);
        let step = wavelengths_nm[after] - wavelengths_nm[before];
        let part = if step > 0.0 {
            (wavelength - wavelengths_nm[before]) / step
        } else {
            1.0
        };
        for (i, value) in xyz.into_iter().enumerate() {
            weights[before][i] += (1.0 - part) * value / whole;
            weights[after][i] += part * value / whole;
        }
    }
    Some(weights)
}

/// Colour of a reflecting or transmitting surface under D65.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Tristimulus values; a perfect reflector has Y = 1.
    pub xyz: [f64; 3],
    /// Chromaticity; that of D65 where there is no light.
    pub xy: [f64; 2],
    /// sRGB with its transfer function, `[0, 1]`.
    pub srgb: [f64; 3],
    /// `true` if the colour is outside of sRGB, by more than rounding, and was clipped.
    pub is_clipped: bool,
}

impl Colour {
    /// The colour of tristimulus values for `observer`.
    ///
    /// For sRGB each of X, Y and Z is scaled by the ratio of the white of sRGB to D65 for the observer, so that a perfect reflector is
    /// `(1, 1, 1)`: sRGB is defined for the 2 degree observer alone.
    #[must_use]
    pub fn from_xyz(xyz: [f64; 3], observer: ColourObserver) -> Self {
        let white = white(observer);
        let [x, y, z] = if xyz.iter().sum::<f64>() > 0.0 {
            xyz
        } else {
            white
        };
        let sum = x + y + z;
        let linear = linear_srgb(xyz, observer);
        Self {
            xyz,
            xy: [x / sum, y / sum],
            srgb: linear.map(|value| srgb_encoded(value.clamp(0.0, 1.0))),
            is_clipped: linear
                .iter()
                .any(|value| !(-ROUNDING..=1.0 + ROUNDING).contains(value)),
        }
    }
}

/// Linear sRGB of tristimulus values for `observer`, adapted as in [`Colour::from_xyz`]; outside of `[0, 1]` for colours out of sRGB.
#[must_use]
pub fn linear_srgb(xyz: [f64; 3], observer: ColourObserver) -> [f64; 3] {
    let white = white(observer);
    let adapted = [0, 1, 2].map(|i| xyz[i] / white[i] * SRGB_WHITE[i]);
    XYZ_TO_SRGB.map(|row| (0..3).map(|i| row[i] * adapted[i]).sum::<f64>())
}

/// Tristimulus values of a perfect reflector.
fn white(observer: ColourObserver) -> [f64; 3] {
    let sum = table(observer).fold([0.0; 3], |sum, (_, xyz)| [0, 1, 2].map(|i| sum[i] + xyz[i]));
    sum.map(|value| value / sum[1])
}

/// Transfer function of sRGB, from linear values of `[0, 1]` to stored ones.
#[must_use]
pub fn srgb_encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// Wavelengths, nm, and the products of D65 and the colour-matching functions.
fn table(observer: ColourObserver) -> impl Iterator<Item = (f64, [f64; 3])> {
    let first = match observer {
        ColourObserver::Cie1931 => 1,
        ColourObserver::Cie1964 => 4,
    };
    (TABLE.iter().enumerate()).map(move |(i, row)| {
        let wavelength = 5.0f64.mul_add(i as f64, 380.0);
        (wavelength, [0, 1, 2].map(|j| row[0] * row[first + j]))
    })
}

/// Linear sRGB of XYZ, IEC 61966-2-1, and its white.
const XYZ_TO_SRGB: [[f64; 3]; 3] = [
    [3.2406, -1.5372, -0.4986],
    [-0.9689, 1.8758, 0.0415],
    [0.0557, -0.2040, 1.0570],
];
const SRGB_WHITE: [f64; 3] = [0.9505, 1.0, 1.0890];

/// Rounding of the matrix, whose white differs from one by 1e-4.
const ROUNDING: f64 = 2e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use ColourObserver::{Cie1931, Cie1964};

    /// Reflectance of a gold face at 390, 400, ... 780 nm: indices of Johnson and Christy, Phys. Rev. B 6, 4370 (1972), interpolated.
    const GOLD: [f64; 40] = [
        0.405164, 0.407143, 0.408713, 0.408746, 0.40803, 0.4081, 0.408211, 0.405222, 0.401944,
        0.417377, 0.435913, 0.478848, 0.557433, 0.636017, 0.69041, 0.742288, 0.791251, 0.822278,
        0.853305, 0.883187, 0.896161, 0.909134, 0.922108, 0.933322, 0.940732, 0.948143, 0.955553,
        0.962684, 0.96462, 0.966555, 0.968491, 0.970427, 0.97163, 0.972246, 0.972862, 0.973478,
        0.974094, 0.974586, 0.974892, 0.975198,
    ];

    fn colour(spectrum: &[(f64, f64)], observer: ColourObserver) -> Colour {
        let wavelengths: Vec<f64> = spectrum.iter().map(|point| point.0).collect();
        let weights = colour_weights(&wavelengths, observer).unwrap();
        let xyz = weights
            .iter()
            .zip(spectrum)
            .fold([0.0; 3], |sum, (w, point)| {
                [0, 1, 2].map(|i| sum[i] + w[i] * point.1)
            });
        Colour::from_xyz(xyz, observer)
    }

    fn from(first: i32, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let wavelengths = (first / 10..=78).map(|i| f64::from(10 * i));
        wavelengths.map(|nm| (nm, value(nm))).collect()
    }

    #[track_caller]
    fn assert_near<const N: usize>(found: [f64; N], expected: [f64; N], tolerance: f64) {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < tolerance, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn a_perfect_reflector_is_white() {
        for (observer, xy) in [(Cie1931, [0.31271, 0.32902]), (Cie1964, [0.31382, 0.33100])] {
            for nm in [5, 10, 20] {
                let wavelengths = (380..=780).step_by(nm).map(|nm| (f64::from(nm), 1.0));
                let white = colour(&wavelengths.collect::<Vec<_>>(), observer);
                assert!((white.xyz[1] - 1.0).abs() < 1e-12);
                // Sums in steps of 5 nm; published for 1 nm.
                assert_near(white.xy, xy, 3e-5);
                assert_near(white.srgb, [1.0; 3], 1e-3);
                assert!(!white.is_clipped);
            }
        }
    }

    #[test]
    fn colours_agree_with_another_program() {
        // The Python package colour-science 0.4.7: sd_to_XYZ by sums in steps of 5 nm, and XYZ_to_sRGB for 2 degrees.
        let green = from(380, |nm| (-0.5 * ((nm - 530.0) / 30.0).powi(2)).exp());
        let half = from(380, |_| 0.5);
        let gold: Vec<_> = from(390, |nm| GOLD[((nm - 390.0) / 10.0).round() as usize]);
        for (spectrum, observer, xyz) in [
            (&green, Cie1931, [0.20089313, 0.52300633, 0.12717832]),
            (&green, Cie1964, [0.22245547, 0.50787245, 0.10430495]),
            (&half, Cie1931, [0.47521483, 0.5, 0.54440027]),
            (&half, Cie1964, [0.47405893, 0.5, 0.53662054]),
            (&gold, Cie1931, [0.75428913, 0.76829169, 0.45421588]),
            (&gold, Cie1964, [0.74617004, 0.7444402, 0.44437202]),
        ] {
            assert_near(colour(spectrum, observer).xyz, xyz, 1e-7);
        }
        // The other program does not scale to the white of sRGB, which differs by 1e-4.
        for (spectrum, srgb, is_clipped) in [
            (&green, [0.0, 0.902157, 0.217799], true),
            (&half, [0.735320, 0.735394, 0.735291], false),
            (&gold, [1.0, 0.869912, 0.638533], true),
        ] {
            let found = colour(spectrum, Cie1931);
            assert_near(found.srgb, srgb, 5e-4);
            assert_eq!(found.is_clipped, is_clipped);
        }
    }

    #[test]
    fn spectra_are_interpolated_and_keep_their_ends() {
        let line = |nm: f64| 0.2 + 1e-3 * (nm - 400.0);
        let uneven: Vec<_> = [380.0, 397.0, 412.5, 430.0].map(|nm| (nm, line(nm))).into();
        let uneven: Vec<_> = uneven.into_iter().chain(from(440, line)).collect();
        assert_near(
            colour(&uneven, Cie1931).xyz,
            colour(&from(380, line), Cie1931).xyz,
            1e-12,
        );
        let cut: Vec<_> = from(400, line);
        let kept = from(380, |nm| line(nm.max(400.0)));
        assert_near(colour(&cut, Cie1964).xyz, colour(&kept, Cie1964).xyz, 1e-12);
    }

    #[test]
    fn spectra_that_do_not_cover_the_visible_have_no_colour() {
        let weights = |nm: &[f64]| colour_weights(nm, Cie1931);
        let every = |first: u32, last: u32, step: usize| -> Vec<f64> {
            (first..=last).step_by(step).map(f64::from).collect()
        };
        assert!(weights(&every(400, 700, 20)).is_some());
        assert!(weights(&every(410, 710, 20)).is_none());
        assert!(weights(&every(380, 690, 10)).is_none());
        assert!(weights(&every(400, 700, 25)).is_none());
        assert!(weights(&[]).is_none() && weights(&[550.0]).is_none());
        let mut turned = every(400, 700, 10);
        turned.swap(3, 4);
        assert!(weights(&turned).is_none());
    }

    #[test]
    fn darkness_has_the_chromaticity_of_the_light() {
        let black = Colour::from_xyz([0.0; 3], Cie1931);
        assert_near(black.xy, [0.31272, 0.32903], 1e-5);
        assert_eq!((black.srgb, black.is_clipped), ([0.0; 3], false));
    }
}
