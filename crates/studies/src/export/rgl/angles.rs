//! Angles of the light: what readers interpolate between them, and the error of that.

use crate::export::half_vectors::{HalfVectors, integral};
use asperity_numerics::elementary::cos;

use super::sample::{Sample, Slice};

impl Sample<'_> {
    /// Factors of the values in the file, by azimuth and polar angle of the light: inverse integrals over half-vectors, 1 for the first direction.
    pub(super) fn sigma(&self, slices: &[(Slice, HalfVectors)]) -> Vec<f64> {
        let wavelengths = slices.len() / (self.phi.len() * self.theta.len());
        let of_direction = |slices: &[(Slice, HalfVectors)]| {
            let integrals = slices.iter().map(|(_, values)| values.over_half_vectors());
            integrals.sum::<f64>()
        };
        let sums: Vec<f64> = slices.chunks(wavelengths).map(of_direction).collect();
        match sums.iter().all(|&sum| sum > 0.0) {
            true => sums.iter().map(|sum| sums[0] / sum).collect(),
            false => vec![1.0; sums.len()],
        }
    }

    /// Factor at a polar angle of the light, radians, from those of its azimuth: linear in the cosine.
    pub(super) fn sigma_at(&self, sigma: &[f64], theta: f64) -> f64 {
        let upper = self
            .theta
            .partition_point(|&one| one < theta)
            .clamp(1, self.theta.len() - 1);
        let value = linear(
            theta,
            [&self.theta, sigma].map(|list| [list[upper - 1], list[upper]]),
            cos,
        );
        let last = sigma[sigma.len() - 1];
        // Beyond the last angle it falls no further than by half
        value.max(0.5 * sigma[upper].min(last))
    }

    /// Sentences on reflection of light between the directions of the file, by leaving one out.
    pub(super) fn between_angles(
        &self,
        slices: &[(Slice, HalfVectors)],
        sigma: &[f64],
    ) -> Vec<String> {
        let per_phi = slices.len() / self.phi.len();
        let per_theta = per_phi / self.theta.len();
        let theta = |i: usize| i % per_phi / per_theta;
        let weights = |[before, i, after]: [usize; 3], angle: &dyn Fn(usize) -> f64, of| {
            let angles = [before, after].map(angle);
            let sigma = [before, after].map(|k| sigma[k / per_theta]);
            let whole = linear(angle(i), [angles, sigma], of);
            let part = linear(angle(i), [angles, [0.0, 1.0]], |angle| angle);
            [(1.0 - part) * sigma[0] / whole, part * sigma[1] / whole]
        };
        let of_theta = |three| weights(three, &|k| self.theta[theta(k)], cos);
        let of_phi = |three| weights(three, &|k| self.phi[k / per_phi].0, |angle| angle);
        let inner = |&i: &usize| (1..self.theta.len() - 1).contains(&theta(i));
        let over_theta = farthest((0..slices.len()).filter(inner), slices, per_theta, of_theta);
        let inner = per_phi..slices.len().saturating_sub(per_phi);
        let over_phi = farthest(inner, slices, per_phi, of_phi);
        let sentence = |(name, found): (&str, Option<(f64, usize)>)| {
            let (error, i) = found?;
            let light = slices[i].0.outcome.case.light.incidence;
            let without = 100.0 * error;
            Some(format!(
                "between {name} of the light: about {:+.2} % of the reflected light at most ({without:+.2} % with theta {:.1} left out)",
                without / 4.0,
                light.theta_deg()
            ))
        };
        [("polar angles", over_theta), ("azimuths", over_phi)]
            .into_iter()
            .filter_map(sentence)
            .collect()
    }
}

/// Value at `at` on the line through two points of `[arguments, values]`, linear in a function of the argument.
fn linear(at: f64, [x, y]: [[f64; 2]; 2], of: fn(f64) -> f64) -> f64 {
    let part = (of(at) - of(x[0])) / (of(x[1]) - of(x[0]));
    y[0] + part * (y[1] - y[0])
}

/// Largest relative error of reflection of light from the directions `inner`, interpolated with `weights` of those `step` before and after.
fn farthest(
    inner: impl Iterator<Item = usize>,
    slices: &[(Slice, HalfVectors)],
    step: usize,
    weights: impl Fn([usize; 3]) -> [f64; 2],
) -> Option<(f64, usize)> {
    let errors = inner.map(|i| {
        let (slice, values) = &slices[i];
        let weights = weights([i - step, i, i + step]);
        let [before, after] = [i - step, i + step].map(|k| &slices[k].1);
        let parts = 2 * (values.nodes() - 1);
        let found = integral(slice.light, parts, |at| {
            weights[0] * before.at(at) + weights[1] * after.at(at)
        });
        (
            found / integral(slice.light, parts, |at| values.at(at)) - 1.0,
            i,
        )
    });
    let errors = errors.filter(|(error, _)| error.is_finite());
    errors.max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
}
