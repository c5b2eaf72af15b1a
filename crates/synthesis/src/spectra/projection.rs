//! Projection: how the power of a spectrum over the plane spreads over the wave number along one direction.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{cos, exp};
use asperity_numerics::root;

/// Steps of the wave number up to the largest: the autocorrelation is off by less than 1e-5 up to lags of a hundred of the shortest
/// wavelengths.
const STEPS: usize = 16_384;

/// Power by the wave number along a direction, which is counted without its sign.
pub(super) struct Projection {
    step: f64,
    /// At each step, of those around it in proportion.
    powers: Vec<f64>,
}

impl Projection {
    /// `reach`: largest wave numbers along x and y. `for_each_node`: hands on wave vectors, and the power of each.
    pub(super) fn of(
        [cos, sin]: [f64; 2],
        [reach_x, reach_y]: [f64; 2],
        for_each_node: impl FnOnce(&mut dyn FnMut(f64, f64, f64)),
    ) -> Self {
        let reach = (reach_x * cos).abs() + (reach_y * sin).abs();
        let step = reach / STEPS as f64;
        let mut powers = vec![0.0; STEPS + 2];
        for_each_node(&mut |kx, ky, power| {
            let place = (kx * cos + ky * sin).abs() / step;
            let i = (place as usize).min(STEPS);
            let along = place - i as f64;
            powers[i] += (1.0 - along) * power;
            powers[i + 1] += along * power;
        });
        Self { step, powers }
    }

    /// Wave numbers, and the power of each.
    fn waves(&self) -> impl DoubleEndedIterator<Item = [f64; 2]> {
        let step = self.step;
        let powers = self.powers.iter().enumerate();
        powers.map(move |(i, power)| [i as f64 * step, *power])
    }

    /// The lag along the direction at which the autocorrelation first falls to 1/e.
    pub(super) fn one_over_e_lag(&self) -> f64 {
        let total: f64 = self.powers.iter().sum();
        let below = |r: f64| {
            let waves = self.waves().filter(|[_, power]| *power > 0.0);
            let sum: f64 = waves.map(|[k, power]| power * cos(k * r)).sum();
            sum / total - exp(-1.0_f64)
        };
        // Waves of half a radian at most have not turned far
        let mut low = 0.5 / (self.step * STEPS as f64);
        while below(1.2 * low) > 0.0 {
            low *= 1.2;
        }
        root(below, low, 1.2 * low)
    }

    /// Wavelength below which waves hold `fraction` of the slope variance along the direction.
    pub(super) fn wavelength_holding(&self, fraction: f64) -> f64 {
        let slopes = |[k, power]: [f64; 2]| k * k * power;
        let all: f64 = self.waves().map(slopes).sum();
        let mut beyond = 0.0;
        for [k, power] in self.waves().rev() {
            beyond += slopes([k, power]);
            if beyond > fraction * all {
                return TAU / k;
            }
        }
        f64::INFINITY
    }
}
