//! Light that stays on its side, is not lost, and adds up to one.

use asperity_optics::{Incidence, Material};
use asperity_surface::Border;
use asperity_tally::{HemisphereGrid, TallyResult, TallySpec, TallyValues};
use asperity_tracer::Heading;
use asperity_tracer::{
    AcceleratorKind, Branching, Geometry, HalfSpace, Illumination, PathSettings, PathStream, Query,
    SmoothSurface, Surface, TileRay, Tracer,
};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::cases::{Case, cases, is_long};
use crate::paths::{Account, BySide, Light, Numbers, Scheme, start, start_towards, walk};
use crate::rays;
use crate::rows::{Row, assert_scenes_are_clean};
use crate::scenes::{Scene, gaussian, scaled};
use crate::stressed::Stressed;
use crate::textbook::comes_in_its_medium;
use crate::{Effort, MAX_ORDER, SMALL, accelerators, generator};

#[test]
fn light_stays_on_its_side_and_none_is_lost() {
    assert_scenes_are_clean::<Surface>(|i, scene| sides_and_losses(i, scene, SMALL));
    assert_scenes_are_clean::<SmoothSurface>(|i, scene| sides_and_losses(i, scene, SMALL));
}

#[test]
fn flux_adds_up_to_one_and_is_the_same_for_every_accelerator() {
    assert_scenes_are_clean::<Surface>(|i, scene| budgets(i, scene, SMALL));
    assert_scenes_are_clean::<SmoothSurface>(|i, scene| budgets(i, scene, SMALL));
}

#[test]
fn powers_of_two_of_scale_change_no_byte() {
    let spec = TallySpec::default();
    let incidence = Incidence::from_degrees(75.0, 20.0).unwrap();
    let glass = Material::dielectric(1.5).unwrap();
    let settings = PathSettings::default();
    for (s, border) in [(0.3, Border::Periodic), (2.0, Border::Mirrored)] {
        let field = gaussian(s, [12, 10], [1.0, 1.7], 60).with_border(border);
        let trace = |scale: f64| {
            let surface = Surface::new(scaled(&field, scale));
            let values = accelerators(&surface).into_iter().map(|(_, accelerator)| {
                let tracer =
                    Tracer::new(&surface, &*accelerator, glass, HalfSpace::Above, settings);
                tracer.batch(
                    &Illumination::new(incidence, false),
                    10,
                    spec,
                    None,
                    PathStream::new(61, 0),
                )
            });
            values.collect::<Vec<_>>()
        };
        let expected = trace(1.0);
        // About 1e-9, 1e-3, 1e3 and 1e9.
        for power in [-30, -10, 10, 30] {
            assert_eq!(trace(2_f64.powi(power)), expected, "2^{power}");
        }
    }
}

/// Directions of incident rays.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// Anywhere, from anywhere.
    Random,
    /// Every second one at vertices, edges and diagonals; every third along an axis or a diagonal of
    /// the cells; every fifth from many periods away.
    Awkward,
}

