//! Stockham transform: lines whose length has small prime factors, two lines at a time.
//!
//! Each pass takes a factor `R` off the length: it does transforms of `R` numbers, multiplies by roots of one, and sorts. What remains are
//! `R` times as many transforms, interleaved, of lines `1 / R` as long. After the last pass numbers are in order.
//!
//! # Source
//! Stockham, AFIPS Conf. Proc. 28, 229 (1966); van Loan, Computational frameworks for the fast Fourier transform (1992), 1.7.

use std::array::from_fn;
use std::{iter, mem};

use num_complex::Complex;

use super::pair::ComplexPair;
use super::unit_root::unit_root;

/// Largest prime factor of a length; above, a convolution is faster.
const MAX_FACTOR: usize = 101;

/// The forward transform of lines of one length, not normalised.
#[derive(Debug)]
pub(super) struct Stockham {
    length: usize,
    passes: Vec<Pass>,
}

/// One pass over all numbers: transforms of `radix` of them at a time.
#[derive(Debug)]
struct Pass {
    radix: usize,
    /// Factors of the results of each transform of `radix` numbers.
    twiddles: Vec<Complex<f64>>,
    /// Factors within transforms of `radix` numbers, which those of an odd radix take.
    roots: Vec<Complex<f64>>,
}

impl Stockham {
    /// Returns `true` if the length has no prime factor above [`MAX_FACTOR`].
    pub(super) fn takes(length: usize) -> bool {
        factors(length).all(|factor| factor <= MAX_FACTOR)
    }

    /// `length`: one that [`Stockham::takes`].
    pub(super) fn new(length: usize) -> Self {
        let mut rest = length;
        let passes = factors(length).map(|radix| {
            let products = (0..rest / radix).flat_map(|p| (0..radix).map(move |k| p * k));
            let twiddles = products.map(|product| unit_root(product, rest)).collect();
            rest /= radix;
            let roots = (0..radix).map(|k| unit_root(k, radix)).collect();
            Pass {
                radix,
                twiddles,
                roots,
            }
        });
        Self {
            length,
            passes: passes.collect(),
        }
    }

    pub(super) const fn length(&self) -> usize {
        self.length
    }

    /// Transforms `x`. Returns the result, in the memory of either, and what is free.
    pub(super) fn transform<'a>(
        &self,
        mut x: &'a mut [ComplexPair],
        mut y: &'a mut [ComplexPair],
    ) -> [&'a mut [ComplexPair]; 2] {
        let mut stride = 1;
        for pass in &self.passes {
            match pass.radix {
                2 => pass.run(x, y, stride, |[a, b]| [a + b, a - b]),
                3 => pass.run(x, y, stride, odd::<3>(&pass.roots)),
                4 => pass.run(x, y, stride, four),
                5 => pass.run(x, y, stride, odd::<5>(&pass.roots)),
                _ => pass.run_any(x, y, stride),
            }
            stride *= pass.radix;
            mem::swap(&mut x, &mut y);
        }
        [x, y]
    }
}

/// Factors of a length, fours first, then primes.
fn factors(length: usize) -> impl Iterator<Item = usize> {
    let mut rest = length;
    let mut radix = 4;
    iter::from_fn(move || {
        while rest > 1 && !rest.is_multiple_of(radix) {
            radix = match radix {
                4 => 2,
                2 => 3,
                _ if radix * radix > rest => rest,
                _ => radix + 2,
            };
        }
        (rest > 1).then(|| {
            rest /= radix;
            radix
        })
    })
}

