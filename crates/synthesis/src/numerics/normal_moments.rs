//! Means and moments of functions of a normal number.

/// Nodes from -8 to 8, `per_unit` of them per unit, and weights of the trapezium rule for a standard normal number. Weights are not
/// normalised.
pub(crate) fn normal_nodes(per_unit: u32) -> impl Iterator<Item = [f64; 2]> {
    let last = 8 * per_unit as i32;
    (-last..=last).map(move |i| {
        let z = f64::from(i) / f64::from(per_unit);
        [z, (-0.5 * z * z).exp()]
    })
}

/// Mean, variance, skewness and kurtosis of `function(z)`, `z` a standard normal number: by the trapezium rule in steps of `step` from
/// `-range` to `range`, exact to rounding for functions that are smooth on that scale.
pub(crate) fn normal_moments(function: impl Fn(f64) -> f64, step: f64, range: f64) -> [f64; 4] {
    let steps = (range / step).round() as i32;
    let nodes = (-steps..=steps).map(|i| f64::from(i) * step);
    let weighted = nodes.map(|z| ((-0.5 * z * z).exp(), function(z)));
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
        central(3) / variance.powf(1.5),
        central(4) / (variance * variance),
    ]
}
