//! Adaptive Gauss-Kronrod quadrature on pieces between known special points.

/// Points of the Kronrod rule.
const POINTS: usize = 15;

/// Nodes of the 15-point Kronrod rule on `[0, 1]` of the half interval; odd ones are Gauss's.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_5,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_48,
    0.0,
];
/// Weights of the Kronrod rule.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_19,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_42,
    0.204_432_940_075_298_89,
    0.209_482_141_084_727_82,
];
/// Weights of the embedded 7-point Gauss rule, at nodes 1, 3, 5 and 7.
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Error allowed in an integral: the larger of both.
#[derive(Clone, Copy, Debug)]
pub struct AllowedError {
    /// Error in the unit of the integral.
    pub absolute: f64,
    /// Fraction of the integral.
    pub relative: f64,
}

impl AllowedError {
    /// The tolerance with this error and at most `max_pieces` pieces.
    pub const fn within(self, max_pieces: usize) -> Tolerance {
        Tolerance {
            absolute: self.absolute,
            relative: self.relative,
            max_pieces,
        }
    }
}

/// End of the subdivision of an integral: allowed error and number of pieces.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Error allowed in the integral.
    pub absolute: f64,
    /// Error allowed as a fraction of the integral.
    pub relative: f64,
    /// Pieces allowed after subdivision.
    pub max_pieces: usize,
}

/// Special points of an integrand within a range.
#[derive(Clone, Debug, Default)]
pub struct Breaks {
    points: Vec<(f64, bool)>,
    lo: f64,
    hi: f64,
}

impl Breaks {
    /// No special points yet between `lo` and `hi`.
    pub fn new(lo: f64, hi: f64) -> Self {
        let mut breaks = Self::default();
        breaks.reset(lo, hi);
        breaks
    }

    /// Forgets all points; the range becomes `[lo, hi]`.
    pub fn reset(&mut self, lo: f64, hi: f64) {
        self.points.clear();
        self.points.push((lo, false));
        self.points.push((hi, false));
        (self.lo, self.hi) = (lo, hi);
    }

    /// A point where the scale of the integrand changes; it stays smooth there.
    pub fn add_smooth(&mut self, x: f64) {
        if x > self.lo && x < self.hi {
            self.points.push((x, false));
        }
    }

    /// A point where the integrand may behave like a power `|x - x0|^(k / 2)`.
    pub fn add_root(&mut self, x: f64) {
        // Also at the ends, which are then roots themselves.
        if x >= self.lo && x <= self.hi {
            self.points.push((x, true));
        }
    }

    /// All points, in the order in which they were added.
    pub fn points(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| point.0)
    }

    /// Sorts and merges; must precede integration.
    pub fn finish(&mut self) {
        self.points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let gap = 1e-13 * (self.hi - self.lo).abs();
        self.points.dedup_by(|next, kept| {
            let merged = next.0 - kept.0 <= gap;
            kept.1 |= merged && next.1;
            merged
        });
        if let Some(last) = self.points.last_mut() {
            last.0 = self.hi;
        }
    }
}

/// A part of the range with its own variable `u` in `[0, 1]`.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// The interval between two breaks.
    lo: f64,
    width: f64,
    /// `true` for `x = lo + width u^2 (3 - 2 u)`, which turns square roots at both ends into analytic
    /// functions of `u`; `false` for `x = lo + width u`.
    rooted: bool,
    /// The part of it that this piece covers, in `u`.
    u0: f64,
    u1: f64,
    value: f64,
    error: f64,
}

impl Piece {
    /// The 15 nodes: pairs about the centre from the outside in, then the centre.
    fn nodes(&self) -> [f64; POINTS] {
        let (centre, half) = self.extent();
        let x_of = |u: f64| match self.rooted {
            true => self.lo + self.width * (u * u * (3.0 - 2.0 * u)),
            false => self.lo + self.width * u,
        };
        self.abscissae(centre, half).map(x_of)
    }

