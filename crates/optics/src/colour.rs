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
        let adapted = [0, 1, 2].map(|i| xyz[i] / white[i] * SRGB_WHITE[i]);
        let linear = XYZ_TO_SRGB.map(|row| (0..3).map(|i| row[i] * adapted[i]).sum::<f64>());
        Self {
            xyz,
            xy: [x / sum, y / sum],
            srgb: linear.map(|value| encoded(value.clamp(0.0, 1.0))),
            is_clipped: linear
                .iter()
                .any(|value| !(-ROUNDING..=1.0 + ROUNDING).contains(value)),
        }
    }
}

/// Tristimulus values of a perfect reflector.
fn white(observer: ColourObserver) -> [f64; 3] {
    let sum = table(observer).fold([0.0; 3], |sum, (_, xyz)| [0, 1, 2].map(|i| sum[i] + xyz[i]));
    sum.map(|value| value / sum[1])
}

/// Transfer function of sRGB.
fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
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

/// D65, then x, y and z of the CIE 1931 and of the CIE 1964 observer, from 380 to 780 nm in steps of 5 nm.
const TABLE: [[f64; 7]; 81] = [
    [
        49.9755,
        0.001368,
        0.000039,
        0.006450001,
        0.000159952,
        0.000017364,
        0.000704776,
    ],
    [
        52.3118, 0.002236, 0.000064, 0.01054999, 0.00066244, 0.00007156, 0.0029278,
    ],
    [
        54.6482, 0.004243, 0.00012, 0.02005001, 0.0023616, 0.0002534, 0.0104822,
    ],
    [
        68.7015, 0.00765, 0.000217, 0.03621, 0.0072423, 0.0007685, 0.032344,
    ],
    [
        82.7549, 0.01431, 0.000396, 0.06785001, 0.0191097, 0.0020044, 0.0860109,
    ],
    [87.1204, 0.02319, 0.00064, 0.1102, 0.0434, 0.004509, 0.19712],
    [
        91.486, 0.04351, 0.00121, 0.2074, 0.084736, 0.008756, 0.389366,
    ],
    [
        92.4589, 0.07763, 0.00218, 0.3713, 0.140638, 0.014456, 0.65676,
    ],
    [
        93.4318, 0.13438, 0.004, 0.6456, 0.204492, 0.021391, 0.972542,
    ],
    [90.057, 0.21477, 0.0073, 1.03905, 0.264737, 0.029497, 1.2825],
    [86.6823, 0.2839, 0.0116, 1.3856, 0.314679, 0.038676, 1.55348],
    [
        95.7736, 0.3285, 0.01684, 1.62296, 0.357719, 0.049602, 1.7985,
    ],
    [
        104.865, 0.34828, 0.023, 1.74706, 0.383734, 0.062077, 1.96728,
    ],
    [110.936, 0.34806, 0.0298, 1.7826, 0.386726, 0.074704, 2.0273],
    [117.008, 0.3362, 0.038, 1.77211, 0.370702, 0.089456, 1.9948],
    [117.41, 0.3187, 0.048, 1.7441, 0.342957, 0.106256, 1.9007],
    [117.812, 0.2908, 0.06, 1.6692, 0.302273, 0.128201, 1.74537],
    [116.336, 0.2511, 0.0739, 1.5281, 0.254085, 0.152761, 1.5549],
    [
        114.861, 0.19536, 0.09098, 1.28764, 0.195618, 0.18519, 1.31756,
    ],
    [115.392, 0.1421, 0.1126, 1.0419, 0.132349, 0.21994, 1.0302],
    [
        115.923, 0.09564, 0.13902, 0.8129501, 0.080507, 0.253589, 0.772125,
    ],
    [
        112.367, 0.05795001, 0.1693, 0.6162, 0.041072, 0.297665, 0.57006,
    ],
    [
        108.811, 0.03201, 0.20802, 0.46518, 0.016172, 0.339133, 0.415254,
    ],
    [
        109.082, 0.0147, 0.2586, 0.3533, 0.005132, 0.395379, 0.302356,
    ],
    [109.354, 0.0049, 0.323, 0.272, 0.003816, 0.460777, 0.218502],
    [108.578, 0.0024, 0.4073, 0.2123, 0.015444, 0.53136, 0.159249],
    [107.802, 0.0093, 0.503, 0.1582, 0.037465, 0.606741, 0.112044],
    [106.296, 0.0291, 0.6082, 0.1117, 0.071358, 0.68566, 0.082248],
    [
        104.79, 0.06327, 0.71, 0.07824999, 0.117749, 0.761757, 0.060709,
    ],
    [
        106.239, 0.1096, 0.7932, 0.05725001, 0.172953, 0.82333, 0.04305,
    ],
    [
        107.689, 0.1655, 0.862, 0.04216, 0.236491, 0.875211, 0.030451,
    ],
    [
        106.047, 0.2257499, 0.9148501, 0.02984, 0.304213, 0.92381, 0.020584,
    ],
    [104.405, 0.2904, 0.954, 0.0203, 0.376772, 0.961988, 0.013676],
    [104.225, 0.3597, 0.9803, 0.0134, 0.451584, 0.9822, 0.007918],
    [
        104.046,
        0.4334499,
        0.9949501,
        0.008749999,
        0.529826,
        0.991761,
        0.003988,
    ],
    [
        102.023,
        0.5120501,
        1.0,
        0.005749999,
        0.616053,
        0.99911,
        0.001091,
    ],
    [100.0, 0.5945, 0.995, 0.0039, 0.705224, 0.99734, 0.0],
    [98.1671, 0.6784, 0.9786, 0.002749999, 0.793832, 0.98238, 0.0],
    [96.3342, 0.7621, 0.952, 0.0021, 0.878655, 0.955552, 0.0],
    [96.0611, 0.8425, 0.9154, 0.0018, 0.951162, 0.915175, 0.0],
    [95.788, 0.9163, 0.87, 0.001650001, 1.01416, 0.868934, 0.0],
    [92.2368, 0.9786, 0.8163, 0.0014, 1.0743, 0.825623, 0.0],
    [88.6856, 1.0263, 0.757, 0.0011, 1.11852, 0.777405, 0.0],
    [89.3459, 1.0567, 0.6949, 0.001, 1.1343, 0.720353, 0.0],
    [90.0062, 1.0622, 0.631, 0.0008, 1.12399, 0.658341, 0.0],
    [89.8026, 1.0456, 0.5668, 0.0006, 1.0891, 0.593878, 0.0],
    [89.5991, 1.0026, 0.503, 0.00034, 1.03048, 0.527963, 0.0],
    [88.6489, 0.9384, 0.4412, 0.00024, 0.95074, 0.461834, 0.0],
    [87.6987, 0.8544499, 0.381, 0.00019, 0.856297, 0.398057, 0.0],
    [85.4936, 0.7514, 0.321, 0.0001, 0.75493, 0.339554, 0.0],
    [
        83.2886,
        0.6424,
        0.265,
        0.00004999999,
        0.647467,
        0.283493,
        0.0,
    ],
    [83.4939, 0.5419, 0.217, 0.00003, 0.53511, 0.228254, 0.0],
    [83.6992, 0.4479, 0.175, 0.00002, 0.431567, 0.179828, 0.0],
    [81.863, 0.3608, 0.1382, 0.00001, 0.34369, 0.140211, 0.0],
    [80.0268, 0.2835, 0.107, -0., 0.268329, 0.107633, 0.0],
    [80.1207, 0.2187, 0.0816, 0.0, 0.2043, 0.081187, 0.0],
    [80.2146, 0.1649, 0.061, 0.0, 0.152568, 0.060281, 0.0],
    [81.2462, 0.1212, 0.04458, 0.0, 0.11221, 0.044096, 0.0],
    [82.2778, 0.0874, 0.032, 0.0, 0.0812606, 0.0318004, 0.0],
    [80.281, 0.0636, 0.0232, 0.0, 0.05793, 0.0226017, 0.0],
    [78.2842, 0.04677, 0.017, 0.0, 0.0408508, 0.0159051, 0.0],
    [74.0027, 0.0329, 0.01192, 0.0, 0.028623, 0.0111303, 0.0],
    [69.7213, 0.0227, 0.00821, 0.0, 0.0199413, 0.0077488, 0.0],
    [70.6652, 0.01584, 0.005723, 0.0, 0.013842, 0.0053751, 0.0],
    [
        71.6091, 0.01135916, 0.004102, 0.0, 0.00957688, 0.00371774, 0.0,
    ],
    [
        72.979,
        0.008110916,
        0.002929,
        0.0,
        0.0066052,
        0.00256456,
        0.0,
    ],
    [
        74.349,
        0.005790346,
        0.002091,
        0.0,
        0.00455263,
        0.00176847,
        0.0,
    ],
    [
        67.9765,
        0.004109457,
        0.001484,
        0.0,
        0.0031447,
        0.00122239,
        0.0,
    ],
    [
        61.604,
        0.002899327,
        0.001047,
        0.0,
        0.00217496,
        0.00084619,
        0.0,
    ],
    [
        65.7448, 0.00204919, 0.00074, 0.0, 0.0015057, 0.00058644, 0.0,
    ],
    [
        69.8856,
        0.001439971,
        0.00052,
        0.0,
        0.00104476,
        0.00040741,
        0.0,
    ],
    [
        72.4863,
        0.0009999493,
        0.0003611,
        0.0,
        0.00072745,
        0.000284041,
        0.0,
    ],
    [
        75.087,
        0.0006900786,
        0.0002492,
        0.0,
        0.000508258,
        0.00019873,
        0.0,
    ],
    [
        69.3398,
        0.0004760213,
        0.0001719,
        0.0,
        0.00035638,
        0.00013955,
        0.0,
    ],
    [
        63.5927,
        0.0003323011,
        0.00012,
        0.0,
        0.000250969,
        0.000098428,
        0.0,
    ],
    [
        55.0054,
        0.0002348261,
        0.0000848,
        0.0,
        0.00017773,
        0.000069819,
        0.0,
    ],
    [
        46.4182,
        0.0001661505,
        0.00006,
        0.0,
        0.00012639,
        0.000049737,
        0.0,
    ],
    [
        56.6118,
        0.000117413,
        0.0000424,
        0.0,
        0.000090151,
        0.0000355405,
        0.0,
    ],
    [
        66.8054,
        0.00008307527,
        0.00003,
        0.0,
        0.0000645258,
        0.000025486,
        0.0,
    ],
    [
        65.0941,
        0.00005870652,
        0.0000212,
        0.0,
        0.000046339,
        0.0000183384,
        0.0,
    ],
    [
        63.3828,
        0.00004150994,
        0.00001499,
        0.0,
        0.0000334117,
        0.000013249,
        0.0,
    ],
];

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
