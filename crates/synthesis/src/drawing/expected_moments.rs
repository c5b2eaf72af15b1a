//! Slope moments expected of drawn surfaces.

use asperity_surface::SlopeMoments;

use super::splines::SplineSynthesis;
use super::synthesis::Synthesis;

impl Synthesis {
    /// Moments that [`HeightField::slope_moments`](asperity_surface::HeightField::slope_moments) of drawn surfaces has on average.
    #[must_use]
    pub fn expected_slope_moments(&self) -> SlopeMoments {
        SlopeMoments::of_normal(self.facet_slope_covariance())
    }
}

impl SplineSynthesis {
    /// Moments that [`SplineSurface::slope_moments`](asperity_surface::SplineSurface::slope_moments) of drawn surfaces has on average.
    #[must_use]
    pub fn expected_slope_moments(&self) -> SlopeMoments {
        SlopeMoments::of_normal(self.slope_covariance_at_grid_points())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Psd;

    /// Each surface gives one mean; these scatter about what is expected by what their own scatter tells. Each of 24 passes
    /// |z| < 4 with probability 1 - 7e-5.
    fn check_expected(draws: u64, expected: SlopeMoments, of_draw: impl Fn(u64) -> SlopeMoments) {
        let values = |moments: SlopeMoments| {
            let [xx, xy, yy] = moments.second;
            [xx, xy, yy, moments.fourth]
        };
        let found: Vec<[f64; 4]> = (0..draws).map(|draw| values(of_draw(draw))).collect();
        let n = draws as f64;
        for (i, expected) in values(expected).into_iter().enumerate() {
            let mean = found.iter().map(|moments| moments[i]).sum::<f64>() / n;
            let squares: f64 = found.iter().map(|m| (m[i] - mean).powi(2)).sum();
            let z = (mean - expected) / (squares / (n * (n - 1.0))).sqrt();
            println!("{i}: {mean:.5} against {expected:.5}, z = {z:.2}");
            assert!(z.abs() < 4.0, "{i}: z = {z}");
        }
    }

    #[test]
    fn moments_of_drawn_surfaces_have_their_expected_means() {
        for (tau_x, tau_y, azimuth, shape) in [
            (4.0, 4.0, 0.0, [40, 36]),
            (6.0, 4.5, 0.5, [52, 63]),
            (1.5, 1.0, 0.3, [7, 10]),
        ] {
            let psd = Psd::anisotropic_gaussian(1.5, tau_x, tau_y, azimuth).unwrap();
            let spacing = [1.0, 0.8];
            let facets = Synthesis::new(psd.clone(), shape, spacing, true).unwrap();
            check_expected(2000, facets.expected_slope_moments(), |draw| {
                facets.draw(3, draw).unwrap().slope_moments()
            });
            let splines = SplineSynthesis::new(psd, shape, spacing, true).unwrap();
            check_expected(2000, splines.expected_slope_moments(), |draw| {
                splines.draw(3, draw).unwrap().slope_moments()
            });
        }
    }

    /// Slopes at the grid points of a spline that is resolved are those of the surface, but for the fourth power of the spacing: with `a`
    /// radians per sample along the slope, a wave is less steep there by `a^4 / 240 + a^6 / 3024`, and across it higher by `b^4 / 720`. Over a
    /// Gaussian spectrum the first takes `(d / tau)^4 / 2` of the slope variance, the second 3 % of that at six samples per correlation
    /// length, and the third gives less than a tenth of the first back.
    #[test]
    fn slopes_of_a_resolved_spline_are_those_of_the_spectrum() {
        let psd = Psd::anisotropic_gaussian(2.0, 8.0, 6.0, 0.4).unwrap();
        let splines = SplineSynthesis::new(psd.clone(), [64, 80], [1.0, 1.0], false).unwrap();
        let expected = psd.slope_covariance();
        let found = splines.expected_slope_moments().second;
        for (found, expected) in found.iter().zip(expected) {
            let less = 1.0 - found / expected;
            let most = 0.52 * 6.0_f64.powi(-4);
            assert!(less > 0.0 && less < most, "{found} {expected}");
        }
    }
}
