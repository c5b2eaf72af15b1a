//! Sampling: start positions of rays in the mean plane, and their azimuths; random, stratified or quasi-random.

use std::fmt;
use std::str::FromStr;

use asperity_numerics::elementary::pow;
use rand::RngExt;
use serde::{Deserialize, Serialize};

use self::jitter::Jitter;
use self::net::Net;
use crate::random::{PathStream, Step, Use};
use crate::sampling::morton::morton_position;
use crate::vector::Instructions;

mod jitter;
pub(crate) mod morton;
mod net;
mod start;
mod strata;

pub(crate) use self::start::Start;
pub use self::strata::BatchedRays;
use self::strata::Strata;

/// Distribution of the rays of a batch over the mean plane and, where it is free, over azimuth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// Each ray anywhere, whatever the others do.
    Random,
    /// One ray in each stratum of the mean plane; azimuths anywhere.
    #[default]
    Stratified,
    /// One ray in each stratum, and evenly spread over position and azimuth together: Owen-scrambled
    /// Sobol points, as many as rays.
    QuasiRandom,
}

impl Sampling {
    /// Most strata along a side that a batch of quasi-random rays may have: its `2^20` points take
    /// 24 MiB while they are drawn and 12 MiB afterwards.
    pub const MAX_QUASI_RANDOM_STRATA: u32 = 1 << 10;

    /// Returns `true` if a batch of quasi-random rays may have `strata` along a side: powers of two up to
    /// [`Sampling::MAX_QUASI_RANDOM_STRATA`]. Other batches may have any number.
    #[must_use]
    pub const fn quasi_random_strata(strata: u32) -> bool {
        strata.is_power_of_two() && strata <= Self::MAX_QUASI_RANDOM_STRATA
    }
}

impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Random => "random",
            Self::Stratified => "stratified",
            Self::QuasiRandom => "quasi-random",
        })
    }
}

impl FromStr for Sampling {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "random" => Ok(Self::Random),
            "stratified" => Ok(Self::Stratified),
            "quasi-random" => Ok(Self::QuasiRandom),
            _ => Err(format!(
                "unknown sampling `{text}`; allowed are random, stratified and quasi-random"
            )),
        }
    }
}

/// Start positions of rays, neighbours together: along a Morton curve.
pub(crate) struct Positions {
    order: Order,
    any_azimuth: bool,
    stream: PathStream,
}

enum Order {
    Random(Shuffle),
    Stratified(Strata),
    QuasiRandom(Net),
}

impl Positions {
    /// Positions of the paths of `stream`, from its first on.
    ///
    /// # Panics
    /// For the reasons of [`crate::Tracer::batches`].
    pub(crate) fn new(
        sampling: Sampling,
        rays: &BatchedRays,
        any_azimuth: bool,
        stream: PathStream,
    ) -> Self {
        assert!(
            sampling == Sampling::Stratified || rays.is_one_batch(),
            "only stratified rays of several batches are traced together"
        );
        let strata = rays.strata();
        let order = match sampling {
            Sampling::Random => Order::Random(Shuffle::new(rays.rays_of_batch())),
            Sampling::Stratified => Order::Stratified(Strata::new(rays)),
            Sampling::QuasiRandom => {
                assert!(
                    Sampling::quasi_random_strata(strata),
                    "{strata} strata along a side of a quasi-random batch"
                );
                let mut draws = stream.draws(0, Step::START, Use::Scramble);
                Order::QuasiRandom(Net::new(strata, any_azimuth, &mut draws))
            }
        };
        Self {
            order,
            any_azimuth,
            stream,
        }
    }

    /// The next starts, at most `count`; `starts` is cleared.
    pub(crate) fn draw_many(
        &mut self,
        count: usize,
        instructions: Instructions,
        starts: &mut Vec<Start>,
    ) {
        starts.clear();
        let (stream, any_azimuth) = (self.stream, self.any_azimuth);
        let size = match &mut self.order {
            Order::Random(shuffle) => {
                let draw = || shuffle.draw(stream, any_azimuth);
                starts.extend(std::iter::from_fn(draw).take(count));
                return;
            }
            Order::Stratified(strata) => {
                starts.extend(strata.by_ref().take(count));
                [strata.width(), strata.width(), 1.0]
            }
            Order::QuasiRandom(net) => {
                starts.extend(net.by_ref().take(count));
                [net.width(); 3]
            }
        };
        instructions.run(Jitter {
            stream,
            size,
            any_azimuth,
            starts,
        });
    }

