//! White Gaussian noise whose rows can be drawn in any order.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Sets these numbers apart from any others that the same seed yields elsewhere.
const PURPOSE: &[u8; 16] = b"asperity heights";

/// Fills `row` with independent standard normal numbers.
///
/// The generator is ChaCha8. Its 32 bytes of key are the seed (8 bytes, little endian), the
/// realisation (8 bytes, little endian) and a fixed text; its stream number is the row. So a row's
/// numbers depend on `seed`, `realisation` and `iy` alone, and a shorter row begins as a longer one.
pub(super) fn fill_row(seed: u64, realisation: u64, iy: u64, row: &mut [f64]) {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&realisation.to_le_bytes());
    key[16..].copy_from_slice(PURPOSE);
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(iy);
    for value in row {
        *value = rng.sample(StandardNormal);
    }
}
