//! Region shifts: what the slopes of each region of a surface explain of the light that it scatters.
//!
//! Models of a given surface are made for the slope covariance `c` that it has, which is itself an estimate of that of the ensemble
//! it comes from. Where `c` happens to be large, so is the light at large angles: both are known by the same surface. With `c_b` the
//! covariance in region `b` and `M(c)` what a model expects,
//!
//! ```text
//! M(c_b) = M(c) + J (c_b - c) + ...
//! ```
//!
//! to first order, and the tally of region `b` less `J (c_b - c)` is compared with `M(c)`. The mean over regions stays as it is, since
//! the differences cancel, and what is left of the scatter is the error of `mean - M(c)`, with that of `c` in it.
//!
//! Neighbouring regions share the surface along their edges, so that their scatter is below that of surfaces of this size. For what
//! depends on squares of slopes with the autocorrelation `exp(-r^2 / tau^2)`, the variance of the mean over regions of widths `X` and
//! `Y` is that of their scatter over `1 - 0.53 tau / X - 0.40 tau / Y`, and for squares of heights over `1 - 0.40 (tau / X + tau / Y)`.
//! All deviations from the mean are stretched by the root of `1 / (1 - (tau / X + tau / Y) / 2)`.

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_surface::RegionSlopes;
use asperity_tally::{Estimate, TallyValues};

/// Step of the differences that stand for derivatives, as a fraction of the covariance: the terms left out are 1 % of its square
/// times the third derivative by the logarithm.
const STEP: f64 = 0.1;

/// Slopes of one surface and of its regions.
#[derive(Clone, Debug)]
pub(crate) struct RegionShifts {
    covariance: SlopeCovariance,
    /// Cholesky factor of the covariance: elements xx, xy and yy.
    factor: [f64; 3],
    /// For each region, elements xx, xy and yy of its covariance less that of the surface, in units in which that is one.
    shifts: Vec<[f64; 3]>,
    /// Standard errors of the elements xx, xy and yy of the covariance.
    errors: [f64; 3],
    /// Factor by which the scatter between regions is increased.
    stretch: f64,
}

impl RegionShifts {
    /// `regions`: slopes of each, whose `second` moments are about the mean slope of the surface. `widths`: of a region along x and y,
    /// in correlation lengths, above 1.
    ///
    /// # Errors
    /// [`SlopeError`] if the slopes of the surface have no density.
    pub(crate) fn new(regions: &[RegionSlopes], widths: [f64; 2]) -> Result<Self, SlopeError> {
        let [xx, xy, yy] = RegionSlopes::mean_of(regions).second;
        let covariance = SlopeCovariance::new(xx, yy, xy)?;
        let stretch = 1.0 / (1.0 - 0.5 * (1.0 / widths[0] + 1.0 / widths[1])).sqrt();
        let a = xx.sqrt();
        let b = xy / a;
        let factor = [a, b, (yy - b * b).sqrt()];
        let count = regions.len() as f64;
        let differences = regions.iter().map(|region| {
            let [rxx, rxy, ryy] = region.second;
            [rxx - xx, rxy - xy, ryy - yy]
        });
        let differences: Vec<[f64; 3]> = differences.collect();
        let errors = [0, 1, 2].map(|i| {
            let squares: f64 = differences.iter().map(|d| d[i] * d[i]).sum();
            stretch * (squares / (count * (count - 1.0))).sqrt()
        });
        let shifts = differences.iter().map(|&d| whitened(factor, d));
        Ok(Self {
            covariance,
            factor,
            shifts: shifts.collect(),
            errors,
            stretch,
        })
    }

    /// The slopes of the whole surface.
    pub(crate) const fn covariance(&self) -> SlopeCovariance {
        self.covariance
    }

    /// The elements xx, xy and yy of the covariance, with their errors as estimates of those of the ensemble.
    pub(crate) fn elements(&self) -> [Estimate; 3] {
        let c = self.covariance;
        let means = [c.xx(), c.xy(), c.yy()];
        [0, 1, 2].map(|i| Estimate {
            mean: means[i],
            se: Some(self.errors[i]),
        })
    }

    /// Factor by which the scatter between regions is increased, since neighbours share the surface along their edges.
    pub(crate) const fn stretch(&self) -> f64 {
        self.stretch
    }

    /// Derivatives of what a model expects by the three elements, given what it `expects` of other slopes.
    pub(crate) fn derivatives<E>(
        &self,
        expects: impl Fn(SlopeCovariance) -> Result<TallyValues, E> + Sync,
    ) -> Result<[TallyValues; 3], E>
    where
        E: From<SlopeError> + Send,
    {
        let derivative = |element: usize| -> Result<TallyValues, E> {
            let at = |step: f64| expects(self.stepped(element, step)?);
            let (above, below) = rayon::join(|| at(STEP), || at(-STEP));
            Ok(above?.zip_map(&below?, |a, b| (a - b) / (2.0 * STEP)))
        };
        let (first, (second, third)) = rayon::join(
            || derivative(0),
            || rayon::join(|| derivative(1), || derivative(2)),
        );
        Ok([first?, second?, third?])
    }

    /// The tallies of the regions less what their slopes explain, with deviations from the mean stretched.
    pub(crate) fn adjusted(
        &self,
        tallies: &[TallyValues],
        derivatives: &[TallyValues; 3],
    ) -> Vec<TallyValues> {
        let less_explained = tallies.iter().zip(&self.shifts).map(|(tally, shift)| {
            let mut left = tally.clone();
            for (derivative, shift) in derivatives.iter().zip(shift) {
                left.update(derivative, |value, slope| *value -= shift * slope);
            }
            left
        });
        self.stretched(tallies, less_explained.collect())
    }

