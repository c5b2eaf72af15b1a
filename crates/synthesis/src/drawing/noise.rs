//! White Gaussian noise in the plane of wave vectors, in streams that can be drawn in any order.
//!
//! A wave takes 64 random bits and turns them into a complex normal number by the transform of Box
//! and Muller (Ann. Math. Stat. 29, 610 (1958)). Logarithm, sine and cosine are short polynomials in
//! single precision, free of branches, which compilers turn into vector instructions. They add,
//! multiply, divide and take roots, and nothing else, so that every processor computes the same bits.
//!
//! Single precision is ample: parts are off by less than `1e-6 |z|`, which no ensemble of surfaces is
//! large enough to show, and `|z|` ends at 4.7, beyond which one wave in `2^32` would lie.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Purpose of the numbers, which sets them apart from any others of the same seed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stream {
    /// Heights of a surface.
    Heights,
    /// Amplitude of the slopes of a surface.
    Amplitude,
    /// Heights of a surface whose spectrum was measured on another, of which this number tells: the measured surface itself may be of the
    /// same seed.
    Measured(u32),
}

impl Stream {
    fn key(self) -> [u8; 16] {
        match self {
            Self::Heights => *b"asperity heights",
            Self::Amplitude => *b"asperity amplit.",
            Self::Measured(mark) => {
                let mut key = *b"asper. meas.....";
                key[12..].copy_from_slice(&mark.to_le_bytes());
                key
            }
        }
    }
}

/// Waves drawn together; the generator yields as many random bits at a time.
const BLOCK: usize = 32;

/// The noise of one surface.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    key: [u8; 32],
}

/// Side of `ky = 0` on which the waves of a stream lie.
#[derive(Clone, Copy)]
pub(super) enum Side {
    /// `ky = 0, dk, 2 dk, ...`
    Positive,
    /// `ky = -dk, -2 dk, ...`
    Negative,
}

impl Side {
    /// Row of wave `i` of this side, of an FFT over `ny` rows.
    pub(super) const fn row(self, i: usize, ny: usize) -> usize {
        match self {
            Self::Positive => i,
            Self::Negative => ny - 1 - i,
        }
    }
}

impl Noise {
    /// The noise of the heights of a realisation of a seed.
    #[cfg(test)]
    pub(super) fn new(seed: u64, realisation: u64) -> Self {
        Self::of_stream(Stream::Heights, seed, realisation)
    }

    /// The noise of a realisation of a seed.
    pub(super) fn of_stream(stream: Stream, seed: u64, realisation: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&realisation.to_le_bytes());
        key[16..].copy_from_slice(&stream.key());
        Self { key }
    }

    /// Hands the numbers of `count` waves of one side of column `ix`, from `ky = 0` outwards, to
    /// `take`, some at a time: index of the first, real parts, imaginary parts. They are
    /// independent and normal, of variance 1/2 in each part.
    ///
    /// The generator is ChaCha8. Its 32 bytes of key are the seed (8 bytes, little endian), the
    /// realisation (8 bytes, little endian) and a fixed text; its stream number is `2 ix`, plus one
    /// on the negative side. So a wave's number depends on `seed`, `realisation` and the wave vector
    /// in units of `dk` alone, and not on how many waves there are: a finer grid over the same tile
    /// has the same surface.
    pub(super) fn waves(
        &self,
        ix: usize,
        side: Side,
        count: usize,
        mut take: impl FnMut(usize, &[f32], &[f32]),
    ) {
        let mut rng = ChaCha8Rng::from_seed(self.key);
        rng.set_stream(2 * ix as u64 + u64::from(matches!(side, Side::Negative)));
        let mut bytes = [0; 8 * BLOCK];
        for first in (0..count).step_by(BLOCK) {
            rng.fill_bytes(&mut bytes);
            let [re, im] = normal_block(&bytes);
            let len = BLOCK.min(count - first);
            take(first, &re[..len], &im[..len]);
        }
    }
}

/// Real and imaginary parts of complex normal numbers, from 32 bits for the modulus and 32 bits for
/// the phase of each: all moduli first.
fn normal_block(bytes: &[u8; 8 * BLOCK]) -> [[f32; BLOCK]; 2] {
    const SIGN: u32 = 1 << 31;
    let (words, _) = bytes.as_chunks::<4>();
    let (for_modulus, for_phase) = words.split_at(BLOCK);
    let (mut re, mut im) = ([0.0; BLOCK], [0.0; BLOCK]);
    for i in 0..BLOCK {
        // |z|^2 = -ln u
        let r = half_exponential(u32::from_le_bytes(for_modulus[i])).sqrt();
        // A phase of 45 degrees + b, in the first quadrant; the two bits left over turn it to another.
        let phase = u32::from_le_bytes(for_phase[i]);
        let (sin, cos) = eighth_turn(phase << 2);
        let (x, y) = (r * (cos - sin), r * (cos + sin));
        re[i] = f32::from_bits(x.to_bits() ^ (phase & SIGN));
        im[i] = f32::from_bits(y.to_bits() ^ ((phase << 1) & SIGN));
    }
    [re, im]
}

/// `-ln(u) / 2`, where the random `word` becomes `u`, uniform between 0 and 1, above 0.
fn half_exponential(word: u32) -> f32 {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    // 31 bits, since vector instructions convert signed numbers only
    let u = ((word >> 1) as i32 as f32 + 0.5) * (1.0 / 2_147_483_648.0);
    // u = 2^e m with m between sqrt 1/2 and sqrt 2, and ln m = 2 artanh s
    let bits = u.to_bits();
    let e = bits.wrapping_sub(SQRT_HALF) as i32 >> 23;
    let m = f32::from_bits(bits.wrapping_sub((e << 23) as u32));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let artanh = s + s * s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0)));
    e as f32 * (-0.5 * std::f32::consts::LN_2) - artanh
}

