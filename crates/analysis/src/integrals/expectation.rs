//! Expectation of a model for a run: a tally of the same spec, with errors where it was sampled.

use asperity_optics::Incidence;
use asperity_tally::{
    Azimuth, Component, Mirror, SideFluxes, Tally, TallySpec, TallyStatistics, TallyValues,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::integrals::flux::{bin_fluxes_of, in_plane_fluxes};
use crate::integrals::tabulated::TabulatedTally;
use crate::microfacet::lambda_map::MapSize;
use crate::models::model::{BsdfModel, RandomWalk, ScatteringModel, Scope};
use asperity_numerics::fnv1a;

/// Rays of a batch between two questions whether it is given up.
const RAYS_UNASKED: u64 = 1 << 14;

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

/// Fluxes that a model expects, entry by entry of a spec.
#[derive(Clone, Debug)]
pub struct Expectation {
    scope: Scope,
    /// One tally per batch; one alone if it is exact to the accuracy of quadrature.
    tallies: Vec<TallyValues>,
    statistics: TallyStatistics,
    rays: u64,
    /// `true` if single scattering has an analytic result.
    exact_single: bool,
}

/// Expectation of `model` for light from `incidence` in a tally of `spec`.
///
/// `azimuth`: origin of the azimuths of a tally, as in the run that it is compared with.
/// Entries that the model does not describe are zero. Light scattered once comes from quadrature where
/// the model has a density, to about 1e-12 of the incident flux in a bin; all else from `effort.rays`
/// rays, divided into batches with separate random streams: the same for any number of threads. Where exact
/// single scattering replaces sampled one, energies add to one within errors only.
#[must_use]
pub fn expect(
    model: &dyn ScatteringModel,
    incidence: Incidence,
    spec: &TallySpec,
    azimuth: Azimuth,
    effort: SamplingEffort,
) -> Expectation {
    let found = expect_unless(model, incidence, spec, azimuth, effort, &|| false);
    found.unwrap_or_else(|| unreachable!("it is not given up"))
}

/// Expectation as of [`expect`]; `None` once `gives_up` returns `true`, which is asked several times a second.
#[must_use]
pub fn expect_unless(
    model: &dyn ScatteringModel,
    incidence: Incidence,
    spec: &TallySpec,
    azimuth: Azimuth,
    effort: SamplingEffort,
    gives_up: &(dyn Fn() -> bool + Sync),
) -> Option<Expectation> {
    let single = model
        .density()
        .map(|density| single_scattering(density, incidence, spec));
    let exact_single = single.is_some();
    let (tallies, rays) = match (model.random_walk(), single) {
        (None, single) => (vec![single.unwrap_or_else(|| TallyValues::zeros(*spec))], 0),
        (Some(walk), single) => {
            let batches = effort.batches.max(2);
            let rays = effort.rays.div_ceil(batches).max(1);
            let tallies = (0..batches)
                .into_par_iter()
                .map(|batch| {
                    let rng = walk_stream(effort.seed, model.name(), batch);
                    let tally = Tally::new(*spec, azimuth);
                    let mut tally = batch_of(walk, incidence, tally, rays, rng, gives_up)?;
                    if let Some(single) = &single {
                        tally.replace_single_scattering(single);
                    }
                    Some(tally)
                })
                .collect::<Option<_>>()?;
            (tallies, rays * batches)
        }
    };
    Some(Expectation {
        exact_single,
        ..Expectation::of(*spec, model.scope(), tallies, rays)
    })
}

impl Expectation {
    pub(crate) fn of(spec: TallySpec, scope: Scope, tallies: Vec<TallyValues>, rays: u64) -> Self {
        let statistics = match tallies.as_slice() {
            [exact] => TallyStatistics::analytic(exact.clone(), TallyValues::zeros(spec)),
            batches => {
                let mut statistics = TallyStatistics::new(spec);
                batches.iter().for_each(|batch| statistics.push(batch));
                statistics
            }
        };
        Self {
            scope,
            tallies,
            statistics,
            rays,
            exact_single: false,
        }
    }

    /// Bins averaged with their mirror images, as in the tallies that the expectation is compared with.
    #[must_use]
    pub fn folded(mut self, mirror: &Mirror) -> Self {
        let (spec, exact_single) = (*self.spec(), self.exact_single);
        self.tallies.iter_mut().for_each(|tally| mirror.fold(tally));
        Self {
            exact_single,
            ..Self::of(spec, self.scope, self.tallies, self.rays)
        }
    }

    /// The spec of the entries.
    #[must_use]
    pub fn spec(&self) -> &TallySpec {
        self.statistics.spec()
    }

    /// Means and standard errors; the error is zero where the model was not sampled.
    #[must_use]
    pub const fn statistics(&self) -> &TallyStatistics {
        &self.statistics
    }

    /// One tally per batch, or a single one if it is exact.
    #[must_use]
    pub fn tallies(&self) -> &[TallyValues] {
        &self.tallies
    }

    /// Returns `true` if no entry was sampled.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.rays == 0
    }

    /// Number of rays; zero if the expectation is exact.
    #[must_use]
    pub const fn rays(&self) -> u64 {
        self.rays
    }

    /// Returns `true` if this component of the light was sampled, at least in part.
    #[must_use]
    pub fn samples(&self, component: Component) -> bool {
        let analytic = component == Component::Single && self.exact_single;
        !(self.is_exact() || analytic)
    }

    /// Returns `true` if the model describes this component of the light scattered by the surface.
    #[must_use]
    pub fn describes(&self, component: Component) -> bool {
        match self.scope {
            Scope::SingleScattering => component == Component::Single,
            Scope::AllOrders => !component.is_of_medium(),
            Scope::ScatteredInside => false,
        }
    }
}

/// Expectation of a closed form: light scattered once and nothing else.
fn single_scattering(
    density: &dyn BsdfModel,
    incidence: Incidence,
    spec: &TallySpec,
) -> TallyValues {
    if let Some(table) = density.tabulated() {
        let images = TabulatedTally::new(table, density.material(), incidence, spec);
        return images.fluxes(table, MapSize::FINE);
    }
    let wi = incidence.wi();
    let mut expected = TallyValues::zeros(*spec);
    let bins = bin_fluxes_of(density, wi, &spec.grid(), density.sides());
    for side in spec.sides().filter(|&side| density.sides().includes(side)) {
        let filter = spec.bin_filter(side);
        let of_side = bins[side.index() * filter.len()..][..filter.len()].to_vec();
        let in_plane = in_plane_fluxes(density, incidence, spec, side);
        let fluxes = SideFluxes::from_bins(&filter, of_side, in_plane);
        expected.set_single_scattering(side, &fluxes);
    }
    expected
}

fn batch_of(
    walk: &dyn RandomWalk,
    incidence: Incidence,
    mut tally: Tally,
    rays: u64,
    mut rng: ChaCha8Rng,
    gives_up: &(dyn Fn() -> bool + Sync),
) -> Option<TallyValues> {
    for first in (0..rays).step_by(RAYS_UNASKED as usize) {
        if gives_up() {
            return None;
        }
        let count = RAYS_UNASKED.min(rays - first);
        walk.follow_all(incidence.wi(), count, &mut rng, &mut tally);
    }
    Some(tally.into_fractions(rays))
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
        let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH).unwrap();
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
            let found = expect(&model, light, &spec, Azimuth::From(0.0), effort);
            found.tallies().to_vec()
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
