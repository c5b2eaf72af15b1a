//! First root: the first parameter at which a polynomial in Bernstein form falls below zero.
//!
//! A polynomial has no more roots in [0, 1] than its Bernstein coefficients have changes of sign, and as many but for
//! an even number (Descartes' rule). No change: none. One: exactly one, found by Halley's method within brackets. More:
//! the interval is halved, and the first half looked at first.
//!
//! All polynomials are of degree six. Code for many of them at once (`many.rs`) is written without branches.

/// Halvings after which an interval is as narrow as rounding.
const MAX_HALVINGS: u32 = 50;

/// The smallest `s` in [0, 1] at which the polynomial with the Bernstein coefficients `b`, positive before,
/// becomes negative; `None` if it does not.
///
/// Coefficients within `noise` of zero are taken as zero. A polynomial that only touches zero
/// does not become negative.
pub(super) fn first_root(b: &[f64; 7], noise: f64) -> Option<f64> {
    match (changes_of_sign(b, noise), first_sign(b, noise)) {
        (0.0, sign) => (sign < 0.0).then_some(0.0),
        (1.0, 1.0) => Some(single_root(b)),
        _ => by_halves(b, noise),
    }
}

/// The first root by halving the interval, the first half first.
#[cold]
fn by_halves(b: &[f64; 7], noise: f64) -> Option<f64> {
    let mut waiting = vec![(0.0, 1.0, 0, *b)];
    while let Some((from, width, halvings, b)) = waiting.pop() {
        match (changes_of_sign(&b, noise), first_sign(&b, noise)) {
            // Negative from the start: the root is where the half before ended.
            (0.0, -1.0) => return Some(from),
            (0.0, _) => {}
            (1.0, 1.0) => return Some(from + width * single_root(&b)),
            _ if halvings == MAX_HALVINGS => {
                if b[6] < -noise {
                    return Some(from);
                }
            }
            _ => {
                let [low, high] = halved(&b);
                let half = 0.5 * width;
                waiting.push((from + half, half, halvings + 1, high));
                waiting.push((from, half, halvings + 1, low));
            }
        }
    }
    None
}

/// 1, -1, or 0 within the noise.
#[inline(always)]
fn sign(x: f64, noise: f64) -> f64 {
    let positive = if x > noise { 1.0 } else { 0.0 };
    if x < -noise { -1.0 } else { positive }
}

fn first_sign(b: &[f64; 7], noise: f64) -> f64 {
    let mut signs = b.iter().map(|&x| sign(x, noise));
    signs.find(|s| *s != 0.0).unwrap_or(0.0)
}

/// Number of sign changes of the coefficients.
#[inline(always)]
fn changes_of_sign(b: &[f64; 7], noise: f64) -> f64 {
    let (mut last, mut changes) = (0.0, 0.0);
    for &x in b {
        let sign = sign(x, noise);
        changes += if last * sign < 0.0 { 1.0 } else { 0.0 };
        last = if sign == 0.0 { last } else { sign };
    }
    changes
}

/// Returns `true` if a polynomial changes sign once, from positive to negative, so that [`first_root`] is its
/// [`single_root`].
#[inline(always)]
pub(super) fn falls_once(b: &[f64; 7], noise: f64) -> bool {
    (changes_of_sign(b, noise) == 1.0) & (b[0] > noise) & (b[6] < -noise)
}

/// The two halves of a polynomial, by de Casteljau's algorithm.
fn halved(b: &[f64; 7]) -> [[f64; 7]; 2] {
    let (mut low, mut high) = ([0.0; 7], *b);
    for (k, low) in low.iter_mut().enumerate() {
        *low = high[0];
        for i in 0..6 - k {
            high[i] = 0.5 * (high[i] + high[i + 1]);
        }
    }
    [low, high]
}

/// The root of a polynomial that changes from positive to negative once.
fn single_root(b: &[f64; 7]) -> f64 {
    let mut bracket = Bracket::near_root(b);
    // Where these steps are not enough, halving ends it
    for _ in 0..200 {
        if bracket.is_narrow() {
            break;
        }
        bracket = bracket.narrowed(b);
    }
    bracket.s
}

/// An interval that contains a root, and a guess at it.
#[derive(Clone, Copy)]
pub(super) struct Bracket {
    low: f64,
    high: f64,
    pub(super) s: f64,
    /// Last change of the guess.
    change: f64,
}

impl Bracket {
    /// The guess after the steps that take most roots to rounding.
    #[inline(always)]
    pub(super) fn near_root(b: &[f64; 7]) -> Self {
        let bracket = Self::new(b).narrowed(b);
        bracket.narrowed(b).narrowed(b)
    }

