//! Heights on the Smith microsurface, and free paths between them.

use asperity_numerics::elementary::{exp, exp_m1, ln, ln_1p};

/// The height of a ray as the logarithm of `C1`, the fraction of the surface below it: from minus infinity
/// (excluded) at the bottom to zero above all facets. The distribution of heights enters through `C1` alone.
///
/// The logarithm resolves heights near both ends, where `C1` itself would round to zero or to one. It is zero
/// for incident light only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Height(f64);

impl Height {
    /// Above all facets.
    pub(super) const ABOVE_ALL: Self = Self(0.0);

    /// The height of this logarithm of `C1`.
    #[inline(always)]
    pub(super) const fn at(log_fraction: f64) -> Self {
        Self(log_fraction)
    }

    /// The logarithm of `C1`.
    #[inline(always)]
    pub(super) const fn logarithm(self) -> f64 {
        self.0
    }

    /// Intersection of a ray that travels downwards with a facet, which always exists; `lambda` is that of its direction.
    ///
    /// `u` in (0, 1) is uniform. The free path gives `C1' = C1 / (1 - u)^(1 / Lambda)` with
    /// `Lambda = -1 - lambda` downwards.
    ///
    /// # Source
    /// Heitz et al. 2016, Sec. 4.
    #[inline(always)]
    pub(super) fn descended(self, lambda: f64, u: f64) -> Self {
        Self::of(self.0 + ln(u) / (1.0 + lambda))
    }

    /// The probability `C1^lambda` that a ray which travels upwards escapes, and that it does not, each to its
    /// own relative accuracy; `lambda` is that of its direction.
    ///
    /// # Source
    /// Heitz et al. 2016, Sec. 4.
    #[inline(always)]
    pub(super) fn escape(self, lambda: f64) -> (f64, f64) {
        let exponent = lambda * self.0;
        (exp(exponent), -exp_m1(exponent))
    }

    /// Intersection of a ray that travels upwards and does *not* escape; `lambda` is that of its direction.
    ///
    /// `u` in (0, 1) is uniform; `blocked` is the second probability of [`Self::escape`], above zero.
    #[inline(always)]
    pub(super) fn ascended(self, lambda: f64, blocked: f64, u: f64) -> Self {
        Self::of(self.0 - ln_1p(-u * blocked) / lambda)
    }

    /// This point for a ray behind the surface, where heights are reversed: `1 - C1`.
    #[inline(always)]
    pub(super) fn seen_from_behind(self) -> Self {
        // Each form is accurate where the other loses digits.
        Self::of(if self.0 > -std::f64::consts::LN_2 {
            ln(-exp_m1(self.0))
        } else {
            ln_1p(-exp(self.0))
        })
    }

    #[inline(always)]
    fn of(log_fraction: f64) -> Self {
        Self(log_fraction.min(-f64::MIN_POSITIVE))
    }

