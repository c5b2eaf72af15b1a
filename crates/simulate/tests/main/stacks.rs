//! Layers that are lit from below, and light of several directions.

use std::f64::consts::PI;

use asperity_optics::{
    Bottom, BottomSurface, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction, Spread,
};
use asperity_simulate::{
    Case, Effort, Estimator, Light, Outcome, Settings, Silent, SurfaceSource, simulate,
};
use asperity_surface::HeightField;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Entry, Measure, Polarimetry, Side, TallyResult};
use asperity_tracer::{HalfSpace, Polarisation, Shape};

const ETA: f64 = 1.5;

fn clear() -> ParticipatingMedium {
    ParticipatingMedium::from_coefficients(0.0, 0.0, PhaseFunction::Isotropic).unwrap()
}

/// Heights steep enough for several interactions, and of no symmetry.
fn rough() -> HeightField {
    let psd = Psd::gaussian(3.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [64, 64], [1.0, 0.5], false).unwrap();
    synthesis.draw(3, 0).unwrap()
}

fn settings(rays: u64) -> Settings {
    let settings = Settings::default();
    Settings {
        effort: Effort::Rays {
            total: rays,
            surfaces: 1,
        },
        estimator: Estimator::Plain,
        ..settings
    }
}

fn run(case: Case, settings: &Settings) -> Outcome {
    simulate(&[case], settings, &Silent).unwrap().swap_remove(0)
}

/// Chi-squared of two outcomes over entries that enough rays carry, per entry.
fn reduced_chi_squared(a: &Outcome, b: &Outcome, entries: &[Entry]) -> (f64, f64) {
    let (mut squares, mut count) = (0.0, 0.0);
    for &entry in entries {
        let [x, y] = [a, b].map(|outcome| outcome.statistics.at(entry));
        let variance = x.se.unwrap().powi(2) + y.se.unwrap().powi(2);
        if variance > 0.0 {
            squares += (x.mean - y.mean).powi(2) / variance;
            count += 1.0;
        }
    }
    (squares / count, count)
}

/// A clear layer that ends on nothing is the half space below: all elements of the Mueller matrix agree with their signs, though the one
/// is traced turned over.
#[test]
fn light_through_an_open_layer_from_below_meets_the_bare_surface() {
    let mut settings = settings(100_000);
    settings.tally = settings.tally.with_polarimetry(Polarimetry::Mueller);
    settings.paths = settings.paths.with_polarisation(Polarisation::Mueller);
    let incidence = Incidence::from_degrees(35.0, 20.0).unwrap();
    let light = Light {
        from: HalfSpace::Below,
        ..Light::from_above(incidence)
    };
    let surface = SurfaceSource::height_field(rough());
    // Without a layer the index is relative to the medium of the light
    let inward = Material::dielectric(1.0 / ETA).unwrap();
    let bare = run(Case::new(surface.clone(), inward, light), &settings);
    let layer = Layer::slab(clear(), 50.0, Bottom::Open).unwrap();
    let mut over = Case::new(surface, Material::dielectric(ETA).unwrap(), light);
    over.layers = vec![layer];
    let turned = run(
        over,
        &Settings {
            seed: 2,
            ..settings
        },
    );
    let spec = settings.tally;
    let mut odd_is_seen = 0.0_f64;
    for i in 0..16 {
        let measure = Measure::Element {
            row: i / 4,
            column: i % 4,
        };
        let bins = spec.recorded_entries(Component::All);
        let entries: Vec<_> = bins
            .iter()
            .filter_map(|bin| spec.measure_entry(bin, measure))
            .collect();
        let (reduced, count) = reduced_chi_squared(&bare, &turned, &entries);
        println!("{measure}: {reduced:.2} of {count}");
        assert!((0.7..1.4).contains(&reduced), "{measure}: {reduced}");
        if (i / 4 < 2) != (i % 4 < 2) {
            for entry in entries {
                let of = bare.statistics.at(entry);
                odd_is_seen = odd_is_seen.max((of.mean / of.se.unwrap().max(1e-12)).abs());
            }
        }
    }
    // Signs could be wrong unnoticed if no element had any
    assert!(odd_is_seen > 10.0, "{odd_is_seen}");
}

