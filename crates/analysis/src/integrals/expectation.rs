//! Expectation of a model for a run: a tally of the same layout, with errors where it was sampled.

use asperity_optics::Incidence;
use asperity_tally::{
    Azimuth, BatchStatistics, Event, EventPath, Layout, OrderClass, Record, Share, Side,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::integrals::energy::hemispherical_energy;
use crate::integrals::flux::{bin_fluxes_of, in_plane_fluxes};
use crate::models::model::{BsdfModel, RandomWalk, ScatteringModel, Scope};
use crate::numerics::hash::fnv1a;

/// Number of rays of a random walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplingEffort {
    /// Rays in total.
    pub rays: u64,
    /// Independent batches, two or more; one per surface if the model is compared with surfaces.
    pub batches: u64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Fluxes that a model expects, entry by entry of a layout.
#[derive(Clone, Debug)]
pub struct Expectation {
    layout: Layout,
    scope: Scope,
    /// One record per batch, or a single one if it is exact to the accuracy of quadrature.
    records: Vec<Vec<f64>>,
    statistics: BatchStatistics,
    rays: u64,
    /// Whether single scattering comes from quadrature.
    exact_single: bool,
}

/// Computes what `model` expects of light from `incidence` in a tally of `layout`.
///
/// `azimuth`: the origin of azimuths in the tally, as in the run that it is compared with.
/// Entries that the model does not describe are zero. Light scattered once comes from quadrature where
/// the model has a density, to about 1e-12 of the incident flux in a bin; all else from `effort.rays`
/// rays, divided into batches with separate random streams: the same for any number of threads. Where exact
/// single scattering replaces sampled one, energies add to one within errors only.
#[must_use]
pub fn expect(
    model: &dyn ScatteringModel,
    incidence: Incidence,
    layout: &Layout,
    azimuth: Azimuth,
    effort: SamplingEffort,
) -> Expectation {
    let single = model
        .density()
        .map(|density| single_scattering(density, incidence, layout));
    let exact_single = single.is_some();
    let (records, rays) = match (model.random_walk(), single) {
        (None, single) => (vec![single.unwrap_or_else(|| vec![0.0; layout.len()])], 0),
        (Some(walk), single) => {
            let batches = effort.batches.max(2);
            let rays = effort.rays.div_ceil(batches).max(1);
            let records = (0..batches)
                .into_par_iter()
                .map(|batch| {
                    let rng = walk_stream(effort.seed, model.name(), batch);
                    let mut record = batch_of(walk, incidence, layout, azimuth, rays, rng);
                    if let Some(single) = &single {
                        replace_single(layout, &mut record, single);
                    }
                    record
                })
                .collect();
            (records, rays * batches)
        }
    };
    Expectation {
        exact_single,
        ..Expectation::of(*layout, model.scope(), records, rays)
    }
}

impl Expectation {
    pub(crate) fn of(layout: Layout, scope: Scope, records: Vec<Vec<f64>>, rays: u64) -> Self {
        let statistics = match records.as_slice() {
            [exact] => BatchStatistics::known(exact.clone(), vec![0.0; exact.len()]),
            batches => {
                let mut statistics = BatchStatistics::new(layout.len());
                batches.iter().for_each(|batch| statistics.push(batch));
                statistics
            }
        };
        Self {
            layout,
            scope,
            records,
            statistics,
            rays,
            exact_single: false,
        }
    }

    /// The layout of the entries.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Means and standard errors; the error is zero where the model was not sampled.
    #[must_use]
    pub const fn statistics(&self) -> &BatchStatistics {
        &self.statistics
    }

    /// One record per batch, or a single one if it is exact.
    #[must_use]
    pub fn records(&self) -> &[Vec<f64>] {
        &self.records
    }

    /// Whether no entry was sampled.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.rays == 0
    }

    /// Number of rays; zero if the expectation is exact.
    #[must_use]
    pub const fn rays(&self) -> u64 {
        self.rays
    }

    /// Whether this component of the light was sampled, at least in part.
    #[must_use]
    pub fn samples(&self, share: Share) -> bool {
        let known = share == Share::Single && self.exact_single;
        !(self.is_exact() || known)
    }

    /// Whether the model describes this component of the light scattered by the surface.
    #[must_use]
    pub fn describes(&self, share: Share) -> bool {
        match self.scope {
            Scope::SingleScattering => share == Share::Single,
            Scope::AllOrders => true,
            Scope::ScatteredInside => false,
        }
    }
}

