//! Sunlight: weights of the values of a spectrum in solar transmittance and reflectance.
//!
//! # Source
//! Global irradiance at air mass 1.5 on a surface tilted by 37 degrees, ASTM G173-03 (SMARTS 2.9.2), as the National Renewable Energy Laboratory
//! publishes it: integrals over intervals of 50 nm from 300 to 2500 nm, which hold 99.2 % of its 1000.4 W/m^2.

/// First wavelength of the table, and its intervals, nm.
const FIRST_NM: f64 = 300.0;
const INTERVAL_NM: f64 = 50.0;

/// Parts of an interval, over which its irradiance is uniform.
const PARTS: usize = 10;

/// Irradiance of each interval, W/m^2.
const IRRADIANCE: [f64; 44] = [
    13.77, 32.33, 61.77, 77.80, 76.39, 74.63, 72.01, 67.23, 60.05, 53.13, 48.74, 45.79, 26.65,
    29.67, 34.71, 29.89, 11.96, 19.57, 22.58, 20.46, 11.91, 0.02, 1.22, 5.68, 12.88, 12.65, 11.54,
    10.57, 8.92, 5.57, 0.23, 0.0, 0.14, 2.65, 3.08, 3.78, 4.48, 4.0, 3.74, 3.25, 2.76, 2.08, 1.54,
    0.73,
];

/// Longest first and shortest last wavelength, and largest step, nm.
const COVERED_NM: [f64; 2] = [350.0, 2000.0];
const MAX_STEP_NM: f64 = 100.0;

/// Weights of the values of a spectrum at these wavelengths, nm, increasing; their sum is 1.
///
/// Between wavelengths a spectrum is interpolated linearly; beyond its ends it keeps the value of the end, which then stands for up to 1.4 % of
/// the light below 350 nm and 3.0 % above 2000 nm. Returns `None` if the wavelengths do not increase, do not cover 350 to 2000 nm, or have a step
/// above 100 nm.
///
/// # Examples
/// ```
/// use asperity_optics::solar_weights;
///
/// let wavelengths: Vec<f64> = (3..=25).map(|i| f64::from(100 * i)).collect();
/// let weights = solar_weights(&wavelengths).unwrap();
/// assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
/// assert!(solar_weights(&wavelengths[1..]).is_none());
/// ```
#[must_use]
pub fn solar_weights(wavelengths_nm: &[f64]) -> Option<Vec<f64>> {
    let (first, last) = (*wavelengths_nm.first()?, *wavelengths_nm.last()?);
    let is_fine = wavelengths_nm
        .windows(2)
        .all(|pair| pair[1] > pair[0] && pair[1] - pair[0] <= MAX_STEP_NM);
    if !(is_fine && first <= COVERED_NM[0] && last >= COVERED_NM[1]) {
        return None;
    }
    let whole: f64 = IRRADIANCE.iter().sum();
    let mut weights = vec![0.0; wavelengths_nm.len()];
    for i in 0..IRRADIANCE.len() * PARTS {
        let irradiance = IRRADIANCE[i / PARTS] / PARTS as f64;
        let middle = FIRST_NM + (i as f64 + 0.5) * INTERVAL_NM / PARTS as f64;
        let after = wavelengths_nm.partition_point(|&nm| nm < middle);
        let after = after.clamp(1, wavelengths_nm.len() - 1);
        let [below, above] = [wavelengths_nm[after - 1], wavelengths_nm[after]];
        let part = ((middle - below) / (above - below)).clamp(0.0, 1.0);
        weights[after - 1] += (1.0 - part) * irradiance / whole;
        weights[after] += part * irradiance / whole;
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_sunlight_is_below_about_720_nm() {
        // A step between neighbouring wavelengths, as of an edge filter
        let wavelengths: Vec<f64> = (0..=110).map(|i| 300.0 + 20.0 * f64::from(i)).collect();
        let weights = solar_weights(&wavelengths).expect("they cover sunlight");
        let below = |edge: f64| {
            let both = wavelengths.iter().zip(&weights);
            both.filter(|(nm, _)| **nm < edge)
                .map(|(_, weight)| weight)
                .sum::<f64>()
        };
        // By the table of 2002 wavelengths: 0.5 at 716 nm of 300 to 2500 nm. Linear interpolation puts the edges at 710 and 390 nm
        assert!((below(716.0) - 0.5).abs() < 0.01, "{}", below(716.0));
        assert!((below(400.0) - 0.0464).abs() < 0.01);
    }
}
