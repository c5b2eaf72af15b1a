//! Random numbers of points and pictures.

use asperity_numerics::fnv1a;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The stream that seeds repeat `repeat` of the run `name` of a convergence measurement under `seed`.
pub fn convergence_stream(seed: u64, name: &str, repeat: u64) -> ChaCha8Rng {
    stream(b"asperity conv v1", [seed, fnv1a(name.as_bytes())], repeat)
}

/// The stream of chunk `chunk` of the points on realisation `realisation` under `seed`.
pub fn point_stream(seed: u64, realisation: u64, chunk: u64) -> ChaCha8Rng {
    stream(b"asperity pts  v1", [seed, realisation], chunk)
}

/// The stream of row `row` in pass `pass` of a picture under `seed`.
pub fn picture_stream(seed: u64, pass: u64, row: u64) -> ChaCha8Rng {
    stream(b"asperity pict v1", [seed, pass], row)
}

/// A ChaCha stream: its key holds a name, which keeps streams of different uses apart, and two numbers.
fn stream(name: &[u8; 16], [a, b]: [u64; 2], number: u64) -> ChaCha8Rng {
    let mut key = [0_u8; 32];
    key[..16].copy_from_slice(name);
    key[16..24].copy_from_slice(&a.to_le_bytes());
    key[24..].copy_from_slice(&b.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(number);
    rng
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    #[test]
    fn streams_differ_in_each_of_their_numbers() {
        let draw = |seed, pass, row| picture_stream(seed, pass, row).random::<u64>();
        let reference = draw(1, 2, 3);
        assert_eq!(draw(1, 2, 3), reference);
        for other in [draw(2, 2, 3), draw(1, 3, 3), draw(1, 2, 4), draw(2, 1, 3)] {
            assert_ne!(other, reference);
        }
    }
}
