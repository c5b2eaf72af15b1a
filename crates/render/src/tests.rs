//! Pictures whose radiance is known, and pictures against light that is traced forwards.

use asperity_simulate::{BottomSurface, Silent, smooth_shape};
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Bottom, Incidence, ParticipatingMedium, PhaseFunction, dielectric};
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{BatchStatistics, Estimate, TallyResult, TallySpec};
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, HalfSpace, Illumination, PathEnd, PathSettings,
    PathStream, Polarisation, SearchedSurface, TracedStack, Tracer,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

const GLASS: Material = Material::Dielectric { eta: 1.5 };

/// A rough surface of its own border.
fn rough(border: Border) -> HeightField {
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], true).unwrap();
    synthesis.draw(3, 0).unwrap().with_border(border)
}

/// The shape of heights with two triangles per cell.
fn facets(field: HeightField) -> Shape {
    Shape::height_field(field)
}

/// The shape of the same heights with smooth cells.
fn smooth(field: &HeightField) -> Shape {
    smooth_shape(field).unwrap()
}

fn flat() -> HeightField {
    HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).unwrap()
}

fn slab(albedo: f64, thickness: f64, bottom: Bottom) -> Layer {
    let phase = PhaseFunction::henyey_greenstein(0.3).unwrap();
    let medium = ParticipatingMedium::from_mean_free_path(4.0, albedo, phase).unwrap();
    Layer::slab(medium, thickness, bottom).unwrap()
}

