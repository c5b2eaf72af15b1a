//! Dispersion: refractive index and extinction coefficient of a material against the wavelength in vacuum.
//!
//! The curves are those of records of the refractiveindex.info database: dispersion formulas 1 to 9 and tables with linear
//! interpolation in wavelength. Nothing is extrapolated.
//!
//! Source of the formulas: M. N. Polyanskiy, "Refractiveindex.info database of optical constants", Scientific Data 11, 94 (2024),
//! <https://doi.org/10.1038/s41597-023-02898-2>.

use asperity_numerics::elementary::pow;

/// Relative distance from an end of a range that counts as on the end: rounding in the conversion of units.
const RANGE_TOLERANCE: f64 = 1e-9;

/// Most coefficients of a formula.
const MAX_COEFFICIENTS: usize = 64;

/// Complex refractive index `n + i k` at one wavelength, for the time factor `exp(-i w t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexIndex {
    /// Refractive index, above zero.
    pub n: f64,
    /// Extinction coefficient, zero or more; `None` where it is unknown, which is not zero.
    pub k: Option<f64>,
}

/// Optical constants of a material: `n`, and `k` where it is known, against the wavelength in micrometres.
///
/// # Examples
/// ```
/// use asperity_optics::{DispersionCurve, OpticalConstants};
///
/// // Fused silica, I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965)
/// let coefficients = vec![0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
/// let n = DispersionCurve::formula(1, coefficients, [0.21, 6.7])?;
/// let silica = OpticalConstants::new(n, None)?;
/// let index = silica.at(0.55)?;
/// assert!((index.n - 1.4599109).abs() < 1e-7 && index.k.is_none());
/// assert!(silica.at(0.1).is_err());
/// # Ok::<(), asperity_optics::DispersionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OpticalConstants {
    n: DispersionCurve,
    k: Option<DispersionCurve>,
}

/// One quantity, `n` or `k`, against the wavelength in micrometres, within a range.
#[derive(Clone, Debug, PartialEq)]
pub struct DispersionCurve(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Formula {
        number: u8,
        coefficients: Vec<f64>,
        range: [f64; 2],
    },
    /// As many values as wavelengths, which ascend.
    Table {
        wavelengths: Vec<f64>,
        values: Vec<f64>,
    },
}

/// Error of a dispersion curve, or of a wavelength at which it has no value. Wavelengths are in micrometres, and in
/// nanometres in the messages.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DispersionError {
    /// The wavelength is outside of the range of the data.
    #[error(
        "the wavelength {} nm is out of range; the data reach from {} to {} nm",
        nm(*wavelength), nm(*first), nm(*last)
    )]
    OutOfRange {
        /// Wavelength.
        wavelength: f64,
        /// Shortest wavelength of the data.
        first: f64,
        /// Longest wavelength of the data.
        last: f64,
    },
    /// The formula has no positive finite value there.
    #[error(
        "formula {number} gives {value:?} at {} nm; a refractive index must be above zero", nm(*wavelength)
    )]
    NoIndex {
        /// Number of the formula.
        number: u8,
        /// Wavelength.
        wavelength: f64,
        /// Value of the formula.
        value: f64,
    },
    /// No formula of that number.
    #[error("formula {0} is unknown; formulas 1 to 9 are allowed")]
    UnknownFormula(u64),
    /// A number of coefficients that the formula cannot have.
    #[error("formula {number} has {count} coefficients; {allowed}")]
    CoefficientCount {
        /// Number of the formula.
        number: u8,
        /// Number of coefficients.
        count: usize,
        /// Allowed numbers.
        allowed: &'static str,
    },
    /// A coefficient that is not finite.
    #[error("coefficient {index} of formula {number} is {value:?}; it must be finite")]
    BadCoefficient {
        /// Number of the formula.
        number: u8,
        /// Place of the coefficient, from 1.
        index: usize,
        /// Value.
        value: f64,
    },
    /// A wavelength range that is empty or not positive.
    #[error(
        "the wavelength range {} to {} nm is invalid; it must ascend and be above zero", nm(*.0), nm(*.1)
    )]
    BadRange(f64, f64),
    /// A table without points, or with columns of different lengths.
    #[error("the table has no points, or columns of different lengths")]
    BadTable,
    /// A wavelength of a table that is not positive and finite.
    #[error("the wavelength {} nm is invalid; wavelengths must be finite and above zero", nm(*.0))]
    BadWavelength(f64),
    /// A wavelength that occurs twice.
    #[error("the wavelength {} nm occurs twice", nm(*.0))]
    Duplicate(f64),
    /// Wavelengths that neither ascend nor descend.
    #[error(
        "the wavelength {} nm follows {} nm; wavelengths must ascend or descend throughout", nm(*.1), nm(*.0)
    )]
    Unsorted(f64, f64),
    /// A refractive index of a table that is not positive and finite.
    #[error(
        "n is {value:?} at {} nm; the refractive index must be finite and above zero", nm(*wavelength)
    )]
    BadIndex {
        /// Wavelength.
        wavelength: f64,
        /// Value.
        value: f64,
    },
    /// An extinction coefficient that is negative or not finite.
    #[error(
        "k is {value:?} at {} nm; the extinction coefficient must be finite, zero or more", nm(*wavelength)
    )]
    BadExtinction {
        /// Wavelength.
        wavelength: f64,
        /// Value.
        value: f64,
    },
    /// A formula for the extinction coefficient.
    #[error("the extinction coefficient is given by a formula; it must be a table")]
    ExtinctionFormula,
}

