//! Slopes that drawn surfaces are expected to have: of their facets, and of their splines at the grid points.

use std::f64::consts::PI;

use asperity_numerics::elementary::sin_cos;
use rayon::prelude::*;

use super::noise::Side;
use super::splines::SplineSynthesis;
use super::synthesis::Synthesis;

impl Synthesis {
    /// Covariance `[xx, xy, yy]` expected of the slopes of a facet, dimensionless.
    ///
    /// Facets are those of [`HeightField::facet_slopes`](asperity_surface::HeightField::facet_slopes): slopes are
    /// differences of heights along the edges of a cell that is split along the diagonal from its
    /// corner `(ix, iy)`. Both triangles have the same covariance. It is that of the ensemble that
    /// [`Synthesis::draw`] draws, with its grid, its period and without its mean, to the `1e-6` to which
    /// its random numbers are normal; means of slopes are zero.
    ///
    /// For an isotropic Gaussian on square cells of side `d`, resolved and held by its tile, `xx = yy`
    /// is `2 sigma^2 (1 - a) / d^2` and `xy` is `-sigma^2 (1 - a)^2 / d^2`, where
    /// `a = exp(-d^2 / tau^2)`: steps along x and y share a corner, so a facet's slopes are correlated
    /// even where those of the surface are not. [`Psd::slope_covariance`](crate::Psd::slope_covariance)
    /// is that of the surface.
    ///
    /// The cost is one pass over the waves that are not empty, as for a drawing before its FFTs.
    #[must_use]
    pub fn facet_slope_covariance(&self) -> [f64; 3] {
        // The middles of the edges `h10 - h00` and `h11 - h10` lie half a cell apart along both axes.
        self.covariance_of_slopes(|x, y| {
            let cos_of_sum = x.cos * y.cos - x.sin * y.sin;
            [x.sin * x.sin, x.sin * y.sin * cos_of_sum, y.sin * y.sin].map(|term| 4.0 * term)
        })
    }

    /// Covariance `[xx, xy, yy]` expected of the slopes of the waves themselves, between the samples as well as at them.
    pub(crate) fn wave_slope_covariance(&self) -> [f64; 3] {
        self.covariance_of_slopes(|x, y| {
            let [kx, ky] = [2.0 * x.angle, 2.0 * y.angle];
            [kx * kx, kx * ky, ky * ky]
        })
    }

    /// Covariance `[xx, xy, yy]` of slopes, of each wave of unit variance `of_wave`, for cells of unit sides.
    fn covariance_of_slopes(
        &self,
        of_wave: impl Fn(HalfTurn, HalfTurn) -> [f64; 3] + Sync,
    ) -> [f64; 3] {
        let ny = self.shape[0];
        let half_turns: Vec<HalfTurn> = (0..=ny / 2).map(|iy| HalfTurn::of(iy, ny)).collect();
        let columns: Vec<[f64; 3]> = (0..self.filter.columns())
            .into_par_iter()
            .map(|ix| self.sum_of_column(ix, &half_turns, &of_wave))
            .collect();
        let [xx, xy, yy] = columns.into_iter().fold([0.0; 3], plus);
        let [dx, dy] = self.spacing;
        [xx / (dx * dx), xy / (dx * dy), yy / (dy * dy)]
    }

    /// Sum over the waves of column `ix` of the half spectrum and their opposites.
    fn sum_of_column(
        &self,
        ix: usize,
        half_turns: &[HalfTurn],
        of_wave: &impl Fn(HalfTurn, HalfTurn) -> [f64; 3],
    ) -> [f64; 3] {
        let [ny, nx] = self.shape;
        // Where kx and -kx are one, the waves of one side are the opposites of those of the other.
        let both_sides = ix != 0 && 2 * ix != nx;
        let along_x = HalfTurn::of(ix, nx);
        let mut amplitudes = vec![0.0; ny / 2 + 1];
        let mut sum = [0.0; 3];
        let sides = [(Side::Positive, 0, 1.0), (Side::Negative, 1, -1.0)];
        let drawn = if both_sides { &sides[..] } else { &sides[..1] };
        for &(side, first, sign) in drawn {
            let amplitudes = &mut amplitudes[..self.filter.rows(ix, side)];
            self.filter.fill(ix, side, amplitudes);
            for (i, amplitude) in (first..).zip(&*amplitudes) {
                let HalfTurn { angle, sin, cos } = half_turns[i];
                let along_y = HalfTurn {
                    angle: sign * angle,
                    sin: sign * sin,
                    cos,
                };
                // A wave stands for its opposite as well, unless it is its own.
                let alone = !both_sides && (i == 0 || 2 * i == ny);
                let variance = amplitude * amplitude * if alone { 1.0 } else { 2.0 };
                let terms = of_wave(along_x, along_y);
                sum = plus(sum, terms.map(|term| variance * term));
            }
        }
        sum
    }
}

impl SplineSynthesis {
    /// Covariance `[xx, xy, yy]` expected of the slopes at the grid points of drawn splines, dimensionless; means of slopes are
    /// zero.
    ///
    /// There a spline of coefficients `c` has the height `(c[-1] + 4 c[0] + c[1]) / 6` and the slope `(c[1] - c[-1]) / 2` along each
    /// axis.
    #[must_use]
    pub fn slope_covariance_at_grid_points(&self) -> [f64; 3] {
        self.waves().covariance_of_slopes(|x, y| {
            let height = |along: HalfTurn| (3.0 - 2.0 * along.sin * along.sin) / 3.0;
            let slope = |along: HalfTurn| 2.0 * along.sin * along.cos;
            let [sx, sy] = [slope(x) * height(y), height(x) * slope(y)];
            [sx * sx, sx * sy, sy * sy]
        })
    }
}