    fn extent(&self) -> (f64, f64) {
        (0.5 * (self.u0 + self.u1), 0.5 * (self.u1 - self.u0))
    }

    fn abscissae(&self, centre: f64, half: f64) -> [f64; POINTS] {
        std::array::from_fn(|i| match i % 2 {
            0 => centre - half * NODES[i / 2],
            _ => centre + half * NODES[i / 2],
        })
    }

    /// Takes the values of the integrand at the nodes.
    fn take(&mut self, values: &[f64]) {
        let (centre, half) = self.extent();
        let mut at = [0.0; POINTS];
        let abscissae = self.abscissae(centre, half);
        for ((at, value), u) in at.iter_mut().zip(values).zip(abscissae) {
            *at = match self.rooted {
                true => self.width * 6.0 * u * (1.0 - u) * value,
                false => self.width * value,
            };
        }
        let middle = at[POINTS - 1];
        let pairs = || at.chunks_exact(2).map(|pair| (pair[0], pair[1]));
        let mut kronrod = KRONROD[7] * middle;
        let mut gauss = GAUSS[3] * middle;
        let mut absolute = KRONROD[7] * middle.abs();
        for (i, (a, b)) in pairs().enumerate() {
            kronrod += KRONROD[i] * (a + b);
            absolute += KRONROD[i] * (a.abs() + b.abs());
            if i % 2 == 1 {
                gauss += GAUSS[i / 2] * (a + b);
            }
        }
        let mean = 0.5 * kronrod;
        let mut spread = KRONROD[7] * (middle - mean).abs();
        for (i, (a, b)) in pairs().enumerate() {
            spread += KRONROD[i] * ((a - mean).abs() + (b - mean).abs());
        }
        // The error estimate of QUADPACK; the difference of both rules is the error of the poorer one.
        let difference = (kronrod - gauss).abs();
        let mut error = if spread > 0.0 {
            let ratio = 200.0 * difference / spread;
            spread * (ratio * ratio.sqrt()).min(1.0)
        } else {
            difference
        };
        error = error.max(8.0 * f64::EPSILON * absolute);
        self.value = half * kronrod;
        self.error = half * error;
    }
}

/// Integral of `f` over the range of `breaks`.
///
/// Pieces with the largest estimated error are halved until the sum of errors meets `tolerance` or
/// the maximum number of pieces is reached.
pub fn integrate(
    breaks: &Breaks,
    tolerance: Tolerance,
    pieces: &mut Pieces,
    mut f: impl FnMut(f64) -> f64,
) -> f64 {
    let of_column = |x: &[f64], values: &mut [f64]| {
        for (value, x) in values.iter_mut().zip(x) {
            *value = f(*x);
        }
    };
    of_columns::<1>(breaks, tolerance, pieces, of_column)
}

/// Integral as of [`integrate`], of a function that fills a column of values at a column of points, in lanes.
///
/// The last point is repeated up to a multiple of 16, so that vector instructions leave no rest.
pub fn integrate_columns(
    breaks: &Breaks,
    tolerance: Tolerance,
    pieces: &mut Pieces,
    f: impl FnMut(&[f64], &mut [f64]),
) -> f64 {
    of_columns::<16>(breaks, tolerance, pieces, f)
}

