//! Drawn moments: heights and slopes of surfaces that no formula describes, measured on two of them.

use asperity_numerics::elementary::hypot;
use asperity_surface::HeightField;

/// Surfaces drawn to measure what is not known in closed form.
const MEASURED: u64 = 2;

/// Least slope variance along any direction, as a fraction of both together: grooves have slopes along one direction alone, which
/// have no density.
const LEAST_VARIANCE: f64 = 1e-4;

/// Mean moments of two drawn surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DrawnMoments {
    /// Mean height, length units.
    pub(super) mean: f64,
    /// Mean square height, length units squared.
    pub(super) square: f64,
    /// Second moments `[xx, xy, yy]` of slopes.
    pub(super) slopes: [f64; 3],
}

impl DrawnMoments {
    /// Measures the surfaces that `draw` returns for a seed and a number.
    pub(crate) fn of<E>(draw: impl Fn(u64, u64) -> Result<HeightField, E>) -> Result<Self, E> {
        let mut moments = Self::default();
        for realisation in 0..MEASURED {
            // Of a seed of its own, so that surfaces of the run are as independent of it as of each other
            let field = draw(u64::MAX, realisation)?;
            let part = 1.0 / MEASURED as f64;
            let of_sample = part / field.heights().len() as f64;
            moments.mean += of_sample * field.heights().iter().sum::<f64>();
            moments.square += of_sample * field.heights().iter().map(|h| h * h).sum::<f64>();
            let second = field.slope_moments().second;
            moments.slopes = [0, 1, 2].map(|i| moments.slopes[i] + part * second[i]);
        }
        Ok(moments)
    }
}

/// The covariance, equal along both axes if it is isotropic, else raised along its minor axis to [`LEAST_VARIANCE`] of both.
pub(super) fn with_density([xx, xy, yy]: [f64; 3], is_isotropic: bool) -> [f64; 3] {
    let half = 0.5 * (xx + yy);
    if is_isotropic {
        return [half, 0.0, half];
    }
    let off = hypot(0.5 * (xx - yy), xy);
    let most = half * (1.0 - 2.0 * LEAST_VARIANCE);
    let scale = if off > most { most / off } else { 1.0 };
    [
        half + 0.5 * (xx - yy) * scale,
        xy * scale,
        half - 0.5 * (xx - yy) * scale,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_along_one_direction_get_a_density() {
        // Eigenvalues 4 and 0, along an axis at 30 degrees
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        let [xx, xy, yy] = with_density([4.0 * cos * cos, 4.0 * cos * sin, 4.0 * sin * sin], false);
        assert!((xx + yy - 4.0).abs() < 1e-12);
        let minor = xx * sin * sin - 2.0 * xy * sin * cos + yy * cos * cos;
        assert!((minor - 4e-4).abs() < 1e-12, "{minor}");
        assert_eq!(with_density([1.0, 0.25, 2.0], false), [1.0, 0.25, 2.0]);
        assert_eq!(with_density([1.0, 0.25, 2.0], true), [1.5, 0.0, 1.5]);
    }
}