    /// `adjusted`, which have the mean of `tallies`, with their deviations from it stretched.
    pub(crate) fn stretched(
        &self,
        tallies: &[TallyValues],
        mut adjusted: Vec<TallyValues>,
    ) -> Vec<TallyValues> {
        let Some(first) = tallies.first() else {
            return adjusted;
        };
        let mut mean = TallyValues::zeros(*first.spec());
        tallies.iter().for_each(|tally| mean += tally);
        let mean = mean.map(|sum| sum / tallies.len() as f64);
        for tally in &mut adjusted {
            tally.update(&mean, |value, mean| {
                *value = mean + self.stretch * (*value - mean)
            });
        }
        adjusted
    }

    /// The covariance with one of its three elements changed by `step`, in units in which it is one.
    fn stepped(&self, element: usize, step: f64) -> Result<SlopeCovariance, SlopeError> {
        let [a, b, c] = self.factor;
        let mut change = [0.0; 3];
        change[element] = step;
        let [xx, xy, yy] = change;
        // L (1 + change) L^T
        let [xx, yy] = [1.0 + xx, 1.0 + yy];
        SlopeCovariance::new(
            a * a * xx,
            b * b * xx + 2.0 * b * c * xy + c * c * yy,
            a * (b * xx + c * xy),
        )
    }
}

/// `L^-1 D L^-T` for the symmetric matrix `D`; elements xx, xy and yy.
fn whitened([a, b, c]: [f64; 3], [xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    // Rows of L^-1: (1 / a, 0) and (-b / (a c), 1 / c)
    let (p, q, r) = (1.0 / a, -b / (a * c), 1.0 / c);
    [
        p * p * xx,
        p * (q * xx + r * xy),
        q * q * xx + 2.0 * q * r * xy + r * r * yy,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::{TallyResult, TallySpec};

    fn regions() -> Vec<RegionSlopes> {
        let of = |second| RegionSlopes {
            mean: [0.0; 2],
            second,
        };
        vec![
            of([0.3, 0.10, 0.2]),
            of([0.5, 0.16, 0.1]),
            of([0.4, 0.05, 0.3]),
            of([0.2, -0.03, 0.4]),
        ]
    }

    /// A "model" whose tallies are linear in the covariance explains regions of the same law entirely, whatever the axes.
    #[test]
    fn slopes_explain_all_of_what_is_linear_in_them() {
        let regions = regions();
        let shifts = RegionShifts::new(&regions, [5.0, 5.0]).unwrap();
        let spec = TallySpec::default();
        let linear = |xx: f64, xy: f64, yy: f64| {
            let mut number = 0.0;
            TallyValues::from_fn(spec, |_| {
                number += 1.0;
                0.1 + xx * number + xy * (3.0 + number) - 0.5 * yy * number
            })
        };
        let expects = |c: SlopeCovariance| Ok::<_, SlopeError>(linear(c.xx(), c.xy(), c.yy()));
        let derivatives = shifts.derivatives(expects).unwrap();
        let tallies: Vec<TallyValues> = regions
            .iter()
            .map(|region| {
                let [xx, xy, yy] = region.second;
                linear(xx, xy, yy)
            })
            .collect();
        let c = shifts.covariance();
        let expected = linear(c.xx(), c.xy(), c.yy());
        for tally in shifts.adjusted(&tallies, &derivatives) {
            for (found, expected) in tally.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0));
            }
        }
    }

    /// The mean stays as it is; deviations that slopes do not explain are stretched: of regions of two correlation lengths by the
    /// root of 2.
    #[test]
    fn the_mean_stays_and_deviations_are_stretched() {
        let regions = regions();
        let shifts = RegionShifts::new(&regions, [2.0, 2.0]).unwrap();
        let spec = TallySpec::default();
        let zeros = || TallyValues::zeros(spec);
        let tallies: Vec<TallyValues> = [0.1, 0.4, 0.3, 0.4]
            .map(|flux| TallyValues::from_fn(spec, |_| flux))
            .to_vec();
        let entry = TallySpec::BUDGET.reflected;
        let found = shifts.adjusted(&tallies, &[zeros(), zeros(), zeros()]);
        for (found, flux) in found.iter().zip([0.1, 0.4, 0.3, 0.4]) {
            let expected = 0.3 + 2.0_f64.sqrt() * (flux - 0.3);
            assert!((found.at(entry) - expected).abs() < 1e-12);
        }
        let derivatives = [0.2, -0.3, 0.7].map(|x| TallyValues::from_fn(spec, |_| x));
        let adjusted = shifts.adjusted(&tallies, &derivatives);
        let mean = adjusted.iter().map(|tally| tally.at(entry)).sum::<f64>() / 4.0;
        assert!((mean - 0.3).abs() < 1e-12);
        assert!((adjusted[0].at(entry) - found[0].at(entry)).abs() > 1e-3);
        // The error of xx, of differences -0.05, 0.15, 0.05, -0.15
        let expected = 2.0_f64.sqrt() * (0.05_f64 / 12.0).sqrt();
        assert!((shifts.errors[0] / expected - 1.0).abs() < 1e-12);
    }
}
