//! Light on surfaces whose answer is known exactly.

mod branches;
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
