//! Slope control variate: a regression of the fluxes of random surfaces on the moments of their slopes.
//!
//! A surface that happens to be steeper than the ensemble reflects and transmits in other directions. The moments of its slopes are
//! known exactly, and so is what they are on average over Gaussian surfaces. From the flux of each surface, `b . (c - E[c])` is
//! subtracted, with the deviations `c - E[c]` of its moments and coefficients `b` by least squares. That takes away
//! what the moments explain of the scatter between surfaces, and leaves the mean as it is, since coefficients come
//! from other surfaces than those that they are used for: surfaces are dealt into eight folds, and each fold has the coefficients of
//! the seven others. Coefficients are linear in the fluxes, so that sums of fluxes stay sums, and the budget closes.
//!
//! # Source
//! S. Lavenberg, P. Welch, A perspective on the use of control variables to increase the efficiency of Monte Carlo simulations, Manage.
//! Sci. 27 (1981) 322, for regression; A. Avramidis, J. Wilson, A splitting scheme for control variates, Oper. Res. Lett. 14 (1993)
//! 187, for coefficients from other samples.

use asperity_surface::SlopeMoments;
use asperity_synthesis::SurfaceRecipe;
use asperity_tally::{Entry, TallySpec, TallyValues};

use crate::input::case::Light;

/// Fewest surfaces for which coefficients are known well enough: with four of them, variance rises by a seventh where they explain
/// nothing.
const MIN_SURFACES: usize = 32;

const FOLDS: usize = 8;

/// The part of the variance that must remain at most: a smaller gain is not worth a mention.
const WORTHWHILE: f64 = 0.97;

/// The moments whose deviations serve as controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ControlMoments {
    /// Mean square gradient and the mean fourth power: all that matters to light of random azimuth on isotropic surfaces.
    Isotropic,
    /// Mean squares along both axes and the fourth power, where light and surfaces are symmetric about an axis.
    Symmetric,
    /// All of them.
    All,
}

impl ControlMoments {
    /// Moments for this light on surfaces of this spectrum; `folded`: whether bins are averaged with their mirror images.
    pub(crate) fn of(light: &Light, recipe: &SurfaceRecipe, folded: bool) -> Self {
        if light.random_azimuth && recipe.is_isotropic() {
            Self::Isotropic
        } else if folded {
            Self::Symmetric
        } else {
            Self::All
        }
    }

    /// Deviations of moments from those expected: second moments over the expected mean square gradient, the fourth over its own
    /// expectation.
    fn deviations(self, found: &SlopeMoments, expected: &SlopeMoments) -> Vec<f64> {
        let [xx, _, yy] = expected.second;
        let of_second = |i: usize| (found.second[i] - expected.second[i]) / (xx + yy);
        let [xx, xy, yy] = [0, 1, 2].map(of_second);
        let fourth = found.fourth / expected.fourth - 1.0;
        match self {
            Self::Isotropic => vec![xx + yy, fourth],
            Self::Symmetric => vec![xx, yy, fourth],
            Self::All => vec![xx, xy, yy, fourth],
        }
    }
}

/// Control variate between surfaces: coefficients of the moments, one set per fold of surfaces.
#[derive(Clone, Debug)]
pub(crate) struct SlopeControlVariate {
    moments: ControlMoments,
    expected: SlopeMoments,
    /// By fold, then by control.
    coefficients: Vec<Vec<TallyValues>>,
    /// Variance over surfaces that remains, of the entries by which it was judged.
    remaining: f64,
}

/// Fluxes of surfaces, in the order of their number, and the moments of their slopes.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a> {
    pub(crate) tallies: &'a [TallyValues],
    pub(crate) slopes: &'a [SlopeMoments],
    pub(crate) expected_slopes: SlopeMoments,
}

