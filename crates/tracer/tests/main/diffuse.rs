//! Light on Lambertian facets: flat surfaces and spherical pits against closed forms, the energy budget, and the path engine
//! against the reference.

use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField};
use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, Geometry, HalfSpace, Illumination, PathEnd,
    PathIntegrator, PathSettings, PathStream, Polarisation, Pyramid, Surface, Tracer,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{Run, rugged, waves, z_score};

/// No roulette, so that fluxes of each order are those of every path.
fn exhaustive() -> PathSettings {
    PathSettings::new(Branching::Split, 1e-6, 1_000_000).unwrap()
}

/// A flat Lambertian surface reflects `reflectance` once, of which `sin^2` of an angle leaves within that angle of the normal.
///
/// Rings of 5 degrees, 40 batches: 18 deviations of both sides, of which one above 4 standard errors of 39 degrees of freedom has a
/// probability of 0.5 %.
#[test]
fn a_flat_surface_reflects_by_the_cosine_law_from_either_side() {
    let surface = Surface::new(HeightField::new(vec![0.0; 64], [8, 8], [1.0, 1.0]).unwrap());
    let accelerator = surface.accelerator(AcceleratorKind::Flat).unwrap();
    for incident in [HalfSpace::Above, HalfSpace::Below] {
        let run = Run {
            incident,
            theta_deg: 70.0,
            ..Run::new(&surface, &*accelerator, Material::lambertian(0.6).unwrap())
        };
        let (statistics, _) = run.go(40, 24);
        let budget = statistics.means().budget();
        assert!((budget.reflected - 0.6).abs() < 1e-12);
        assert!((budget.absorbed - 0.4).abs() < 1e-12);
        let rings = statistics.rings(Side::Reflected, Component::Single);
        let n = rings.iter().count();
        for (i, ring) in rings.iter().enumerate() {
            let sin_squared = |i: usize| (90.0 * i as f64 / n as f64).to_radians().sin().powi(2);
            let expected = 0.6 * (sin_squared(i + 1) - sin_squared(i));
            let z = z_score(ring, expected, 0.0);
            assert!(z.abs() < 4.0, "{incident:?}, ring {i}: {ring:?} {expected}");
        }
    }
}

#[test]
fn white_facets_absorb_nothing_and_grey_ones_close_the_budget() {
    let surfaces = [
        Surface::new(waves(32, 4.0, 2)),
        rugged(24, 20, 6.0, 4, Border::Periodic),
        rugged(24, 20, 1.0, 4, Border::Mirrored),
        rugged(24, 20, 1.0, 4, Border::Open),
    ];
    for surface in &surfaces {
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        for (reflectance, incident) in [
            (1.0, HalfSpace::Above),
            (1.0, HalfSpace::Below),
            (0.5, HalfSpace::Above),
            (0.0, HalfSpace::Above),
        ] {
            for theta_deg in [0.0, 89.9] {
                let material = Material::lambertian(reflectance).unwrap();
                let run = Run {
                    theta_deg,
                    incident,
                    settings: exhaustive(),
                    ..Run::new(surface, &*accelerator, material)
                };
                let (statistics, _) = run.go(4, 8);
                let budget = statistics.means().budget();
                assert!((budget.total() - 1.0).abs() < 1e-12, "{budget:?}");
                assert_eq!([budget.lost, budget.transmitted], [0.0; 2]);
                if reflectance == 1.0 {
                    assert_eq!(budget.absorbed, 0.0);
                    if surface.border() != Border::Open {
                        assert!((budget.reflected - 1.0).abs() < 1e-12, "{budget:?}");
                    }
                }
            }
        }
    }
}

/// One spherical pit in a flat tile, whose wall is a fraction of the area of its sphere.
struct Pit {
    radius: f64,
    depth: f64,
    n: usize,
}

impl Pit {
    fn rim_squared(&self) -> f64 {
        self.depth * (2.0 * self.radius - self.depth)
    }

    /// Area of the wall over that of the sphere: `2 pi R d / (4 pi R^2)`.
    fn wall_fraction(&self) -> f64 {
        self.depth / (2.0 * self.radius)
    }

    fn surface(&self) -> Surface {
        let middle = self.n as f64 / 2.0;
        let heights = (0..self.n * self.n).map(|i| {
            let [x, y] = [i % self.n, i / self.n].map(|k| k as f64 - middle);
            let r_squared = x * x + y * y;
            if r_squared < self.rim_squared() {
                let r2 = self.radius.powi(2);
                self.radius - self.depth - (r2 - r_squared).sqrt()
            } else {
                0.0
            }
        });
        let field = HeightField::new(heights.collect(), [self.n; 2], [1.0, 1.0]).unwrap();
        Surface::new(field)
    }
}

