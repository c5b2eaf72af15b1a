//! Roots of functions and of quadratic polynomials.

/// Halvings of an interval, to 1e-15 of it.
const MAX_BISECTIONS: usize = 50;

/// Zero of a function that changes its sign between `low` and `high`, by bisection; the end nearer to zero if it does not change.
pub fn root(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (at_low, at_high) = (function(low), function(high));
    if at_low * at_high > 0.0 {
        return if at_low.abs() < at_high.abs() {
            low
        } else {
            high
        };
    }
    let (mut low, mut high) = (low, high);
    for _ in 0..MAX_BISECTIONS {
        let middle = 0.5 * (low + high);
        if function(middle) * at_low > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Real roots of `a x^2 + 2 b x + c = 0`, without cancellation.
pub fn quadratic_roots(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let discriminant = b * b - a * c;
    let mut roots = [f64::NAN; 2];
    if discriminant >= 0.0 {
        let larger = -(b + discriminant.sqrt().copysign(b));
        roots = [larger / a, c / larger];
    }
    roots.into_iter().filter(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found() {
        let steep = |x: f64| x.powi(9) - 1e-3;
        assert!((root(steep, 0.0, 10.0) - 1e-3_f64.powf(1.0 / 9.0)).abs() < 1e-12);
        assert!((root(|x| (-x).exp() - 0.5, 0.0, 700.0) - 2.0_f64.ln()).abs() < 1e-11);
        assert_eq!(root(|x| x + 1.0, 0.0, 1.0), 0.0);
    }
}
