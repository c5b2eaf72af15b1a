//! Random numbers of light paths: each is a function of the path and of the step along it.
//!
//! A number depends on the seed, the surface, the path and the step alone, not on the order in which paths are
//! traced, on how many are traced together, or on threads. The generator is [`threefry`].
//!
//! | word | bits | holds |
//! |---|---|---|
//! | key 0 | 64 | seed |
//! | key 1 | 64 | number of the surface |
//! | counter 0 | 0 to 55 | number of the path, from zero for each surface |
//! | | 56 to 59 | number of the pair of a [`Draws`], for more than two numbers |
//! | | 60 to 63 | [`Use`] |
//! | counter 1 | 0 to 31 | step: interactions and scatterings so far |
//! | | 32 to 63 | events of the path so far, bit by bit, so that branches of one path differ |
//!
//! Two branches that part after their 32nd interaction share numbers; each alone is as random as any other path.

use std::convert::Infallible;

use asperity_numerics::random::{threefry, unit};
use asperity_tally::EventPath;
use rand::TryRng;

/// Purpose of the random numbers of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Use {
    /// Start position of a path.
    Start,
    /// Branches and Russian roulette at an interface.
    Interaction,
    /// Direction of diffuse reflection.
    Diffuse,
    /// Choice of paths that look for shadowed facets behind the first.
    Shadow,
    /// Free flight that begins at an interface.
    Flight,
    /// Scattering in a medium, and the free flight that follows.
    Medium,
    /// Scrambling of quasi-random starts; the path is the first of its batch.
    Scramble,
    /// Direction of light that comes from several.
    Direction,
}

/// The random numbers of the paths on one surface.
///
/// # Examples
/// ```
/// use asperity_tracer::PathStream;
///
/// // Paths 1000 and above on surface 3 under seed 1
/// let stream = PathStream::new(1, 3).from_path(1000);
/// assert_eq!(stream.of_start(7), PathStream::new(1, 3).of_start(1007));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathStream {
    key: [u64; 2],
    first: u64,
}

/// Paths of one surface have numbers below this.
const MAX_PATHS: u64 = 1 << 56;

/// Binary digits of the number of a path in its batch.
const BATCH_DIGITS: u32 = 20;

impl PathStream {
    /// The numbers of all paths on surface number `realisation` under `seed`.
    #[must_use]
    pub const fn new(seed: u64, realisation: u64) -> Self {
        Self {
            key: [seed, realisation],
            first: 0,
        }
    }

    /// Seed and number of the surface, and number of its first path: all that its numbers depend on.
    #[must_use]
    pub const fn key(&self) -> ([u64; 2], u64) {
        (self.key, self.first)
    }

    /// Most paths of a batch that is traced together with others: those of batch `n` have numbers from `n` times this on.
    pub const MAX_PATHS_OF_BATCH: u64 = 1 << BATCH_DIGITS;

    /// This stream from the first path of batch number `batch` on, where batches have up to
    /// [`PathStream::MAX_PATHS_OF_BATCH`] paths.
    ///
    /// # Panics
    /// If `batch` is not below `2^36`.
    #[must_use]
    pub const fn from_batch(self, batch: u64) -> Self {
        assert!(
            batch < MAX_PATHS >> BATCH_DIGITS,
            "batches have numbers below 2^36"
        );
        self.from_path(batch << BATCH_DIGITS)
    }

    /// Number of the path that is number `path` of batch number `batch`, counted from the first path of the stream.
    #[inline(always)]
    pub(crate) const fn ray(batch: u32, path: u32) -> u32 {
        batch << BATCH_DIGITS | path
    }

    /// The batch of a path of that number.
    #[inline(always)]
    pub(crate) const fn batch_of(ray: u32) -> u32 {
        ray >> BATCH_DIGITS
    }

    /// This stream from path number `first` on.
    ///
    /// # Panics
    /// If `first` is not below `2^56`.
    #[must_use]
    pub const fn from_path(self, first: u64) -> Self {
        assert!(first < MAX_PATHS, "paths have numbers below 2^56");
        Self { first, ..self }
    }

    /// The numbers in `[0, 1)` that place the start of path number `ray` of this stream in its stratum.
    #[must_use]
    pub fn of_start(self, ray: u32) -> [f64; 2] {
        self.pair(ray, Step::START, Use::Start)
    }

    /// The numbers in `[0, 1)` of an interaction of path number `ray` of this stream that has had the interactions
    /// `path` and `scatterings` in a medium: the first picks the branch, and is that of Russian roulette over
    /// transmission where both branches are followed; the second is that of roulette over the other branch.
    #[must_use]
    pub fn of_interaction(self, ray: u32, path: EventPath, scatterings: u32) -> [f64; 2] {
        let step = Step {
            number: path.order().wrapping_add(scatterings),
            events: path.code(),
        };
        self.pair(ray, step, Use::Interaction)
    }

    /// The two numbers in `[0, 1)` of a step of path number `ray` of this stream.
    #[inline(always)]
    pub(crate) fn pair(self, ray: u32, step: Step, of: Use) -> [f64; 2] {
        self.pair_number(0, ray, step, of)
    }

