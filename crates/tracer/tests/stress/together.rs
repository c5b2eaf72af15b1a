//! Many rays together against one ray after another.

use asperity_optics::{Incidence, Material};
use asperity_surface::Border;
use asperity_tally::{Entry, HemisphereGrid, Side, TallySpec, TallyValues};
use asperity_tracer::{
    AcceleratorKind, Branching, HalfSpace, Illumination, PathEnd, PathIntegrator, PathSettings,
    PathStream, Polarisation, SmoothSurface, Surface, Tracer,
};
use rand::RngExt;

use crate::paths::{Account, BySide, Light, Numbers, start, walk};
use crate::scenes::{self, Scene, gaussian};
use crate::stressed::Stressed;
use crate::{MAX_ORDER, generator};

#[test]
fn many_rays_together_do_what_one_ray_after_another_does() {
    follow_both_ways::<Surface>();
}

#[test]
fn many_rays_among_smooth_cells_do_what_one_ray_after_another_does() {
    follow_both_ways::<SmoothSurface>();
}

fn follow_both_ways<G: Stressed>() {
    // More rays than are followed together, on surfaces so mild that no branch becomes so weak that
    // roulette is asked; with picked branches it never is, and surfaces may be rough.
    let side = 66;
    let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
    let mut cases = vec![];
    for (i, border) in [Border::Periodic, Border::Mirrored, Border::Open]
        .into_iter()
        .enumerate()
    {
        for incident in [HalfSpace::Above, HalfSpace::Below] {
            for (eta, theta_deg) in [(1.5, 40.0), (1.0 / 1.5, 25.0), (1.0, 70.0)] {
                let glass = Material::dielectric(eta).unwrap();
                cases.push((10.0, border, incident, glass, theta_deg, Branching::Split));
            }
            for (eta, theta_deg) in [(1.5, 80.0), (0.25, 45.0), (1.0 + 1e-9, 70.0)] {
                let glass = Material::dielectric(eta).unwrap();
                cases.push((0.5, border, incident, glass, theta_deg, Branching::Pick));
            }
            let gold = Material::conductor(0.21, 3.272).unwrap();
            let rough = [0.5, 2.0][i % 2];
            cases.push((rough, border, incident, gold, 60.0, Branching::Split));
            let mirror = Material::Mirror;
            cases.push((0.3, border, incident, mirror, 80.0, Branching::Split));
        }
    }
    for (number, (s, border, incident, material, theta_deg, branching)) in
        cases.into_iter().enumerate()
    {
        let field = gaussian(s, [9, 10], [1.0, 1.3], number as u64).with_border(border);
        let surface = G::through(field);
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let light = Light {
            material,
            incident,
            branching,
            weakest: 1e-6,
            max_order: MAX_ORDER as usize,
        };
        // Rays one by one have no polarisation.
        let settings = PathSettings::new(branching, light.weakest, MAX_ORDER)
            .unwrap()
            .with_polarisation(Polarisation::Averaged);
        let tracer = Tracer::new(&surface, &*accelerator, material, incident, settings);
        let incidence = Incidence::from_degrees(theta_deg, 50.0 * number as f64).unwrap();
        let scheme = BySide(&*accelerator);

        // Ray by ray, then all at once.
        for ray in 0..60 {
            let stream = PathStream::new(number as u64, 0).from_path(ray);
            let numbers = Numbers { stream, ray: 0 };
            let [u, v] = stream.of_start(0);
            let heading = start(&surface, &light, incidence, u, v);
            let account = walk(&surface, &scheme, &light, heading, numbers);
            let (values, _) =
                tracer.batch(&Illumination::new(incidence, false), 1, spec, None, stream);
            assert_eq!(account.weak, 0);
            assert_same(&values, spec, &account);
        }
        let stream = PathStream::new(number as u64, 1);
        let mut account = Account::default();
        for (ray, [column, row]) in (0..).zip(z_curve(side)) {
            let width = 1.0 / f64::from(side);
            let [u, v] = stream.of_start(ray);
            let [u, v] = [f64::from(column) + u, f64::from(row) + v].map(|place| place * width);
            let heading = start(&surface, &light, incidence, u, v);
            let numbers = Numbers { stream, ray };
            account.add(&walk(&surface, &scheme, &light, heading, numbers));
        }
        let (values, work) = tracer.batch(
            &Illumination::new(incidence, false),
            side,
            spec,
            None,
            stream,
        );
        assert_eq!(account.weak, 0);
        assert_eq!(work.segments + work.segments_skipped, account.segments);
        assert_same(&values, spec, &account);
    }
}