    #[cfg(test)]
    pub(super) fn fraction_below(self) -> f64 {
        exp(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_fraction(c1: f64) -> Height {
        Height(c1.ln())
    }

    /// The fraction of Gaussian heights of deviation one below `h`, and their density there.
    fn gaussian(h: f64) -> (f64, f64) {
        let density = (-0.5 * h * h).exp() / std::f64::consts::TAU.sqrt();
        (
            0.5 * asperity_numerics::elementary::erfc(-h / std::f64::consts::SQRT_2),
            density,
        )
    }

    /// The height with the fraction `c` of Gaussian heights below it.
    fn gaussian_height(c: f64) -> f64 {
        let (mut low, mut high) = (-9.0, 9.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if gaussian(middle).0 < c {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    /// Probability that a ray gets from one height to another without a hit: `exp(-int k dz / |w_z|)`
    /// with `k = |Lambda w_z| p(z) / C1(z)` per length, by Simpson's rule (Heitz et al. 2016, Sec. 4).
    fn survival(signed_lambda: f64, from: f64, to: f64) -> f64 {
        let n = 4000;
        let h = (to - from).abs() / f64::from(n);
        let integral: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                let (below, density) = gaussian(from.min(to) + h * f64::from(i));
                weight * density / below
            })
            .sum();
        (-signed_lambda.abs() * integral * h / 3.0).exp()
    }

    #[test]
    fn free_paths_agree_with_gaussian_heights() {
        for lambda in [0.03, 0.7, 5.0] {
            for c1 in [0.05, 0.4, 0.9] {
                let (here, h) = (at_fraction(c1), gaussian_height(c1));
                let (escape, blocked) = here.escape(lambda);
                // Above nine deviations there is a fraction of 1e-19 of the surface.
                assert!((escape / survival(lambda, h, 9.0) - 1.0).abs() < 1e-9);
                for u in [0.1, 0.5, 0.8] {
                    let up = here.ascended(lambda, blocked, u).fraction_below();
                    assert!(up > c1 && up < 1.0);
                    let hit = 1.0 - survival(lambda, h, gaussian_height(up));
                    assert!(
                        (hit / (u * blocked) - 1.0).abs() < 1e-9,
                        "{lambda} {c1} {u}"
                    );
                    let down = here.descended(lambda, u).fraction_below();
                    let kept = survival(-1.0 - lambda, h, gaussian_height(down));
                    assert!((kept / u - 1.0).abs() < 1e-9, "{lambda} {c1} {u}");
                }
            }
        }
    }

    #[test]
    fn the_mean_escape_probability_is_g1() {
        // All fractions below are equally likely: int_0^1 c^Lambda dc = 1 / (1 + Lambda), by the midpoint rule.
        for lambda in [0.0, 0.2, 1.0, 7.0] {
            let n = 20_000;
            let mean = (0..n)
                .map(|i| {
                    at_fraction((f64::from(i) + 0.5) / f64::from(n))
                        .escape(lambda)
                        .0
                })
                .sum::<f64>()
                / f64::from(n);
            // The rule is off by at most the first cell, n^-(1 + Lambda), or the second derivative.
            let bound = f64::from(n).powf(-1.0 - lambda) + lambda * lambda / f64::from(n).powi(2);
            assert!(
                (mean - 1.0 / (1.0 + lambda)).abs() < bound + 1e-13,
                "{lambda}"
            );
        }
    }

    #[test]
    fn heights_of_first_hits_have_their_distribution() {
        // From above all, C1 to the power 1 + Lambda is uniform.
        for lambda in [0.0, 0.3, 4.0, 1e6] {
            for u in [1e-6, 0.2, 0.99] {
                let c1 = Height::ABOVE_ALL.descended(lambda, u).fraction_below();
                // The power magnifies the rounding of C1.
                let error = c1.powf(1.0 + lambda) / u - 1.0;
                assert!(
                    error.abs() < 4.0 * f64::EPSILON * (2.0 + lambda),
                    "{lambda} {u}"
                );
            }
        }
    }

    #[test]
    fn heights_behind_the_surface_are_reversed() {
        for c1 in [1e-300, 1e-17, 0.1, 0.5, 0.6, 0.9] {
            let behind = at_fraction(c1).seen_from_behind();
            assert!((behind.fraction_below() - (1.0 - c1)).abs() < 1e-16);
            // There and back again, without loss at either end: to four roundings of the logarithm.
            let again = behind.seen_from_behind().0;
            assert!((again / c1.ln() - 1.0).abs() < 1e-14, "{c1} {again}");
        }
    }

    #[test]
    fn all_heights_are_finite_and_negative() {
        let heights = [-f64::MIN_POSITIVE, -1e-300, -1e-17, -0.3, -40.0, -800.0];
        let lambdas = [0.0, 5e-324, 1e-300, 1e-12, 1.0, 1e17, 1e308, f64::INFINITY];
        for height in heights.map(Height) {
            for lambda in lambdas {
                let (escape, blocked) = height.escape(lambda);
                assert!((escape + blocked - 1.0).abs() < 2.0 * f64::EPSILON);
                assert!((0.0..=1.0).contains(&escape) && (0.0..=1.0).contains(&blocked));
                for u in [f64::EPSILON, 0.5, 1.0 - f64::EPSILON] {
                    let mut next = vec![height.descended(lambda, u)];
                    if blocked >= f64::MIN_POSITIVE {
                        next.push(height.ascended(lambda, blocked, u));
                    }
                    for next in next {
                        assert!(
                            next.0 < 0.0 && next.0.is_finite(),
                            "{height:?} {lambda} {u}"
                        );
                        let behind = next.seen_from_behind();
                        assert!(behind.0 < 0.0 && behind.0.is_finite(), "{next:?}");
                    }
                }
            }
        }
        // A horizontal ray stays at its height.
        let height = Height(-0.3);
        assert_eq!(height.descended(f64::INFINITY, 0.2), height);
        assert_eq!(height.ascended(f64::INFINITY, 1.0, 0.2), height);
    }
}
