//! Polarised light along reference paths: exact answers, and what holds along every path.

use asperity_optics::{
    Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction, Stokes,
    polarised_dielectric, reference_axes,
};
use asperity_surface::{Border, HeightField};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, Geometry, PathEnd, PathIntegrator, PathResult, PathSettings,
    Polarisation, Surface, TracedStack,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const S: Stokes = Stokes([1.0, 1.0, 0.0, 0.0]);
const P: Stokes = Stokes([1.0, -1.0, 0.0, 0.0]);
const DIAGONAL: Stokes = Stokes([1.0, 0.0, 1.0, 0.0]);
const CIRCULAR: Stokes = Stokes([1.0, 0.0, 0.0, 1.0]);
const GLASS: Material = Material::Dielectric { eta: 1.5 };
const GOLD: Material = Material::Conductor {
    eta: 0.43,
    kappa: 2.455,
};

/// A surface, what it is made of, and the light.
struct Scene {
    surface: Surface,
    material: Material,
    layer: Option<Layer>,
    theta_deg: f64,
    polarisation: Polarisation,
    incident: Stokes,
    /// Upper limits of start positions, above the tile, tile coordinates.
    starts: [f64; 2],
    seed: u64,
}

impl Scene {
    fn new(surface: Surface, material: Material) -> Self {
        Self {
            starts: surface.extent(),
            surface,
            material,
            layer: None,
            theta_deg: 30.0,
            polarisation: Polarisation::Tracked,
            incident: Stokes::UNPOLARISED,
            seed: 1,
        }
    }

    fn incidence(&self) -> Incidence {
        Incidence::from_degrees(self.theta_deg, 25.0).unwrap()
    }

    /// Traces `paths` paths from random starting points.
    fn trace(&self, paths: u64) -> Vec<PathResult> {
        let hits = self.surface.accelerator(AcceleratorKind::Auto).unwrap();
        let stack = match &self.layer {
            Some(layer) => crate::common::layer_below(&self.surface, layer, None, 100_000).unwrap(),
            None => TracedStack::default(),
        };
        let settings = PathSettings::default().with_polarisation(self.polarisation);
        let integrator =
            PathIntegrator::new(&self.surface, &*hits, self.material, settings).over(stack);
        let ([cx, cy], [_, high]) = (self.starts, self.surface.z_range());
        let k = -self.incidence().wi();
        (0..paths)
            .map(|path| {
                let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
                rng.set_stream(path);
                let [u, v] = [rng.random::<f64>(), rng.random::<f64>()];
                let origin = DVec3::new(u * cx, v * cy, high);
                if self.incident == Stokes::UNPOLARISED {
                    integrator.trace(origin, k, &mut rng)
                } else {
                    integrator.trace_polarised(origin, k, self.incident, &mut rng)
                }
            })
            .collect()
    }
}

fn flat() -> Surface {
    Surface::new(HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap())
}

fn medium(mean_free_path: f64, phase: PhaseFunction) -> ParticipatingMedium {
    ParticipatingMedium::from_mean_free_path(mean_free_path, 1.0, phase).unwrap()
}

fn clear_slab(bottom: Bottom) -> Layer {
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic).unwrap();
    Layer::slab(clear, 3.0, bottom).unwrap()
}

/// z of the mean of `value`, whose exact mean is `expected`.
fn z_of(paths: &[PathResult], value: impl Fn(&PathResult) -> f64, expected: f64) -> f64 {
    let n = paths.len() as f64;
    let mean = paths.iter().map(&value).sum::<f64>() / n;
    let squares: f64 = paths.iter().map(|path| (value(path) - mean).powi(2)).sum();
    (mean - expected) / (squares / (n * (n - 1.0))).sqrt()
}

/// The Stokes vector of what leaves at `end`.
fn stokes_at(path: &PathResult, end: PathEnd) -> [f64; 4] {
    let Stokes(stokes) = path.stokes;
    let flux = if path.end == end { path.flux } else { 0.0 };
    stokes.map(|element| element * flux)
}

fn degree(Stokes([i, q, u, v]): Stokes) -> f64 {
    DVec3::new(q, u, v).length() / i
}

