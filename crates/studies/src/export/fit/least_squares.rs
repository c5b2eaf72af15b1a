//! Least squares: Levenberg and Marquardt's method for few parameters, with derivatives by differences.

/// Most steps.
const STEPS: usize = 100;

/// Difference of a parameter for the derivative by it.
const DIFFERENCE: f64 = 1e-5;

/// Relative decrease of the sum of squares below which a step is the last.
const TOLERANCE: f64 = 1e-10;

/// Damping at which no step helps.
const MAX_DAMPING: f64 = 1e10;

/// Parameters at a minimum of a sum of squares.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) parameters: Vec<f64>,
    /// Standard errors, as if residuals were independent and of equal variance; `None` where the parameters are not determined.
    pub(super) errors: Option<Vec<f64>>,
    /// Sum of the squared residuals.
    pub(super) sum: f64,
}

/// Parameters of the least sum of squares near `start`; `None` if there are no residuals at the start, or no more than parameters.
pub(super) fn least_squares(
    start: &[f64],
    residuals: impl Fn(&[f64]) -> Option<Vec<f64>>,
) -> Option<Minimum> {
    let squares = |all: &[f64]| all.iter().map(|one| one * one).sum::<f64>();
    let n = start.len();
    let mut parameters = start.to_vec();
    let mut found = residuals(&parameters)?;
    let mut sum = squares(&found);
    if found.len() <= n || !sum.is_finite() {
        return None;
    }
    let mut damping = 1e-3;
    let mut normal = normal_equations(&parameters, &found, &residuals)?;
    for _ in 0..STEPS {
        let (matrix, gradient) = &normal;
        let mut damped = matrix.clone();
        for i in 0..n {
            damped[i * n + i] *= 1.0 + damping;
        }
        let step = solution(damped, gradient.clone());
        let moved: Option<Vec<f64>> =
            step.map(|step| parameters.iter().zip(step).map(|(a, b)| a - b).collect());
        let next = moved.and_then(|moved| Some((residuals(&moved)?, moved)));
        match next.map(|(next, moved)| (squares(&next), next, moved)) {
            Some((smaller, next, moved)) if smaller < sum => {
                let is_last = sum - smaller <= TOLERANCE * sum;
                (parameters, found, sum) = (moved, next, smaller);
                normal = normal_equations(&parameters, &found, &residuals)?;
                damping *= 0.1;
                if is_last {
                    break;
                }
            }
            _ if damping > MAX_DAMPING => break,
            _ => damping *= 10.0,
        }
    }
    let variance = sum / (found.len() - n) as f64;
    let error = |i: usize| {
        let unit = (0..n).map(|k| if k == i { 1.0 } else { 0.0 }).collect();
        let of_unit = solution(normal.0.clone(), unit)?[i] * variance;
        (of_unit >= 0.0 && of_unit.is_finite()).then(|| of_unit.sqrt())
    };
    let errors = (0..n).map(error).collect();
    Some(Minimum {
        parameters,
        errors,
        sum,
    })
}

/// Products of the derivatives of the residuals with each other, and with the residuals.
fn normal_equations(
    parameters: &[f64],
    found: &[f64],
    residuals: impl Fn(&[f64]) -> Option<Vec<f64>>,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = parameters.len();
    let derivative = |i: usize| {
        let mut moved = parameters.to_vec();
        moved[i] += DIFFERENCE;
        let moved = residuals(&moved)?;
        let differences = moved.iter().zip(found).map(|(a, b)| (a - b) / DIFFERENCE);
        Some(differences.collect::<Vec<f64>>())
    };
    let derivatives: Vec<Vec<f64>> = (0..n).map(derivative).collect::<Option<_>>()?;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let rows = derivatives.iter();
    let matrix = rows.flat_map(|a| derivatives.iter().map(move |b| product(a, b)));
    let gradient = derivatives.iter().map(|row| product(row, found));
    Some((matrix.collect(), gradient.collect()))
}

/// Solution of linear equations by elimination with pivots on the diagonal; `None` unless the symmetric matrix is positive definite.
fn solution(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for i in 0..n {
        let pivot = matrix[i * n + i];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        for row in i + 1..n {
            let factor = matrix[row * n + i] / pivot;
            for k in i..n {
                matrix[row * n + k] -= factor * matrix[i * n + k];
            }
            right[row] -= factor * right[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| matrix[i * n + k] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i * n + i];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_a_power_law_are_recovered_from_a_poor_start() {
        let law = |x: f64, p: &[f64]| p[0] - (p[1].exp() + x.powf(p[2])).ln();
        let truth = [-2.0, -5.0, 1.7];
        let x: Vec<f64> = (1..200).map(|i| 0.005 * f64::from(i)).collect();
        let residuals = |p: &[f64]| Some(x.iter().map(|&x| law(x, p) - law(x, &truth)).collect());
        let found = least_squares(&[0.0, -2.0, 3.0], residuals).unwrap();
        for (found, truth) in found.parameters.iter().zip(truth) {
            assert!((found - truth).abs() < 1e-4, "{found} {truth}");
        }
    }

    /// For a straight line the errors are known in closed form.
    #[test]
    fn errors_are_those_of_a_straight_line() {
        let data = [0.1, 1.2, 1.9, 3.2, 3.8];
        let residuals = |p: &[f64]| {
            let at = |(i, y): (usize, &f64)| p[0] + p[1] * i as f64 - y;
            Some(data.iter().enumerate().map(at).collect())
        };
        let found = least_squares(&[5.0, 5.0], residuals).unwrap();
        let slope = data
            .iter()
            .zip(-2..)
            .map(|(y, x)| y * f64::from(x))
            .sum::<f64>()
            / 10.0;
        assert!((found.parameters[1] - slope).abs() < 1e-7);
        let expected = (found.sum / 3.0 / 10.0).sqrt();
        assert!((found.errors.unwrap()[1] / expected - 1.0).abs() < 1e-5);
    }
}