/// A wavelength in micrometres as text in nanometres, with at most six significant digits.
fn nm(micrometres: f64) -> String {
    let rounded = format!("{:.5e}", micrometres * 1e3).parse::<f64>();
    let text = format!("{:?}", rounded.unwrap_or(f64::NAN));
    text.trim_end_matches(".0").to_owned()
}

impl DispersionCurve {
    /// The dispersion formula `number` (1 to 9) of refractiveindex.info for `n`, with wavelengths in micrometres, valid over `range`.
    ///
    /// # Errors
    /// [`DispersionError`] if the formula is unknown, its coefficients are not finite or of a number that it cannot have, or the range
    /// is invalid.
    pub fn formula(
        number: u64,
        coefficients: Vec<f64>,
        range: [f64; 2],
    ) -> Result<Self, DispersionError> {
        let number = match u8::try_from(number) {
            Ok(small @ 1..=9) => small,
            _ => return Err(DispersionError::UnknownFormula(number)),
        };
        let count = coefficients.len();
        let (fits, allowed) = match number {
            1 | 2 | 3 | 5 | 6 => (
                count % 2 == 1 && count <= MAX_COEFFICIENTS,
                "an odd number up to 63 is allowed",
            ),
            4 => (
                matches!(count, 1 | 5 | 9) || (count > 9 && count <= 17 && count % 2 == 1),
                "1, 5, 9, 11, 13, 15 or 17 are allowed",
            ),
            8 => ((1..=4).contains(&count), "1 to 4 are allowed"),
            // 7 and 9
            _ => ((1..=6).contains(&count), "1 to 6 are allowed"),
        };
        if !fits {
            return Err(DispersionError::CoefficientCount {
                number,
                count,
                allowed,
            });
        }
        if let Some(index) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(DispersionError::BadCoefficient {
                number,
                index: index + 1,
                value: coefficients[index],
            });
        }
        let [first, last] = range;
        if !(first > 0.0 && first <= last && last.is_finite()) {
            return Err(DispersionError::BadRange(first, last));
        }
        Ok(Self(Kind::Formula {
            number,
            coefficients,
            range,
        }))
    }

    /// A table of values at `wavelengths` in micrometres, which ascend or descend; linear in wavelength between them.
    ///
    /// # Errors
    /// [`DispersionError`] if there are no points or wavelengths are invalid, unsorted or occur twice.
    pub fn table(mut wavelengths: Vec<f64>, mut values: Vec<f64>) -> Result<Self, DispersionError> {
        if wavelengths.is_empty() || wavelengths.len() != values.len() {
            return Err(DispersionError::BadTable);
        }
        let is_valid = |w: &&f64| w.is_finite() && **w > 0.0;
        if let Some(wavelength) = wavelengths.iter().find(|w| !is_valid(w)) {
            return Err(DispersionError::BadWavelength(*wavelength));
        }
        if wavelengths.first() > wavelengths.last() {
            wavelengths.reverse();
            values.reverse();
        }
        for pair in wavelengths.windows(2) {
            if pair[0] == pair[1] {
                return Err(DispersionError::Duplicate(pair[0]));
            }
            if pair[0] > pair[1] {
                return Err(DispersionError::Unsorted(pair[0], pair[1]));
            }
        }
        Ok(Self(Kind::Table {
            wavelengths,
            values,
        }))
    }

    /// First and last wavelength, micrometres.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        match &self.0 {
            Kind::Formula { range, .. } => *range,
            Kind::Table { wavelengths, .. } => [wavelengths[0], wavelengths[wavelengths.len() - 1]],
        }
    }

    /// The wavelengths of a table, micrometres, ascending; none of a formula.
    #[must_use]
    pub fn points(&self) -> &[f64] {
        match &self.0 {
            Kind::Formula { .. } => &[],
            Kind::Table { wavelengths, .. } => wavelengths,
        }
    }

    /// Number of the formula; `None` for a table.
    #[must_use]
    pub const fn formula_number(&self) -> Option<u8> {
        match self.0 {
            Kind::Formula { number, .. } => Some(number),
            Kind::Table { .. } => None,
        }
    }

    /// The value at a wavelength in micrometres; wavelengths beyond an end by rounding alone count as the end.
    fn value(&self, wavelength: f64) -> Result<f64, DispersionError> {
        let [first, last] = self.range();
        let inside = first * (1.0 - RANGE_TOLERANCE)..=last * (1.0 + RANGE_TOLERANCE);
        if !inside.contains(&wavelength) {
            return Err(DispersionError::OutOfRange {
                wavelength,
                first,
                last,
            });
        }
        match &self.0 {
            Kind::Formula {
                number,
                coefficients,
                ..
            } => {
                let value = formula(*number, coefficients, wavelength);
                match value.is_finite() && value > 0.0 {
                    true => Ok(value),
                    false => Err(DispersionError::NoIndex {
                        number: *number,
                        wavelength,
                        value,
                    }),
                }
            }
            Kind::Table {
                wavelengths,
                values,
            } => Ok(interpolated(
                wavelengths,
                values,
                wavelength.clamp(first, last),
            )),
        }
    }
}