fn settings(theta: f64, projection: Projection, lights: Lights) -> RenderSettings {
    let towards = Incidence::from_degrees(theta, 250.0).unwrap();
    RenderSettings {
        view: View::new(projection, towards, [16.0, 16.0], 32.0).unwrap(),
        lights,
        size: [16, 12],
        samples: 64,
        seed: 4,
        paths: PathSettings::new(Branching::Pick, 0.2, 1000).unwrap(),
        accelerator: AcceleratorKind::Auto,
        most_scatterings: 100_000,
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

const ORTHOGRAPHIC: Projection = Projection::Orthographic;
const PINHOLE: Projection = Projection::Pinhole { field_of_view: 0.5 };

/// In a furnace nothing can be distinguished, since everything that does not absorb passes on equal
/// radiance. Light that a limit ends is dark, and reported. Roulette alone makes noise, of some 0.001 in the mean.
#[test]
fn a_white_furnace_shows_nothing() {
    let furnace = Lights::new(1.0, 1.0, None).unwrap();
    let interface = Bottom::interface(1.0 / 1.5);
    let white = Bottom::lambertian(1.0);
    for (name, shape, material, layer) in [
        ("flat glass", facets(flat()), GLASS, None),
        ("rough glass", facets(rough(Border::Periodic)), GLASS, None),
        (
            "mirror",
            facets(rough(Border::Mirrored)),
            Material::Mirror,
            None,
        ),
        (
            "open slab",
            facets(flat()),
            GLASS,
            Some(slab(1.0, 3.0, Bottom::Open)),
        ),
        (
            "slab",
            facets(rough(Border::Periodic)),
            GLASS,
            Some(slab(1.0, 20.0, interface).on(BottomSurface::Same)),
        ),
        (
            "over a mirror",
            facets(rough(Border::Mirrored)),
            GLASS,
            Some(slab(1.0, 14.0, Bottom::MIRROR)),
        ),
        (
            "over white",
            facets(rough(Border::Periodic)),
            GLASS,
            Some(slab(1.0, 14.0, white)),
        ),
        (
            "smooth glass",
            smooth(&rough(Border::Periodic)),
            GLASS,
            None,
        ),
        (
            "smooth mirror",
            smooth(&rough(Border::Mirrored)),
            Material::Mirror,
            None,
        ),
        (
            "smooth slab",
            smooth(&rough(Border::Periodic)),
            GLASS,
            Some(slab(1.0, 20.0, interface).on(BottomSurface::Same)),
        ),
        (
            "smooth over white",
            smooth(&rough(Border::Mirrored)),
            GLASS,
            Some(slab(1.0, 14.0, white)),
        ),
    ] {
        for projection in [ORTHOGRAPHIC, PINHOLE] {
            let settings = RenderSettings {
                samples: 4,
                ..settings(40.0, projection, furnace)
            };
            let outcome = render(&shape, material, layer.as_slice(), &settings, &Silent);
            let outcome = outcome.unwrap();
            assert_eq!(outcome.lost, 0.0, "{name}");
            // Splitting at the first facet may leave less than the threshold of roulette, 0.2; else nothing
            // is left to chance but which way a flux of one goes.
            let (radiance, errors) = (&outcome.picture.radiance, &outcome.picture.error);
            let noise = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / errors.len() as f64;
            let difference = mean(radiance) + outcome.truncated - 1.0;
            println!("{name}: {difference:.2e} +- {noise:.2e}");
            assert!(difference.abs() <= 4.5 * noise + 1e-12, "{name}");
            assert!(outcome.truncated < 1e-3, "{name}: {}", outcome.truncated);
        }
    }
}

/// Under a uniform sky with nothing below, flat glass shows Fresnel's reflectance, without noise: both
/// branches are followed.
#[test]
fn flat_glass_reflects_the_sky_by_fresnel() {
    for (theta, sky, below) in [(0.0, 1.0, 0.0), (56.0, 2.0, 0.0), (75.0, 0.0, 3.0)] {
        let lights = Lights::new(sky, below, None).unwrap();
        let settings = settings(theta, ORTHOGRAPHIC, lights);
        let outcome = render(&facets(flat()), GLASS, &[], &settings, &Silent).unwrap();
        let fresnel = dielectric(theta.to_radians().cos(), 1.5);
        let expected = sky * fresnel.reflected + below * fresnel.transmitted;
        for radiance in outcome.picture.radiance {
            assert!((radiance - expected).abs() < 1e-12, "{theta}: {radiance}");
        }
        assert!(outcome.picture.coverage.iter().all(|c| *c == 1.0));
    }
}

/// Pictures that a tracer makes of many rays at a time are those of the reference, pixel by pixel: radiance, coverage and losses.
#[test]
fn pictures_are_those_of_the_reference() {
    let gold = Material::conductor(0.4, 2.4).unwrap();
    let sun = Incidence::from_degrees(40.0, 200.0).unwrap();
    let sun = Sun::new(sun, 0.5, 0.4, None).unwrap();
    let lights = Lights::new(0.8, 0.6, Some(sun)).unwrap();
    let lights = lights.with_horizon(0.2).unwrap();
    let body = |border| match border {
        // Glass that floats over nothing, with overhangs
        None => Shape::triangle_mesh(octahedron()),
        Some(border) => facets(rough(border)),
    };
    let rounded = |border| smooth(&rough(border));
    for (name, shape, material, projection, theta) in [
        ("glass", body(Some(Border::Periodic)), GLASS, PINHOLE, 75.0),
        ("open glass", body(Some(Border::Open)), GLASS, PINHOLE, 55.0),
        (
            "gold",
            body(Some(Border::Mirrored)),
            gold,
            ORTHOGRAPHIC,
            60.0,
        ),
        ("mesh", body(None), GLASS, PINHOLE, 50.0),
        (
            "smooth",
            rounded(Border::Periodic),
            GLASS,
            ORTHOGRAPHIC,
            30.0,
        ),
        (
            "smooth gold",
            rounded(Border::Mirrored),
            gold,
            PINHOLE,
            60.0,
        ),
        ("open smooth", rounded(Border::Open), GLASS, PINHOLE, 55.0),
    ] {
        let settings = RenderSettings {
            samples: 16,
            paths: PathSettings::new(Branching::Pick, 0.2, 5).unwrap(),
            ..settings(theta, projection, lights)
        };
        let towards = Incidence::from_degrees(theta, 250.0).unwrap();
        let view = View::new(projection, towards, [16.0, 16.0], 60.0);
        let settings = RenderSettings {
            view: view.unwrap(),
            ..settings
        };
        let [engine, reference] = [0, 1].map(|which| {
            let mut sums = BatchStatistics::new(2 * 16 * 12 + 3);
            for seed in 0..24 {
                let seed = 100 * which + seed + 1;
                let settings = RenderSettings { seed, ..settings };
                let found = match (which, &shape) {
                    (0, _) => render(&shape, material, &[], &settings, &Silent).unwrap(),
                    (_, Shape::HeightField { top, .. }) => {
                        by_reference(&**top, material, &settings)
                    }
                    (_, Shape::Smooth { top, .. }) => by_reference(&**top, material, &settings),
                    (_, Shape::TriangleMesh { top, .. }) => {
                        by_reference(&**top, material, &settings)
                    }
                };
                let Picture {
                    radiance, coverage, ..
                } = found.picture;
                let losses = vec![found.truncated, found.left_patch, found.lost];
                sums.push(&[radiance, coverage, losses].concat());
            }
            let squares: Vec<f64> = sums.error_squares().collect();
            (sums.means().to_vec(), squares)
        });
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0_f64);
        for i in 0..engine.0.len() {
            let difference = engine.0[i] - reference.0[i];
            let variance = engine.1[i] + reference.1[i];
            if variance < 1e-20 {
                assert!(difference.abs() < 1e-9, "{name}, {i}: {difference}");
                continue;
            }
            let z = difference / variance.sqrt();
            (sum, squares, count) = (sum + z, squares + z * z, count + 1.0);
            if i >= 2 * 16 * 12 {
                println!("{name}: loss {} {z:.2}", engine.0[i]);
                assert!(z.abs() < 4.5, "{name}: loss {i} of z = {z}");
            }
        }
        let (mean, square) = (sum / count.sqrt(), squares / count);
        println!("{name}: {count} z, their sum over its error {mean:.2}, mean square {square:.3}");
        // Of t with 46 degrees of freedom 46 / 44 is expected, with an error of sqrt(2.4 / count) where light is not rare.
        assert!(count > 50.0 && mean.abs() < 4.0, "{name}: {mean}");
        assert!((0.5..1.6).contains(&square), "{name}: {square}");
    }
}

/// An octahedron in the place of the tile of [`rough`].
fn octahedron() -> MeshSurface {
    let corners = [
        [32, 16, 12],
        [16, 32, 12],
        [0, 16, 12],
        [16, 0, 12],
        [16, 16, 20],
        [16, 16, 4],
    ];
    let vertices = corners.map(|corner| corner.map(f64::from));
    let sides = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]);
    MeshSurface::new(&vertices, sides.collect(), Border::Open).unwrap()
}

