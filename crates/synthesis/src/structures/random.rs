//! Random numbers of features: one stream per feature, which can be drawn in any order.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{cos, ln};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Sets these numbers apart from any others that the same seed yields elsewhere.
const PURPOSE: &[u8; 16] = b"asperity feature";

/// The random numbers of one surface.
#[derive(Clone, Copy)]
pub(super) struct Streams {
    key: [u8; 32],
}

impl Streams {
    /// Streams of a realisation of a seed. The key of the generator, ChaCha8, is the seed (8 bytes, little endian), the
    /// realisation (8 bytes, little endian) and a fixed text; its stream number is that of the feature.
    pub(super) fn new(seed: u64, realisation: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&realisation.to_le_bytes());
        key[16..].copy_from_slice(PURPOSE);
        Self { key }
    }

    /// Stream of one feature.
    pub(super) fn of(&self, feature: usize) -> Stream {
        let mut generator = ChaCha8Rng::from_seed(self.key);
        generator.set_stream(feature as u64);
        Stream(generator)
    }
}

/// The random numbers of one feature.
pub(super) struct Stream(ChaCha8Rng);

impl Stream {
    /// Uniform from 0 to below 1.
    pub(super) fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.0.next_u64() >> 11) as f64 * STEP
    }

    /// Uniform between `1 - spread` and `1 + spread`.
    pub(super) fn about_one(&mut self, spread: f64) -> f64 {
        1.0 + spread * (2.0 * self.uniform() - 1.0)
    }

    /// A position on the tile with sides `lengths`.
    pub(super) fn position(&mut self, lengths: [f64; 2]) -> [f64; 2] {
        lengths.map(|length| length * self.uniform())
    }

    /// Normal, of mean 0 and variance 1: Box and Muller, Ann. Math. Stat. 29, 610 (1958).
    pub(super) fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * ln(u)).sqrt() * cos(TAU * v)
    }
}
