//! The wavefront: the same bytes with all vector instructions, and loops over many rays that agree with one ray.

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_surface::{Border, HeightField};
use asperity_tally::{
    ControlVariate, Side, Tallies, TallySpec, TallyValues, UnshadowedFluxes, VisibleFractions,
};
use asperity_tracer::{
    AcceleratorKind, BatchedRays, Branching, BuildAccelerator, CullingClass, Escape, Geometry,
    HalfSpace, Heading, Illumination, Instructions, PathSettings, PathStream, Polarisation, Query,
    RayBatch, Sampling, Starts, Surface, TileRay, Tracer, Triangles, Work,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{rugged, turned, waves};

/// Strata along a side of a batch.
const STRATA: u32 = 30;

const INSTRUCTIONS: [Instructions; 3] = [
    Instructions::Portable,
    Instructions::Avx2,
    Instructions::Avx512,
];

/// A scene and how it is traced.
struct Scene {
    surface: Surface,
    material: Material,
    incident: HalfSpace,
    light: Illumination,
    branching: Branching,
    polarisation: Polarisation,
    has_control_variate: bool,
    has_layer: bool,
}

impl Scene {
    fn new(surface: Surface, material: Material, theta_deg: f64) -> Self {
        Self {
            surface,
            material,
            incident: HalfSpace::Above,
            light: Illumination::new(Incidence::from_degrees(theta_deg, 25.0).unwrap(), false),
            branching: Branching::Split,
            polarisation: Polarisation::Tracked,
            has_control_variate: false,
            has_layer: false,
        }
    }

    /// Traces one batch with the given instructions.
    fn trace(&self, instructions: Instructions) -> (TallyValues, Work) {
        let control_variate = self.control_variate();
        let rays = BatchedRays::of_one(STRATA);
        let (sums, work) = self.trace_batches(&rays, 7, instructions, control_variate.as_ref());
        (sums.into_fractions(900).remove(0), work)
    }

    /// Traces rays of several batches of 900, of which `first` is the number of the first.
    fn trace_batches<'c>(
        &self,
        rays: &BatchedRays,
        first: u64,
        instructions: Instructions,
        control_variate: Option<&'c ControlVariate>,
    ) -> (Tallies<'c>, Work) {
        let accelerator = self.surface.accelerator(AcceleratorKind::Mesh).unwrap();
        let settings = PathSettings::new(self.branching, 0.02, 30)
            .unwrap()
            .with_polarisation(self.polarisation);
        let mut tracer = Tracer::new(
            &self.surface,
            &*accelerator,
            self.material,
            self.incident,
            settings,
        )
        .with_instructions(instructions);
        if self.has_layer {
            let medium =
                ParticipatingMedium::from_mean_free_path(4.0, 0.9, PhaseFunction::Rayleigh);
            let bottom = Bottom::lambertian(0.5);
            let layer = Layer::slab(medium.unwrap(), 20.0, bottom).unwrap();
            tracer =
                tracer.over(crate::common::layer_below(&self.surface, &layer, None, 1000).unwrap());
        }
        let stream = PathStream::new(3, 1).from_batch(first);
        tracer.batches(&self.light, rays, self.spec(), control_variate, stream)
    }

    fn spec(&self) -> TallySpec {
        let spec = TallySpec::default().with_polarimetry(self.polarisation.polarimetry());
        if self.has_layer {
            spec.with_medium()
        } else {
            spec
        }
    }

    fn control_variate(&self) -> Option<ControlVariate> {
        self.has_control_variate.then(|| half_of_all(self.spec()))
    }
}

/// A control variate that removes half of the single scattering; that its expectation is wrong does not matter here.
fn half_of_all(spec: TallySpec) -> ControlVariate {
    let n_theta = spec.grid().n_theta();
    let fractions = VisibleFractions {
        rings: [vec![0.5; n_theta], vec![0.5; n_theta]],
        absorbed: 0.5,
    };
    let fluxes = UnshadowedFluxes {
        bins: vec![0.0; spec.grid().len()],
        rings: [vec![0.0; n_theta], vec![0.0; n_theta]],
        in_plane: Side::BOTH.map(|side| vec![0.0; spec.in_plane_filter(side).len()]),
        absorbed: 0.0,
    };
    ControlVariate::new(spec, fractions, &fluxes)
}

