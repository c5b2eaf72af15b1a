//! Light paths on smooth cells: the same bytes with every accelerator and all instructions, no light lost, and the path
//! engine against the reference.

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyStatistics, TallyValues};
use asperity_tracer::{
    Accelerator, AcceleratorKind, Branching, BuildAccelerator, Geometry, HalfSpace, Illumination,
    Instructions, PathEnd, PathIntegrator, PathSettings, PathStream, Pyramid, Sampling,
    SearchedSurface, SmoothSurface, Starts, Tracer, Work,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Random heights of root mean square `sigma` and correlation length 4.
fn random(sigma: f64, border: Border) -> SmoothSurface {
    let psd = Psd::gaussian(sigma, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], true).unwrap();
    let field: HeightField = synthesis.draw(2, 0).unwrap().with_border(border);
    SmoothSurface::new(SplineSurface::through(&field))
}

/// A scene, and how it is lit.
struct Scene {
    surface: SmoothSurface,
    material: Material,
    incident: HalfSpace,
    light: Illumination,
    branching: Branching,
    has_layer: bool,
}

impl Scene {
    fn new(surface: SmoothSurface, material: Material, theta_deg: f64) -> Self {
        Self {
            surface,
            material,
            incident: HalfSpace::Above,
            light: Illumination::new(Incidence::from_degrees(theta_deg, 25.0).unwrap(), false),
            branching: Branching::Split,
            has_layer: false,
        }
    }

    fn trace(
        &self,
        accelerator: &dyn Accelerator<SmoothSurface>,
        instructions: Instructions,
    ) -> (TallyValues, Work) {
        let settings = PathSettings::new(self.branching, 0.02, 1000).unwrap();
        let mut spec = TallySpec::default();
        let mut tracer = Tracer::new(
            &self.surface,
            accelerator,
            self.material,
            self.incident,
            settings,
        )
        .with_instructions(instructions);
        if self.has_layer {
            spec = spec.with_medium();
            let medium =
                ParticipatingMedium::from_mean_free_path(4.0, 0.9, PhaseFunction::Isotropic);
            let bottom = Bottom::lambertian(0.5);
            let layer = Layer::slab(medium.unwrap(), 30.0, bottom).unwrap();
            tracer =
                tracer.over(crate::common::layer_below(&self.surface, &layer, None, 1000).unwrap());
        }
        let stream = PathStream::new(3, 1).from_path(1000);
        tracer.batch(&self.light, 40, spec, None, stream)
    }
}

fn scenes() -> Vec<Scene> {
    let glass = Material::dielectric(1.5).unwrap();
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let dense = Material::dielectric(1.0 / 1.5).unwrap();
    let white = Material::lambertian(0.8).unwrap();
    vec![
        Scene::new(random(2.0, Border::Periodic), glass, 30.0),
        Scene::new(random(8.0, Border::Periodic), dense, 0.0),
        Scene::new(random(4.0, Border::Mirrored), dense, 60.0),
        Scene::new(random(4.0, Border::Open), gold, 75.0),
        Scene {
            branching: Branching::Pick,
            incident: HalfSpace::Below,
            ..Scene::new(random(2.0, Border::Periodic), dense, 40.0)
        },
        Scene {
            light: Illumination {
                starts: Starts::OnSurface,
                sampling: Sampling::Random,
                ..Illumination::new(Incidence::from_degrees(65.0, 10.0).unwrap(), true)
            },
            ..Scene::new(random(4.0, Border::Periodic), glass, 0.0)
        },
        Scene {
            has_layer: true,
            branching: Branching::Pick,
            ..Scene::new(random(2.0, Border::Periodic), glass, 20.0)
        },
        Scene::new(random(8.0, Border::Mirrored), white, 30.0),
        Scene {
            incident: HalfSpace::Below,
            ..Scene::new(random(8.0, Border::Periodic), white, 70.0)
        },
        Scene::new(random(4.0, Border::Open), white, 75.0),
    ]
}

#[test]
fn every_search_gives_the_same_bytes_and_loses_no_light() {
    for (number, scene) in scenes().iter().enumerate() {
        let search = |kind| scene.surface.accelerator(kind).unwrap();
        let (expected, work) = scene.trace(
            &*search(AcceleratorKind::BruteForce),
            Instructions::Portable,
        );
        assert!(work.segments > 2000, "scene {number}: {work:?}");
        let budget = expected.budget();
        let sum = budget.reflected + budget.transmitted + budget.absorbed + budget.truncated;
        assert_eq!(budget.lost, 0.0, "scene {number}");
        // Points of the surface do not each stand for the same flux.
        if scene.light.starts == Starts::FromAbove {
            assert!((sum - 1.0).abs() < 1e-12, "scene {number}: {sum}");
        }
        let mut searches = vec![search(AcceleratorKind::Mesh)];
        let instructions = [
            Instructions::Portable,
            Instructions::Avx2,
            Instructions::Avx512,
        ];
        searches.extend(instructions.map(|instructions| -> Box<dyn Accelerator<_>> {
            let pyramid = Pyramid::build(&scene.surface).unwrap();
            Box::new(pyramid.with_instructions(instructions))
        }));
        for (i, search) in searches.iter().enumerate() {
            for instructions in instructions {
                let (values, other) = scene.trace(&**search, instructions);
                assert_eq!(other, work, "scene {number}, search {i}, {instructions}");
                let same = values.iter().zip(expected.iter()).all(|(a, b)| a == b);
                assert!(same, "scene {number}, search {i}, {instructions}");
            }
        }
    }
}

