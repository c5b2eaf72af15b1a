//! Layers below a surface: the path engine against the reference, which follows one path at a time.
//!
//! [`Tracer`] divides light, waits for searches, and passes over most of them; [`PathIntegrator`] does none of it.
//! Both draw random numbers of their own, so what they find must agree within the noise of both.

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_surface::{Border, HeightField};
use asperity_tally::{
    Component, Entry, HemisphereGrid, Side, TallyResult, TallySpec, TallyStatistics, TallyValues,
};
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, FlightSearch, Geometry, HalfSpace, Illumination,
    PathEnd, PathIntegrator, PathResult, PathSettings, PathStream, SearchedSurface, Surface,
    TracedStack, Tracer,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Batches of each, and paths of one: `STRATA^2`.
const BATCHES: u64 = 100;
const STRATA: u32 = 12;
const PATHS: f64 = (STRATA * STRATA) as f64;

/// |z| that one of all comparisons of this file (some 700, counted up to 1000) exceeds once in 1000 times:
/// by Sidak 1e-6 for each, which a normal distribution exceeds at 4.9; differences of two means of 100
/// batches have 198 degrees of freedom, by which that quantile grows by (z^3 + z) / (4 * 198).
const BOUND: f64 = 4.9 + 0.16;

/// Events of an entry that its noise is about normal with.
const ENOUGH: f64 = 100.0;

/// Everything that is told apart.
struct Scene {
    border: Border,
    height: f64,
    eta: f64,
    medium: ParticipatingMedium,
    end: Option<(Bottom, f64)>,
    /// Height of a bottom of its own.
    rough: Option<f64>,
    /// Further layers, and the heights of bottoms of their own.
    further: Vec<(Layer, Option<f64>)>,
    settings: PathSettings,
    max_scatterings: u32,
    search: FlightSearch,
}

const ISOTROPIC: PhaseFunction = PhaseFunction::Isotropic;
const RAYLEIGH: PhaseFunction = PhaseFunction::Rayleigh;
const INTERFACE: Bottom = Bottom::interface(1.0 / 1.5);

fn scene(border: Border, path: f64, albedo: f64, phase: PhaseFunction) -> Scene {
    Scene {
        border,
        height: 1.0,
        eta: 1.5,
        medium: ParticipatingMedium::from_mean_free_path(path, albedo, phase).unwrap(),
        end: None,
        rough: None,
        further: Vec::new(),
        settings: PathSettings::default(),
        max_scatterings: 100_000,
        search: FlightSearch::Full,
    }
}

fn clear() -> ParticipatingMedium {
    ParticipatingMedium::from_coefficients(0.0, 0.0, ISOTROPIC).unwrap()
}

fn forwards(g: f64) -> PhaseFunction {
    PhaseFunction::henyey_greenstein(g).unwrap()
}

impl Scene {
    fn over(self, bottom: Bottom, thickness: f64) -> Self {
        let end = Some((bottom, thickness));
        Self { end, ..self }
    }

    fn over_rough(self, bottom: Bottom, thickness: f64) -> Self {
        let rough = Some(0.8);
        Self {
            rough,
            ..self.over(bottom, thickness)
        }
    }

    /// A further layer below.
    fn then(mut self, medium: ParticipatingMedium, bottom: Bottom, rough: Option<f64>) -> Self {
        let layer = Layer::slab(medium, 2.5, bottom).unwrap();
        self.further.push((layer, rough));
        self
    }