fn scenes() -> Vec<Scene> {
    let on_surface = |theta_deg| Illumination {
        starts: Starts::OnSurface,
        ..Illumination::new(Incidence::from_degrees(theta_deg, 10.0).unwrap(), true)
    };
    let smooth = || Surface::new(waves(32, 1.5, 4));
    let rough = |border| rugged(17, 12, 0.7, 5, border);
    let glass = Material::dielectric(1.5).unwrap();
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let dense = Material::dielectric(1.0 / 1.5).unwrap();
    let white = Material::lambertian(0.8).unwrap();
    vec![
        Scene::new(smooth(), glass, 30.0),
        Scene {
            polarisation: Polarisation::Mueller,
            ..Scene::new(rough(Border::Mirrored), dense, 60.0)
        },
        Scene {
            polarisation: Polarisation::Mueller,
            ..Scene::new(rough(Border::Open), gold, 75.0)
        },
        Scene {
            polarisation: Polarisation::Averaged,
            ..Scene::new(rough(Border::Periodic), gold, 75.0)
        },
        Scene {
            branching: Branching::Pick,
            incident: HalfSpace::Below,
            polarisation: Polarisation::Both,
            ..Scene::new(rough(Border::Periodic), dense, 40.0)
        },
        Scene {
            has_control_variate: true,
            ..Scene::new(rough(Border::Periodic), glass, 50.0)
        },
        Scene {
            has_control_variate: true,
            light: Illumination {
                sampling: Sampling::Random,
                ..on_surface(65.0)
            },
            ..Scene::new(smooth(), glass, 0.0)
        },
        Scene {
            incident: HalfSpace::Below,
            polarisation: Polarisation::Mueller,
            light: on_surface(60.0),
            ..Scene::new(rough(Border::Mirrored), glass, 0.0)
        },
        Scene {
            polarisation: Polarisation::Tracked,
            light: Illumination {
                stokes: [0.6, 0.3, 0.2],
                ..on_surface(0.0)
            },
            ..Scene::new(rough(Border::Open), gold, 0.0)
        },
        Scene {
            polarisation: Polarisation::Both,
            light: Illumination {
                starts: Starts::FromAbove,
                ..on_surface(50.0)
            },
            ..Scene::new(smooth(), glass, 0.0)
        },
        Scene {
            has_layer: true,
            branching: Branching::Pick,
            polarisation: Polarisation::Mueller,
            ..Scene::new(smooth(), glass, 20.0)
        },
        Scene {
            polarisation: Polarisation::Both,
            ..Scene::new(rough(Border::Mirrored), white, 60.0)
        },
        Scene {
            incident: HalfSpace::Below,
            polarisation: Polarisation::Averaged,
            ..Scene::new(rough(Border::Periodic), white, 40.0)
        },
    ]
}

#[test]
fn all_instructions_give_the_same_bytes() {
    for (number, scene) in scenes().iter().enumerate() {
        let portable = scene.trace(Instructions::Portable);
        for instructions in INSTRUCTIONS {
            if !instructions.are_available() {
                println!("skipped: this machine has no {instructions}");
                continue;
            }
            let (values, work) = scene.trace(instructions);
            assert_eq!(work, portable.1, "scene {number}, {instructions}");
            let differ = values.iter().zip(portable.0.iter());
            let differ = differ.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!(differ, 0, "scene {number}, {instructions}");
        }
    }
}