/// The picture that one path after the other makes.
fn by_reference<G: BuildAccelerator>(
    surface: &G,
    material: Material,
    settings: &RenderSettings,
) -> RenderOutcome {
    let hits = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let top = SearchedSurface {
        geometry: surface,
        accelerator: &*hits,
    };
    let matter = Matter {
        material,
        layers: &[],
    };
    let scene = Scene {
        tracer: None,
        ..scene(top, &[], matter, settings).unwrap()
    };
    let film = expose(
        &scene,
        None,
        settings.samples / SEQUENCES,
        settings,
        &Silent,
    );
    outcome(film, [0.0; 2], None)
}

/// A uniform sky is seen with the radiance that is the fraction of light from the camera that goes back up:
/// Helmholtz. The one comes from camera rays, the other from light paths over the whole tile.
#[test]
fn under_a_uniform_sky_radiance_is_the_albedo_of_light_from_the_eye() {
    let layer = slab(0.9, 14.0, Bottom::lambertian(0.5));
    for (theta, layer) in [(0.0, &[layer][..]), (60.0, &[layer]), (60.0, &[])] {
        let sky = Lights::new(1.0, 0.0, None).unwrap();
        let mut settings = settings(theta, ORTHOGRAPHIC, sky);
        // From any direction, a picture that covers whole tiles: as wide as one tile, and as high as it appears.
        let towards = Incidence::from_degrees(theta, 270.0).unwrap();
        settings.view = View::new(ORTHOGRAPHIC, towards, [16.0, 16.0], 32.0).unwrap();
        settings.size = if theta == 0.0 { [16, 16] } else { [16, 8] };
        let field = rough(Border::Periodic);
        for (name, shape) in [
            ("facets", facets(field.clone())),
            ("smooth", smooth(&field)),
        ] {
            let seen = render(&shape, GLASS, layer, &settings, &Silent).unwrap();
            let errors = &seen.picture.error;
            let noise = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / errors.len() as f64;
            let sent = match &shape {
                Shape::HeightField { top, .. } => albedo(&**top, layer, towards),
                Shape::Smooth { top, .. } => albedo(&**top, layer, towards),
                Shape::TriangleMesh { .. } => unreachable!("no mesh is tested"),
            };
            let difference = mean(&seen.picture.radiance) - sent.mean;
            let z = difference / noise.hypot(sent.se.unwrap());
            println!("{name}, theta {theta}: {difference:.2e}, z = {z:.2}");
            // One of six, of which one in 1000 is to fail by chance: Sidak 1.7e-4.
            assert!(z.abs() < 3.8, "{name}, theta {theta}: z = {z}");
        }
    }
}

