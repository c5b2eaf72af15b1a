//! Rounding: a fingerprint of how this machine rounds, which results carry.
//!
//! The functions of the standard library, such as `exp`, are those of the operating system, whose last digits differ
//! between systems and versions. Cases that were computed by different ones would not add up to the bytes of either.

use std::hint::black_box;
use std::sync::OnceLock;

use asperity_numerics::elementary::{
    acos, asin, atan, atan2, cbrt, cos, exp, exp_m1, hypot, ln, ln_1p, pow, sin, tan, tanh,
};
use asperity_numerics::fnv1a;
use asperity_synthesis::{Psd, Synthesis, SynthesisError};

/// Arguments per function.
const ARGUMENTS: u32 = 256;

/// Functions of one argument, which is above 0 and below 1.
const FUNCTIONS: [fn(f64) -> f64; 14] = [
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    exp,
    exp_m1,
    ln,
    ln_1p,
    cbrt,
    tanh,
    |x| cos(20.0 * x),
    |x| exp(-20.0 * x),
];

/// A function of two arguments.
const OF_TWO: [fn(f64, f64) -> f64; 3] = [atan2, pow, hypot];

/// Samples of the surface that is drawn along y and x: of several prime factors, small.
const SHAPE: [usize; 2] = [32, 60];

/// The fingerprint of this machine: a hash of elementary functions at fixed arguments and of the heights of a small
/// surface, which come out of a Fourier transform.
pub(crate) fn rounding() -> &'static str {
    static ROUNDING: OnceLock<String> = OnceLock::new();
    ROUNDING.get_or_init(|| {
        // Drawing fails only if memory runs out.
        fingerprint(&elementary(), &heights().unwrap_or_default())
    })
}

fn fingerprint(functions: &[f64], heights: &[f64]) -> String {
    let bits = functions.iter().chain(heights).map(|x| x.to_bits());
    let bytes: Vec<u8> = bits.flat_map(u64::to_le_bytes).collect();
    format!("{:016x}", fnv1a(bytes))
}

fn elementary() -> Vec<f64> {
    // black_box: no constant folding
    let argument = |i: u32| black_box((f64::from(i) + 0.5) / f64::from(ARGUMENTS));
    let mut values = Vec::new();
    for i in 0..ARGUMENTS {
        let [x, y] = [argument(i), argument((97 * i + 31) % ARGUMENTS)];
        values.extend(FUNCTIONS.iter().map(|function| function(x)));
        values.extend(OF_TWO.iter().map(|function| function(x, y)));
    }
    values
}

fn heights() -> Result<Vec<f64>, SynthesisError> {
    let Ok(psd) = Psd::gaussian(1.0, 4.0) else {
        return Ok(Vec::new());
    };
    let surface = Synthesis::new(psd, SHAPE, [1.0; 2], true)?.draw(1, 0)?;
    Ok(surface.heights().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fingerprint_depends_on_every_bit_of_functions_and_heights() {
        let functions = elementary();
        assert_eq!(
            functions.len(),
            (FUNCTIONS.len() + OF_TWO.len()) * ARGUMENTS as usize
        );
        assert!(functions.iter().all(|value| value.is_finite()));
        assert_eq!(functions, elementary());
        let heights = heights().unwrap();
        assert_eq!(heights.len(), SHAPE[0] * SHAPE[1]);
        assert_eq!(rounding(), fingerprint(&functions, &heights));
        // One unit in the last place of one number is another fingerprint.
        let rounded = |values: &[f64], index: usize| {
            let mut other = values.to_vec();
            other[index] = f64::from_bits(other[index].to_bits() ^ 1);
            other
        };
        for index in [0, 1000, functions.len() - 1] {
            let other = fingerprint(&rounded(&functions, index), &heights);
            assert_ne!(rounding(), other, "function value {index}");
        }
        for index in [0, 1000, heights.len() - 1] {
            let other = fingerprint(&functions, &rounded(&heights, index));
            assert_ne!(rounding(), other, "height {index}");
        }
    }
}