/// Rays from all around over a patch that is open: each of a mirror leaves, or is lost beside the patch, as a whole, and each that misses
/// leaves with order zero or not at all.
#[test]
fn given_rays_end_completely_and_alike_with_all_instructions() {
    let surface = rugged(17, 12, 1.5, 5, Border::Open);
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let [_, high] = surface.z_range();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let [width, depth] = surface.extent();
    let rays: Vec<Heading> = (0..5000)
        .map(|_| {
            let [x, y] = [width, depth].map(|size| size * rng.random_range(-0.5..1.5));
            let level = DVec3::new(
                rng.random_range(-2.0..2.0),
                rng.random_range(-2.0..2.0),
                0.0,
            );
            Heading {
                origin: DVec3::new(x, y, high + 3.0),
                direction: (level - DVec3::Z).normalize(),
                mirrored: [false; 2],
            }
        })
        .collect();
    let settings = PathSettings::new(Branching::Split, 1e-3, 3).unwrap();
    let settings = settings.with_polarisation(Polarisation::Averaged);
    for material in [Material::Mirror, Material::dielectric(1.5).unwrap()] {
        let trace = |instructions| {
            let tracer = Tracer::new(
                &surface,
                &*accelerator,
                material,
                HalfSpace::Above,
                settings,
            );
            let mut exits = Vec::new();
            let tracer = tracer.with_instructions(instructions);
            let found = tracer.given_rays(&rays, PathStream::new(3, 1), |ray, exit| {
                exits.push((ray, *exit));
            });
            (exits, found)
        };
        let (exits, found) = trace(Instructions::Portable);
        for instructions in INSTRUCTIONS {
            if instructions.are_available() {
                let alike = trace(instructions) == (exits.clone(), found.clone());
                assert!(alike, "{material:?}, {instructions}");
            }
        }
        let met = found.met.iter().filter(|met| **met).count();
        let left = exits.iter().filter(|(_, exit)| exit.path.order() > 0);
        let left: f64 = left.map(|(_, exit)| exit.flux).sum();
        let lost = [found.left_patch, found.truncated, found.lost];
        println!("{met} met, {left} left, {lost:?}");
        assert!(lost[0] > 5.0 && lost[1] > 1.0 && lost[2] == 0.0, "{lost:?}");
        let sum = left + found.left_patch + found.truncated;
        // Roulette adds and removes less than a thousandth at a time.
        let roulette = if material == Material::Mirror {
            1e-9
        } else {
            0.2
        };
        assert!((sum - met as f64).abs() < roulette, "{sum} of {met}");
        for (ray, exit) in &exits {
            assert_eq!(exit.path.order() > 0, found.met[*ray as usize], "{ray}");
        }
    }
}

/// Three batches that are traced together, in parts of any size that are added backwards, have the bytes of each alone.
#[test]
fn neither_batches_traced_together_nor_their_parts_change_a_byte() {
    for (number, scene) in scenes().iter().enumerate() {
        if scene.light.sampling != Sampling::Stratified {
            continue;
        }
        let best = Instructions::best();
        let control_variate = scene.control_variate();
        let trace = |rays, first| scene.trace_batches(&rays, first, best, control_variate.as_ref());
        let alone = [7, 8, 9].map(|batch| trace(BatchedRays::of_one(STRATA), batch));
        let expected = alone
            .iter()
            .map(|(_, work)| work.segments + work.segments_skipped);
        let expected: u64 = expected.sum();
        let alone = alone.map(|(sums, _)| sums.into_fractions(900).remove(0));
        for bounds in [
            vec![0, 900],
            vec![0, 1, 8, 511, 900],
            vec![0, 450, 899, 900],
        ] {
            let parts = bounds.windows(2).rev();
            let traced = parts.map(|part| trace(BatchedRays::new(STRATA, 3, part[0]..part[1]), 7));
            let (together, work) = traced
                .reduce(|(mut sums, mut work), (part, of_part)| {
                    sums += &part;
                    work += of_part;
                    (sums, work)
                })
                .unwrap();
            assert_eq!(
                work.segments + work.segments_skipped,
                expected,
                "scene {number}"
            );
            for (alone, together) in alone.iter().zip(together.into_fractions(900)) {
                let pairs = alone.iter().zip(together.iter());
                let differ = pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
                assert_eq!(differ, 0, "scene {number}, {bounds:?}");
            }
        }
    }
}