/// The fraction of light from a direction that goes back up, traced forwards over the whole tile.
fn albedo<G: BuildAccelerator>(surface: &G, layers: &[Layer], towards: Incidence) -> Estimate {
    let hits = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let mut tracer = Tracer::new(
        surface,
        &*hits,
        GLASS,
        HalfSpace::Above,
        PathSettings::default().with_polarisation(Polarisation::Averaged),
    );
    let top = SearchedSurface {
        geometry: surface,
        accelerator: &*hits,
    };
    tracer = tracer.over(TracedStack::new(top, layers, &[], 100_000).unwrap());
    let mut sums = BatchStatistics::new(1);
    for block in 0..50 {
        let light = Illumination::new(towards, false);
        let stream = PathStream::new(8, block);
        let (tally, _) = tracer.batch(&light, 16, TallySpec::default(), None, stream);
        sums.push(&[tally.budget().reflected]);
    }
    sums.estimate(0)
}

/// A mirror seen from straight above shows a sun straight above where its slope is below `tan(radius / 2)`. Of a wave of largest
/// slope `m` that is the fraction `2 / pi asin(tan(radius / 2) / m)`; no reflected ray meets the wave again. The slopes of the
/// spline are those of the wave to `(k d)^4 / 180`, or 1.3e-4. Facets have eight slopes a period, each on an eighth of it.
#[test]
fn a_mirror_of_smooth_cells_shows_the_sun_by_its_true_normals() {
    let (period, largest) = (16, 0.4);
    let k = std::f64::consts::TAU / f64::from(period);
    let wave = (0..4 * period).map(|i| largest / k * (k * f64::from(i % period)).sin());
    let field = HeightField::new(wave.collect(), [4, 16], [1.0, 1.0]).unwrap();
    let towards = Incidence::from_degrees(0.0, 270.0).unwrap();
    for radius in [0.2_f64, 0.35, 0.6] {
        let sun = Sun::new(towards, 1.0, radius, None).unwrap();
        let lights = Lights::new(0.0, 0.0, Some(sun)).unwrap();
        let settings = RenderSettings {
            view: View::new(ORTHOGRAPHIC, towards, [8.0, 2.0], 16.0).unwrap(),
            size: [64, 16],
            ..settings(0.0, ORTHOGRAPHIC, lights)
        };
        let lit = |shape: &Shape| {
            let picture = render(shape, Material::Mirror, &[], &settings, &Silent);
            mean(&picture.unwrap().picture.radiance) * radius.sin().powi(2)
        };
        let expected = ((0.5 * radius).tan() / largest).asin() / std::f64::consts::FRAC_PI_2;
        let found = lit(&smooth(&field));
        println!(
            "{radius}: {found}, facets {}, expected {expected}",
            lit(&facets(field.clone()))
        );
        // 65536 places, evenly spread: the ends of four stretches lie within a pixel each.
        assert!(
            (found - expected).abs() < 2e-3,
            "{radius}: {found} {expected}"
        );
    }
}