    /// The larger |z| of all entries with enough events, from light at 40 degrees.
    fn compare(&self, name: &str) {
        let surface = |height, seed| {
            let (nx, ny) = (9, 7);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let heights = (0..nx * ny)
                .map(|_| height * rng.random_range(-1.0..1.0))
                .collect();
            let field = HeightField::new(heights, [ny, nx], [1.0, 0.7]).unwrap();
            Surface::new(field.with_border(self.border))
        };
        let top = surface(self.height, 3);
        let first = match self.end {
            None => Layer::half_space(self.medium),
            Some((bottom, thickness)) => Layer::slab(self.medium, thickness, bottom).unwrap(),
        };
        let mut layers = vec![first];
        layers.extend(self.further.iter().map(|(layer, _)| *layer));
        let rough = std::iter::once(&self.rough).chain(self.further.iter().map(|(_, rough)| rough));
        let bottoms = rough.zip(4..);
        let bottoms = bottoms.map(|(height, seed)| Some(surface((*height)?, seed)));
        let bottoms: Vec<Option<Surface>> = bottoms.collect();
        let find = |surface: &Surface| surface.accelerator(AcceleratorKind::Auto).unwrap();
        let top_hits = find(&top);
        let below_hits: Vec<_> = bottoms
            .iter()
            .map(|bottom| bottom.as_ref().map(find))
            .collect();
        let stack = || {
            let below = bottoms.iter().zip(&below_hits).map(|(geometry, hits)| {
                Some(SearchedSurface {
                    geometry: geometry.as_ref()?,
                    accelerator: &**hits.as_ref()?,
                })
            });
            let top = SearchedSurface {
                geometry: &top,
                accelerator: &*top_hits,
            };
            let below: Vec<_> = below.collect();
            TracedStack::new(top, &layers, &below, self.max_scatterings).unwrap()
        };
        let glass = Material::dielectric(self.eta).unwrap();
        let incidence = Incidence::from_degrees(40.0, 25.0).unwrap();
        let grid = HemisphereGrid::new(3, 4).unwrap();
        let spec = TallySpec::new(grid, 0.1).unwrap().with_medium();

        let tracer = Tracer::new(&top, &*top_hits, glass, HalfSpace::Above, self.settings);
        let tracer = tracer.over(stack());
        let mut together = TallyStatistics::new(spec);
        let mut alone = TallyStatistics::new(spec);
        for block in 0..BATCHES {
            let light = Illumination::new(incidence, false);
            let stream = PathStream::new(1, block);
            let (tally, _) = tracer.batch(&light, STRATA, spec, None, stream);
            together.push(&tally);
        }
        let integrator = PathIntegrator::new(&top, &*top_hits, glass, self.settings).over(stack());
        let integrator = integrator.with_flight_search(self.search);
        for block in 0..BATCHES {
            let mut rng = ChaCha8Rng::seed_from_u64(2);
            rng.set_stream(block);
            let mut tally = TallyValues::zeros(spec);
            for _ in 0..STRATA * STRATA {
                let origin = start(&top, incidence, &mut rng);
                let path = integrator.trace(origin, -incidence.wi(), &mut rng);
                count(&path, &spec, &mut tally);
            }
            alone.push(&tally);
        }
        assert_agreement(name, &spec, &together, &alone);
    }
}

/// Above the surface, on a ray that would come to the mean plane anywhere in a period with equal chance.
fn start(top: &Surface, incidence: Incidence, rng: &mut ChaCha8Rng) -> DVec3 {
    let tiles = match top.border() {
        Border::Mirrored => 2.0,
        _ => 1.0,
    };
    let [cx, cy] = top.extent();
    let [_, high] = top.z_range();
    let wi = incidence.wi();
    let back = (high - top.mean_plane()) / wi.z;
    DVec3::new(
        rng.random::<f64>() * cx * tiles + back * wi.x,
        rng.random::<f64>() * cy * tiles + back * wi.y * top.aspect(),
        high,
    )
}

/// Adds one path to the entries that are compared.
fn count(path: &PathResult, spec: &TallySpec, tally: &mut TallyValues) {
    let whole = path.flux + path.absorbed + path.truncated;
    assert!((whole - 1.0).abs() < 1e-12, "{path:?}");
    let mut add = |entry: Entry, flux: f64| tally[entry] += flux / PATHS;
    add(TallySpec::BUDGET.absorbed, path.absorbed);
    add(TallySpec::BUDGET.truncated, path.truncated);
    let side = match path.end {
        PathEnd::Above => Side::Reflected,
        PathEnd::Below => Side::Transmitted,
        PathEnd::Absorbed => return,
        PathEnd::Truncated => return add(TallySpec::BUDGET.truncated, path.flux),
        PathEnd::LeftPatch => {
            add(TallySpec::BUDGET.left_patch, path.flux);
            return add(TallySpec::BUDGET.truncated, path.flux);
        }
        PathEnd::Lost => return add(TallySpec::BUDGET.lost, path.flux),
    };
    let of_medium = match path.scatterings {
        0 => Component::Unscattered,
        1 => Component::ScatteredOnce,
        _ => Component::ScatteredMore,
    };
    for component in [Component::All, of_medium] {
        add(spec.flux_entry(side, component), path.flux);
    }
    add(
        spec.order_entry(side, path.path.order() as usize),
        path.flux,
    );
    let bin = spec.grid().index_of(side, path.direction);
    add(spec.grid_entries(Component::All).get(bin), path.flux);
}