/// [`integrate_columns`], with lengths that are multiples of `MULTIPLE`.
fn of_columns<const MULTIPLE: usize>(
    breaks: &Breaks,
    tolerance: Tolerance,
    pieces: &mut Pieces,
    mut f: impl FnMut(&[f64], &mut [f64]),
) -> f64 {
    let Pieces {
        pieces,
        nodes,
        values,
    } = pieces;
    let mut evaluate = |pieces: &mut [Piece]| {
        nodes.clear();
        nodes.extend(pieces.iter().flat_map(Piece::nodes));
        if let Some(last) = nodes.last().copied() {
            nodes.resize(nodes.len().next_multiple_of(MULTIPLE), last);
        }
        values.resize(nodes.len(), 0.0);
        f(nodes, values);
        for (piece, values) in pieces.iter_mut().zip(values.chunks_exact(POINTS)) {
            piece.take(values);
        }
    };
    pieces.clear();
    pieces.extend(breaks.points.windows(2).map(|pair| {
        let ((lo, root_lo), (hi, root_hi)) = (pair[0], pair[1]);
        Piece {
            lo,
            width: hi - lo,
            rooted: root_lo || root_hi,
            u0: 0.0,
            u1: 1.0,
            value: 0.0,
            error: 0.0,
        }
    }));
    evaluate(pieces);
    loop {
        let value: f64 = pieces.iter().map(|p| p.value).sum();
        let error: f64 = pieces.iter().map(|p| p.error).sum();
        let allowed = tolerance.absolute.max(tolerance.relative * value.abs());
        let worst = pieces
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.error.total_cmp(&b.1.error));
        let Some((worst, _)) = worst else {
            return value;
        };
        if error <= allowed || error.is_nan() || pieces.len() >= tolerance.max_pieces {
            return value;
        }
        let mut halves = [pieces[worst]; 2];
        halves[0].u1 = halves[0].extent().0;
        halves[1].u0 = halves[0].u1;
        evaluate(&mut halves);
        pieces[worst] = halves[0];
        pieces.push(halves[1]);
    }
}

/// Buffer for the pieces of one integral, reused by the next.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    pieces: Vec<Piece>,
    nodes: Vec<f64>,
    values: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIGHT: Tolerance = Tolerance {
        absolute: 1e-14,
        relative: 1e-14,
        max_pieces: 200,
    };

    #[test]
    fn kronrod_rule_is_exact_to_degree_22() {
        let mut breaks = Breaks::new(-1.0, 1.0);
        breaks.finish();
        for degree in (0..=22).step_by(2) {
            let once = Tolerance {
                max_pieces: 1,
                ..TIGHT
            };
            let value = integrate(&breaks, once, &mut Pieces::default(), |x| x.powi(degree));
            assert!(
                (value - 2.0 / f64::from(degree + 1)).abs() < 4e-16,
                "{degree}"
            );
        }
    }

    #[test]
    fn embedded_gauss_rule_agrees_to_degree_13() {
        // Their difference is the error estimate: it must vanish where both are exact.
        for degree in (0..=12).step_by(2) {
            let gauss: f64 = (0..4)
                .map(|i| {
                    let pair = if i == 3 { 1.0 } else { 2.0 };
                    pair * GAUSS[i] * NODES[2 * i + 1].powi(degree)
                })
                .sum();
            assert!(
                (gauss - 2.0 / f64::from(degree + 1)).abs() < 4e-16,
                "{degree}"
            );
        }
    }

    #[test]
    fn square_roots_at_breaks_cost_little() {
        let mut breaks = Breaks::new(0.0, 2.0);
        breaks.add_root(0.7);
        breaks.finish();
        let mut calls = 0;
        let value = integrate(&breaks, TIGHT, &mut Pieces::default(), |x: f64| {
            calls += 1;
            (x - 0.7).abs().sqrt()
        });
        let expected = (0.7_f64.powf(1.5) + 1.3_f64.powf(1.5)) / 1.5;
        assert!((value - expected).abs() < 1e-14);
        assert!(calls <= 120, "{calls}");
    }

    #[test]
    fn a_narrow_peak_is_refined() {
        let mut breaks = Breaks::new(-1.0, 1.0);
        breaks.add_smooth(0.3);
        breaks.finish();
        let w = 1e-2;
        let value = integrate(&breaks, TIGHT, &mut Pieces::default(), |x| {
            (-((x - 0.3) / w).powi(2)).exp()
        });
        // The tolerance is absolute.
        let error = value - w * std::f64::consts::PI.sqrt();
        assert!(error.abs() < 1e-14, "{error:e}");
    }
}