impl SlopeControlVariate {
    /// Coefficients from these surfaces. `None` if there are too few surfaces, or if the variance of the entries `judged` hardly falls.
    pub(crate) fn fit(
        observed: Observed<'_>,
        moments: ControlMoments,
        judged: &[Entry],
    ) -> Option<Self> {
        let Observed {
            tallies,
            slopes,
            expected_slopes,
        } = observed;
        if tallies.len() < MIN_SURFACES || slopes.len() != tallies.len() {
            return None;
        }
        let deviations = slopes
            .iter()
            .map(|found| moments.deviations(found, &expected_slopes));
        let deviations: Vec<Vec<f64>> = deviations.collect();
        let folds: Vec<Sums> = (0..FOLDS)
            .map(|fold| {
                let mut sums = Sums::new(*tallies[0].spec(), deviations[0].len());
                for r in (fold..tallies.len()).step_by(FOLDS) {
                    sums.add(&deviations[r], &tallies[r]);
                }
                sums
            })
            .collect();
        let without = |fold: usize| {
            let others = folds
                .iter()
                .enumerate()
                .filter(move |(other, _)| *other != fold);
            Sums::total(others.map(|(_, sums)| sums))?.coefficients()
        };
        let mut control = Self {
            moments,
            expected: expected_slopes,
            coefficients: (0..FOLDS).map(without).collect::<Option<_>>()?,
            remaining: 1.0,
        };
        control.remaining = control.remaining_variance(observed, judged);
        (control.remaining <= WORTHWHILE).then_some(control)
    }

    /// The fluxes of surface `number`, less what its slopes explain.
    pub(crate) fn adjusted(
        &self,
        number: usize,
        tally: &TallyValues,
        slopes: &SlopeMoments,
    ) -> TallyValues {
        let mut adjusted = tally.clone();
        let deviations = self.moments.deviations(slopes, &self.expected);
        for (deviation, coefficients) in deviations.iter().zip(&self.coefficients[number % FOLDS]) {
            adjusted.update(coefficients, |flux, coefficient| {
                *flux -= coefficient * deviation;
            });
        }
        adjusted
    }

    /// Variance over surfaces that remains, of the entries by which the control was judged.
    pub(crate) const fn remaining(&self) -> f64 {
        self.remaining
    }

    /// Variance of adjusted fluxes over that of fluxes as they were found, summed over entries.
    fn remaining_variance(&self, observed: Observed<'_>, judged: &[Entry]) -> f64 {
        let mut before = vec![Scatter::default(); judged.len()];
        let mut after = before.clone();
        let pairs = observed.tallies.iter().zip(observed.slopes);
        for (number, (tally, slopes)) in pairs.enumerate() {
            let deviations = self.moments.deviations(slopes, &self.expected);
            let coefficients = &self.coefficients[number % FOLDS];
            for (i, &entry) in judged.iter().enumerate() {
                let pairs = deviations.iter().zip(coefficients);
                let explained: f64 = pairs.map(|(c, b)| c * b[entry]).sum();
                before[i].add(number, tally[entry]);
                after[i].add(number, tally[entry] - explained);
            }
        }
        let sum = |scatter: &[Scatter]| scatter.iter().map(|one| one.squares).sum::<f64>();
        let before = sum(&before);
        if before > 0.0 {
            sum(&after) / before
        } else {
            1.0
        }
    }
}

/// Running mean and sum of squared deviations.
#[derive(Clone, Copy, Default)]
struct Scatter {
    mean: f64,
    squares: f64,
}

impl Scatter {
    fn add(&mut self, count_before: usize, value: f64) {
        let before = value - self.mean;
        self.mean += before / (count_before as f64 + 1.0);
        self.squares += before * (value - self.mean);
    }
}

/// Sums over surfaces that a regression needs.
#[derive(Clone)]
struct Sums {
    count: f64,
    /// Sums of controls.
    values: Vec<f64>,
    /// Sums of their products, row by row.
    products: Vec<Vec<f64>>,
    /// Sums of fluxes.
    fluxes: TallyValues,
    /// Sums of the products of each control with the fluxes.
    mixed: Vec<TallyValues>,
}

impl Sums {
    fn new(spec: TallySpec, controls: usize) -> Self {
        Self {
            count: 0.0,
            values: vec![0.0; controls],
            products: vec![vec![0.0; controls]; controls],
            fluxes: TallyValues::zeros(spec),
            mixed: vec![TallyValues::zeros(spec); controls],
        }
    }

    fn add(&mut self, values: &[f64], tally: &TallyValues) {
        self.count += 1.0;
        self.fluxes += tally;
        for (i, value) in values.iter().enumerate() {
            self.values[i] += value;
            self.mixed[i].update(tally, |sum, flux| *sum += value * flux);
            for (j, other) in values.iter().enumerate() {
                self.products[i][j] += value * other;
            }
        }
    }

