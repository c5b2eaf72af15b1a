//! Height table: a measured distribution of heights.

use serde::{Deserialize, Serialize};

use asperity_numerics::elementary::exp;
use asperity_numerics::ln_normal_cdf;
use asperity_numerics::quadrature::normal_moments;
use asperity_surface::{Form, HeightField, HeightFieldError};

/// Nodes per unit of the normal number, and the largest of them.
const PER_UNIT: i32 = 8;
const LAST: i32 = 4 * PER_UNIT;

/// A distribution of mean zero and variance one, by its quantiles: the height that belongs to each standard normal number.
///
/// Between the nodes, at every eighth from -4 to 4, the height is a cubic that rises wherever its nodes do; beyond them it is constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightTable {
    /// Heights at the nodes, ascending.
    quantiles: Vec<f64>,
    skewness: f64,
    kurtosis: f64,
}

/// Reason why a table is not a valid distribution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightTableError {
    /// Fewer than two heights.
    #[error("{rows} heights; a distribution needs at least 2")]
    TooFew {
        /// Number found.
        rows: usize,
    },
    /// A column does not ascend.
    #[error("the numbers of column {column} must be finite and ascend")]
    NotAscending {
        /// Name of the column.
        column: &'static str,
    },
    /// A cumulative probability is outside 0 to 1.
    #[error("a cumulative probability is {value}; it must be from 0 to 1")]
    BadProbability {
        /// The probability.
        value: f64,
    },
    /// A density is negative or not finite, or all are 0.
    #[error("a density is {value}; densities must be finite, not negative, and not all 0")]
    BadDensity {
        /// The density.
        value: f64,
    },
    /// The plane of best fit cannot be removed.
    #[error(transparent)]
    Form(#[from] HeightFieldError),
    /// All heights are equal.
    #[error("all heights are equal; a distribution needs some that differ")]
    NoSpread,
}

impl HeightTable {
    /// Table of heights, ascending, and the cumulative probability of each: the fraction that is lower. Linear between them.
    ///
    /// # Errors
    /// [`HeightTableError`] if either does not ascend, or is out of range.
    pub fn of_probabilities(
        heights: &[f64],
        probabilities: &[f64],
    ) -> Result<Self, HeightTableError> {
        check_ascending("height", heights)?;
        for value in probabilities {
            if !(0.0..=1.0).contains(value) {
                return Err(HeightTableError::BadProbability { value: *value });
            }
        }
        check_ascending("probability", probabilities)?;
        if heights.len() != probabilities.len() {
            return Err(HeightTableError::TooFew {
                rows: heights.len().min(probabilities.len()),
            });
        }
        Self::of_quantiles(|p| interpolated(probabilities, heights, p))
    }

    /// Table of heights, ascending, and the density at each, on any scale. Linear between them, zero beyond.
    ///
    /// # Errors
    /// [`HeightTableError`] if heights do not ascend, or a density is negative.
    pub fn of_densities(heights: &[f64], densities: &[f64]) -> Result<Self, HeightTableError> {
        check_ascending("height", heights)?;
        let rows = heights.len().min(densities.len());
        if heights.len() != densities.len() {
            return Err(HeightTableError::TooFew { rows });
        }
        for value in densities {
            if !(value.is_finite() && *value >= 0.0) {
                return Err(HeightTableError::BadDensity { value: *value });
            }
        }
        // Within a piece the density is a straight line: its integral to finer nodes
        const PARTS: usize = 16;
        let (mut nodes, mut sums) = (vec![heights[0]], vec![0.0]);
        let mut sum = 0.0;
        for i in 1..rows {
            let (width, rise) = (heights[i] - heights[i - 1], densities[i] - densities[i - 1]);
            for part in 1..=PARTS {
                let t = part as f64 / PARTS as f64;
                let power = width * t * (densities[i - 1] + 0.5 * t * rise);
                // Where nothing lies the last height before it stays
                if sum + power > sums[sums.len() - 1] {
                    nodes.push(heights[i - 1] + t * width);
                    sums.push(sum + power);
                }
            }
            sum += 0.5 * width * (densities[i] + densities[i - 1]);
        }
        if sum <= 0.0 {
            return Err(HeightTableError::BadDensity { value: 0.0 });
        }
        sums.iter_mut().for_each(|p| *p /= sum);
        Self::of_quantiles(|p| interpolated(&sums, &nodes, p))
    }