/// Both faces reflect F of either polarisation: R = 2 F / (1 + F), and s and p do not mix.
#[test]
fn a_clear_slab_reflects_both_polarisations_by_themselves() {
    for (theta_deg, incident) in [
        (50.0, Stokes::UNPOLARISED),
        (75.0, Stokes::UNPOLARISED),
        (60.0, S),
        (75.0, P),
        (75.0, DIAGONAL),
    ] {
        let scene = Scene {
            layer: Some(clear_slab(Bottom::interface(1.0 / 1.5))),
            theta_deg,
            incident,
            ..Scene::new(flat(), GLASS)
        };
        let f = polarised_dielectric(scene.incidence().wi().z, 1.5).reflected;
        let [s, p] = [f.m00 + f.m01, f.m00 - f.m01].map(|f| 2.0 * f / (1.0 + f));
        let Stokes([_, q, ..]) = incident;
        let [of_s, of_p] = [0.5 * (1.0 + q) * s, 0.5 * (1.0 - q) * p];
        let paths = scene.trace(400_000);
        let z = [(0, of_s + of_p), (1, of_s - of_p)]
            .map(|(i, exact)| z_of(&paths, |path| stokes_at(path, PathEnd::Above)[i], exact));
        println!("{theta_deg} deg, {incident:?}: z {z:.2?}");
        assert!(z.iter().all(|z| z.abs() < 4.5), "{theta_deg}: {z:?}");
    }
}

/// R = 2 F / (1 + F) of the mean F, further away from the truth than noise is.
#[test]
fn averaged_light_forgets_the_first_face_of_a_slab() {
    let scene = Scene {
        layer: Some(clear_slab(Bottom::interface(1.0 / 1.5))),
        theta_deg: 75.0,
        polarisation: Polarisation::Averaged,
        ..Scene::new(flat(), GLASS)
    };
    let f = polarised_dielectric(scene.incidence().wi().z, 1.5).reflected;
    let [s, p] = [f.m00 + f.m01, f.m00 - f.m01].map(|f| 2.0 * f / (1.0 + f));
    let paths = scene.trace(400_000);
    assert!(paths.iter().all(|path| path.stokes == Stokes::UNPOLARISED));
    let reflected = |path: &PathResult| stokes_at(path, PathEnd::Above)[0];
    let z = z_of(&paths, reflected, 2.0 * f.m00 / (1.0 + f.m00));
    assert!(z.abs() < 4.5, "{z}");
    let z = z_of(&paths, reflected, 0.5 * (s + p));
    assert!(z > 10.0, "{z}");
}

#[test]
fn light_reflected_at_brewsters_angle_is_polarised_along_s() {
    let theta_deg = 1.5_f64.atan().to_degrees();
    let scene = Scene {
        theta_deg,
        ..Scene::new(flat(), GLASS)
    };
    let f = polarised_dielectric(scene.incidence().wi().z, 1.5);
    let paths = scene.trace(4000);
    let along_s = |end| match end {
        PathEnd::Above => 1.0,
        PathEnd::Below => f.transmitted.m01 / f.transmitted.m00,
        end => panic!("{end:?}"),
    };
    for path in &paths {
        let Stokes([i, q, u, v]) = path.stokes;
        let errors = [i - 1.0, q - along_s(path.end), u, v];
        assert!(errors.iter().all(|e| e.abs() < 1e-14), "{path:?}");
    }
    assert!(paths.iter().any(|path| path.end == PathEnd::Above));
    let p = Scene {
        incident: P,
        ..scene
    };
    let is_below = |path: &PathResult| path.end == PathEnd::Below;
    assert!(p.trace(4000).iter().all(is_below));
}

/// Mirrors turn U and V over; 70 degrees inside glass are beyond the critical angle.
#[test]
fn total_reflection_shifts_the_phase_between_s_and_p() {
    for (material, theta_deg) in [(Material::Mirror, 40.0), (GLASS.reversed(), 70.0)] {
        for incident in [S, P, DIAGONAL, CIRCULAR] {
            let scene = Scene {
                theta_deg,
                incident,
                ..Scene::new(flat(), material)
            };
            let c = scene.incidence().wi().z;
            let Stokes(expected) = incident.after(material.polarised_fresnel(c).reflected);
            for path in scene.trace(10) {
                assert_eq!((path.end, path.flux), (PathEnd::Above, 1.0));
                for (found, expected) in path.stokes.0.into_iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-14, "{path:?} {expected}");
                }
            }
        }
    }
}

#[test]
fn interfaces_keep_pure_light_pure_and_energy() {
    let rough = || crate::common::rugged(12, 10, 2.0, 5, Border::Mirrored);
    let layers = [
        None,
        Some(clear_slab(Bottom::interface(1.3))),
        Some(clear_slab(Bottom::MIRROR)),
    ];
    for material in [GLASS, GLASS.reversed(), GOLD, Material::Mirror] {
        for layer in layers {
            let opaque = material.transmitting_index().is_none();
            if opaque && layer.is_some() {
                continue;
            }
            for incident in [Stokes::UNPOLARISED, S, DIAGONAL, CIRCULAR] {
                let scene = Scene {
                    layer,
                    incident,
                    ..Scene::new(rough(), material)
                };
                for path in scene.trace(2000) {
                    let whole = path.flux + path.absorbed + path.truncated;
                    assert!((whole - 1.0).abs() < 1e-12, "{path:?}");
                    assert!((path.stokes.0[0] - 1.0).abs() < 1e-13, "{path:?}");
                    let degree = degree(path.stokes);
                    assert!(degree < 1.0 + 1e-12, "{path:?}");
                    let is_pure = incident != Stokes::UNPOLARISED;
                    assert!(!is_pure || degree > 1.0 - 1e-12, "{path:?}");
                }
            }
        }
    }
}

