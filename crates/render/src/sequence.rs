//! Sequence: the random numbers of samples, whose first dimensions fill their ranges evenly.

use std::convert::Infallible;

use asperity_simulate::picture_stream;
use rand::{Rng, RngExt, TryRng};
use sobol_burley::sample_4d;

/// Dimensions that are spread evenly, in sets of four.
const EVEN_SETS: u32 = 4;

/// Samples of one scramble.
const LENGTH: u64 = 1 << 16;

/// Number of the streams of scrambles and of sun directions; those of samples count from zero.
const SCRAMBLES: u64 = u64::MAX;

/// Scrambles of the pixels of a row, one after the other, for a sequence.
pub(crate) fn scrambles(seed: u64, sequence: u64, row: usize) -> impl Iterator<Item = u32> {
    let mut rng = picture_stream(seed, SCRAMBLES - sequence, row as u64);
    std::iter::repeat_with(move || rng.random())
}

/// Two numbers in `[0, 1)` that are shared by all pixels of a pass in a sequence; `number` counts through all of them.
///
/// They fill the square evenly over all sequences together, so that the scatter between sequences overstates the error of what all pixels
/// share.
pub(crate) fn shared_numbers(seed: u64, number: u64) -> [f64; 2] {
    let mut rng = picture_stream(seed, SCRAMBLES, SCRAMBLES);
    let scramble = rng.random();
    let mut numbers = SampleNumbers::new(number, scramble, &mut rng);
    [numbers.random(), numbers.random()]
}

/// Random numbers of one sample: the first ones are those of a scrambled Sobol sequence, the others of a generator.
///
/// # Source
/// Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4).
pub(crate) struct SampleNumbers<'r, R> {
    sample: u32,
    scramble: u32,
    dimension: u32,
    set: [f32; 4],
    rng: &'r mut R,
}

impl<'r, R: Rng> SampleNumbers<'r, R> {
    /// Random numbers of sample `sample` of the sequence with that scramble; `rng` gives the digits that it does not have.
    pub(crate) fn new(sample: u64, scramble: u32, rng: &'r mut R) -> Self {
        Self {
            sample: (sample % LENGTH) as u32,
            // Another sequence after each whole one
            scramble: scramble.wrapping_add((sample / LENGTH) as u32),
            dimension: 0,
            set: [0.0; 4],
            rng,
        }
    }
}

impl<R: Rng> TryRng for SampleNumbers<'_, R> {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.next_u64() >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let (set, place) = (self.dimension / 4, self.dimension as usize % 4);
        if set == EVEN_SETS {
            return Ok(self.rng.next_u64());
        }
        if place == 0 {
            self.set = sample_4d(self.sample, set, self.scramble);
        }
        self.dimension += 1;
        // Single precision has 24 digits.
        let even = (f64::from(self.set[place]) * f64::from(1 << 24)) as u64;
        Ok(even << 40 | self.rng.next_u64() >> 24)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let number = self.next_u64().to_le_bytes();
            chunk.copy_from_slice(&number[..chunk.len()]);
        }
        Ok(())
    }
}