    /// All starts that are left.
    #[cfg(test)]
    fn draw_all(mut self) -> Vec<Start> {
        let mut starts = Vec::new();
        self.draw_many(usize::MAX, Instructions::best(), &mut starts);
        starts
    }
}

/// Independent uniform points of the unit square, as if drawn and then sorted along a Morton curve,
/// but drawn in that order and held nowhere.
///
/// The curve keeps areas, so its parameter is uniform, and points come in its order if parameters
/// come sorted. Of `left` parameters uniform between `t` and 1, the smallest leaves
/// `(1 - t) U^(1 / left)` above it, where `U` is uniform (Bentley and Saxe, ACM Trans. Math. Softw. 6,
/// 359 (1980)). The curve is followed to squares of `2^-16`; within one, points are anywhere.
struct Shuffle {
    count: u64,
    /// Number of the next start.
    next: u32,
    /// One minus the parameter.
    above: f64,
}

impl Shuffle {
    /// Levels of the curve.
    const LEVELS: u32 = 16;

    const fn new(count: u64) -> Self {
        Self {
            count,
            next: 0,
            above: 1.0,
        }
    }

    /// The next start; `None` after the last.
    fn draw(&mut self, stream: PathStream, any_azimuth: bool) -> Option<Start> {
        let ray = self.next;
        let left = self.count - u64::from(ray);
        if left == 0 {
            return None;
        }
        self.next += 1;
        let rng = &mut stream.draws(ray, Step::START, Use::Start);
        self.above *= pow(rng.random::<f64>(), 1.0 / left as f64);
        let squares = (1_u64 << (2 * Self::LEVELS)) as f64;
        let square = ((1.0 - self.above) * squares).min(squares - 1.0);
        let width = 1.0 / f64::from(1 << Self::LEVELS);
        let [u, v] = morton_position(square as u64)
            .map(|index| (f64::from(index) + rng.random::<f64>()) * width);
        let azimuth = if any_azimuth { rng.random() } else { 0.0 };
        let position = [u, v, azimuth];
        Some(Start { position, ray })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec2;

    use super::*;
    use crate::sampling::morton::{MortonSquare, morton_code};

    const ALL: [Sampling; 3] = [
        Sampling::Random,
        Sampling::Stratified,
        Sampling::QuasiRandom,
    ];

    /// All starts of a batch, with azimuths.
    fn starts(sampling: Sampling, strata: u32, seed: u64) -> Vec<[f64; 3]> {
        starts_with(sampling, strata, true, seed)
    }

    fn starts_with(sampling: Sampling, strata: u32, any_azimuth: bool, seed: u64) -> Vec<[f64; 3]> {
        let rays = BatchedRays::of_one(strata);
        let positions = Positions::new(sampling, &rays, any_azimuth, PathStream::new(seed, 0));
        let starts = positions.draw_all();
        starts.into_iter().map(|start| start.position).collect()
    }

    /// `(x - dof) / sqrt(2 dof)` of a chi-squared of counts that are all expected to be equal; near to
    /// normal, since there are hundreds of cells.
    fn z_of_equal_counts(counts: &[u32]) -> f64 {
        let expected = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
        let chi_squared: f64 = counts
            .iter()
            .map(|n| (f64::from(*n) - expected).powi(2) / expected)
            .sum();
        let dof = counts.len() as f64 - 1.0;
        (chi_squared - dof) / (2.0 * dof).sqrt()
    }

    #[test]
    fn a_start_depends_on_the_number_of_its_path_alone() {
        let stream = PathStream::new(7, 0);
        for any_azimuth in [false, true] {
            let plain: Vec<[f64; 3]> = (0..)
                .zip(MortonSquare::new(5, 0))
                .map(|(path, [column, row])| {
                    let mut draws = stream.draws(path, Step::START, Use::Start);
                    let u = (f64::from(column) + draws.random::<f64>()) * (1.0 / 5.0);
                    let v = (f64::from(row) + draws.random::<f64>()) * (1.0 / 5.0);
                    let azimuth = if any_azimuth { draws.random() } else { 0.0 };
                    [u, v, azimuth]
                })
                .collect();
            assert_eq!(starts_with(Sampling::Stratified, 5, any_azimuth, 7), plain);
        }
    }

    #[test]
    fn each_stratum_has_one_start_and_they_come_along_the_curve() {
        for sampling in [Sampling::Stratified, Sampling::QuasiRandom] {
            for strata in [1, 2, 16, 128] {
                for any_azimuth in [false, true] {
                    let starts = starts_with(sampling, strata, any_azimuth, 3);
                    assert_eq!(starts.len(), (strata * strata) as usize);
                    for ([u, v, azimuth], position) in
                        starts.into_iter().zip(MortonSquare::new(strata, 0))
                    {
                        let stratum = [u, v].map(|x| (x * f64::from(strata)) as u32);
                        assert_eq!(stratum, position, "{sampling} {strata}");
                        assert_eq!(azimuth != 0.0, any_azimuth);
                    }
                }
            }
        }
    }

    #[test]
    fn random_starts_are_as_many_and_come_along_the_curve() {
        for strata in [1, 3, 40] {
            let starts = starts(Sampling::Random, strata, 4);
            assert_eq!(starts.len(), (strata * strata) as usize);
            let codes = starts.iter().map(|[u, v, _]| {
                morton_code([u, v].map(|x| (x * f64::from(1 << Shuffle::LEVELS)) as u32))
            });
            assert!(codes.is_sorted());
        }
    }

    /// Among them are all strips of azimuth times u, and of azimuth times v.
    #[test]
    fn quasi_random_starts_are_one_in_each_box_of_equal_volume() {
        for k in 0..=4_i32 {
            let m = 2 * k;
            for seed in 0..5 {
                let starts = starts(Sampling::QuasiRandom, 1 << k, seed);
                for a in 0..=m {
                    for b in 0..=m - a {
                        let sides = [a, b, m - a - b];
                        let mut found = vec![0; 1 << m];
                        for start in &starts {
                            let index = start.iter().zip(sides).fold(0, |index, (x, side)| {
                                (index << side) + (x * 2_f64.powi(side)) as usize
                            });
                            found[index] += 1;
                        }
                        assert!(found.iter().all(|n| *n == 1), "{sides:?} of seed {seed}");
                    }
                }
            }
        }
    }

    /// One start of each of 51200 batches of 16, in 8 x 8 x 8 cells, each finer than a stratum and than
    /// the box that is the start's own: they are independent, 100 to a cell. |z| < 4 fails once in 1e4.
    #[test]
    fn each_start_is_uniform() {
        for sampling in ALL {
            let mut counts = vec![0; 512];
            for seed in 0..51_200 {
                let starts = starts(sampling, 4, seed);
                let [u, v, azimuth] = starts[seed as usize % starts.len()];
                let [u, v, azimuth] = [u, v, azimuth].map(|x| (8.0 * x) as usize);
                counts[(u * 8 + v) * 8 + azimuth] += 1;
            }
            let z = z_of_equal_counts(&counts);
            println!("{sampling}: z = {z:.2}");
            assert!(z.abs() < 4.0, "{sampling}: z = {z}");
        }
    }

    /// Whatever is spread more evenly than at random has too small a chi-squared within a batch.
    #[test]
    fn random_starts_do_not_know_of_each_other() {
        let mut counts = vec![0; 512];
        for [u, v, azimuth] in starts(Sampling::Random, 256, 11) {
            let [u, v, azimuth] = [u, v, azimuth].map(|x| (8.0 * x) as usize);
            counts[(u * 8 + v) * 8 + azimuth] += 1;
        }
        let z = z_of_equal_counts(&counts);
        println!("z = {z:.2}");
        assert!(z.abs() < 4.0, "z = {z}");
    }

    /// Mean square error, over batches, of the mean of `f` over a batch; `exact`: its true mean.
    fn mean_square_error(
        sampling: Sampling,
        strata: u32,
        batches: u64,
        exact: f64,
        f: impl Fn([f64; 3]) -> f64,
    ) -> f64 {
        let squares = (0..batches).map(|seed| {
            let starts = starts(sampling, strata, 1000 + seed);
            let n = starts.len() as f64;
            (starts.into_iter().map(&f).sum::<f64>() / n - exact).powi(2)
        });
        squares.sum::<f64>() / batches as f64
    }

    /// The mean of `u + v + azimuth` over `n` starts has the variance `3 / 12 / n` if they are random. In strata of
    /// width `w = n^(-1/2)`, a position varies by `w^2 / 12`, so `(2 / n + 1) / 12 / n`. Quasi-random ones
    /// have each coordinate in `n` strata, and their digits are scrambled apart: `3 / 12 / n^3`. The mean
    /// of `b` squares of a near to normal number scatters by `sqrt(2 / b)`, here 3.2 %; 4 of these.
    #[test]
    fn variance_of_a_linear_integrand_is_as_derived() {
        let batches = 2000;
        for strata in [1, 4, 16] {
            let n = f64::from(strata * strata);
            for (sampling, expected) in [
                (Sampling::Random, 0.25 / n),
                (Sampling::Stratified, (2.0 / n + 1.0) / 12.0 / n),
                (Sampling::QuasiRandom, 0.25 / n.powi(3)),
            ] {
                let found = mean_square_error(sampling, strata, batches, 1.5, |x| x.iter().sum());
                let ratio = found / expected;
                println!("{sampling}, {n} starts: {ratio:.3}");
                assert!((ratio - 1.0).abs() < 4.0 * (2.0 / batches as f64).sqrt());
            }
        }
    }

    /// From 64 to 4096 starts the error of random ones falls by 64. Of a smooth integrand that no
    /// coordinate has a part of its own in, scrambled nets promise `n^-3 log^2 n`, here 6.6e4 (Owen,
    /// Ann. Stat. 25, 1541 (1997)); strata, which know no azimuth, stay at 64, each
    /// within 4 times its scatter, 10 %.
    #[test]
    fn quasi_random_error_of_a_smooth_integrand_falls_faster_than_of_random_starts() {
        let smooth = |[u, v, azimuth]: [f64; 3]| {
            (1.0 + (TAU * u).cos()) * (1.0 + v * v) * (1.0 + (TAU * (azimuth + u)).sin())
        };
        let exact = 4.0 / 3.0;
        for (sampling, least, most) in [
            (Sampling::Random, 40.0, 100.0),
            (Sampling::Stratified, 40.0, 100.0),
            (Sampling::QuasiRandom, 4000.0, f64::INFINITY),
        ] {
            let error = |strata| mean_square_error(sampling, strata, 400, exact, smooth);
            let (few, many) = (error(8), error(64));
            println!("{sampling}: {few:.2e} to {many:.2e}, by {:.0}", few / many);
            assert!((least..most).contains(&(few / many)), "{sampling}");
        }
    }

    #[test]
    fn turns_are_those_of_azimuths() {
        for [u, v, azimuth] in starts(Sampling::Stratified, 16, 2) {
            let position = [u, v, azimuth];
            let turn = Start { position, ray: 0 }.turn();
            assert!((turn - DVec2::from_angle(TAU * azimuth)).length() < 1e-15);
        }
        let position = [0.3, 0.7, 0.0];
        assert_eq!(Start { position, ray: 0 }.turn(), DVec2::X);
    }

    #[test]
    fn starts_depend_on_the_generator_alone() {
        for sampling in ALL {
            assert_eq!(starts(sampling, 8, 5), starts(sampling, 8, 5));
            assert_ne!(starts(sampling, 8, 5), starts(sampling, 8, 6));
        }
    }

    #[test]
    #[should_panic(expected = "12 strata")]
    fn quasi_random_strata_are_a_power_of_two() {
        starts(Sampling::QuasiRandom, 12, 0);
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for sampling in ALL {
            assert_eq!(sampling.to_string().parse(), Ok(sampling));
        }
        assert!("sobol".parse::<Sampling>().is_err());
    }
}