/// Sums of a function of x and one of y make cells plane, so that they can be split along either diagonal.
#[test]
fn a_mirrored_border_is_a_surface_with_its_mirror_images() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let n = 6;
    let [along_x, along_y]: [Vec<f64>; 2] =
        [0, 1].map(|_| (0..n).map(|_| rng.random_range(-0.8..0.8)).collect());
    let surface = |size: usize, border| {
        let image = |i: usize| if i < n { i } else { 2 * (n - 1) - i };
        let heights = (0..size * size)
            .map(|i| along_x[image(i % size)] + along_y[image(i / size)])
            .collect();
        let field = HeightField::new(heights, [size, size], [1.0, 1.0]).unwrap();
        Surface::new(field.with_border(border))
    };
    let bottom = Bottom::interface(1.0 / 1.5);
    let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic).unwrap();
    let rayleigh = medium(3.0, PhaseFunction::Rayleigh);
    for (material, medium, incident) in [
        (GOLD, None, DIAGONAL),
        (GLASS, None, CIRCULAR),
        (GLASS, Some(clear), DIAGONAL),
        (GLASS, Some(rayleigh), CIRCULAR),
    ] {
        let trace = |surface: Surface| {
            // The bottom lies at one depth below height zero, not below mean planes that differ.
            let thickness = 4.0 + surface.mean_plane() * surface.unit();
            let layer = medium.map(|medium| Layer::slab(medium, thickness, bottom).unwrap());
            let scene = Scene {
                layer,
                incident,
                theta_deg: 50.0,
                starts: [5.0; 2],
                ..Scene::new(surface, material)
            };
            scene.trace(1000)
        };
        let mirrored = trace(surface(n, Border::Mirrored));
        let written_out = trace(surface(2 * (n - 1), Border::Periodic));
        for (a, b) in mirrored.iter().zip(&written_out) {
            assert_eq!((a.end, a.path), (b.end, b.path));
            assert!((a.direction - b.direction).length() < 1e-11, "{a:?} {b:?}");
            assert!((a.flux - b.flux).abs() < 1e-11, "{a:?} {b:?}");
            for (a, b) in a.stokes.0.into_iter().zip(b.stokes.0) {
                assert!((a - b).abs() < 1e-10, "{a} {b}");
            }
        }
    }
}

/// Light scattered once leaves polarised across the plane of scattering, by `(1 - mu^2) / (1 + mu^2)`.
#[test]
fn rayleigh_scattering_polarises_across_its_plane() {
    let scene = Scene {
        layer: Some(Layer::half_space(medium(1.0, PhaseFunction::Rayleigh))),
        ..Scene::new(flat(), Material::Dielectric { eta: 1.0 })
    };
    let k = -scene.incidence().wi();
    let paths = scene.trace(5000);
    let once = paths.iter().filter(|path| path.scatterings == 1);
    for path in once.clone() {
        let mu = k.dot(path.direction);
        let [s, p] = reference_axes(path.direction);
        let axis = k.cross(path.direction);
        let psi = axis.dot(p).atan2(axis.dot(s));
        let across = (1.0 - mu * mu) / (1.0 + mu * mu);
        let expected = [
            1.0,
            across * (2.0 * psi).cos(),
            across * (2.0 * psi).sin(),
            0.0,
        ];
        for (found, expected) in path.stokes.0.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{path:?} {expected}");
        }
    }
    assert!(once.count() > 500);
}

#[test]
fn diffuse_bottoms_and_other_phase_functions_leave_unpolarised_light() {
    let forwards = PhaseFunction::henyey_greenstein(0.5).unwrap();
    let layers = [
        clear_slab(Bottom::lambertian(0.8)),
        Layer::half_space(medium(1.0, PhaseFunction::Isotropic)),
        Layer::half_space(medium(1.0, forwards)),
    ];
    for layer in layers {
        let scene = Scene {
            layer: Some(layer),
            incident: DIAGONAL,
            ..Scene::new(flat(), Material::Dielectric { eta: 1.0 })
        };
        for path in scene.trace(1000) {
            assert!(degree(path.stokes) < 1e-14, "{path:?}");
        }
    }
}
