//! The polarised random walk: against a walk with complex field vectors, against quadrature where s and p do not mix,
//! and against the averaged walk, where both must agree and where they must not.

mod field_walk;
mod grooves;

use asperity_analysis::{
    Heitz, HeitzPolarised, RandomWalk, ScatteringModel, SlopeCovariance, hemispherical_energy,
    sidak_z_threshold,
};
use asperity_optics::{Material, from_spherical};
use asperity_tally::{
    Azimuth, BatchStatistics, Component, Entry, Estimate, HemisphereGrid, Side, Tally, TallyResult,
    TallySpec, TallyStatistics, TallyValues,
};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use field_walk::FieldWalk;

const BATCHES: u64 = 100;

fn spec() -> TallySpec {
    let grid = HemisphereGrid::new(3, 4).unwrap();
    TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH).unwrap()
}

fn glass(eta: f64) -> Material {
    Material::dielectric(eta).unwrap()
}

fn gold() -> Material {
    Material::conductor(0.43, 2.455).unwrap()
}

/// It reflects little, and s far more than p.
fn dark_metal() -> Material {
    Material::conductor(1.4, 0.5).unwrap()
}

fn isotropic(s: f64) -> SlopeCovariance {
    SlopeCovariance::isotropic(s).unwrap()
}

fn turned() -> SlopeCovariance {
    SlopeCovariance::new(0.5, 2.0, 0.6).unwrap()
}

fn sampled(walk: &dyn RandomWalk, wi: DVec3, rays: u64, seed: u64) -> TallyStatistics {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut statistics = TallyStatistics::new(spec());
    for _ in 0..BATCHES {
        let mut tally = Tally::new(spec(), Azimuth::From(0.0));
        for _ in 0..rays / BATCHES {
            walk.follow(wi, &mut rng, &mut tally);
        }
        statistics.push(&tally.into_fractions(rays / BATCHES));
    }
    statistics
}

/// The first ray of a seed.
fn one_ray(walk: &dyn RandomWalk, wi: DVec3, seed: u64) -> TallyValues {
    let mut tally = Tally::new(spec(), Azimuth::From(0.0));
    walk.follow(wi, &mut ChaCha8Rng::seed_from_u64(seed), &mut tally);
    tally.into_fractions(1)
}

#[test]
fn the_budget_of_each_ray_closes() {
    let steep = SlopeCovariance::new(1e8, 1e8, 0.0).unwrap();
    let extreme = [glass(1e-6), glass(1e6)];
    let usual = [Material::Mirror, glass(1.5), glass(0.5), gold()];
    for slopes in [isotropic(0.3), isotropic(3.0), turned(), steep] {
        for material in usual.into_iter().chain(extreme) {
            let model = HeitzPolarised::new(slopes, material).unwrap();
            for seed in 0..300 {
                let wi = from_spherical(0.3 * (seed % 5) as f64, seed as f64);
                let budget = one_ray(&model, wi, seed).budget();
                // Some tens of products and sums a path.
                assert!((budget.total() - 1.0).abs() < 1e-13, "{}", budget.total());
                assert!(budget.parts()[..3].iter().all(|&v| v >= 0.0) && budget.lost == 0.0);
                let is_metal = material == gold();
                assert_eq!(budget.absorbed > 0.0, is_metal);
            }
        }
    }
}

#[test]
fn single_scattering_is_that_of_the_averaged_walk() {
    let spec = spec();
    for material in [Material::Mirror, glass(1.5), glass(1.0 / 1.5), gold()] {
        let [averaged, polarised]: [Box<dyn ScatteringModel>; 2] = [
            Box::new(Heitz::new(turned(), material).unwrap()),
            Box::new(HeitzPolarised::new(turned(), material).unwrap()),
        ];
        let (wi, wo) = (from_spherical(0.7, 0.2), from_spherical(0.5, 3.0));
        let density = |model: &dyn ScatteringModel| model.density().unwrap().bsdf(wi, wo);
        assert_eq!(density(&*averaged), density(&*polarised));
        for seed in 0..500 {
            // Each ray has its own random numbers, which serve the first facet alike.
            let [a, b] = [&averaged, &polarised]
                .map(|model| one_ray(model.random_walk().unwrap(), wi, seed));
            let bins = spec.grid_entries(Component::Single);
            let tolerance = if material == gold() { 1e-15 } else { 0.0 };
            for i in bins.iter() {
                assert!((a[i] - b[i]).abs() <= tolerance, "{material:?} {seed}");
            }
            // A mirror reflects all light, whatever its polarisation.
            if material == Material::Mirror {
                assert_eq!(a, b);
            }
        }
    }
}

/// Entries of both sides: orders 2 to 4, all light scattered more than once, and each path of two and three facets.
fn multiple_entries(spec: TallySpec) -> Vec<Entry> {
    let of_side = |side| {
        let orders = (2..5).map(move |order| spec.order_entry(side, order));
        let paths = spec
            .listed_paths()
            .filter(|path| matches!(path.order(), 2 | 3))
            .map(move |path| spec.event_path_entry(side, path));
        let multiple = spec.flux_entry(side, Component::Multiple);
        orders.chain(paths).chain([multiple])
    };
    Side::BOTH.into_iter().flat_map(of_side).collect()
}

/// The deviations of `found` from `expected` in standard errors, where `expected` is known to an eighth.
fn z_values(found: &TallyStatistics, expected: &TallyStatistics) -> Vec<f64> {
    let z = |&i: &Entry| {
        let (a, b) = (found.at(i), expected.at(i));
        let error = b.se.unwrap();
        (b.mean > 8.0 * error).then(|| (a.mean - b.mean) / a.se.unwrap().hypot(error))
    };
    let entries = multiple_entries(spec());
    entries.iter().filter_map(z).collect()
}

