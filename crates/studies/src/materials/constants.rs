//! Constants of a material at wavelengths: requested ones, or those of its data.

use asperity_io::MaterialRecord;
use asperity_numerics::elementary::pow;
use asperity_optics::{DispersionCurve, OpticalConstants};

use super::error::MaterialsError;

/// Wavelengths at which constants are shown unless others are given, as far as the data reach, nanometres.
const VISIBLE_NM: [f64; 8] = [400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0];

/// Nanometres per micrometre.
const NM: f64 = 1e3;

/// Steps between the points at which a formula is tabulated, even in the logarithm of the wavelength.
const STEPS: u32 = 400;

/// Optical constants at one wavelength.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) wavelength_nm: f64,
    pub(super) n: f64,
    pub(super) k: Option<f64>,
}

/// Constants at wavelengths in nanometres.
pub(super) fn constants_at(
    record: &MaterialRecord,
    wavelengths_nm: &[f64],
) -> Result<Vec<Row>, MaterialsError> {
    let rows = wavelengths_nm.iter().map(|nm| row(record, *nm, nm / NM));
    rows.collect()
}

/// Constants at all points of the data, to the digit, but for those at which a formula has no value.
pub(super) fn constants_of_data(record: &MaterialRecord) -> Vec<Row> {
    let points = tabulated(&record.constants).into_iter();
    points
        .filter_map(|um| row(record, nanometres(um), um).ok())
        .collect()
}

fn row(
    record: &MaterialRecord,
    wavelength_nm: f64,
    micrometres: f64,
) -> Result<Row, MaterialsError> {
    let index = record.constants.at(micrometres);
    let index = index.map_err(|error| MaterialsError::NoIndex {
        name: record.name.clone(),
        error,
    })?;
    Ok(Row {
        wavelength_nm,
        n: index.n,
        k: index.k,
    })
}

/// Visible wavelengths within the data, or as many from end to end where none or one is, nanometres.
pub(super) fn default_wavelengths(constants: &OpticalConstants) -> Vec<f64> {
    let [first, last] = range_nm(constants.n());
    if first == last {
        return vec![first];
    }
    let is_known = |nm: &f64| (first..=last).contains(nm);
    let visible: Vec<f64> = VISIBLE_NM.into_iter().filter(is_known).collect();
    if visible.len() > 1 {
        return visible;
    }
    let steps = VISIBLE_NM.len() - 1;
    let at = |i: usize| match i == steps {
        true => last,
        false => first + (last - first) * i as f64 / steps as f64,
    };
    (0..=steps).map(at).collect()
}

/// All wavelengths of the tables of a material, and those at which its formula is tabulated, micrometres, ascending.
fn tabulated(constants: &OpticalConstants) -> Vec<f64> {
    let n = constants.n();
    let [first, last] = n.range();
    let at = |i: u32| match i {
        0 => first,
        STEPS => last,
        i => first * pow(last / first, f64::from(i) / f64::from(STEPS)),
    };
    let mut points: Vec<f64> = match n.formula_number() {
        Some(_) => (0..=STEPS).map(at).collect(),
        None => n.points().to_vec(),
    };
    let of_k = constants.k().map_or(&[][..], |k| k.points());
    let within = of_k.iter().filter(|point| (first..=last).contains(*point));
    points.extend(within);
    points.sort_by(f64::total_cmp);
    points.dedup();
    points
}

/// First and last wavelength of a curve, nanometres.
pub(super) fn range_nm(curve: &DispersionCurve) -> [f64; 2] {
    curve.range().map(nanometres)
}

/// A wavelength in nanometres, without the digits that the conversion from micrometres rounds.
fn nanometres(micrometres: f64) -> f64 {
    const DIGITS: f64 = 1e9;
    let nm = micrometres * NM;
    let rounded = (nm * DIGITS).round() / DIGITS;
    match (rounded - nm).abs() <= 4.0 * f64::EPSILON * nm {
        true => rounded,
        false => nm,
    }
}

#[cfg(test)]
mod tests {
    use asperity_io::materials;

    use super::*;

    #[test]
    fn nanometres_keep_the_digits_of_micrometres() {
        for (um, nm) in [
            (0.2096, 209.6),
            (0.2098, 209.8),
            (1.937, 1937.0),
            (0.123_456_789_012_3, 123.456_789_012_3),
        ] {
            assert_eq!(nanometres(um), nm);
        }
        for record in materials() {
            for um in tabulated(&record.constants) {
                let nm = nanometres(um);
                assert!(record.constants.at(nm / NM).is_ok(), "{} {nm}", record.name);
            }
        }
    }

    #[test]
    fn data_outside_the_visible_are_shown_from_end_to_end() {
        let constants = |range| {
            let n = DispersionCurve::formula(5, vec![1.5], range).unwrap();
            OpticalConstants::new(n, None).unwrap()
        };
        let found = default_wavelengths(&constants([1.0, 8.0]));
        assert_eq!(found[..2], [1000.0, 2000.0]);
        assert_eq!(found.last(), Some(&8000.0));
        assert_eq!(default_wavelengths(&constants([0.55, 0.55])), [550.0]);
        assert_eq!(
            default_wavelengths(&constants([0.45, 0.6])),
            [450.0, 500.0, 550.0, 600.0]
        );
        assert_eq!(tabulated(&constants([0.45, 0.6])).len(), 401);
    }
}
