//! The random walk in lanes against the scalar walk: ratios of time by smoothness, medians of interleaved pairs on one thread.
//!
//! The scalar walk also tallies light scattered once, which the walk in lanes leaves to the density.
//!
//! Run with `cargo bench -p asperity-analysis --bench walk`; `ASPERITY_INSTRUCTIONS` takes other vector instructions.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and ends where it fails"
)]

use std::time::Instant;

use asperity_analysis::{Heitz, HeitzPolarised, RandomWalk, SlopeCovariance};
use asperity_optics::{Material, from_spherical};
use asperity_tally::{Azimuth, Tally, TallySpec};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const RAYS: u64 = 100_000;
const PAIRS: u64 = 9;

fn main() {
    let glass = Material::dielectric(1.5).unwrap();
    let wi = from_spherical(f64::to_radians(30.0), 0.0);
    println!(
        "{:<16} {:>3} {:>16} {:>16} {:>7}",
        "walk", "s", "scalar, ns/ray", "lanes, ns/ray", "ratio"
    );
    for s in [6.0, 3.0, 2.0, 1.0] {
        let slopes = SlopeCovariance::isotropic(s).unwrap();
        let walks: [(&str, Box<dyn RandomWalk>); 2] = [
            ("heitz", Box::new(Heitz::new(slopes, glass).unwrap())),
            (
                "heitz-polarised",
                Box::new(HeitzPolarised::new(slopes, glass).unwrap()),
            ),
        ];
        for (name, walk) in &walks {
            let seconds = |seed: u64, follow: &dyn Fn(&mut ChaCha8Rng, &mut Tally<'_>)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let mut tally = Tally::new(TallySpec::default(), Azimuth::From(0.0));
                let begin = Instant::now();
                follow(&mut rng, &mut tally);
                begin.elapsed().as_secs_f64()
            };
            let mut pairs: Vec<[f64; 2]> = (0..PAIRS)
                .map(|seed| {
                    let scalar = seconds(seed, &|rng, tally| {
                        (0..RAYS).for_each(|_| walk.follow(wi, rng, tally));
                    });
                    [
                        scalar,
                        seconds(seed, &|rng, tally| walk.follow_all(wi, RAYS, rng, tally)),
                    ]
                })
                .collect();
            pairs.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
            let [scalar, lanes] = pairs[pairs.len() / 2];
            let nanoseconds = |t: f64| 1e9 * t / RAYS as f64;
            println!(
                "{name:<16} {s:>3} {:>16.0} {:>16.0} {:>7.2}",
                nanoseconds(scalar),
                nanoseconds(lanes),
                scalar / lanes
            );
        }
    }
}
