//! Light that is scattered more than once where that is rare.

use asperity_analysis::{
    Heitz, ScatteringModel, SlopeCovariance, hemispherical_energy, sidak_z_threshold,
};
use asperity_optics::{Material, from_spherical};
use asperity_tally::{
    Azimuth, Component, HemisphereGrid, Side, Tally, TallyResult, TallySpec, TallyStatistics,
};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const BATCHES: u64 = 100;

fn mirror(s: f64) -> Heitz {
    Heitz::new(SlopeCovariance::isotropic(s).unwrap(), Material::Mirror).unwrap()
}

fn spec() -> TallySpec {
    let grid = HemisphereGrid::new(2, 2).unwrap();
    TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH).unwrap()
}

fn sampled(model: &Heitz, wi: DVec3, rays: u64, seed: u64) -> TallyStatistics {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut statistics = TallyStatistics::new(spec());
    for _ in 0..BATCHES {
        let mut tally = Tally::new(spec(), Azimuth::From(0.0));
        for _ in 0..rays / BATCHES {
            model
                .random_walk()
                .unwrap()
                .follow(wi, &mut rng, &mut tally);
        }
        statistics.push(&tally.into_fractions(rays / BATCHES));
    }
    statistics
}

/// A mirror absorbs nothing, so that what does not leave after one reflection leaves after several: one
/// less the closed form of light scattered once, which quadrature knows to 1e-10.
#[test]
fn second_order_of_a_smooth_mirror_is_the_rest_of_the_first() {
    let mut z_values = Vec::new();
    for (seed, (s, theta)) in [(8.0, 40.0), (8.0, 60.0), (12.0, 50.0), (12.0, 70.0)]
        .into_iter()
        .enumerate()
    {
        let model = mirror(s);
        let wi = from_spherical(f64::to_radians(theta), 0.3);
        let once = hemispherical_energy(model.density().unwrap(), wi).reflected;
        let expected = 1.0 - once;
        let statistics = sampled(&model, wi, 20_000, 70 + seed as u64);
        let found = statistics.at(spec().flux_entry(Side::Reflected, Component::Multiple));
        let z = (found.mean - expected) / found.se.unwrap();
        println!("s = {s}, {theta} deg: {found:?} of {expected:.3e}, z = {z:.2}");
        z_values.push(z);
    }
    let bound = sidak_z_threshold(1e-3, z_values.len());
    assert!(z_values.iter().all(|z| z.abs() < bound));
}

/// Most rays leave a smooth mirror but for some 1e-8 of their light, and that must leave as well: what
/// later reflections send away is in the mean what the first has left, however little. Rays that leave between 1e-11, well above rounding, and 1e-6 are added up.
#[test]
fn rare_multiple_scattering_is_followed() {
    for (seed, (s, theta)) in [(8.0, 20.0), (10.0, 30.0), (12.0, 30.0)]
        .into_iter()
        .enumerate()
    {
        let model = mirror(s);
        let wi = from_spherical(f64::to_radians(theta), 0.3);
        let mut rng = ChaCha8Rng::seed_from_u64(80 + seed as u64);
        let [mut left, mut found, mut second] = [0.0; 3];
        let mut rays = 0;
        for _ in 0..10_000 {
            let mut tally = Tally::new(spec(), Azimuth::From(0.0));
            model
                .random_walk()
                .unwrap()
                .follow(wi, &mut rng, &mut tally);
            let values = tally.into_fractions(1);
            let rest = 1.0 - values[spec().order_entry(Side::Reflected, 1)];
            if (1e-11..1e-6).contains(&rest) {
                let later = values[spec().flux_entry(Side::Reflected, Component::Multiple)];
                left += rest;
                found += later;
                second += values[spec().order_entry(Side::Reflected, 2)];
                rays += 1;
            }
        }
        let ratio = found / left;
        println!("s = {s}: {rays} rays leave {left:.4e}, found {ratio:.6}, {second:.4e} second");
        assert!(rays > 100, "{rays}");
        // Roulette strikes what the second facet leaves alone, which is a small part of this.
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
        assert!(second > 0.9 * left);
    }
}