fn assert_agreement(
    name: &str,
    spec: &TallySpec,
    together: &TallyStatistics,
    alone: &TallyStatistics,
) {
    let mut entries = vec![
        ("absorbed".to_owned(), TallySpec::BUDGET.absorbed),
        ("truncated".to_owned(), TallySpec::BUDGET.truncated),
        ("left patch".to_owned(), TallySpec::BUDGET.left_patch),
        ("reflected".to_owned(), TallySpec::BUDGET.reflected),
        ("transmitted".to_owned(), TallySpec::BUDGET.transmitted),
    ];
    for side in Side::BOTH {
        for component in Component::MEDIUM {
            let entry = spec.flux_entry(side, component);
            entries.push((format!("{side:?} {}", component.name()), entry));
        }
        for order in 1..=6 {
            entries.push((
                format!("{side:?} order {order}"),
                spec.order_entry(side, order),
            ));
        }
    }
    for (i, entry) in spec.grid_entries(Component::All).iter().enumerate() {
        entries.push((format!("{:?}", spec.grid().bin(i)), entry));
    }
    let (mut worst, mut compared) = (0.0_f64, 0);
    for (entry, i) in &entries {
        let [a, b] = [together, alone].map(|statistics| statistics.at(*i));
        let rare = ENOUGH / (BATCHES as f64 * PATHS);
        if a.mean.abs() < rare && b.mean.abs() < rare {
            continue;
        }
        compared += 1;
        let z = crate::common::z_score(a, b.mean, b.se.unwrap());
        if z.abs() > 3.0 {
            println!("{name}: {entry}: {} against {}, z = {z:.2}", a.mean, b.mean);
        }
        worst = worst.max(z.abs());
        assert!(
            z.abs() < BOUND,
            "{name}: {entry}: {a:?} against {b:?}, z = {z:.2}"
        );
    }
    println!("{name}: largest |z| of {compared}: {worst:.2}");
    for statistics in [together, alone] {
        assert_eq!(statistics.means().budget().lost, 0.0, "{name}");
    }
}

#[test]
fn half_spaces() {
    scene(Border::Periodic, 0.5, 0.9, ISOTROPIC).compare("half space, isotropic");
    scene(Border::Mirrored, 1.5, 0.8, forwards(0.7)).compare("half space, mirrored, forwards");
    let flat = Scene {
        height: 0.0,
        ..scene(Border::Periodic, 0.3, 0.95, RAYLEIGH)
    };
    flat.compare("half space, flat, Rayleigh");
    scene(Border::Open, 0.7, 0.8, forwards(-0.5)).compare("half space, open, backwards");
}

#[test]
fn slabs_on_planes() {
    let slab = |border, bottom| scene(border, 2.0, 0.9, forwards(0.5)).over(bottom, 2.5);
    slab(Border::Periodic, Bottom::Open).compare("open bottom");
    slab(Border::Mirrored, INTERFACE).compare("interface, mirrored");
    slab(Border::Open, Bottom::interface(1.2)).compare("interface, open border");
    slab(Border::Periodic, Bottom::ABSORBING).compare("absorbing bottom");
    slab(Border::Mirrored, Bottom::MIRROR).compare("mirror, mirrored");
    let grey = Bottom::lambertian(0.7);
    slab(Border::Periodic, grey).compare("Lambertian bottom");
}