    /// The distribution of the heights of a surface, without its mean, and without its plane of best fit unless it is periodic.
    ///
    /// # Errors
    /// [`HeightTableError::NoSpread`] of a flat one, [`HeightTableError::Form`] if sums of heights overflow.
    pub fn like(field: &HeightField) -> Result<Self, HeightTableError> {
        let form = Form::left_out_of_statistics(field.border());
        let mut heights = form.remove(field.clone())?.into_heights();
        heights.sort_by(f64::total_cmp);
        let last = heights.len() - 1;
        Self::of_quantiles(|p| {
            // The middle of the k-th of n heights has the probability (k + 1/2) / n
            let place = (p * heights.len() as f64 - 0.5).clamp(0.0, last as f64);
            let i = (place as usize).min(last - 1);
            heights[i] + (place - i as f64) * (heights[i + 1] - heights[i])
        })
    }

    fn of_quantiles(quantile: impl Fn(f64) -> f64) -> Result<Self, HeightTableError> {
        let node = |i: i32| quantile(exp(ln_normal_cdf(f64::from(i) / f64::from(PER_UNIT))));
        let quantiles: Vec<f64> = (-LAST..=LAST).map(node).collect();
        let raw = Self {
            quantiles,
            skewness: 0.0,
            kurtosis: 3.0,
        };
        let [mean, variance, skewness, kurtosis] = raw.moments();
        if !(variance.is_finite() && variance > 0.0) {
            return Err(HeightTableError::NoSpread);
        }
        let standard = |h: &f64| (h - mean) / variance.sqrt();
        Ok(Self {
            quantiles: raw.quantiles.iter().map(standard).collect(),
            skewness,
            kurtosis,
        })
    }

    /// Mean, variance, skewness and kurtosis, by the trapezium rule over normal numbers.
    fn moments(&self) -> [f64; 4] {
        normal_moments(|z| self.at(z), 64, 8)
    }

    /// Skewness of the distribution.
    #[must_use]
    pub const fn skewness(&self) -> f64 {
        self.skewness
    }

    /// Kurtosis of the distribution, 3 of a normal one.
    #[must_use]
    pub const fn kurtosis(&self) -> f64 {
        self.kurtosis
    }

    /// The height, of mean zero and variance one, that belongs to a standard normal number.
    ///
    /// # Source
    /// F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300: slopes that keep a cubic monotone.
    pub(crate) fn at(&self, z: f64) -> f64 {
        let q = &self.quantiles;
        let place = ((z * f64::from(PER_UNIT)) + f64::from(LAST)).clamp(0.0, f64::from(2 * LAST));
        let i = (place as usize).min(q.len() - 2);
        let t = place - i as f64;
        let rise = q[i + 1] - q[i];
        // Harmonic mean of the rises on either side of a node
        let slope = |k: usize| {
            if k == 0 || k == q.len() - 1 {
                return 0.0;
            }
            let (before, after) = (q[k] - q[k - 1], q[k + 1] - q[k]);
            match before + after > 0.0 {
                true => 2.0 * before * after / (before + after),
                false => 0.0,
            }
        };
        let (d0, d1) = (slope(i), slope(i + 1));
        let (square, cube) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        q[i] + t * (d0 + t * (square + t * cube))
    }

    pub(super) fn is_valid(&self) -> bool {
        let ascends = self.quantiles.windows(2).all(|pair| pair[0] <= pair[1]);
        let moments = [self.skewness, self.kurtosis];
        self.quantiles.len() == 2 * LAST as usize + 1
            && ascends
            && self.quantiles.iter().chain(&moments).all(|x| x.is_finite())
    }
}

fn check_ascending(column: &'static str, values: &[f64]) -> Result<(), HeightTableError> {
    if values.len() < 2 {
        return Err(HeightTableError::TooFew { rows: values.len() });
    }
    let ascends = values.windows(2).all(|pair| pair[0] < pair[1]);
    match ascends && values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(HeightTableError::NotAscending { column }),
    }
}