impl Pass {
    /// Goes from `x` to `y`, of `stride` interleaved lines. `butterfly`: the transform of `R` numbers.
    #[inline]
    fn run<const R: usize>(
        &self,
        x: &[ComplexPair],
        y: &mut [ComplexPair],
        stride: usize,
        butterfly: impl Fn([ComplexPair; R]) -> [ComplexPair; R],
    ) {
        let inputs: [&[ComplexPair]; R] = from_fn(|j| &x[j * (x.len() / R)..][..x.len() / R]);
        let (twiddles, _) = self.twiddles.as_chunks::<R>();
        if stride == 1 {
            let (outputs, _) = y.as_chunks_mut::<R>();
            for (p, (output, twiddles)) in outputs.iter_mut().zip(twiddles).enumerate() {
                let results = butterfly(inputs.map(|input| input[p]));
                output[0] = results[0];
                for k in 1..R {
                    output[k] = results[k] * twiddles[k];
                }
            }
            return;
        }
        for (p, (output, twiddles)) in y.chunks_exact_mut(R * stride).zip(twiddles).enumerate() {
            let inputs = inputs.map(|part| &part[p * stride..][..stride]);
            let mut rest = output;
            let outputs: [&mut [ComplexPair]; R] = from_fn(|_| {
                let (part, others) = mem::take(&mut rest).split_at_mut(stride);
                rest = others;
                part
            });
            if p == 0 {
                // All factors are one.
                for q in 0..stride {
                    let results = butterfly(inputs.map(|input| input[q]));
                    for k in 0..R {
                        outputs[k][q] = results[k];
                    }
                }
            } else {
                for q in 0..stride {
                    let results = butterfly(inputs.map(|input| input[q]));
                    outputs[0][q] = results[0];
                    for k in 1..R {
                        outputs[k][q] = results[k] * twiddles[k];
                    }
                }
            }
        }
    }

    /// [`Pass::run`] of any odd radix.
    fn run_any(&self, x: &[ComplexPair], y: &mut [ComplexPair], stride: usize) {
        let (radix, part) = (self.radix, x.len() / self.radix);
        let twiddles = self.twiddles.chunks_exact(radix);
        // Sums and differences of the second and last numbers, the third and last but one, and so on
        let mut pairs = [[ComplexPair::default(); 2]; MAX_FACTOR / 2];
        let pairs = &mut pairs[..radix / 2];
        for (p, (output, twiddles)) in y.chunks_exact_mut(radix * stride).zip(twiddles).enumerate()
        {
            for q in 0..stride {
                let number = |j: usize| x[j * part + p * stride + q];
                let mut sum = number(0);
                for (j, pair) in (1..).zip(&mut *pairs) {
                    let [a, b] = [number(j), number(radix - j)];
                    *pair = [a + b, a - b];
                    sum = sum + pair[0];
                }
                output[q] = sum;
                for k in 1..=radix / 2 {
                    let (mut even, mut odd) = (number(0), ComplexPair::default());
                    let mut place = 0;
                    for [sum, difference] in &*pairs {
                        place += k;
                        if place >= radix {
                            place -= radix;
                        }
                        even = even + *sum * self.roots[place].re;
                        odd = odd + *difference * self.roots[place].im;
                    }
                    let odd = odd.times_i();
                    output[k * stride + q] = (even + odd) * twiddles[k];
                    output[(radix - k) * stride + q] = (even - odd) * twiddles[radix - k];
                }
            }
        }
    }
}

/// The transform of four numbers.
#[inline]
fn four([a, b, c, d]: [ComplexPair; 4]) -> [ComplexPair; 4] {
    let (even, odd) = (a + c, b + d);
    let (real, imaginary) = (a - c, (b - d).times_i());
    [even + odd, real - imaginary, even - odd, real + imaginary]
}

/// The transform of an odd number of numbers, which takes the second and last, the third and last but one, and so on together.
#[inline]
fn odd<const R: usize>(roots: &[Complex<f64>]) -> impl Fn([ComplexPair; R]) -> [ComplexPair; R] {
    let roots: [Complex<f64>; R] = from_fn(|k| roots[k]);
    move |numbers| {
        let mut results = numbers;
        for k in 1..=R / 2 {
            let term = |j: usize| {
                let (root, [a, b]) = (roots[j * k % R], [numbers[j], numbers[R - j]]);
                [(a + b) * root.re, (a - b) * root.im]
            };
            let [mut even, mut odd] = term(1);
            for j in 2..=R / 2 {
                let [sum, difference] = term(j);
                (even, odd) = (even + sum, odd + difference);
            }
            let (even, odd) = (numbers[0] + even, odd.times_i());
            results[0] = results[0] + numbers[k] + numbers[R - k];
            results[k] = even + odd;
            results[R - k] = even - odd;
        }
        results
    }
}