    /// The first guess is where the coefficients, taken as values at equal distances, change sign.
    #[inline(always)]
    fn new(b: &[f64; 7]) -> Self {
        let mut s = 0.5;
        for i in (0..6).rev() {
            let guess = (i as f64 + b[i] / (b[i] - b[i + 1])) * (1.0 / 6.0);
            s = if (b[i] > 0.0) & (b[i + 1] < 0.0) {
                guess
            } else {
                s
            };
        }
        Self {
            low: 0.0,
            high: 1.0,
            s,
            change: 1.0,
        }
    }

    /// After a step of Halley's method, or half the interval where that leaves it.
    #[inline(always)]
    fn narrowed(self, b: &[f64; 7]) -> Self {
        let s = self.s;
        let [value, rate, half_bend] = value_rate_and_half_bend(b, s);
        let is_before = value > 0.0;
        let low = if is_before { s } else { self.low };
        let high = if is_before { self.high } else { s };
        let guess = s - value * rate / (rate * rate - value * half_bend);
        let inside = (guess >= low) & (guess <= high);
        let next = if inside { guess } else { 0.5 * (low + high) };
        Self {
            low,
            high,
            s: next,
            change: (next - s).abs(),
        }
    }

    /// Returns `true` if the next step would change the guess by rounding only: by about the cube of the last step.
    #[inline(always)]
    pub(super) fn is_narrow(&self) -> bool {
        self.change < 1e-7
    }
}

/// Value, derivative and half the second derivative at `s`, by de Casteljau's algorithm.
#[inline(always)]
fn value_rate_and_half_bend(b: &[f64; 7], s: f64) -> [f64; 3] {
    let r = 1.0 - s;
    let mut c = *b;
    for last in [6, 5, 4, 3] {
        for i in 0..last {
            c[i] = r * c[i] + s * c[i + 1];
        }
    }
    let (first, second) = (c[1] - c[0], c[2] - c[1]);
    let rate = r * first + s * second;
    let value = r * (r * c[0] + s * c[1]) + s * (r * c[1] + s * c[2]);
    [value, 6.0 * rate, 15.0 * (second - first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bernstein coefficients of degree six of `sum a_k s^k`.
    fn bernstein(a: [f64; 7]) -> [f64; 7] {
        let choose = |n: usize, k: usize| -> f64 {
            (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
        };
        std::array::from_fn(|m| (0..=m).map(|k| choose(m, k) / choose(6, k) * a[k]).sum())
    }

    /// Coefficients of the powers of `scale * prod (s - root)`.
    fn with_roots(roots: &[f64], scale: f64) -> [f64; 7] {
        let mut a = [0.0; 7];
        a[0] = scale;
        for root in roots {
            for k in (0..7).rev() {
                a[k] = if k > 0 { a[k - 1] } else { 0.0 } - root * a[k];
            }
        }
        a
    }

    #[test]
    fn the_first_of_several_roots_is_found() {
        for roots in [
            vec![0.3],
            vec![0.2, 0.5, 0.9],
            vec![0.1, 0.11, 0.7],
            vec![0.4, 0.400_001, 0.8],
            vec![0.05, 1.5, 0.9, 2.0, 0.95],
            vec![-0.2, 0.6],
            vec![1.0 - 1e-9],
            vec![1e-9],
        ] {
            // Positive before the first root in [0, 1].
            let first = roots
                .iter()
                .filter(|r| **r >= 0.0)
                .fold(2.0_f64, |a, r| a.min(*r));
            let before: f64 = roots.iter().map(|r| 0.5 * first - r).product();
            let a = with_roots(&roots, before.signum());
            let found = first_root(&bernstein(a), 1e-16).unwrap();
            assert!((found - first).abs() < 1e-9, "{roots:?}: {found}");
        }
    }

    #[test]
    fn what_stays_positive_or_only_touches_zero_has_no_root() {
        assert_eq!(
            first_root(&bernstein(with_roots(&[1.5, 2.0], 1.0)), 0.0),
            None
        );
        // (s - 1/2)^2 and (s - 1/2)^2 + 1e-6
        for lift in [0.0, 1e-6] {
            let mut a = with_roots(&[0.5, 0.5], 1.0);
            a[0] += lift;
            assert_eq!(first_root(&bernstein(a), 1e-15), None, "{lift}");
        }
        assert_eq!(first_root(&[0.0; 7], 0.0), None);
        assert_eq!(first_root(&[1e-17; 7], 1e-16), None);
    }

    #[test]
    fn what_is_negative_from_the_start_has_its_root_there() {
        assert_eq!(first_root(&[-1.0; 7], 1e-16), Some(0.0));
        assert_eq!(
            first_root(&[0.0, -1.0, -2.0, -1.0, -1.0, -1.0, -1.0], 0.0),
            Some(0.0)
        );
    }
}
