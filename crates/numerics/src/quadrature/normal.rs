//! Trapezium rule for functions of a normal number.

use crate::elementary::{exp, pow};

/// Nodes from `-range` to `range`, `per_unit` of them per unit, and weights of the trapezium rule for a standard normal number. Weights are not
/// normalised.
pub fn normal_nodes(per_unit: u32, range: u32) -> impl Iterator<Item = [f64; 2]> {
    let last = (range * per_unit) as i32;
    (-last..=last).map(move |i| {
        let z = f64::from(i) / f64::from(per_unit);
        [z, exp(-0.5 * z * z)]
    })
}

/// Mean, variance, skewness and kurtosis of `function(z)`, `z` a standard normal number: by the trapezium rule of
/// [`normal_nodes`], exact to rounding for functions that are smooth on that scale.
pub fn normal_moments(function: impl Fn(f64) -> f64, per_unit: u32, range: u32) -> [f64; 4] {
    let nodes = normal_nodes(per_unit, range);
    let weighted = nodes.map(|[z, weight]| (weight, function(z)));
    let weighted: Vec<(f64, f64)> = weighted.collect();
    let total: f64 = weighted.iter().map(|(weight, _)| weight).sum();
    let mean = weighted.iter().map(|(weight, x)| weight * x).sum::<f64>() / total;
    let central = |power: i32| {
        let terms = weighted.iter();
        let terms = terms.map(|(weight, x)| weight * (x - mean).powi(power));
        terms.sum::<f64>() / total
    };
    let variance = central(2);
    [
        mean,
        variance,
        central(3) / pow(variance, 1.5),
        central(4) / (variance * variance),
    ]
}