/// Turned over twice is as it was: a stack lit from below is the mirrored stack lit from above.
#[test]
fn stacks_from_below_are_turned_stacks_from_above() {
    let settings = settings(100_000);
    let incidence = Incidence::from_degrees(30.0, 0.0).unwrap();
    let from = |from| Light {
        from,
        ..Light::from_above(incidence)
    };
    let absorbing = ParticipatingMedium::from_coefficients(0.01, 0.0, PhaseFunction::Isotropic);
    let absorbing = absorbing.unwrap();
    let field = rough();
    let mut below = Case::new(
        SurfaceSource::height_field(field.clone()),
        Material::dielectric(ETA).unwrap(),
        from(HalfSpace::Below),
    );
    below.layers = vec![
        Layer::slab(absorbing, 30.0, Bottom::interface(1.2 / ETA)).unwrap(),
        Layer::slab(clear(), 20.0, Bottom::interface(1.0 / 1.2)).unwrap(),
    ];
    let flat = field
        .with_heights(vec![0.0; field.heights().len()])
        .unwrap();
    let turned = field.heights().iter().map(|h| -h).collect();
    let turned = field.with_heights(turned).unwrap();
    let shape = Shape::height_field(flat);
    let shape = shape.over(1, Shape::height_field(turned)).unwrap();
    let mut above = Case::new(
        SurfaceSource::Given(vec![shape]),
        Material::dielectric(1.2).unwrap(),
        from(HalfSpace::Above),
    );
    above.layers = vec![
        Layer::slab(clear(), 20.0, Bottom::interface(ETA / 1.2)).unwrap(),
        Layer::slab(absorbing, 30.0, Bottom::interface(1.0 / ETA)).unwrap(),
    ];
    let [a, b] = [below, above].map(|case| run(case, &settings));
    let difference = |side| {
        let of = |outcome: &Outcome| outcome.statistics.flux(side, Component::All).mean;
        (of(&a) - of(&b)).abs()
    };
    assert!(difference(Side::Reflected) < 1e-12 && difference(Side::Transmitted) < 1e-12);
    assert!(a.statistics.budget().absorbed.mean > 0.05);
}

/// Light between two rings of directions is as much one way as the other, over equal radiance: the flux from a ring, times its projected
/// solid angle, is that of the reversed light. Both faces are rough, of materials of their own.
#[test]
fn light_through_a_rough_slab_is_reciprocal() {
    let settings = settings(100_000);
    let rings = [[20.0, 30.0], [40.0, 50.0]];
    let middle = |[a, b]: [f64; 2]| Incidence::from_degrees(0.5 * (a + b), 0.0).unwrap();
    let patch = |ring| Spread::patch([10.0, 360.0], middle(ring)).unwrap();
    let lit = |ring, from| {
        let light = Light {
            from,
            spread: Some(patch(ring)),
            ..Light::from_above(middle(ring))
        };
        let mut case = Case::new(
            SurfaceSource::height_field(rough()),
            Material::dielectric(ETA).unwrap(),
            light,
        );
        let layer = Layer::slab(clear(), 40.0, Bottom::interface(1.3 / ETA)).unwrap();
        let lower = Layer::slab(clear(), 30.0, Bottom::interface(1.0 / 1.3)).unwrap();
        case.layers = vec![layer, lower.on(BottomSurface::Same)];
        run(case, &settings)
    };
    let into = |outcome: &Outcome, side, [a, b]: [f64; 2]| {
        let spec = outcome.statistics.spec();
        let rings = spec.ring_filter(side);
        let mut sum = [0.0; 2];
        for i in 0..spec.grid().n_theta() {
            let [low, high] = rings.theta_deg(i);
            let (low, high) = match side {
                Side::Reflected => (low, high),
                Side::Transmitted => (180.0 - high, 180.0 - low),
            };
            if low >= a - 1e-9 && high <= b + 1e-9 {
                let found = outcome.statistics.rings(side, Component::All).get(i);
                sum[0] += found.mean;
                sum[1] += found.se.unwrap().powi(2);
            }
        }
        sum
    };
    let area = |ring| patch(ring).projected_solid_angle(middle(ring)) / PI;
    let [inner, outer] = rings;
    for (side, back) in [
        (Side::Transmitted, HalfSpace::Below),
        (Side::Reflected, HalfSpace::Above),
    ] {
        let [there, there_se] = into(&lit(inner, HalfSpace::Above), side, outer);
        let [home, home_se] = into(&lit(outer, back), side, inner);
        let (there, home) = (there * area(inner), home * area(outer));
        let se = (there_se * area(inner).powi(2) + home_se * area(outer).powi(2)).sqrt();
        let z = (there - home) / se;
        println!("{side}: {there:.6} and {home:.6}, z {z:.2}");
        assert!(z.abs() < 3.5 && se < 0.1 * there, "{side}");
    }
}

/// Of light over a cone on a plane all is reflected into the cone about the mirror direction.
#[test]
fn light_of_a_cone_leaves_a_plane_in_a_cone() {
    let incidence = Incidence::from_degrees(50.0, 0.0).unwrap();
    let plane = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
    let light = Light {
        spread: Some(Spread::cone(10.0, incidence).unwrap()),
        ..Light::from_above(incidence)
    };
    let case = Case::new(SurfaceSource::height_field(plane), Material::Mirror, light);
    let found = run(case, &settings(40_000)).statistics;
    let rings = found.rings(Side::Reflected, Component::All);
    let between: f64 = (0..18)
        .filter(|i| (8..12).contains(i))
        .map(|i| rings.get(i).mean)
        .sum();
    assert!((between - 1.0).abs() < 1e-12, "{between}");
    // Uniform in projected solid angle, which is symmetric about the axis there: half of the flux beyond
    let beyond: f64 = (10..12).map(|i| rings.get(i).mean).sum();
    assert!((beyond - 0.5).abs() < 0.05, "{beyond}");
}
