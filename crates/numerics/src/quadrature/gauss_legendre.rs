//! Gauss-Legendre rule of 8 points.

/// Nodes and weights of the Gauss-Legendre rule of 8 points between 0 and 1 around the middle.
const RULE: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

/// The integral from `start` to `stop` by the Gauss-Legendre rule of 8 points.
pub fn gauss_legendre(function: &dyn Fn(f64) -> f64, start: f64, stop: f64) -> f64 {
    let (middle, half) = (0.5 * (start + stop), 0.5 * (stop - start));
    let pair = |[node, weight]: [f64; 2]| {
        weight * (function(middle - half * node) + function(middle + half * node))
    };
    half * RULE.into_iter().map(pair).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_up_to_degree_fifteen() {
        let integral = gauss_legendre(&|x: f64| x.powi(15) - 3.0 * x.powi(8), 0.5, 2.0);
        let exact = (2.0_f64.powi(16) - 0.5_f64.powi(16)) / 16.0
            - (2.0_f64.powi(9) - 0.5_f64.powi(9)) / 3.0;
        assert!((integral / exact - 1.0).abs() < 1e-13, "{integral}");
    }
}