/// Sunlight below smooth cells is found by chance, that below facets by light beams; facets as fine as these are the same surface.
#[test]
fn smooth_cells_over_a_medium_look_like_fine_facets() {
    let field = rough(Border::Periodic);
    let fine = SplineSurface::through(&field).tessellated(4).unwrap();
    let medium = ParticipatingMedium::from_mean_free_path(2.0, 0.9, PhaseFunction::Isotropic);
    let layer = Layer::half_space(medium.unwrap());
    let towards = Incidence::from_degrees(35.0, 20.0).unwrap();
    let sun = Sun::new(towards, 0.7, 0.6, None).unwrap();
    let settings = RenderSettings {
        size: [16, 16],
        ..settings(0.0, ORTHOGRAPHIC, Lights::new(0.1, 0.0, Some(sun)).unwrap())
    };
    let [smooth, fine] = [smooth(&field), facets(fine)].map(|shape| {
        let picture = render(&shape, GLASS, &[layer], &settings, &Silent);
        let picture = picture.unwrap().picture;
        let squares = picture.error.iter().map(|e| e * e).sum::<f64>();
        (
            mean(&picture.radiance),
            squares.sqrt() / picture.error.len() as f64,
        )
    });
    let z = (smooth.0 - fine.0) / smooth.1.hypot(fine.1);
    println!("{smooth:?} {fine:?}: z = {z:.2}");
    // Few enough samples to see a missing sun, and errors of some percent.
    assert!(z.abs() < 3.3 && smooth.1 < 0.04 * smooth.0, "z = {z}");
}

/// Seen from straight above with x to the right, the left half of the picture lies below the patch. Light
/// spreads over a few free paths of 0.2, a tenth of a column.
#[test]
fn a_patch_lights_what_lies_below_it_and_little_around_it() {
    let medium = ParticipatingMedium::from_mean_free_path(0.2, 0.9, PhaseFunction::Isotropic);
    let layer = Layer::half_space(medium.unwrap());
    let patch = Patch::new([0.0, 0.0], [16.0, 32.0]).unwrap();
    let towards = Incidence::from_degrees(20.0, 0.0).unwrap();
    let sun = Sun::new(towards, 1.0, 0.02, Some(patch)).unwrap();
    let lights = Lights::new(0.0, 0.0, Some(sun)).unwrap();
    let settings = settings(0.0, ORTHOGRAPHIC, lights);
    let view = View::new(
        ORTHOGRAPHIC,
        Incidence::from_degrees(0.0, 270.0).unwrap(),
        [16.0, 16.0],
        32.0,
    );
    let settings = RenderSettings {
        view: view.unwrap(),
        ..settings
    };
    let picture = render(&facets(flat()), GLASS, &[layer], &settings, &Silent)
        .unwrap()
        .picture;
    // Columns by the edges of the patch and of the picture are left out.
    let column = |i: usize| {
        (0..12)
            .map(|row| picture.radiance[row * 16 + i])
            .sum::<f64>()
    };
    let lit = mean(&[2, 3, 4, 5].map(column));
    let dark = mean(&[10, 11, 12, 13].map(column));
    assert!(lit > 1.0 && dark < 1e-3 * lit, "{lit} {dark}");
}

#[test]
fn thread_count_changes_no_byte() {
    let sun = Sun::new(Incidence::from_degrees(50.0, 10.0).unwrap(), 1.0, 0.1, None).unwrap();
    let lights = Lights::new(0.5, 0.0, Some(sun)).unwrap();
    let layer = slab(0.9, 14.0, Bottom::ABSORBING);
    let settings = settings(60.0, PINHOLE, lights);
    // Rays of a surface alone are followed thousands at a time.
    for (layers, size) in [(&[layer][..], [16, 12]), (&[], [100, 90])] {
        let settings = RenderSettings { size, ..settings };
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let field = rough(Border::Periodic);
            pool.unwrap()
                .install(|| render(&facets(field), GLASS, layers, &settings, &Silent))
                .unwrap()
        });
        assert_eq!(one.picture, three.picture);
    }
}

/// Stops at the question after so many.
struct Patience(AtomicU64, StoppedBy);

impl Observer for Patience {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        let left = self.0.load(Ordering::Relaxed);
        self.0.store(left.saturating_sub(1), Ordering::Relaxed);
        (left == 0).then_some(self.1)
    }
}

/// Renders on one thread, so that the observer is asked in a fixed order.
fn render_until(
    settings: &RenderSettings,
    progress: &Patience,
) -> Result<RenderOutcome, RenderError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap()
        .install(|| render(&facets(flat()), GLASS, &[], settings, progress))
}

