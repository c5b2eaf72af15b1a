//! The wavefront against the scalar walk.

use asperity_optics::{Material, from_spherical};
use asperity_tally::{
    Azimuth, Component, Entry, HemisphereGrid, Side, Tally, TallyResult, TallySpec, TallyStatistics,
};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::compare::multiple_tests::{chi_squared_survival, sidak_level, sidak_z_threshold};
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::heitz::Heitz;
use crate::models::heitz_polarised::HeitzPolarised;
use crate::models::model::RandomWalk;

const BATCHES: u64 = 100;

fn spec() -> TallySpec {
    TallySpec::new(HemisphereGrid::new(6, 8).unwrap(), 0.2).unwrap()
}

/// Statistics of `rays` rays, by the scalar walk or by the wavefront.
fn sampled(walk: &dyn RandomWalk, wi: DVec3, rays: u64, is_scalar: bool) -> TallyStatistics {
    let mut rng = ChaCha8Rng::seed_from_u64(11 + u64::from(is_scalar));
    let mut statistics = TallyStatistics::new(spec());
    let rays = rays / BATCHES;
    for _ in 0..BATCHES {
        let mut tally = Tally::new(spec(), Azimuth::From(0.0));
        match is_scalar {
            true => (0..rays).for_each(|_| walk.follow(wi, &mut rng, &mut tally)),
            false => walk.follow_all(wi, rays, &mut rng, &mut tally),
        }
        statistics.push(&tally.into_fractions(rays));
    }
    statistics
}

#[test]
fn multiple_scattering_agrees_with_the_scalar_walk() {
    let isotropic = |s| SlopeCovariance::isotropic(s).unwrap();
    let turned = SlopeCovariance::new(0.5, 2.0, 0.6).unwrap();
    let glass = Material::dielectric(1.5).unwrap();
    let gold = Material::conductor(0.2, 3.0).unwrap();
    let cases = [
        (isotropic(3.0), glass, 60.0),
        (isotropic(0.5), glass, 30.0),
        (
            isotropic(1.0),
            Material::dielectric(1.0 / 1.5).unwrap(),
            70.0,
        ),
        (turned, glass, 50.0),
        (turned, gold, 70.0),
        (isotropic(1.0), Material::Mirror, 0.0),
    ];
    let (mut z_values, mut p_values) = (Vec::new(), Vec::new());
    for (slopes, material, theta) in cases {
        let wi = from_spherical(f64::to_radians(theta), 0.7);
        let walks: [Box<dyn RandomWalk>; 2] = [
            Box::new(Heitz::new(slopes, material).unwrap()),
            Box::new(HeitzPolarised::new(slopes, material).unwrap()),
        ];
        for walk in walks {
            let [scalar, wave] =
                [true, false].map(|is_scalar| sampled(&*walk, wi, 60_000, is_scalar));
            let spec = spec();
            let z = |entry: Entry| {
                let (a, b) = (scalar.at(entry), wave.at(entry));
                (a.mean - b.mean) / a.se.unwrap().hypot(b.se.unwrap())
            };
            let enough = |entry: &Entry| scalar.means()[*entry] > 1e-3;
            let orders = Side::BOTH.into_iter().flat_map(|side| {
                let paths = spec
                    .listed_paths()
                    .filter(|path| matches!(path.order(), 2 | 3));
                let paths = paths.map(move |path| spec.event_path_entry(side, path));
                (2..6)
                    .map(move |order| spec.order_entry(side, order))
                    .chain([spec.flux_entry(side, Component::Multiple)])
                    .chain(paths)
            });
            let entries = orders.chain([TallySpec::BUDGET.absorbed]);
            z_values.extend(entries.filter(enough).map(z));
            let bins = spec.grid_entries(Component::Multiple);
            let bins: Vec<f64> = bins.iter().filter(enough).map(z).collect();
            let chi_squared = bins.iter().map(|z| z * z).sum();
            p_values.push(chi_squared_survival(chi_squared, bins.len()));
            // Single scattering is left to the density.
            assert_eq!(
                wave.means()[spec.flux_entry(Side::Reflected, Component::Single)],
                0.0
            );
        }
    }
    println!("z {z_values:.2?}\np {p_values:.4?}");
    let bound = sidak_z_threshold(1e-3, z_values.len());
    assert!(
        z_values.len() > 100 && z_values.iter().all(|z| z.abs() < bound),
        "{bound}"
    );
    let level = sidak_level(1e-3, p_values.len());
    assert!(p_values.iter().all(|&p| p > level), "{level}");
}

#[test]
fn light_on_a_side_that_is_not_recorded_is_booked() {
    let glass = Material::dielectric(1.5).unwrap();
    let walk = Heitz::new(SlopeCovariance::isotropic(2.0).unwrap(), glass).unwrap();
    let wi = from_spherical(0.5, 0.0);
    let spec = spec().with_sides(asperity_tally::Sides::Reflected);
    let mut tally = Tally::new(spec, Azimuth::From(0.0));
    walk.follow_all(wi, 4000, &mut ChaCha8Rng::seed_from_u64(1), &mut tally);
    let budget = tally.into_fractions(4000).budget();
    assert!(budget.not_recorded > 0.9, "{budget:?}");
}