#[test]
fn slabs_on_surfaces() {
    let slab = |border, bottom| scene(border, 2.0, 0.9, RAYLEIGH).over_rough(bottom, 2.5);
    slab(Border::Periodic, INTERFACE).compare("rough interface");
    slab(Border::Mirrored, Bottom::interface(1.3)).compare("rough interface, mirrored");
    slab(Border::Open, INTERFACE).compare("rough interface, open border");
    slab(Border::Mirrored, Bottom::ABSORBING).compare("rough absorbing bottom");
    slab(Border::Periodic, Bottom::MIRROR).compare("rough mirror");
    let white = Bottom::lambertian(1.0);
    slab(Border::Mirrored, white).compare("rough Lambertian bottom");
}

#[test]
fn clear_media() {
    let clear = |border| Scene {
        medium: clear(),
        ..scene(border, 1.0, 1.0, ISOTROPIC)
    };
    clear(Border::Periodic).compare("clear half space");
    // Light that bends away from steep facets rises inside, and leaves the patch below them.
    let rarer = |border| Scene {
        height: 4.0,
        eta: 1.0 / 1.5,
        ..clear(border)
    };
    rarer(Border::Open).compare("clear half space, rarer, open border");
    rarer(Border::Mirrored).compare("clear half space, rarer, mirrored");
    clear(Border::Mirrored)
        .over(INTERFACE, 1.5)
        .compare("clear slab, mirrored");
    clear(Border::Periodic)
        .over_rough(INTERFACE, 3.0)
        .compare("clear rough slab");
    clear(Border::Open)
        .over_rough(INTERFACE, 3.0)
        .compare("clear rough slab, open border");
    let absorbing = scene(Border::Periodic, 2.0, 0.0, ISOTROPIC);
    absorbing
        .over(Bottom::MIRROR, 1.5)
        .compare("absorbing medium");
}

/// Flat and rough faces above and below layers that scatter, absorb or do neither.
#[test]
fn stacks_of_several_layers() {
    let fog = |path, albedo| {
        ParticipatingMedium::from_mean_free_path(path, albedo, forwards(0.4)).unwrap()
    };
    let first = |border, bottom| scene(border, 2.0, 0.9, RAYLEIGH).over(bottom, 2.5);
    let thinner = Bottom::interface(1.3 / 1.5);
    let out = Bottom::interface(1.0 / 1.3);
    first(Border::Periodic, thinner)
        .then(clear(), out, None)
        .compare("two layers between flat faces");
    Scene {
        rough: Some(0.8),
        ..first(Border::Mirrored, thinner)
    }
    .then(fog(1.5, 0.8), out, None)
    .compare("rough face between layers, mirrored");
    first(Border::Open, thinner)
        .then(fog(3.0, 0.5), out, Some(0.8))
        .compare("flat face above a rough one, open border");
    let many = Scene {
        rough: Some(0.8),
        medium: clear(),
        ..first(Border::Periodic, Bottom::interface(1.2))
    };
    many.then(fog(2.0, 1.0), Bottom::interface(0.6), Some(0.5))
        .then(clear(), Bottom::interface(1.1), None)
        .then(fog(4.0, 0.9), Bottom::lambertian(0.6), Some(0.7))
        .compare("four layers");
}

#[test]
fn settings_of_paths() {
    let slab = |settings| Scene {
        settings,
        ..scene(Border::Periodic, 0.8, 0.97, ISOTROPIC).over_rough(INTERFACE, 2.5)
    };
    let settings = |branching, roulette, order| PathSettings::new(branching, roulette, order);
    let pick = settings(Branching::Pick, 0.2, 1000).unwrap();
    slab(pick).compare("picked branches");
    let short = settings(Branching::Split, 0.01, 3).unwrap();
    slab(short).compare("at most three interactions");
    let few = Scene {
        max_scatterings: 4,
        ..slab(PathSettings::default())
    };
    few.compare("at most four scatterings");
    let nearby = Scene {
        search: FlightSearch::Nearby,
        ..scene(Border::Mirrored, 0.3, 0.97, forwards(0.6)).over_rough(INTERFACE, 2.5)
    };
    nearby.compare("walks with heights nearby");
}