#[test]
fn mirrors_end_paths_where_the_reference_does() {
    follow_mirrors::<Surface>();
    follow_mirrors::<SmoothSurface>();
}

/// The reference draws numbers of its own, but not where all light is reflected.
fn follow_mirrors<G: Stressed>() {
    let light = Light {
        material: Material::Mirror,
        incident: HalfSpace::Above,
        branching: Branching::Split,
        weakest: 1e-3,
        max_order: MAX_ORDER as usize,
    };
    let settings = PathSettings::new(light.branching, light.weakest, MAX_ORDER).unwrap();
    for (index, scene) in scenes::all::<G>().into_iter().enumerate() {
        let Scene { name, surface } = scene;
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let reference = PathIntegrator::new(&surface, &*accelerator, light.material, settings);
        let scheme = BySide(&*accelerator);
        let mut rng = generator(index, 200);
        for ray in 0..40 {
            let theta = [0.0, 30.0, 60.0, 80.0][ray as usize % 4];
            let incidence = Incidence::from_degrees(theta, 9.0 * f64::from(ray)).unwrap();
            let heading = start(&surface, &light, incidence, rng.random(), rng.random());
            let numbers = Numbers {
                stream: PathStream::new(0, 0),
                ray,
            };
            let account = walk(&surface, &scheme, &light, heading, numbers);
            let found = reference.trace(heading.origin, heading.direction, &mut rng);
            let order = found.path.order() as usize;
            let expected = match found.end {
                PathEnd::Above => account.by_order[0].get(order).copied(),
                PathEnd::Truncated => Some(account.truncated),
                PathEnd::LeftPatch => Some(account.left_patch),
                end => panic!("{name}: {end:?} of {heading:?}"),
            };
            assert_eq!(
                expected,
                Some(1.0),
                "{name}: {:?} of {heading:?}",
                found.end
            );
        }
    }
}

/// Columns and rows of a square, along a Z curve.
fn z_curve(side: u32) -> Vec<[u32; 2]> {
    let mut places: Vec<[u32; 2]> = (0..side * side).map(|i| [i % side, i / side]).collect();
    let code = |[column, row]: [u32; 2]| {
        (0..16).fold(0_u64, |code, bit| {
            let (x, y) = (u64::from(column >> bit & 1), u64::from(row >> bit & 1));
            code | x << (2 * bit) | y << (2 * bit + 1)
        })
    };
    places.sort_by_key(|&place| code(place));
    places
}

/// Asserts that `Tracer::batch` gave what paths one by one gave.
fn assert_same(values: &TallyValues, spec: TallySpec, account: &Account) {
    let rays = account.rays as f64;
    // Each segment adds at most 2 eps of the whole, here and there; see `Row::book`.
    let bound = 4.0 * f64::EPSILON * (account.segments + 1) as f64;
    let assert_near = |entry: Entry, expected: f64, what: &str| {
        let difference = (values[entry] - expected / rays).abs();
        assert!(
            difference <= bound,
            "{what}: {} is not {}",
            values[entry],
            expected / rays
        );
    };
    for side in Side::BOTH {
        for order in 1..=MAX_ORDER as usize {
            let orders = &account.by_order[side.index()];
            let expected = orders.get(order).copied().unwrap_or(0.0);
            assert_near(spec.order_entry(side, order), expected, "order");
        }
    }
    assert_near(TallySpec::BUDGET.absorbed, account.absorbed, "absorbed");
    assert_near(TallySpec::BUDGET.left_patch, account.left_patch, "left");
    let truncated = account.truncated + account.left_patch;
    assert_near(TallySpec::BUDGET.truncated, truncated, "truncated");
    assert_near(TallySpec::BUDGET.lost, account.lost, "lost");
}