/// Within a sphere every patch of its wall sheds diffuse light evenly over the whole sphere, since the cosines at both ends are
/// half the distance over the radius. Of light that a pit reflects, the fraction `f` of the sphere that is wall meets the wall
/// again, and `1 - f` leaves, whatever the angle of incidence. So order `k` returns `rho^k f^(k - 1) (1 - f)`, and all orders
/// `rho (1 - f) / (1 - rho f)`, beyond the first order by the cosine law. The flat surround reflects `rho` and is not lit by the pit.
///
/// Facets at the rim, over about `2 dx / a` of the pit of radius `a`, are inclined between pit and surround: they return
/// between what each does. Other facets are off by the square of their length over the radius, some 1e-5.
///
/// # Source
/// Koenderink, van Doorn, Dana and Nayar, Bidirectional reflection distribution function of thoroughly pitted surfaces, Int. J.
/// Computer Vision 31 (1999).
#[test]
fn a_spherical_pit_returns_what_the_closed_form_says() {
    const N: usize = 512;
    const RHO: f64 = 0.8;
    for (wall, theta_deg) in [(0.15, 30.0), (0.4, 0.0), (0.4, 65.0)] {
        // A rim of 240 cells: a^2 = d (2 R - d) with d = 2 f R
        let rim = 240.0_f64;
        let radius = 0.5 * rim / f64::sqrt(wall * (1.0 - wall));
        let pit = Pit {
            radius,
            depth: 2.0 * wall * radius,
            n: N,
        };
        assert!((pit.wall_fraction() - wall).abs() < 1e-12);
        let surface = pit.surface();
        let accelerator = Pyramid::build(&surface).unwrap();
        let run = Run {
            theta_deg,
            phi_deg: 20.0,
            settings: exhaustive(),
            ..Run::new(&surface, &accelerator, Material::lambertian(RHO).unwrap())
        };
        let (statistics, _) = run.go(20, 100);
        let area = std::f64::consts::PI * pit.rim_squared() / (N * N) as f64;
        let of_pit = RHO * (1.0 - wall) / (1.0 - RHO * wall);
        let first_of_pit = RHO * (1.0 - wall);
        let expected = [
            (Component::Single, first_of_pit),
            (Component::Multiple, of_pit - first_of_pit),
        ];
        for (component, of_pit) in expected {
            let of_surround = if component == Component::Single {
                RHO
            } else {
                0.0
            };
            let expected = area * of_pit + (1.0 - area) * of_surround;
            let rim_error = area * (2.0 / rim) * (of_surround - of_pit).abs();
            let found = statistics.flux(Side::Reflected, component);
            let tolerance = 4.0 * found.se.unwrap() + rim_error;
            println!("{wall} {theta_deg} {component:?}: {found:?} {expected} +- {rim_error}");
            assert!((found.mean - expected).abs() < tolerance);
        }
        // Light between facets arrives evenly at all of the wall, which sheds it evenly in all directions, and so through the opening
        // by the cosine law, whatever the direction of the light. Of the 54 rings of all pits one lies beyond 4.5 standard errors of 20
        // batches with a probability of 1 %; the rim is as above.
        let twice = area * RHO * RHO * wall * (1.0 - wall);
        let rings = statistics.rings(Side::Reflected, Component::Order(2));
        for (i, found) in rings.iter().enumerate() {
            let [from, to] = [i, i + 1].map(|k| (5.0 * k as f64).to_radians().sin().powi(2));
            let expected = twice * (to - from);
            let tolerance = 4.5 * found.se.unwrap() + 2.0 / rim * expected;
            println!("{wall} {theta_deg} ring {i}: {found:?} {expected}");
            assert!((found.mean - expected).abs() < tolerance);
        }
    }
}

/// Light that comes from below meets the mirror image of the surface as light from above meets the surface.
#[test]
fn light_from_below_is_reflected_as_light_from_above_is() {
    let above = waves(32, 3.0, 2);
    let turned = above.heights().iter().map(|h| -h).collect();
    let below = HeightField::new(turned, above.shape(), above.spacing()).unwrap();
    let [above, below] = [above, below].map(Surface::new);
    let fluxes =
        [(&above, HalfSpace::Above), (&below, HalfSpace::Below)].map(|(surface, incident)| {
            let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
            let run = Run {
                incident,
                seed: 5 + u64::from(incident == HalfSpace::Below),
                ..Run::new(surface, &*accelerator, Material::lambertian(0.7).unwrap())
            };
            let (statistics, _) = run.go(40, 16);
            [Component::Single, Component::Multiple]
                .map(|component| statistics.flux(Side::Reflected, component))
        });
    for (a, b) in fluxes[0].into_iter().zip(fluxes[1]) {
        assert!(a.mean > 0.02, "{a:?}");
        assert!(z_score(a, b.mean, b.se.unwrap()).abs() < 4.0, "{a:?} {b:?}");
    }
}