    /// The pair of random numbers of [`PathStream::draws`] that comes after `pair` others, which are fewer than 16.
    #[inline(always)]
    pub(crate) fn pair_number(self, pair: u64, ray: u32, step: Step, of: Use) -> [f64; 2] {
        threefry(self.key, self.counter(ray, step, of, pair)).map(unit)
    }

    /// Any number of random numbers of a step of path number `ray` of this stream.
    pub(crate) const fn draws(self, ray: u32, step: Step, of: Use) -> Draws {
        Draws {
            stream: self,
            ray,
            step,
            of,
            pair: 0,
            spare: None,
        }
    }

    #[inline(always)]
    const fn counter(self, ray: u32, step: Step, of: Use, pair: u64) -> [u64; 2] {
        let path = self.first + ray as u64;
        [
            path | pair << 56 | (of as u64) << 60,
            step.number as u64 | (step.events as u64) << 32,
        ]
    }
}

/// Step along a path at which random numbers are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    /// Interactions and scatterings so far.
    pub(crate) number: u32,
    /// Events so far, bit by bit.
    pub(crate) events: u32,
}

impl Step {
    /// Before anything has happened.
    pub(crate) const START: Self = Self {
        number: 0,
        events: 0,
    };
}

/// The random numbers of one step, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Draws {
    stream: PathStream,
    ray: u32,
    step: Step,
    of: Use,
    pair: u64,
    spare: Option<u64>,
}

impl TryRng for Draws {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.try_next_u64()? >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        if let Some(word) = self.spare.take() {
            return Ok(word);
        }
        // Scrambling takes more pairs than have numbers: it has all steps for itself.
        let step = Step {
            number: self.step.number + (self.pair >> 4) as u32,
            ..self.step
        };
        let counter = self
            .stream
            .counter(self.ray, step, self.of, self.pair & 0xf);
        let [word, spare] = threefry(self.stream.key, counter);
        self.pair += 1;
        self.spare = Some(spare);
        Ok(word)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            let word = self.try_next_u64()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn numbers_differ_in_each_part_of_their_place() {
        let stream = PathStream::new(1, 2).from_path(3);
        let step = Step {
            number: 4,
            events: 5,
        };
        let pair = |stream: PathStream, ray, number, events, of| {
            stream.pair(ray, Step { number, events }, of)
        };
        let all = [
            stream.pair(6, step, Use::Interaction),
            pair(
                PathStream::new(2, 2).from_path(3),
                6,
                4,
                5,
                Use::Interaction,
            ),
            pair(
                PathStream::new(1, 3).from_path(3),
                6,
                4,
                5,
                Use::Interaction,
            ),
            pair(stream, 7, 4, 5, Use::Interaction),
            pair(stream, 6, 5, 5, Use::Interaction),
            pair(stream, 6, 4, 4, Use::Interaction),
            pair(stream, 6, 4, 5, Use::Flight),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
        // Path 9 is the same however it is reached.
        assert_eq!(
            all[0],
            pair(PathStream::new(1, 2), 9, 4, 5, Use::Interaction)
        );
    }

    #[test]
    fn draws_begin_with_the_pair_and_do_not_repeat() {
        let stream = PathStream::new(1, 2);
        let mut draws = stream.draws(3, Step::START, Use::Scramble);
        let numbers: Vec<f64> = (0..5000).map(|_| draws.random()).collect();
        for (pair, numbers) in (0..16).zip(numbers.chunks(2)) {
            let found = stream.pair_number(pair, 3, Step::START, Use::Scramble);
            assert_eq!(numbers, found);
        }
        let mut sorted = numbers;
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        assert_eq!(sorted.len(), 5000);
    }

    /// Pairs of consecutive paths, steps and branches in 16 x 16 cells: the chi-squared of a million of
    /// each, |z| < 4.
    #[test]
    fn numbers_of_neighbours_are_uniform_and_independent() {
        let stream = PathStream::new(7, 0);
        let step = |number, events| Step { number, events };
        let interaction = |ray, step| stream.pair(ray, step, Use::Interaction)[0];
        type Neighbours<'a> = &'a dyn Fn(u32) -> [f64; 2];
        let kinds: [(&str, Neighbours<'_>); 4] = [
            ("words", &|i| stream.pair(i, Step::START, Use::Interaction)),
            ("paths", &|i| {
                [2 * i, 2 * i + 1].map(|ray| interaction(ray, step(1, 0)))
            }),
            ("steps", &|i| {
                [1, 2].map(|number| interaction(i, step(number, 0)))
            }),
            ("branches", &|i| {
                [0, 1].map(|events| interaction(i, step(1, events)))
            }),
        ];
        for (name, pair) in kinds {
            let mut counts = [0_u32; 256];
            let total = 1_000_000;
            for i in 0..total {
                let [u, v] = pair(i).map(|u| (16.0 * u) as usize);
                counts[16 * u + v] += 1;
            }
            let expected = f64::from(total) / 256.0;
            let chi_squared: f64 = counts
                .iter()
                .map(|n| (f64::from(*n) - expected).powi(2) / expected)
                .sum();
            let z = (chi_squared - 255.0) / (2.0_f64 * 255.0).sqrt();
            println!("{name}: z = {z:.2}");
            assert!(z.abs() < 4.0, "{name}: z = {z}");
        }
    }
}
