//! Gauss rule: a few weighted nodes in place of many.

/// Halvings of the interval that holds a node, to rounding.
const MAX_BISECTIONS: usize = 60;

/// Squared norm of a polynomial, over that of the one before, below which the rule is complete: the measure has no more points.
const COMPLETE: f64 = 1e-20;

/// Nodes and weights, at most `count`, whose sums of polynomials up to degree `2 count - 1` are those over `measure`: pairs of
/// a point between -1 and 1 and its weight. Weights are normalised to add to one.
///
/// # Source
/// Stieltjes's procedure for the recurrence of the orthogonal polynomials, whose Jacobi matrix has the nodes as eigenvalues:
/// W. Gautschi, *Orthogonal Polynomials: Computation and Approximation*, Oxford 2004, sections 2.2 and 3.1.
pub fn gauss_rule(measure: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let total: f64 = measure.iter().map(|[_, weight]| weight).sum();
    // p_(k+1) = (x - a_k) p_k - b_k p_(k-1), of leading coefficient one
    let (mut diagonal, mut squares) = (Vec::new(), Vec::new());
    let mut before = vec![0.0; measure.len()];
    let mut now = vec![1.0; measure.len()];
    let (mut norm, mut norm_before) = (total, 0.0);
    for k in 0..count {
        if k > 0 {
            let square = norm / norm_before;
            if square < COMPLETE {
                break;
            }
            squares.push(square);
        }
        let terms = measure.iter().zip(&now);
        let a = terms.map(|([x, w], p)| w * x * p * p).sum::<f64>() / norm;
        let b = squares.last().copied().unwrap_or(0.0);
        diagonal.push(a);
        for (([x, _], now), before) in measure.iter().zip(&mut now).zip(&mut before) {
            let next = (x - a) * *now - b * *before;
            (*before, *now) = (*now, next);
        }
        norm_before = norm;
        norm = measure.iter().zip(&now).map(|([_, w], p)| w * p * p).sum();
    }
    let jacobi = Jacobi { diagonal, squares };
    let nodes = (0..jacobi.diagonal.len()).map(|i| jacobi.node(i));
    nodes.map(|x| [x, jacobi.weight(x)]).collect()
}

/// The symmetric tridiagonal matrix of a recurrence.
struct Jacobi {
    diagonal: Vec<f64>,
    /// Squares of the elements beside the diagonal.
    squares: Vec<f64>,
}

impl Jacobi {
    /// Eigenvalues below `x`: the negative pivots of the matrix less `x`.
    fn count_below(&self, x: f64) -> usize {
        let mut pivot = 1.0;
        let mut count = 0;
        for (k, a) in self.diagonal.iter().enumerate() {
            let square = match k {
                0 => 0.0,
                _ => self.squares[k - 1],
            };
            pivot = a - x - square / pivot;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }

    /// Eigenvalue `i` in rising order.
    fn node(&self, i: usize) -> f64 {
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..MAX_BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.count_below(middle) > i {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The weight of the node `x`: one over the sum of the squares of the normalised polynomials.
    fn weight(&self, x: f64) -> f64 {
        let (mut before, mut now, mut sum) = (0.0, 1.0, 1.0);
        for (k, a) in self.diagonal.iter().enumerate().take(self.squares.len()) {
            let last = match k {
                0 => 0.0,
                _ => self.squares[k - 1].sqrt(),
            };
            let next = ((x - a) * now - last * before) / self.squares[k].sqrt();
            (before, now) = (now, next);
            sum += now * now;
        }
        sum.recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4001 even points with the weights of Simpson's rule are Legendre's measure, up to the degree asked, to 1e-12.
    #[test]
    fn even_points_give_the_rule_of_gauss_and_legendre() {
        let simpson = |i: i32| match i {
            0 | 4000 => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let measure: Vec<[f64; 2]> = (0..=4000)
            .map(|i| [f64::from(i - 2000) / 2000.0, simpson(i)])
            .collect();
        let rule = gauss_rule(&measure, 3);
        let outer = 0.6_f64.sqrt();
        let expected = [[-outer, 5.0 / 18.0], [0.0, 8.0 / 18.0], [outer, 5.0 / 18.0]];
        for (found, expected) in rule.iter().zip(expected) {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-11, "{rule:?}");
            }
        }
        let rule = gauss_rule(&measure, 12);
        let mean: f64 = rule.iter().map(|[x, w]| w * x.powi(22)).sum();
        assert!((mean - 1.0 / 23.0).abs() < 1e-9, "{mean}");
        assert!((rule.iter().map(|[_, w]| w).sum::<f64>() - 1.0).abs() < 1e-13);
    }

    #[test]
    fn a_few_points_are_kept_as_they_are() {
        let measure = [[-0.5, 1.0], [0.3, 2.0], [-0.5, 1.0]];
        let rule = gauss_rule(&measure, 8);
        assert_eq!(rule.len(), 2);
        for (found, expected) in rule.iter().flatten().zip([-0.5, 0.5, 0.3, 0.5]) {
            assert!((found - expected).abs() < 1e-14, "{rule:?}");
        }
        assert_eq!(gauss_rule(&[[0.25, 3.0]], 8).len(), 1);
    }
}