#[test]
fn the_walk_with_complex_fields_agrees_and_the_averaged_walk_does_not() {
    let cases = [
        (isotropic(2.0), glass(1.5), 30.0),
        (turned(), glass(1.5), 50.0),
        (turned(), dark_metal(), 70.0),
        (isotropic(2.0), dark_metal(), 0.0),
        (isotropic(1.0), glass(1.0 / 1.5), 60.0),
    ];
    let (mut polarised, mut averaged) = (Vec::new(), Vec::new());
    for (seed, (slopes, material, theta)) in (1..).zip(cases) {
        let wi = from_spherical(f64::to_radians(theta), 0.4);
        let fields = FieldWalk::new(slopes, material);
        let expected = sampled(&fields, wi, 200_000, 100 + seed);
        let model = HeitzPolarised::new(slopes, material).unwrap();
        let found = sampled(&model, wi, 100_000, 200 + seed);
        polarised.extend(z_values(&found, &expected));
        let model = Heitz::new(slopes, material).unwrap();
        let found = sampled(&model, wi, 100_000, 300 + seed);
        averaged.push(z_values(&found, &expected));
    }
    let bound = sidak_z_threshold(1e-3, polarised.len());
    println!("{} z, bound {bound:.2}: {polarised:.2?}", polarised.len());
    assert!(polarised.len() > 40 && polarised.iter().all(|z| z.abs() < bound));
    // The test resolves what averaging costs, but for light that leaves the denser medium: most of that is reflected totally.
    for (z, resolved) in averaged.iter().zip([true, true, true, true, false]) {
        println!("averaged: {z:.1?}");
        assert!(!resolved || z.iter().any(|z| z.abs() > bound));
    }
}

/// Reflected light that averaging leaves out, from both walks with the same random numbers ray by ray: they serve
/// the first facet alike, and most others.
struct CostOfAveraging {
    /// Reflectance of the polarised walk minus that of the averaged one.
    difference: Estimate,
    /// Reflectance of all orders by the polarised walk.
    reflectance: f64,
    /// Light reflected in two interactions: averaged over polarised.
    second_order: f64,
}

impl CostOfAveraging {
    const RAYS_PER_BATCH: u64 = 300;

    fn of(slopes: SlopeCovariance, material: Material, wi: DVec3) -> Self {
        let averaged = Heitz::new(slopes, material).unwrap();
        let polarised = HeitzPolarised::new(slopes, material).unwrap();
        let mut statistics = BatchStatistics::new(4);
        for batch in 0..BATCHES {
            let [multiple, second] = Self::batch(&averaged, wi, batch);
            let [multiple_polarised, second_polarised] = Self::batch(&polarised, wi, batch);
            let difference = multiple_polarised - multiple;
            statistics.push(&[difference, multiple_polarised, second, second_polarised]);
        }
        let [_, multiple, second, second_polarised] = *statistics.means() else {
            panic!("four quantities");
        };
        let single = hemispherical_energy(polarised.density().unwrap(), wi).reflected;
        Self {
            difference: statistics.estimate(0),
            reflectance: single + multiple,
            second_order: second / second_polarised,
        }
    }

    /// Reflected light scattered more than once, and twice.
    fn batch(walk: &dyn RandomWalk, wi: DVec3, batch: u64) -> [f64; 2] {
        let spec = spec();
        let mut tally = Tally::new(spec, Azimuth::From(0.0));
        for ray in 0..Self::RAYS_PER_BATCH {
            let mut rng = ChaCha8Rng::seed_from_u64(9);
            rng.set_stream(batch * Self::RAYS_PER_BATCH + ray);
            walk.follow(wi, &mut rng, &mut tally);
        }
        let fractions = tally.into_fractions(Self::RAYS_PER_BATCH);
        let multiple = spec.flux_entry(Side::Reflected, Component::Multiple);
        [multiple, spec.order_entry(Side::Reflected, 2)].map(|entry| fractions[entry])
    }
}

/// Prints what averaging costs, at s = 2.
#[test]
fn averaging_loses_reflection_where_facets_reflect_in_nearly_the_same_plane() {
    // What the first facet reflects is polarised along s there. Where the second facet has nearly the same plane of
    // incidence, it reflects more of that: the mean of a product of two reflectances that vary together.
    println!("material   theta   difference in R        of R  averaged / polarised, order 2");
    let materials = [
        ("n = 1.5", glass(1.5)),
        ("n = 1/1.5", glass(1.0 / 1.5)),
        ("gold", gold()),
    ];
    for (name, material) in materials {
        for theta in [0.0, 30.0, 60.0, 80.0] {
            let wi = from_spherical(f64::to_radians(theta), 0.0);
            let cost = CostOfAveraging::of(isotropic(2.0), material, wi);
            let (mean, se) = (cost.difference.mean, cost.difference.se.unwrap());
            let percent = 100.0 * mean / cost.reflectance;
            println!(
                "{name:9}  {theta:5}  {mean:9.2e} +- {se:.1e}  {percent:6.3} %  {:.4}",
                cost.second_order
            );
            // At grazing and from the denser side these rays do not resolve it.
            let is_resolved = match name {
                "n = 1.5" => theta < 80.0,
                "gold" => theta < 60.0,
                _ => false,
            };
            assert!(!is_resolved || mean > 4.5 * se, "{name} {theta}");
        }
    }
}