#[test]
fn a_picture_that_is_stopped_has_whole_passes_and_at_least_one() {
    let lights = Lights::new(1.0, 0.0, None).unwrap();
    let settings = settings(30.0, ORTHOGRAPHIC, lights);
    // Questions are asked before the strip of each of four sequences; in the first pass only interrupts are heeded.
    for (patience, samples) in [(0, 4), (4 * 3, 12), (4 * 16, 64)] {
        let progress = Patience(AtomicU64::new(patience), StoppedBy::Time);
        let outcome = render_until(&settings, &progress).unwrap();
        assert_eq!(outcome.samples, samples);
        assert_eq!(outcome.stopped_by.is_some(), samples < 64);
        assert!(outcome.picture.error.iter().all(|e| e.is_finite()));
    }
}

#[test]
fn passes_are_short_however_many_samples_are_asked_for_and_an_interrupt_ends_one() {
    let lights = Lights::new(1.0, 0.0, None).unwrap();
    for samples in [64, 1 << 53, u64::MAX] {
        let settings = RenderSettings {
            samples,
            ..settings(30.0, ORTHOGRAPHIC, lights)
        };
        let in_no_time = Patience(AtomicU64::new(0), StoppedBy::Time);
        assert_eq!(render_until(&settings, &in_no_time).unwrap().samples, 4);
        let interrupted = Patience(AtomicU64::new(2), StoppedBy::Interrupt);
        let none = render_until(&settings, &interrupted);
        assert_eq!(none, Err(RenderError::Interrupted));
        assert!(interrupted.0.load(Ordering::Relaxed) == 0);
    }
}

/// A scene with a sun, whose pictures are compared with what random paths find of it.
struct SunnyScene {
    name: &'static str,
    shape: fn(HeightField) -> Shape,
    border: Border,
    material: Material,
    layer: Option<Layer>,
}

/// Pictures under a sun show what random paths find of it by chance. Roughness, tiles that
/// are longer than wide with unequal spacings, and a patch that is smaller than the tile make places matter.
#[test]
fn connected_sunlight_agrees_with_random_paths() {
    let isotropic = |length, albedo| {
        ParticipatingMedium::from_mean_free_path(length, albedo, PhaseFunction::Isotropic).unwrap()
    };
    let white = Bottom::lambertian(0.8);
    let absorbing =
        ParticipatingMedium::from_coefficients(0.02, 0.0, PhaseFunction::Isotropic).unwrap();
    let grey = Material::Lambertian { reflectance: 0.6 };
    let over = |medium, thickness| Some(Layer::slab(medium, thickness, white).unwrap());
    let scene = |name, border, material, layer| SunnyScene {
        name,
        shape: facets,
        border,
        material,
        layer,
    };
    let half_space = Some(Layer::half_space(isotropic(0.7, 0.9)));
    for scene in [
        scene("medium", Border::Periodic, GLASS, half_space),
        scene("matt", Border::Periodic, grey, None),
        scene("matt, mirrored", Border::Mirrored, grey, None),
        scene("matt, open", Border::Open, grey, None),
        SunnyScene {
            shape: |field| smooth(&field),
            ..scene("smooth matt", Border::Periodic, grey, None)
        },
        scene(
            "absorbing over white",
            Border::Periodic,
            GLASS,
            over(absorbing, 14.0),
        ),
        scene(
            "medium over white",
            Border::Periodic,
            GLASS,
            over(isotropic(8.0, 0.9), 14.0),
        ),
        scene(
            "mirrored over white",
            Border::Mirrored,
            GLASS,
            over(absorbing, 14.0),
        ),
    ] {
        compare_with_chance(&scene);
    }
}