/// Rays from on, above, below and beside a surface, in all directions.
fn rays(surface: &Surface, count: usize) -> Vec<Query> {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let ([cx, cy], [low, high]) = (surface.extent(), surface.z_range());
    (0..count)
        .map(|i| {
            let mut uniform = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
            let mut origin = DVec3::new(
                uniform(-0.1 * cx, 1.1 * cx),
                uniform(-0.1 * cy, 1.1 * cy),
                uniform(1.2 * low, 1.2 * high),
            );
            let steepness = 10_f64.powf(uniform(-2.0, 1.5));
            let mut direction = DVec3::new(
                uniform(-1.0, 1.0),
                uniform(-1.0, 1.0),
                uniform(-1.0, 1.0) * steepness,
            );
            match i % 9 {
                0 => (origin.x, direction.x) = (cx, 0.0),
                1 => (origin.y, direction.y) = (0.0, -0.0),
                2 => (direction.x, direction.y) = (0.0, 0.0),
                3 => origin.z = high,
                _ => {}
            }
            let ray = TileRay {
                origin,
                direction: direction.normalize(),
            };
            let half_space = [HalfSpace::Above, HalfSpace::Below][i % 2];
            Query { ray, half_space }
        })
        .collect()
}

#[test]
fn culling_classes_of_many_rays_are_those_of_one() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        // Smooth but for a corner, so that bounds on what lies ahead say more than those of the whole.
        let smooth = waves(160, 0.3, 2);
        let mut heights = smooth.heights().to_vec();
        (0..400).for_each(|i| heights[160 * (i / 20) + i % 20] *= (i % 7) as f64);
        let field = HeightField::new(heights, smooth.shape(), smooth.spacing()).unwrap();
        let surface = Surface::new(field.with_border(border));
        let queries = rays(&surface, 5000);
        let batch: RayBatch = queries.iter().collect();
        let mut classes = vec![CullingClass::Elsewhere; queries.len()];
        surface.culling_classes(batch.columns(), &mut classes);
        let mut found = [0; 4];
        for (Query { ray, half_space }, class) in queries.iter().zip(classes) {
            let expected = match surface.escapes(ray, *half_space) {
                _ if !surface.is_in_tile(ray.origin) => CullingClass::Elsewhere,
                None => CullingClass::Unknown,
                Some(Escape::SteeperThanAll) => CullingClass::SteeperThanAll,
                Some(Escape::AboveHorizon) => CullingClass::AboveHorizon,
            };
            assert_eq!(class, expected, "{ray:?}");
            found[class as usize] += 1;
        }
        assert!(found.iter().all(|count| *count > 50), "{found:?}");
    }
}

#[test]
fn many_rays_arrive_where_one_does() {
    let surface = rugged(9, 7, 2.0, 8, Border::Periodic);
    arrive_alike(&Surface::new(turned(surface.field())));
    arrive_alike(&surface);
}

fn arrive_alike(surface: &Surface) {
    let queries = rays(surface, 500);
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let facets: Vec<_> = (0..queries.len())
        .map(|_| surface.facet(rng.random_range(0..surface.facet_count())))
        .collect();
    let ts: Vec<f64> = facets.iter().map(|_| 5.0 * rng.random::<f64>()).collect();
    let column = |of: fn(&Query) -> f64| -> Vec<f64> { queries.iter().map(of).collect() };
    let mut origin = [
        column(|q| q.ray.origin.x),
        column(|q| q.ray.origin.y),
        column(|q| q.ray.origin.z),
    ];
    let direction = [
        column(|q| q.ray.direction.x),
        column(|q| q.ray.direction.y),
        column(|q| q.ray.direction.z),
    ];
    let mut normal = origin.clone();
    surface.arrive(
        &facets,
        &ts,
        origin.each_mut().map(|column| &mut column[..]),
        direction.each_ref().map(|column| &column[..]),
        normal.each_mut().map(|column| &mut column[..]),
    );
    let at =
        |columns: &[Vec<f64>; 3], i: usize| DVec3::from_array(columns.each_ref().map(|c| c[i]));
    for (i, Query { ray, .. }) in queries.iter().enumerate() {
        assert_eq!(at(&origin, i), surface.snap(facets[i], ray.at(ts[i])));
        assert_eq!(at(&normal, i), surface.normal(facets[i]));
    }
}