/// `count` incident rays, followed one by one.
pub(super) fn watched<G: Stressed>(
    surface: &G,
    scheme: &dyn Scheme<G>,
    case: Case,
    aim: Aim,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Account {
    let light = Light {
        material: case.material,
        incident: case.incident,
        branching: Branching::Split,
        weakest: 1e-3,
        max_order: MAX_ORDER as usize,
    };
    let mut account = Account::default();
    for i in 0..count {
        let phi_deg = if aim == Aim::Awkward && i % 3 == 0 {
            45.0 * f64::from(rng.random_range(0..8))
        } else {
            rng.random_range(0.0..360.0)
        };
        let incidence = Incidence::from_degrees(case.theta_deg, phi_deg).unwrap();
        let mut heading = if aim == Aim::Random || i % 2 == 0 {
            let (u, v) = (rng.random(), rng.random());
            start(surface, &light, incidence, u, v)
        } else {
            let target = rays::frame_point(surface, rng);
            start_towards(surface, &light, incidence, target)
        };
        if aim == Aim::Awkward && i % 5 == 0 && surface.border() != Border::Open {
            // From many periods away: a mirrored tile and its image make one.
            for (axis, size) in surface.extent().into_iter().enumerate() {
                let periods = f64::from(rng.random_range(-100_000..=100_000));
                heading.origin[axis] += 2.0 * periods * size;
            }
        }
        // Light that comes in under the rim of an open patch is on no side.
        let first = first_query(surface, &heading, case.incident);
        if surface.border() != Border::Open || comes_in_its_medium(surface, &first) {
            let numbers = Numbers {
                stream: PathStream::new(0, 0),
                ray: i as u32,
            };
            account.add(&walk(surface, scheme, &light, heading, numbers));
        }
    }
    account
}

/// First query about a ray that starts with `heading`.
fn first_query<G: Geometry>(surface: &G, heading: &Heading, half_space: HalfSpace) -> Query {
    let scale = DVec3::new(1.0, surface.aspect(), 1.0);
    Query {
        ray: TileRay {
            origin: heading.origin,
            direction: heading.direction * scale,
        },
        half_space,
    }
}

/// Paths one by one, watched by [`ground`].
pub(super) fn sides_and_losses<G: Stressed>(index: usize, scene: &Scene<G>, effort: Effort) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    for (kind, accelerator) in accelerators(surface) {
        let fast = usize::from(accelerator.kind() != AcceleratorKind::BruteForce);
        let scheme = BySide(&*accelerator);
        let mut rng = generator(index, 100);
        for case in cases(index, surface, effort) {
            if fast == 0 && is_long(surface, case) {
                continue;
            }
            let account = watched(
                surface,
                &scheme,
                case,
                Aim::Awkward,
                effort.walks[fast],
                &mut rng,
            );
            row.segments += account.segments;
            row.lost += account.lost_segments;
            row.wrong_sides += account.wrong_sides;
            let rays = account.rays as f64;
            if account.rays > 0 {
                row.book((account.total() / rays - 1.0).abs(), account.segments);
            }
            if let Some(fault) = account.first_fault {
                row.fault(|| format!("{kind}: {fault}"));
            }
        }
    }
    row
}

/// `Tracer::batch` with every accelerator.
pub(super) fn budgets<G: Stressed>(index: usize, scene: &Scene<G>, effort: Effort) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
    let settings = PathSettings::new(Branching::Split, 1e-3, MAX_ORDER).unwrap();
    let accelerators = accelerators(surface);
    for (number, case) in cases(index, surface, effort).into_iter().enumerate() {
        let incidence = Incidence::from_degrees(case.theta_deg, 36.0 * number as f64).unwrap();
        for strata in effort.strata {
            let mut first: Option<TallyValues> = None;
            for (kind, accelerator) in &accelerators {
                if accelerator.kind() == AcceleratorKind::BruteForce
                    && (strata != effort.strata[0] || is_long(surface, case))
                {
                    continue;
                }
                let stream = PathStream::new(index as u64, number as u64);
                let tracer = Tracer::new(
                    surface,
                    &**accelerator,
                    case.material,
                    case.incident,
                    settings,
                );
                let (values, work) = tracer.batch(
                    &Illumination::new(incidence, true),
                    strata,
                    spec,
                    None,
                    stream,
                );
                let segments = work.segments + work.segments_skipped;
                row.segments += segments;
                row.lost += u64::from(values.budget().lost != 0.0);
                let sum: f64 = values.budget().total();
                row.book((sum - 1.0).abs(), segments);
                let expected = first.get_or_insert_with(|| values.clone());
                if values != *expected {
                    row.unlike_batches += 1;
                    row.fault(|| format!("{kind}: other values of {:?}", case.material));
                }
            }
        }
    }
    row
}