    fn total<'a>(mut all: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let mut total = all.next()?.clone();
        for sums in all {
            total.count += sums.count;
            total.fluxes += &sums.fluxes;
            for i in 0..total.values.len() {
                total.values[i] += sums.values[i];
                total.mixed[i] += &sums.mixed[i];
                for j in 0..total.values.len() {
                    total.products[i][j] += sums.products[i][j];
                }
            }
        }
        Some(total)
    }

    /// Coefficients of the least-squares plane of all fluxes over the controls; `None` if the controls do not vary
    /// independently of each other. Numbers of rays have none.
    fn coefficients(&self) -> Option<Vec<TallyValues>> {
        let controls = self.values.len();
        let covariance =
            |i: usize, j: usize| self.products[i][j] - self.values[i] * self.values[j] / self.count;
        let matrix = (0..controls).map(|i| (0..controls).map(|j| covariance(i, j)).collect());
        let inverse = inverse(matrix.collect())?;
        let with_fluxes: Vec<TallyValues> = (0..controls)
            .map(|i| {
                let mean = self.values[i] / self.count;
                self.mixed[i].zip_map(&self.fluxes, |mixed, flux| mixed - mean * flux)
            })
            .collect();
        let of_control = |row: &Vec<f64>| {
            let mut sum = TallyValues::zeros(*self.fluxes.spec());
            for (factor, covariances) in row.iter().zip(&with_fluxes) {
                sum.update(covariances, |sum, covariance| *sum += factor * covariance);
            }
            sum.clear_hits();
            sum
        };
        Some(inverse.iter().map(of_control).collect())
    }
}

/// Pivots relative to the diagonal below which a matrix counts as singular.
const SINGULAR: f64 = 1e-10;