/// `(sin b, cos b)`, where the random `word` becomes `b`, uniform between -45 and 45 degrees.
fn eighth_turn(word: u32) -> (f32, f32) {
    let b = word as i32 as f32 * (std::f32::consts::FRAC_PI_4 / 2_147_483_648.0);
    let b2 = b * b;
    let sin = b + b * b2 * (-1.0 / 6.0 + b2 * (1.0 / 120.0 + b2 * (-1.0 / 5040.0)));
    let cos = 1.0 + b2 * (-0.5 + b2 * (1.0 / 24.0 + b2 * (-1.0 / 720.0 + b2 * (1.0 / 40_320.0))));
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Series end at `b^9 / 9! = 3e-7` of a sine, `b^10 / 10! = 2e-8` of a cosine and `s^8 / 9 = 8e-8`
    /// of a logarithm; rounding adds a few times `2^-24 = 6e-8`.
    #[test]
    fn polynomials_are_the_functions() {
        for i in 0..=10_000_u32 {
            let word = (i * 429_496).wrapping_add(i % 7);
            let b = f64::from(word as i32) / f64::from(1_u32 << 31) * std::f64::consts::FRAC_PI_4;
            let (sin, cos) = eighth_turn(word);
            assert!((f64::from(sin) - b.sin()).abs() < 5e-7, "{b}: {sin}");
            assert!((f64::from(cos) - b.cos()).abs() < 3e-7, "{b}: {cos}");
            // Of the same u, rounded to single precision
            let u = f64::from(((word >> 1) as f32 + 0.5) / (1_u32 << 31) as f32);
            let expected = -0.5 * u.ln();
            let found = f64::from(half_exponential(word));
            assert!((found - expected).abs() < 4e-7 * expected, "{u}: {found}");
        }
    }

    #[test]
    fn ends_of_the_range_are_finite() {
        assert_eq!(half_exponential(u32::MAX), 0.0);
        let largest = half_exponential(0);
        assert!((largest - 16.0 * std::f32::consts::LN_2).abs() < 1e-5);
    }

    /// Moments of `n` numbers scatter by the square root of their variance over `n`: for a normal
    /// number in units of its deviation, 1, 2, 15 and 96 for the powers 1 to 4; 1 for a product of
    /// two. The fractions beyond 1, 2, 3 and 4 deviations are `erfc(t / sqrt 2)`. Each of 13 passes
    /// |z| < 4 with probability 1 - 6e-5.
    #[test]
    fn numbers_are_normal_and_independent() {
        let (columns, count) = (64, 1 << 14);
        let (mut moments, mut product, mut beyond) = ([[0.0; 4]; 2], 0.0, [0.0; 4]);
        for ix in 0..columns {
            Noise::new(5, 0).waves(ix, Side::Negative, count, |_, re, im| {
                for (&re, &im) in re.iter().zip(im) {
                    let pair = [re, im].map(|part| f64::from(part) * std::f64::consts::SQRT_2);
                    for (sums, part) in moments.iter_mut().zip(pair) {
                        for (sum, power) in sums.iter_mut().zip(1..) {
                            *sum += part.powi(power);
                        }
                        for (sum, t) in beyond.iter_mut().zip(1..) {
                            *sum += f64::from(u8::from(part.abs() > f64::from(t)));
                        }
                    }
                    product += pair[0] * pair[1];
                }
            });
        }
        let n = (columns * count) as f64;
        let check = |name: &str, sum: f64, n: f64, expected: f64, variance: f64| {
            let z = (sum / n - expected) / (variance / n).sqrt();
            println!("{name}: z = {z:.2}");
            assert!(z.abs() < 4.0, "{name}: z = {z}");
        };
        let known = [
            ("mean", 0.0, 1.0),
            ("square", 1.0, 2.0),
            ("cube", 0.0, 15.0),
            ("fourth", 3.0, 96.0),
        ];
        for sums in moments {
            for (sum, (name, expected, variance)) in sums.into_iter().zip(known) {
                check(name, sum, n, expected, variance);
            }
        }
        check("product", product, n, 0.0, 1.0);
        let tails = [
            0.317_310_507_863,
            0.045_500_263_896,
            0.002_699_796_063,
            6.334_248_367e-5,
        ];
        for (sum, fraction) in beyond.into_iter().zip(tails) {
            check("tail", sum, 2.0 * n, fraction, fraction * (1.0 - fraction));
        }
    }

    #[test]
    fn numbers_do_not_depend_on_how_many_are_drawn() {
        let draw = |count| {
            let mut numbers = Vec::new();
            Noise::new(1, 2).waves(3, Side::Positive, count, |first, re, im| {
                assert_eq!(first, numbers.len());
                numbers.extend(
                    re.iter()
                        .zip(im)
                        .map(|(re, im)| [re.to_bits(), im.to_bits()]),
                );
            });
            numbers
        };
        assert_eq!(draw(45), draw(200)[..45]);
    }

    /// The bits that every processor must compute, as long as this version's surfaces are to last.
    #[test]
    fn bits_agree_with_the_published_ones() {
        let mut bits = 0_u64;
        Noise::new(2024, 3).waves(7, Side::Positive, 1000, |_, re, im| {
            for part in re.iter().chain(im) {
                bits = bits.rotate_left(5).wrapping_mul(0x9e37_79b9_7f4a_7c15)
                    ^ u64::from(part.to_bits());
            }
        });
        assert_eq!(bits, 0xed0b_dc99_2d46_a9d4, "{bits:#x}");
    }
}