impl OpticalConstants {
    /// The constants with the curve `n`, and `k` if it is known.
    ///
    /// # Errors
    /// [`DispersionError`] if a table has an `n` that is not finite and above zero, or a `k` that is negative or not finite, or if `k`
    /// is a formula.
    pub fn new(n: DispersionCurve, k: Option<DispersionCurve>) -> Result<Self, DispersionError> {
        if let Kind::Table {
            wavelengths,
            values,
        } = &n.0
        {
            let is_bad = |n: &f64| !(n.is_finite() && *n > 0.0);
            if let Some(i) = values.iter().position(is_bad) {
                let (wavelength, value) = (wavelengths[i], values[i]);
                return Err(DispersionError::BadIndex { wavelength, value });
            }
        }
        match k.as_ref().map(|k| &k.0) {
            Some(Kind::Formula { .. }) => return Err(DispersionError::ExtinctionFormula),
            Some(Kind::Table {
                wavelengths,
                values,
            }) => {
                let is_bad = |k: &f64| !(k.is_finite() && *k >= 0.0);
                if let Some(i) = values.iter().position(is_bad) {
                    let (wavelength, value) = (wavelengths[i], values[i]);
                    return Err(DispersionError::BadExtinction { wavelength, value });
                }
            }
            None => {}
        }
        Ok(Self { n, k })
    }

    /// The complex index at a `wavelength` in vacuum, in micrometres. `k` is `None` where it is unknown: without data, or outside of
    /// their range.
    ///
    /// # Errors
    /// [`DispersionError::OutOfRange`] outside of the range of `n`; [`DispersionError::NoIndex`] where a formula has no value.
    pub fn at(&self, wavelength: f64) -> Result<ComplexIndex, DispersionError> {
        let n = self.n.value(wavelength)?;
        let k = self.k.as_ref().and_then(|k| k.value(wavelength).ok());
        Ok(ComplexIndex { n, k })
    }

    /// The curve of the refractive index.
    #[must_use]
    pub const fn n(&self) -> &DispersionCurve {
        &self.n
    }

    /// The curve of the extinction coefficient, if it is known anywhere.
    #[must_use]
    pub const fn k(&self) -> Option<&DispersionCurve> {
        self.k.as_ref()
    }
}

/// Linear between the neighbours, exact at the points. `x` is within the range of `xs`.
fn interpolated(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let after = xs.partition_point(|known| *known <= x);
    let i = after.saturating_sub(1);
    if after == xs.len() || xs[i] == x {
        return ys[i];
    }
    (ys[after] - ys[i]) / (xs[after] - xs[i]) * (x - xs[i]) + ys[i]
}