/// Half the angle by which a wave turns from sample to sample along an axis.
#[derive(Clone, Copy)]
struct HalfTurn {
    /// Radians.
    angle: f64,
    sin: f64,
    cos: f64,
}

impl HalfTurn {
    /// Angle of wave `i` of `n`.
    fn of(i: usize, n: usize) -> Self {
        let angle = PI * i as f64 / n as f64;
        let (sin, cos) = sin_cos(angle);
        Self { angle, sin, cos }
    }
}

fn plus(sum: [f64; 3], term: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| sum[i] + term[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Psd;

    /// Differences of the autocorrelation over the edges of a cell. Images of the tile add less than
    /// `exp(-7^2)` of it, and the mean that is missing has no slope. Half a unit in the last place of
    /// each autocorrelation, 1e-16 sigma^2 or so, counts `(tau / d)^2` in the reference.
    #[test]
    fn covariance_is_that_of_differences_of_the_autocorrelation() {
        for (tau_x, tau_y, azimuth, shape, [dx, dy]) in [
            (16.0, 16.0, 0.0, [256, 256], [1.0, 1.0]),
            (4.0, 4.0, 0.0, [33, 36], [1.0, 1.0]),
            (4.0, 7.0, 0.0, [64, 33], [1.0, 0.9]),
            (8.0, 5.0, 0.6, [66, 60], [1.0, 1.1]),
            (8.0, 5.0, -2.0, [67, 81], [1.0, 1.1]),
        ] {
            let sigma = 3.0;
            let psd = Psd::anisotropic_gaussian(sigma, tau_x, tau_y, azimuth).unwrap();
            let synthesis = Synthesis::new(psd.clone(), shape, [dx, dy], false).unwrap();
            let found = synthesis.facet_slope_covariance();
            let at = |x, y| psd.autocorrelation(x, y);
            let c00 = at(0.0, 0.0);
            let expected = [
                2.0 * (c00 - at(dx, 0.0)) / (dx * dx),
                (at(dx, 0.0) + at(0.0, dy) - at(dx, dy) - c00) / (dx * dy),
                2.0 * (c00 - at(0.0, dy)) / (dy * dy),
            ];
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-14 * sigma * sigma,
                    "{psd:?}: {found} against {expected}"
                );
            }
        }
    }

    #[test]
    fn isotropic_gaussian_has_its_closed_form() {
        let (sigma, tau, d) = (2.0_f64, 16.0_f64, 1.0_f64);
        let psd = Psd::gaussian(sigma, tau).unwrap();
        let synthesis = Synthesis::new(psd, [128, 256], [d, d], false).unwrap();
        // 1 - a
        let drop = -(-(d / tau).powi(2)).exp_m1();
        let along = 2.0 * sigma * sigma * drop / (d * d);
        let expected = [along, -(sigma * drop / d).powi(2), along];
        for (found, expected) in synthesis.facet_slope_covariance().iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// Slopes of drawn surfaces, also where Nyquist waves are strong and where few waves fit the tile.
    /// Each surface gives one mean over its facets; these scatter about what is expected by what their
    /// own scatter tells. Each of 18 passes |z| < 4 with probability 1 - 7e-5.
    #[test]
    fn covariance_is_the_mean_over_drawn_surfaces() {
        for (tau_x, tau_y, azimuth, shape) in [
            (4.0, 4.0, 0.0, [40, 36]),
            (6.0, 4.5, 0.5, [52, 63]),
            (1.0, 1.0, 0.0, [8, 6]),
            (0.8, 1.3, 1.0, [6, 8]),
            (0.8, 1.3, 1.0, [7, 5]),
            (0.8, 0.6, 0.4, [2, 3]),
        ] {
            let psd = Psd::anisotropic_gaussian(1.5, tau_x, tau_y, azimuth).unwrap();
            let synthesis = Synthesis::new(psd, shape, [1.0, 0.8], true).unwrap();
            let expected = synthesis.facet_slope_covariance();
            let draws = 3000;
            let (mut sums, mut squares) = ([0.0; 3], [0.0; 3]);
            for realisation in 0..draws {
                let field = synthesis.draw(9, realisation).unwrap();
                let mut means = [0.0; 3];
                for iy in 0..field.ny() {
                    for ix in 0..field.nx() {
                        for [sx, sy] in field.facet_slopes(ix, iy) {
                            means = plus(means, [sx * sx, sx * sy, sy * sy]);
                        }
                    }
                }
                let facets = 2.0 * (field.nx() * field.ny()) as f64;
                let means = means.map(|sum| sum / facets);
                sums = plus(sums, means);
                squares = plus(squares, means.map(|mean| mean * mean));
            }
            let n = draws as f64;
            for i in 0..3 {
                let mean = sums[i] / n;
                let error = ((squares[i] / n - mean * mean) / (n - 1.0)).sqrt();
                let z = (mean - expected[i]) / error;
                println!(
                    "{shape:?} {i}: {mean:.5} against {:.5}, z = {z:.2}",
                    expected[i]
                );
                assert!(z.abs() < 4.0, "{shape:?} {i}: z = {z}");
            }
        }
    }
}
