//! Light on surfaces whose answer is known exactly.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod branches;
#[path = "../common/mod.rs"]
mod common;
mod energy;
mod known;
mod starts;
mod symmetries;

use asperity_optics::Material;
use asperity_tally::{TallyResult, TallyStatistics};
use asperity_tracer::{Branching, PathSettings};

const GLASS: f64 = 1.5;

fn glass() -> Material {
    Material::dielectric(GLASS).unwrap()
}

/// Both branches always: no roulette, so that budgets hold ray by ray.
fn exhaustive() -> PathSettings {
    PathSettings::new(Branching::Split, 1e-6, 1_000_000).unwrap()
}

fn budget(statistics: &TallyStatistics) -> f64 {
    statistics.means().budget().total()
}