/// `n` by a dispersion formula at the wavelength `w`, micrometres; not finite where it has no value.
fn formula(number: u8, coefficients: &[f64], w: f64) -> f64 {
    let w2 = w * w;
    let c = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
    let pairs = |from: usize| {
        let rest = coefficients.get(from..).unwrap_or_default();
        rest.chunks_exact(2).map(|pair| (pair[0], pair[1]))
    };
    let add = |start: f64, term: &dyn Fn(f64, f64) -> f64| {
        pairs(1).fold(start, |sum, (a, b)| sum + term(a, b))
    };
    match number {
        // Sellmeier
        1 => add(1.0 + c(0), &|a, b| a * w2 / (w2 - b * b)).sqrt(),
        // Sellmeier with squared resonances
        2 => add(1.0 + c(0), &|a, b| a * w2 / (w2 - b)).sqrt(),
        // Polynomial
        3 => add(c(0), &|a, b| a * pow(w, b)).sqrt(),
        // refractiveindex.info
        4 => {
            let quads = coefficients.get(1..).unwrap_or_default().chunks_exact(4);
            let resonances = quads.take(2).fold(c(0), |n2, q| {
                n2 + q[0] * pow(w, q[1]) / (w2 - pow(q[2], q[3]))
            });
            pairs(9)
                .fold(resonances, |n2, (a, b)| n2 + a * pow(w, b))
                .sqrt()
        }
        // Cauchy
        5 => add(c(0), &|a, b| a * pow(w, b)),
        // Gases
        6 => add(1.0 + c(0), &|a, b| a / (b - 1.0 / w2)),
        // Herzberger
        7 => {
            let l = 1.0 / (w2 - 0.028);
            let start = c(0) + c(1) * l + c(2) * l * l;
            let powers = (3..coefficients.len()).zip(1..);
            powers.fold(start, |n, (i, power)| n + c(i) * w2.powi(power))
        }
        // Retro
        8 => {
            let t = c(0) + c(1) * w2 / (w2 - c(2)) + c(3) * w2;
            ((2.0 * t + 1.0) / (1.0 - t)).sqrt()
        }
        // Exotic
        _ => {
            let d = w - c(4);
            (c(0) + c(1) / (w2 - c(2)) + c(3) * d / (d * d + c(5))).sqrt()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn index(number: u64, coefficients: &[f64], wavelength: f64) -> f64 {
        let curve = DispersionCurve::formula(number, coefficients.to_vec(), [0.2, 2.0]).unwrap();
        OpticalConstants::new(curve, None)
            .unwrap()
            .at(wavelength)
            .unwrap()
            .n
    }

    #[test]
    fn each_formula_gives_the_value_worked_out_by_hand() {
        for (number, coefficients, expected) in [
            // At w = 1: 1 + 0.5 + 1 / (1 - 0.25)
            (1, &[0.5, 1.0, 0.5][..], (1.5_f64 + 1.0 / 0.75).sqrt()),
            (2, &[0.5, 1.0, 0.5], (1.5_f64 + 1.0 / 0.5).sqrt()),
            (3, &[2.0, 0.5, 2.0, 0.25, -2.0], 2.75_f64.sqrt()),
            (
                4,
                &[2.0, 0.5, 0.0, 0.5, 2.0, 0.25, 2.0, 0.5, 1.0, 0.1, 3.0],
                (2.0_f64 + 0.5 / 0.75 + 0.25 / 0.5 + 0.1).sqrt(),
            ),
            (5, &[1.5, 0.01, -2.0], 1.51),
            (6, &[0.0, 0.05, 200.0], 1.0 + 0.05 / 199.0),
            (
                7,
                &[1.5, 0.1, 0.01, 0.001, 0.002, 0.003],
                1.506 + 0.1 / 0.972 + 0.01 / (0.972 * 0.972),
            ),
            (8, &[0.2, 0.1, 0.5, 0.01], (1.82_f64 / 0.59).sqrt()),
            (
                9,
                &[2.0, 0.1, 0.5, 0.2, 0.6, 0.04],
                (2.0_f64 + 0.2 + 0.2 * 0.4 / 0.2).sqrt(),
            ),
        ] {
            let found = index(number, coefficients, 1.0);
            assert!(
                (found - expected).abs() < 1e-14,
                "{number}: {found} {expected}"
            );
        }
        // Powers of the wavelength, at w = 0.5
        assert!((index(5, &[1.5, 0.01, -2.0], 0.5) - 1.54).abs() < 1e-15);
        assert!((index(3, &[2.0, 1.0, 3.0], 0.5) - 2.125_f64.sqrt()).abs() < 1e-15);
        let herzberger = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert!((index(7, &herzberger, 0.5) - (1.25 + 1.0 / 16.0 + 1.0 / 64.0)).abs() < 1e-15);
    }

    #[test]
    fn tables_are_linear_between_points_and_exact_at_them() {
        let n = DispersionCurve::table(vec![0.7, 0.5, 0.4], vec![3.0, 2.0, 1.0]).unwrap();
        let k = DispersionCurve::table(vec![0.4, 0.5], vec![0.0, 0.1]).unwrap();
        let constants = OpticalConstants::new(n, Some(k)).unwrap();
        let at = |w| constants.at(w).unwrap();
        assert_eq!(
            at(0.4),
            ComplexIndex {
                n: 1.0,
                k: Some(0.0)
            }
        );
        assert_eq!(
            at(0.5),
            ComplexIndex {
                n: 2.0,
                k: Some(0.1)
            }
        );
        assert!((at(0.6).n - 2.5).abs() < 1e-15);
        assert_eq!(at(0.6).k, None);
        assert_eq!(at(0.7 * (1.0 + 1e-12)).n, 3.0);
        assert_eq!(constants.n().range(), [0.4, 0.7]);
        assert_eq!(constants.k().unwrap().range(), [0.4, 0.5]);
        let error = constants.at(0.71).unwrap_err().to_string();
        assert_eq!(
            error,
            "the wavelength 710 nm is out of range; the data reach from 400 to 700 nm"
        );
        for wavelength in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
            assert!(constants.at(wavelength).is_err());
        }
    }

    #[test]
    fn messages_state_short_nanometres() {
        for (micrometres, text) in [
            (0.4, "400"),
            (0.2098, "209.8"),
            (0.187_901_234, "187.901"),
            (-0.4, "-400"),
            (0.0, "0"),
            (1e300, "1e303"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(nm(micrometres), text);
        }
    }

    #[test]
    fn invalid_curves_are_refused() {
        use DispersionError as E;
        let table = |w: &[f64]| DispersionCurve::table(w.to_vec(), vec![1.0; w.len()]).unwrap_err();
        assert_eq!(table(&[]), E::BadTable);
        assert_eq!(table(&[0.4, 0.4]), E::Duplicate(0.4));
        assert_eq!(table(&[0.4, 0.6, 0.5, 0.7]), E::Unsorted(0.6, 0.5));
        assert_eq!(table(&[-0.4]), E::BadWavelength(-0.4));
        assert!(matches!(table(&[f64::NAN]), E::BadWavelength(_)));
        let formula = |number, c: &[f64]| DispersionCurve::formula(number, c.to_vec(), [0.4, 0.7]);
        assert_eq!(formula(10, &[1.0]), Err(E::UnknownFormula(10)));
        assert_eq!(formula(0, &[1.0]), Err(E::UnknownFormula(0)));
        assert!(matches!(
            formula(1, &[0.0, 1.0]),
            Err(E::CoefficientCount { .. })
        ));
        assert!(matches!(formula(2, &[]), Err(E::CoefficientCount { .. })));
        assert!(matches!(
            formula(5, &[f64::NAN]),
            Err(E::BadCoefficient { index: 1, .. })
        ));
        for range in [
            [0.7, 0.4],
            [0.0, 1.0],
            [f64::NAN, 1.0],
            [0.4, f64::INFINITY],
        ] {
            let curve = DispersionCurve::formula(5, vec![1.5], range);
            assert!(matches!(curve, Err(E::BadRange(..))));
        }
        let curve = |value| DispersionCurve::table(vec![0.5], vec![value]).unwrap();
        for n in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(OpticalConstants::new(curve(n), None).is_err());
        }
        for k in [-1e-3, f64::NAN, f64::INFINITY] {
            assert!(OpticalConstants::new(curve(1.5), Some(curve(k))).is_err());
        }
        let k = formula(5, &[1.5]).unwrap();
        let constants = OpticalConstants::new(curve(1.5), Some(k));
        assert_eq!(constants, Err(E::ExtinctionFormula));
        // Below its resonance this formula has no real index
        let n = DispersionCurve::formula(2, vec![0.0, 5.0, 1.0], [0.4, 0.99]).unwrap();
        let constants = OpticalConstants::new(n, None).unwrap();
        assert!(matches!(constants.at(0.9), Err(E::NoIndex { .. })));
    }
}