/// The tally of a closed form: single scattering alone.
fn single_scattering(density: &dyn BsdfModel, incidence: Incidence, layout: &Layout) -> Vec<f64> {
    let wi = incidence.wi();
    let grid = layout.grid();
    let mut record = vec![0.0; layout.len()];
    let sides = layout.sides().filter(|&side| density.sides().ask(side));
    let bins = bin_fluxes_of(density, wi, &grid, density.sides());
    let energy = hemispherical_energy(density, wi);
    for side in sides {
        let of_side = side.index() * grid.bins_per_side();
        for (i, &flux) in bins[of_side..][..grid.bins_per_side()].iter().enumerate() {
            for share in [Share::Single, Share::Total] {
                record[layout.bins(share).start + of_side + i] = flux;
            }
        }
        let rings: Vec<f64> = bins[of_side..][..grid.bins_per_side()]
            .chunks_exact(grid.n_phi())
            .map(|ring| ring.iter().sum())
            .collect();
        let in_plane = in_plane_fluxes(density, incidence, layout, side);
        for class in [OrderClass::First, OrderClass::All] {
            record[layout.rings(side, class)].copy_from_slice(&rings);
            record[layout.in_plane(side, class)].copy_from_slice(&in_plane);
        }
        let total = match side {
            Side::Reflected => energy.reflected,
            Side::Transmitted => energy.transmitted,
        };
        record[layout.order(side, 1)] = total;
        record[single_path(layout, side)] = total;
        record[side.index()] = total;
    }
    record
}

/// Replaces the single scattering of `record` by that of `single`.
fn replace_single(layout: &Layout, record: &mut [f64], single: &[f64]) {
    let mut replace = |single_entry: usize, total: usize| {
        let known = single[single_entry];
        record[total] += known - record[single_entry];
        record[single_entry] = known;
    };
    let grid = layout.grid();
    for i in 0..grid.len() {
        replace(
            layout.bins(Share::Single).start + i,
            layout.bins(Share::Total).start + i,
        );
    }
    for side in Side::BOTH {
        for i in 0..grid.n_theta() {
            replace(
                layout.rings(side, OrderClass::First).start + i,
                layout.rings(side, OrderClass::All).start + i,
            );
        }
        for i in 0..layout.in_plane_len() {
            replace(
                layout.in_plane(side, OrderClass::First).start + i,
                layout.in_plane(side, OrderClass::All).start + i,
            );
        }
        replace(layout.order(side, 1), side.index());
    }
    for side in Side::BOTH {
        let path = single_path(layout, side);
        record[path] = single[path];
    }
}

/// Entry of light that left on `side` after one interaction.
fn single_path(layout: &Layout, side: Side) -> usize {
    let event = match side {
        Side::Reflected => Event::Reflection,
        Side::Transmitted => Event::Transmission,
    };
    layout.path(side, EventPath::default().then(event))
}

fn batch_of(
    walk: &dyn RandomWalk,
    incidence: Incidence,
    layout: &Layout,
    azimuth: Azimuth,
    rays: u64,
    mut rng: ChaCha8Rng,
) -> Vec<f64> {
    let mut record = Record::new(*layout, azimuth);
    for _ in 0..rays {
        walk.follow(incidence.wi(), &mut rng, &mut record);
    }
    record.into_fractions(rays).to_vec()
}

/// The random stream of one batch. The ChaCha key holds a name, the seed and the model, and the batch is the
/// stream number. So models and batches are independent of each other and of surfaces and rays. Cases with the
/// same seed share their numbers, as they share surfaces.
fn walk_stream(seed: u64, model: &str, batch: u64) -> ChaCha8Rng {
    let mut key = [0_u8; 32];
    key[..16].copy_from_slice(b"asperity walk v1");
    key[16..24].copy_from_slice(&seed.to_le_bytes());
    key[24..].copy_from_slice(&fnv1a(model.as_bytes()).to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(batch);
    rng
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RayVisibility, SlopeCovariance, XuSunMonteCarlo};
    use asperity_optics::Material;
    use asperity_tally::HemisphereGrid;
    use rand::RngExt;

    fn first_draws(seed: u64, model: &str, batch: u64) -> [u64; 2] {
        let mut rng = walk_stream(seed, model, batch);
        [rng.random(), rng.random()]
    }

    #[test]
    fn seeds_models_and_batches_have_distinct_streams() {
        let mut draws = Vec::new();
        for seed in [0, 1, 2, 1 << 40] {
            for model in ["heitz", "xu-sun-mc", "xu-sun-mc-smith", ""] {
                draws.extend((0..16).map(|batch| first_draws(seed, model, batch)));
            }
        }
        assert_eq!(first_draws(2, "heitz", 3), first_draws(2, "heitz", 3));
        let all = draws.len();
        draws.sort_unstable();
        draws.dedup();
        assert_eq!(draws.len(), all);
    }

    #[test]
    fn batches_differ() {
        let grid = HemisphereGrid::new(3, 4).unwrap();
        let layout = Layout::new(grid, Layout::DEFAULT_HALF_WIDTH).unwrap();
        let slopes = SlopeCovariance::isotropic(0.5).unwrap();
        let glass = Material::dielectric(1.5).unwrap();
        let of = |visibility| {
            let model = XuSunMonteCarlo::new(slopes, glass, visibility).unwrap();
            let light = Incidence::from_degrees(50.0, 0.0).unwrap();
            let effort = SamplingEffort {
                rays: 160,
                batches: 8,
                seed: 5,
            };
            let found = expect(&model, light, &layout, Azimuth::From(0.0), effort);
            found.records().to_vec()
        };
        let records = [of(RayVisibility::XuSun), of(RayVisibility::Smith)].concat();
        assert_eq!(records.len(), 16);
        for (i, a) in records.iter().enumerate() {
            for (j, b) in records[..i].iter().enumerate() {
                assert_ne!(a, b, "{i} {j}");
            }
        }
    }
}