fn compare_with_chance(scene: &SunnyScene) {
    let heights = rough(Border::Periodic).heights()[..32 * 8].to_vec();
    let field = HeightField::new(heights, [8, 32], [0.5, 1.5]).unwrap();
    let field = field.with_border(scene.border);
    let [width, depth] = field.extent();
    // Half the second quarter along x, and more than half the tile along y.
    let patch = Patch::new([0.3 * width, 0.2 * depth], [0.55 * width, 0.8 * depth]).unwrap();
    let towards = Incidence::from_degrees(35.0, 20.0).unwrap();
    let sun = Sun::new(towards, 0.7, 0.6, Some(patch)).unwrap();
    let lights = Lights::new(0.3, 0.0, Some(sun)).unwrap();
    let from = Incidence::from_degrees(0.0, 270.0).unwrap();
    let middle = [0.5 * width, 0.5 * depth];
    let settings = RenderSettings {
        view: View::new(ORTHOGRAPHIC, from, middle, width).unwrap(),
        size: [16, 4],
        samples: 600,
        ..settings(0.0, ORTHOGRAPHIC, lights)
    };
    let shape = (scene.shape)(field);
    let layers = scene.layer.as_slice();
    let picture = render(&shape, scene.material, layers, &settings, &Silent);
    let picture = picture.unwrap().picture;
    let chance = match &shape {
        Shape::HeightField { top, .. } => by_chance(&**top, [width, depth], scene, &settings),
        Shape::Smooth { top, .. } => by_chance(&**top, [width, depth], scene, &settings),
        Shape::TriangleMesh { .. } => unreachable!("no mesh is tested"),
    };
    let (seen, errors) = (mean(&picture.radiance), &picture.error);
    let noise = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / errors.len() as f64;
    let se = noise.hypot(chance.se.unwrap());
    let z = (seen - chance.mean) / se;
    let name = scene.name;
    println!("{name}: {seen:.5} +- {noise:.5}, chance {chance:?}: z = {z:.2}");
    assert!(se < 0.02 * seen, "{name}: too noisy");
    // One of eight, of which one in 1000 is to fail by chance: Sidak 1.3e-4, with 99 degrees of freedom.
    assert!(z.abs() < 3.95, "{name}: z = {z}");
}

/// The mean radiance of the scene of [`compare_with_chance`], in which chance alone finds the sun.
fn by_chance<G: BuildAccelerator>(
    surface: &G,
    [width, depth]: [f64; 2],
    scene: &SunnyScene,
    settings: &RenderSettings,
) -> Estimate {
    let hits = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let top = SearchedSurface {
        geometry: surface,
        accelerator: &*hits,
    };
    let stack = TracedStack::new(top, scene.layer.as_slice(), &[], 100_000).unwrap();
    let paths = settings.paths.with_polarisation(Polarisation::Averaged);
    let integrator = PathIntegrator::new(surface, &*hits, scene.material, paths).over(stack);
    let integrator = integrator.with_flight_search(FlightSearch::Nearby);
    let frame = TileFrame::of(surface);
    let seen_depth = width / 4.0;
    let high = frame.highest() + 1.0;
    let mut sums = BatchStatistics::new(1);
    for batch in 0..100 {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        rng.set_stream(batch);
        let mut sum = 0.0;
        for _ in 0..600 {
            let [u, v] = [rng.random::<f64>(), rng.random::<f64>()];
            let (x, y) = (width * u, 0.5 * depth + seen_depth * (v - 0.5));
            let origin = frame.in_tile(DVec3::new(x, y, high));
            let path = integrator.trace(origin, DVec3::NEG_Z, &mut rng);
            if path.end == PathEnd::Above {
                let place = || frame.on_mean_plane(path.origin, path.direction);
                sum += path.flux * settings.lights.above(path.direction, place);
            }
        }
        sums.push(&[sum / 600.0]);
    }
    sums.estimate(0)
}

/// The error of a pixel is that of its mean: over pictures of other seeds, pixels scatter by so much.
#[test]
fn errors_are_how_pixels_scatter() {
    let lights = Lights::new(1.0, 0.0, None).unwrap();
    let layer = slab(0.9, 3.0, Bottom::ABSORBING);
    let pictures: Vec<Picture> = [1, 2]
        .map(|seed| {
            let settings = RenderSettings {
                seed,
                ..settings(0.0, ORTHOGRAPHIC, lights)
            };
            render(&facets(flat()), GLASS, &[layer], &settings, &Silent)
                .unwrap()
                .picture
        })
        .into();
    let [a, b] = [&pictures[0], &pictures[1]];
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let apart = squares(&mut a.radiance.iter().zip(&b.radiance).map(|(a, b)| a - b));
    let said = squares(&mut a.error.iter().chain(&b.error).copied());
    let ratio = apart / said;
    println!("squares of differences over those of errors: {ratio:.3}");
    // 192 pixels: the ratio scatters by sqrt(2 / 192) = 0.10, and by less for 3 degrees of freedom each in two pictures.
    assert!((ratio - 1.0).abs() < 0.4, "{ratio}");
}
