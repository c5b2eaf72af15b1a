//! Analog random walk: one branch, weight one, escape by chance. It tests the walk with expectations.

use asperity_numerics::elementary::pow;
use asperity_optics::{Material, dielectric, reflect, refract};
use asperity_tally::{Event, EventPath, Exit, Loss, Side, Tally, TallyResult};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::microfacet::smith_normals::SmithNormals;
use crate::models::model::RandomWalk;

/// The random walk of Heitz et al. 2016 as they write it, in one frame, with `C1` itself and the sign
/// rule of Lambda.
pub(crate) struct Analog {
    pub(crate) distribution: SmithNormals,
    pub(crate) material: Material,
}

impl Analog {
    /// Lambda of a direction anywhere on the sphere, for a ray whose medium lies towards `up`.
    fn lambda(&self, d: DVec3, up: f64) -> f64 {
        let lambda = self.distribution.lambda(d);
        if d.z * up > 0.0 {
            lambda
        } else {
            -1.0 - lambda
        }
    }
}

impl RandomWalk for Analog {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        let mut path = EventPath::default();
        // +1 in the incident medium, -1 in the other.
        let mut up = 1.0;
        let mut d = -wi;
        // Fraction of the surface on the far side of the medium that the ray is in.
        let mut c1: f64 = 1.0;
        while path.order() < 1000 {
            let lambda = self.lambda(d, up);
            let u: f64 = rng.random();
            if d.z * up > 0.0 && u >= 1.0 - pow(c1, lambda) {
                let side = if up > 0.0 {
                    Side::Reflected
                } else {
                    Side::Transmitted
                };
                let wo = d;
                tally.add_exit(&Exit {
                    side,
                    wo,
                    flux: 1.0,
                    path,
                    scatterings: 0,
                });
                return;
            }
            c1 /= pow(1.0 - u, 1.0 / lambda);
            let flip = DVec3::new(1.0, 1.0, up);
            let m = flip * self.distribution.sample_visible(-d * flip, rng);
            let cos_theta_i = m.dot(-d).clamp(0.0, 1.0);
            match self.material {
                Material::Dielectric { eta } => {
                    let eta = if up > 0.0 { eta } else { 1.0 / eta };
                    let fresnel = dielectric(cos_theta_i, eta);
                    if rng.random::<f64>() < fresnel.reflected {
                        path = path.then(Event::Reflection);
                        d = reflect(-d, m);
                    } else {
                        path = path.then(Event::Transmission);
                        d = refract(-d, m, eta, fresnel.cos_theta_t);
                        up = -up;
                        c1 = 1.0 - c1;
                    }
                }
                opaque => {
                    if rng.random::<f64>() >= opaque.fresnel(cos_theta_i).reflected {
                        tally.add_loss(Loss::Absorbed, 1.0);
                        return;
                    }
                    path = path.then(Event::Reflection);
                    d = reflect(-d, m);
                }
            }
        }
        tally.add_loss(Loss::Truncated, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::multiple_tests::{chi_squared_survival, sidak_level, sidak_z_threshold};
    use crate::microfacet::beckmann::Beckmann;
    use crate::microfacet::ggx::Ggx;
    use crate::microfacet::slopes::SlopeCovariance;
    use crate::models::heitz::Heitz;
    use asperity_optics::from_spherical;
    use asperity_tally::{Azimuth, Component, Entry, HemisphereGrid, TallySpec, TallyStatistics};
    use rand::SeedableRng;

    const BATCHES: u64 = 200;

    fn spec() -> TallySpec {
        TallySpec::new(
            HemisphereGrid::new(6, 8).unwrap(),
            TallySpec::DEFAULT_HALF_WIDTH,
        )
        .unwrap()
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

    fn beckmann(slopes: SlopeCovariance) -> SmithNormals {
        SmithNormals::Beckmann(Beckmann::new(slopes))
    }

    /// (normals, material, theta of the light in degrees)
    fn cases() -> Vec<(SmithNormals, Material, f64)> {
        let isotropic = |s| beckmann(SlopeCovariance::isotropic(s).unwrap());
        let slopes = SlopeCovariance::new(0.5, 2.0, 0.6).unwrap();
        let turned = beckmann(slopes);
        let glass = Material::dielectric(1.5).unwrap();
        vec![
            (isotropic(3.0), glass, 60.0),
            (isotropic(0.5), glass, 30.0),
            (
                isotropic(1.0),
                Material::dielectric(1.0 / 1.5).unwrap(),
                70.0,
            ),
            (turned, glass, 50.0),
            (turned, Material::conductor(0.2, 3.0).unwrap(), 70.0),
            (SmithNormals::Ggx(Ggx::isotropic(0.6).unwrap()), glass, 60.0),
            (SmithNormals::Ggx(Ggx::new(slopes)), Material::Mirror, 40.0),
        ]
    }

    #[test]
    fn the_expectation_walk_agrees_with_the_analog_walk() {
        let cases = cases();
        let mut z_values = Vec::new();
        let mut p_values = Vec::new();
        for (i, &(distribution, material, theta)) in cases.iter().enumerate() {
            let wi = from_spherical(theta.to_radians(), 0.7);
            let walk = Analog {
                distribution,
                material,
            };
            let analog = sampled(&walk, wi, 100_000, 211 + i as u64);
            let heitz = Heitz::of_normals(distribution, material).unwrap();
            let expectation = sampled(&heitz, wi, 60_000, 231 + i as u64);
            let spec = spec();
            // Each path of two and of three facets; others are too rare.
            let paths = |side| {
                spec.listed_paths()
                    .filter(|path| matches!(path.order(), 2 | 3))
                    .map(move |path| spec.event_path_entry(side, path))
            };
            let entries = Side::BOTH.into_iter().flat_map(|side| {
                (1..5)
                    .map(move |order| spec.order_entry(side, order))
                    .chain([
                        spec.flux_entry(side, Component::Multiple),
                        spec.flux_entry(side, Component::All),
                    ])
                    .chain(paths(side))
            });
            let z = |i: Entry| {
                let (a, b) = (analog.at(i), expectation.at(i));
                (a.mean - b.mean) / a.se.unwrap().hypot(b.se.unwrap())
            };
            // The analog walk counts rays: below some 40 they are not normally distributed.
            let enough = |i: &Entry| analog.means()[*i] > 40.0 / 100_000.0;
            z_values.extend(
                entries
                    .chain([TallySpec::BUDGET.absorbed])
                    .filter(enough)
                    .map(z),
            );
            for component in [Component::Single, Component::Multiple] {
                let bins: Vec<f64> = spec
                    .grid_entries(component)
                    .iter()
                    .filter(enough)
                    .map(z)
                    .collect();
                let chi_squared = bins.iter().map(|z| z * z).sum();
                p_values.push(chi_squared_survival(chi_squared, bins.len()));
            }
        }
        println!("z {z_values:.2?}");
        println!("p {p_values:.4?}");
        let bound = sidak_z_threshold(1e-3, z_values.len());
        assert!(z_values.len() > 40 && z_values.iter().all(|z| z.abs() < bound));
        let level = sidak_level(1e-3, p_values.len());
        assert!(p_values.iter().all(|&p| p > level), "{level}");
    }

    /// On slopes of about thirty, light is reflected many times. The flux above order 30 must be equal in both
    /// walks, and the expectation walk must not truncate it.
    #[test]
    fn high_orders_on_a_steep_mirror_agree_with_the_analog_walk() {
        let slopes = SlopeCovariance::isotropic(0.05).unwrap();
        let material = Material::Mirror;
        let wi = from_spherical(f64::to_radians(50.0), 0.7);
        let spec = spec();
        let high_orders = |walk: &dyn RandomWalk, seed| -> [f64; 4] {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let fluxes: Vec<[f64; 2]> = (0..100)
                .map(|_| {
                    let mut tally = Tally::new(spec, Azimuth::From(0.0));
                    (0..80).for_each(|_| walk.follow(wi, &mut rng, &mut tally));
                    let values = tally.into_fractions(80);
                    let orders = (31..=64).map(|k| values[spec.order_entry(Side::Reflected, k)]);
                    [orders.sum(), values.budget().truncated]
                })
                .collect();
            let [high, ended] = [0, 1].map(|k| {
                let mean = fluxes.iter().map(|x| x[k]).sum::<f64>() / 100.0;
                let squares: f64 = fluxes.iter().map(|x| (x[k] - mean).powi(2)).sum();
                [mean, (squares / 9900.0).sqrt()]
            });
            [high[0], high[1], ended[0], ended[1]]
        };
        let walk = Analog {
            distribution: beckmann(slopes),
            material,
        };
        let [analog, analog_se, ..] = high_orders(&walk, 251);
        let heitz = Heitz::new(slopes, material).unwrap();
        let [high, high_se, ended, ended_se] = high_orders(&heitz, 252);
        let z = [(high - analog) / high_se.hypot(analog_se), ended / ended_se];
        println!("{high:.4} and {analog:.4}, ended {ended:.4}, z {z:.2?}");
        assert!(analog > 0.5);
        // Two values of z, each beyond 4 with probability 6e-5.
        assert!(z.iter().all(|z| z.abs() < 4.0));
    }
}