/// Both draw random numbers of their own, so what they find agrees within the noise of both.
#[test]
fn the_path_engine_agrees_with_the_reference() {
    const BATCHES: u64 = 60;
    const STRATA: u32 = 12;
    for (sigma, eta, theta_deg) in [(8.0, 1.0 / 1.5, 10.0), (2.0, 1.5, 60.0)] {
        let surface = random(sigma, Border::Periodic);
        let search = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let material = Material::dielectric(eta).unwrap();
        let incidence = Incidence::from_degrees(theta_deg, 25.0).unwrap();
        let settings = PathSettings::default();
        let tracer = Tracer::new(&surface, &*search, material, HalfSpace::Above, settings);
        let light = Illumination::new(incidence, false);
        let mut engine = TallyStatistics::new(TallySpec::default());
        for block in 0..BATCHES {
            let stream = PathStream::new(7, 0).from_path(block << 20);
            engine.push(
                &tracer
                    .batch(&light, STRATA, TallySpec::default(), None, stream)
                    .0,
            );
        }

        // Fluxes by side, single and multiple
        let reference = PathIntegrator::new(&surface, &*search, material, settings);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let ([cx, cy], [_, high]) = (surface.extent(), surface.z_range());
        let batches: Vec<[f64; 4]> = (0..BATCHES)
            .map(|_| {
                let mut fluxes = [0.0; 4];
                let paths = f64::from(STRATA * STRATA);
                for _ in 0..STRATA * STRATA {
                    let place = [rng.random_range(0.0..cx), rng.random_range(0.0..cy)];
                    let origin = DVec3::new(place[0], place[1], high);
                    let found = reference.trace(origin, -incidence.wi(), &mut rng);
                    let side = match found.end {
                        PathEnd::Above => 0,
                        PathEnd::Below => 2,
                        _ => continue,
                    };
                    let multiple = usize::from(found.path.order() > 1);
                    fluxes[side + multiple] += found.flux / paths;
                }
                fluxes
            })
            .collect();
        let components = [
            (Side::Reflected, Component::Single),
            (Side::Reflected, Component::Multiple),
            (Side::Transmitted, Component::Single),
            (Side::Transmitted, Component::Multiple),
        ];
        for (i, (side, component)) in components.into_iter().enumerate() {
            let found = engine.flux(side, component);
            let n = BATCHES as f64;
            let mean = batches.iter().map(|b| b[i]).sum::<f64>() / n;
            let squares: f64 = batches.iter().map(|b| (b[i] - mean).powi(2)).sum();
            let error = (squares / (n * (n - 1.0))).sqrt();
            let z = (found.mean - mean) / error.hypot(found.se.unwrap());
            println!(
                "{eta} {theta_deg} {side:?} {component:?}: {found:?} {mean} +- {error}, z {z}"
            );
            // 8 comparisons: one in 1e4 runs exceeds 4.5 of a t distribution of 118 degrees of freedom.
            assert!(z.abs() < 4.5, "{eta} {side:?} {component:?}: z = {z}");
        }
    }
}

/// Far below the surface the heights of a bottom with a shape lose digits, so that light begins beneath it there, by far more than rounding on
/// the bottom itself.
#[test]
fn no_light_is_lost_at_a_smooth_bottom_of_any_depth() {
    let surface = random(4.0, Border::Periodic);
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    for thickness in [1e3, 1e5, 1e7] {
        let medium =
            ParticipatingMedium::from_mean_free_path(thickness, 0.9, PhaseFunction::Isotropic);
        let bottom = Bottom::lambertian(1.0);
        let layer = Layer::slab(medium.unwrap(), thickness, bottom).unwrap();
        let below = SearchedSurface {
            geometry: &surface,
            accelerator: &*accelerator,
        };
        let settings = PathSettings::new(Branching::Pick, 0.02, 1000).unwrap();
        let glass = Material::dielectric(1.5).unwrap();
        let light = Illumination::new(Incidence::from_degrees(30.0, 25.0).unwrap(), false);
        let spec = TallySpec::default().with_medium();
        let tracer = Tracer::new(&surface, &*accelerator, glass, HalfSpace::Above, settings)
            .over(crate::common::layer_below(&surface, &layer, Some(below), 1000).unwrap());
        let (values, _) = tracer.batch(&light, 100, spec, None, PathStream::new(3, 1));
        println!("{thickness}: {:?}", values.budget());
        assert_eq!(values.budget().lost, 0.0, "{thickness}");
    }
}