/// Fluxes of single and multiple scattering, and within 45 degrees of the normal and beyond, of engine and reference, which draw random numbers
/// of their own. The settings of polarisation change no flux.
#[test]
fn the_path_engine_agrees_with_the_reference() {
    const BATCHES: u64 = 60;
    const STRATA: u32 = 12;
    let material = Material::lambertian(0.8).unwrap();
    let spec = TallySpec::default();
    for (border, theta_deg) in [(Border::Periodic, 10.0), (Border::Mirrored, 65.0)] {
        let surface = rugged(14, 11, 0.8, 3, border);
        let search = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let incidence = Incidence::from_degrees(theta_deg, 25.0).unwrap();
        let near = spec.grid().n_theta() / 2;
        let cos_near = std::f64::consts::FRAC_PI_4.cos();

        let light = Illumination::new(incidence, false);
        let settings = PathSettings::default().with_polarisation(Polarisation::Tracked);
        let tracer = Tracer::new(&surface, &*search, material, HalfSpace::Above, settings);
        let batches = |of: &mut dyn FnMut(u64) -> [f64; 4]| -> Vec<[f64; 4]> {
            (0..BATCHES).map(of).collect()
        };
        let engine = batches(&mut |block| {
            let stream = PathStream::new(7, 0).from_path(block << 20);
            let mut one = TallyStatistics::new(spec);
            one.push(&tracer.batch(&light, STRATA, spec, None, stream).0);
            let values = one.means();
            let [single, multiple] = [Component::Single, Component::Multiple]
                .map(|component| values.flux(Side::Reflected, component));
            let mut fluxes = [single, multiple, 0.0, 0.0];
            let rings = values.rings(Side::Reflected, Component::All);
            for (i, flux) in rings.iter().enumerate() {
                fluxes[2 + usize::from(i >= near)] += flux;
            }
            fluxes
        });

        let averaged = settings.with_polarisation(Polarisation::Averaged);
        for settings in [settings, averaged] {
            let reference = PathIntegrator::new(&surface, &*search, material, settings);
            let mut rng = ChaCha8Rng::seed_from_u64(1);
            let ([cx, cy], [_, high]) = (surface.extent(), surface.z_range());
            let traced = batches(&mut |_| {
                let mut fluxes = [0.0; 4];
                for _ in 0..STRATA * STRATA {
                    let place = [rng.random_range(0.0..cx), rng.random_range(0.0..cy)];
                    let origin = DVec3::new(place[0], place[1], high);
                    let found = reference.trace(origin, -incidence.wi(), &mut rng);
                    if found.end == PathEnd::Above {
                        let multiple = usize::from(found.path.order() > 1);
                        let far = usize::from(found.direction.z < cos_near);
                        let flux = found.flux / f64::from(STRATA * STRATA);
                        fluxes[multiple] += flux;
                        fluxes[2 + far] += flux;
                    }
                }
                fluxes
            });
            for i in 0..4 {
                let [a, b] = [&engine, &traced].map(|batches| {
                    let n = BATCHES as f64;
                    let mean = batches.iter().map(|b| b[i]).sum::<f64>() / n;
                    let squares: f64 = batches.iter().map(|b| (b[i] - mean).powi(2)).sum();
                    (mean, squares / (n * (n - 1.0)))
                });
                let z = (a.0 - b.0) / (a.1 + b.1).sqrt();
                println!("{border:?}, {theta_deg}, {i}: {} {} z = {z:.2}", a.0, b.0);
                assert!(a.0 > 0.005 && z.abs() < 4.0);
            }
        }
    }
}

/// No element of the Mueller matrix but the first is left after diffuse reflection.
#[test]
fn light_is_depolarised() {
    let surface = rugged(14, 11, 0.8, 3, Border::Periodic);
    let search = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let settings = PathSettings::default().with_polarisation(Polarisation::Mueller);
    let spec = TallySpec::default().with_polarimetry(Polarisation::Mueller.polarimetry());
    let material = Material::lambertian(0.8).unwrap();
    let tracer = Tracer::new(&surface, &*search, material, HalfSpace::Above, settings);
    let light = Illumination::new(Incidence::from_degrees(50.0, 0.0).unwrap(), false);
    let (values, _) = tracer.batch(&light, 16, spec, None, PathStream::new(1, 0));
    let plain = PathSettings::default().with_polarisation(Polarisation::Averaged);
    let tracer = Tracer::new(&surface, &*search, material, HalfSpace::Above, plain);
    let (expected, _) = tracer.batch(
        &light,
        16,
        TallySpec::default(),
        None,
        PathStream::new(1, 0),
    );
    assert_eq!(values.budget(), expected.budget());
    // Sums of all entries: those of fluxes, and as much again for the first element of the matrices, which counts single
    // and multiple scattering in bins, rings and slice.
    let nonzero = values.iter().filter(|value| **value != 0.0).count();
    let of_fluxes = expected.iter().filter(|value| **value != 0.0).count();
    assert!(nonzero <= 2 * of_fluxes, "{nonzero} {of_fluxes}");
}