/// The inverse of a symmetric positive definite matrix by Gauss-Jordan elimination; `None` if it is singular.
fn inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let diagonal: Vec<f64> = (0..n).map(|i| matrix[i][i]).collect();
    let unit = |i: usize| (0..n).map(move |j| if i == j { 1.0 } else { 0.0 });
    let mut inverse: Vec<Vec<f64>> = (0..n).map(|i| unit(i).collect()).collect();
    for column in 0..n {
        let pivot = matrix[column][column];
        if pivot.is_nan() || pivot <= SINGULAR * diagonal[column] {
            return None;
        }
        for values in [&mut matrix, &mut inverse] {
            values[column].iter_mut().for_each(|value| *value /= pivot);
        }
        for row in (0..n).filter(|&row| row != column) {
            let factor = matrix[row][column];
            for values in [&mut matrix, &mut inverse] {
                let own = values[column].clone();
                let pairs = values[row].iter_mut().zip(own);
                pairs.for_each(|(value, own)| *value -= factor * own);
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use asperity_tally::{Component, Side};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn normal(rng: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    const REFLECTED: Entry = TallySpec::BUDGET.reflected;

    /// Moments of slopes whose mean square gradient is one.
    fn expected() -> SlopeMoments {
        SlopeMoments::of_normal([0.5, 0.0, 0.5])
    }

    /// Surfaces whose reflected flux is `0.5 + a xx + b fourth + noise`.
    fn surfaces(
        rng: &mut ChaCha8Rng,
        count: usize,
        [a, b, noise]: [f64; 3],
    ) -> (Vec<TallyValues>, Vec<SlopeMoments>) {
        let one = |_| {
            let [xx, xy, yy, fourth] = [0.05; 4].map(|scale| scale * normal(rng));
            let fourth = fourth + 2.0 * (xx + yy);
            let expected = expected();
            let [mean_xx, _, mean_yy] = expected.second;
            let slopes = SlopeMoments {
                second: [mean_xx + xx, xy, mean_yy + yy],
                fourth: expected.fourth * (1.0 + fourth),
            };
            let mut tally = TallyValues::zeros(TallySpec::default());
            let flux = 0.5 + a * (xx + yy) + b * fourth + noise * normal(rng);
            tally[REFLECTED] = flux;
            tally[TallySpec::BUDGET.transmitted] = 1.0 - flux;
            let hits = tally.spec().hit_entries(Side::Reflected, Component::Single);
            tally[hits.get(0)] = flux;
            (tally, slopes)
        };
        (0..count).map(one).unzip()
    }

    fn fit(tallies: &[TallyValues], slopes: &[SlopeMoments]) -> Option<SlopeControlVariate> {
        let observed = Observed {
            tallies,
            slopes,
            expected_slopes: expected(),
        };
        SlopeControlVariate::fit(observed, ControlMoments::Isotropic, &[REFLECTED])
    }

    #[test]
    fn what_slopes_explain_is_taken_away_and_nothing_else() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let (tallies, slopes) = surfaces(&mut rng, 64, [0.3, -0.2, 1e-3]);
        let control = fit(&tallies, &slopes).unwrap();
        let before: f64 = 0.05 * 0.05 * ((0.3 - 0.4_f64).powi(2) * 2.0 + 0.04);
        assert!(
            control.remaining() < 3.0 * 1e-6 / before,
            "{}",
            control.remaining()
        );
        for (number, (tally, slopes)) in tallies.iter().zip(&slopes).enumerate() {
            let adjusted = control.adjusted(number, tally, slopes);
            assert!((adjusted[REFLECTED] - 0.5).abs() < 6e-3);
            let sum = adjusted[REFLECTED] + adjusted[TallySpec::BUDGET.transmitted];
            assert!((sum - 1.0).abs() < 1e-12);
            let hits = tally
                .spec()
                .hit_entries(Side::Reflected, Component::Single)
                .get(0);
            assert_eq!(adjusted[hits], tally[hits]);
        }
    }

    /// Means of adjusted fluxes over many ensembles: without bias, with the errors that the scatter of adjusted fluxes shows, although
    /// the flux depends on the control by a square as well. Each of two passes |z| < 4 with probability 1 - 6e-5.
    #[test]
    fn means_keep_their_expectation_and_errors_are_honest() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let runs = 2000;
        let (mut deviations, mut z_squares) = (Scatter::default(), 0.0);
        for run in 0..runs {
            let (mut tallies, slopes) = surfaces(&mut rng, 32, [0.3, 0.1, 5e-3]);
            for (tally, slopes) in tallies.iter_mut().zip(&slopes) {
                let xx = slopes.second[0] - 0.5;
                tally[REFLECTED] += 2.0 * (xx * xx - 0.0025);
            }
            let control = fit(&tallies, &slopes).unwrap();
            let mut statistics = asperity_tally::TallyStatistics::new(TallySpec::default());
            for (number, (tally, slopes)) in tallies.iter().zip(&slopes).enumerate() {
                statistics.push(&control.adjusted(number, tally, slopes));
            }
            let found = asperity_tally::TallyResult::at(&statistics, REFLECTED);
            deviations.add(run, found.mean - 0.5);
            let z = (found.mean - 0.5) / found.se.unwrap();
            z_squares += z * z;
        }
        let n = runs as f64;
        let mean = deviations.mean / (deviations.squares / (n * (n - 1.0))).sqrt();
        // Student's t of 31 degrees of freedom has the variance 31 / 29.
        let variance = z_squares / n;
        println!("mean {mean:.2} standard errors off, variance of z {variance:.3}");
        assert!(mean.abs() < 4.0);
        assert!((variance - 31.0 / 29.0).abs() < 4.0 * (2.0 / n).sqrt() * 1.2);
    }

    #[test]
    fn what_explains_nothing_or_too_little_is_left_out() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (tallies, slopes) = surfaces(&mut rng, 64, [0.0, 0.0, 1e-3]);
        assert!(fit(&tallies, &slopes).is_none());
        let (tallies, slopes) = surfaces(&mut rng, 31, [0.3, 0.0, 1e-3]);
        assert!(fit(&tallies, &slopes).is_none());
        // Slopes that do not vary
        let same = vec![expected(); 64];
        let (tallies, _) = surfaces(&mut rng, 64, [0.3, 0.0, 1e-3]);
        assert!(fit(&tallies, &same).is_none());
    }

    #[test]
    fn deviations_are_relative_to_the_expected_moments() {
        let expected = SlopeMoments::of_normal([2.0, 0.0, 2.0]);
        let found = SlopeMoments {
            second: [2.2, 0.4, 1.8],
            fourth: 1.1 * expected.fourth,
        };
        let values = ControlMoments::All.deviations(&found, &expected);
        for (value, expected) in values.iter().zip([0.05, 0.1, -0.05, 0.1]) {
            assert!((value - expected).abs() < 1e-12, "{values:?}");
        }
    }
}