/// The value at `x` of the straight lines through `(xs, ys)`, constant beyond them.
fn interpolated(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let i = xs.partition_point(|node| *node < x);
    if i == 0 || i == xs.len() {
        return ys[i.min(xs.len() - 1)];
    }
    let t = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
    ys[i - 1] + t * (ys[i] - ys[i - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform heights: skewness 0, kurtosis 9/5, and the height of `z` is `sqrt 3 (2 Phi(z) - 1)`. The cubic between nodes an eighth apart is of second order where its slopes are
    /// harmonic means: within 1e-3.
    #[test]
    fn a_uniform_density_gives_a_uniform_distribution() {
        let by_density = HeightTable::of_densities(&[2.0, 5.0], &[7.0, 7.0]).unwrap();
        let by_probability = HeightTable::of_probabilities(&[2.0, 5.0], &[0.0, 1.0]).unwrap();
        for table in [by_density, by_probability] {
            assert!(table.skewness().abs() < 1e-12);
            assert!(
                (table.kurtosis() - 1.8).abs() < 2e-3,
                "{}",
                table.kurtosis()
            );
            for z in [-2.3, -0.7, 0.01, 1.9] {
                let exact = 3.0_f64.sqrt() * (2.0 * ln_normal_cdf(z).exp() - 1.0);
                assert!((table.at(z) - exact).abs() < 2e-3, "{z}: {}", table.at(z));
            }
        }
    }

    /// A density that rises from 0: the cumulative one is `h^2`, skewness -2 sqrt 2 / 5 and kurtosis 12 / 5 of a right triangle. Pieces of a
    /// sixteenth and nodes an eighth apart keep both within 2e-2.
    #[test]
    fn a_triangular_density_has_the_moments_of_a_triangle() {
        let table = HeightTable::of_densities(&[0.0, 1.0], &[0.0, 3.0]).unwrap();
        let skewness = -2.0 * 2.0_f64.sqrt() / 5.0;
        assert!(
            (table.skewness() - skewness).abs() < 2e-2,
            "{}",
            table.skewness()
        );
        assert!(
            (table.kurtosis() - 2.4).abs() < 2e-2,
            "{}",
            table.kurtosis()
        );
    }

    /// Density 1, 0, 1 of two blocks: half the heights in each, none between.
    #[test]
    fn a_gap_stays_empty() {
        let table = HeightTable::of_densities(
            &[0.0, 1.0, 1.0001, 8.9999, 9.0, 10.0],
            &[1.0, 1.0, 0.0, 0.0, 1.0, 1.0],
        )
        .unwrap();
        let (low, high) = (table.at(-0.125), table.at(0.125));
        assert!(high - low > 1.5, "{low} {high}");
        assert!((table.at(-1.0) - low).abs() < 0.3);
    }

    #[test]
    fn malformed_tables_are_refused() {
        use HeightTableError::{BadDensity, BadProbability, NoSpread, NotAscending, TooFew};
        let probabilities = HeightTable::of_probabilities;
        assert_eq!(probabilities(&[1.0], &[0.5]), Err(TooFew { rows: 1 }));
        let column = "height";
        assert_eq!(
            probabilities(&[1.0, 1.0], &[0.0, 1.0]),
            Err(NotAscending { column })
        );
        let column = "probability";
        assert_eq!(
            probabilities(&[1.0, 2.0], &[0.5, 0.5]),
            Err(NotAscending { column })
        );
        let value = 1.5;
        assert_eq!(
            probabilities(&[1.0, 2.0], &[0.0, 1.5]),
            Err(BadProbability { value })
        );
        let value = -1.0;
        assert_eq!(
            HeightTable::of_densities(&[1.0, 2.0], &[1.0, -1.0]),
            Err(BadDensity { value })
        );
        let value = 0.0;
        assert_eq!(
            HeightTable::of_densities(&[1.0, 2.0], &[0.0; 2]),
            Err(BadDensity { value })
        );
        let flat = HeightField::new(vec![1.0; 16], [4, 4], [1.0; 2]).unwrap();
        assert_eq!(HeightTable::like(&flat), Err(NoSpread));
    }
}
