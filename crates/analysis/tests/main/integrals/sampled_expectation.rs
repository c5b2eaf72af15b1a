//! Expectation of a random walk: the parts of a tally fit together.

use asperity_analysis::{
    Expectation, SamplingEffort, ScatteringModel, SlopeCovariance, create_model, expect,
    hemispherical_energy, sidak_z_threshold,
};
use asperity_optics::{Incidence, Material};
use asperity_tally::{
    Azimuth, Component, Event, EventPath, HemisphereGrid, Side, Sides, TallyResult, TallySpec,
};

/// Sectors of 10 degrees, like the in-plane slice.
fn spec() -> TallySpec {
    let grid = HemisphereGrid::new(6, 36).unwrap();
    TallySpec::new(grid, 5_f64.to_radians()).unwrap()
}

const EFFORT: SamplingEffort = SamplingEffort {
    rays: 20_000,
    batches: 50,
    seed: 3,
};

fn rough_glass() -> Box<dyn ScatteringModel> {
    let slopes = SlopeCovariance::new(0.5, 2.0, 0.6).unwrap();
    create_model("heitz", slopes, Material::dielectric(1.5).unwrap()).unwrap()
}

/// Light of 50 degrees that travels towards the azimuth of 5 degrees, the middle of the first sector.
fn found(spec: TallySpec, effort: SamplingEffort) -> Expectation {
    let incidence = Incidence::from_degrees(50.0, 185.0).unwrap();
    let forward = Azimuth::From(5_f64.to_radians());
    expect(rough_glass().as_ref(), incidence, &spec, forward, effort)
}

/// Quadrature knows a bin to 1e-12 of the incident flux, and there are some hundred of them; energies come
/// by another integral, to 1e-10.
const ROUNDING: f64 = 3e-10;

#[test]
fn every_view_of_an_expectation_agrees() {
    let spec = spec();
    let found = found(spec, EFFORT);
    assert!(!found.is_exact() && found.rays() == EFFORT.rays);
    assert!(found.describes(Component::Multiple));
    let n_phi = spec.grid().n_phi();
    for tally in found.tallies() {
        let of = |component| tally[spec.grid_entries(component)].to_vec();
        let [single, multiple, total] = Component::BINS.map(of);
        for i in 0..total.len() {
            assert!((total[i] - single[i] - multiple[i]).abs() < 1e-15);
        }
        for side in Side::BOTH {
            let of_side = |bins: &[f64]| -> Vec<f64> {
                let n = spec.grid().bins_per_side();
                bins[side.index() * n..][..n].to_vec()
            };
            let views = [
                (
                    of_side(&single),
                    spec.order_entry(side, 1),
                    Component::Single,
                ),
                (
                    of_side(&total),
                    spec.flux_entry(side, Component::All),
                    Component::All,
                ),
            ];
            for (bins, energy, class) in views {
                assert!((bins.iter().sum::<f64>() - tally[energy]).abs() < ROUNDING);
                let rings = &tally[spec.ring_entries(side, class)];
                // In-plane bins go from -90 to 90 degrees off the side's own normal.
                let in_plane = &tally[spec.in_plane_entries(side, class)];
                let n_theta = rings.len();
                for (ring, bins) in bins.chunks_exact(n_phi).enumerate() {
                    assert!((bins.iter().sum::<f64>() - rings[ring]).abs() < ROUNDING);
                    let from_pole = match side {
                        Side::Reflected => ring,
                        Side::Transmitted => n_theta - 1 - ring,
                    };
                    let forward = in_plane[n_theta + from_pole];
                    let backward = in_plane[n_theta - 1 - from_pole];
                    assert!((bins[0] - forward).abs() < ROUNDING, "{side:?} {ring}");
                    assert!(
                        (bins[n_phi / 2] - backward).abs() < ROUNDING,
                        "{side:?} {ring}"
                    );
                }
            }
            let multiple = of_side(&multiple).iter().sum::<f64>();
            assert!((multiple - tally[spec.flux_entry(side, Component::Multiple)]).abs() < 1e-14);
            let orders: f64 = (1..=64)
                .map(|order| tally[spec.order_entry(side, order)])
                .sum();
            assert!((orders - tally[spec.flux_entry(side, Component::All)]).abs() < 1e-14);
            let paths: f64 = spec
                .listed_paths()
                .map(|path| tally[spec.event_path_entry(side, path)])
                .sum();
            let all = paths + tally[spec.longer_paths_entry(side)];
            assert!((all - tally[spec.flux_entry(side, Component::All)]).abs() < 1e-14);
        }
    }
}

#[test]
fn single_scattering_is_the_exact_closed_form() {
    let spec = spec();
    let found = found(spec, EFFORT);
    let model = rough_glass();
    let wi = Incidence::from_degrees(50.0, 185.0).unwrap().wi();
    let energy = hemispherical_energy(model.density().unwrap(), wi);
    let sides = [
        (Side::Reflected, Event::Reflection, energy.reflected),
        (Side::Transmitted, Event::Transmission, energy.transmitted),
    ];
    for (side, event, energy) in sides {
        let path = spec.event_path_entry(side, EventPath::default().then(event));
        for entry in [spec.order_entry(side, 1), path] {
            let estimate = found.statistics().at(entry);
            assert!((estimate.mean - energy).abs() < 1e-14);
            assert!(estimate.se.unwrap() < 1e-15);
        }
        let multiple = found
            .statistics()
            .at(spec.flux_entry(side, Component::Multiple));
        assert!(multiple.mean > 0.0 && multiple.se.unwrap() > 0.0);
    }
}

#[test]
fn energies_add_up_within_their_errors() {
    // Light scattered once is exact and the rest is sampled: the sum is one on average.
    let found = found(spec(), EFFORT);
    let sums: Vec<f64> = found
        .tallies()
        .iter()
        .map(|tally| tally.budget().total())
        .collect();
    let n = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / n;
    let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let z = (mean - 1.0) / (variance / n).sqrt();
    println!("sum of all energies {mean:.6}, z {z:.2}");
    assert!(z.abs() < sidak_z_threshold(1e-3, 1));
    assert!((mean - 1.0).abs() < 0.01);
}

#[test]
fn results_depend_on_the_seed_and_not_on_the_thread_count() {
    let run = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let effort = SamplingEffort { seed, ..EFFORT };
        pool.install(|| found(spec(), effort).tallies().to_vec())
    };
    let one = run(1, 3);
    assert_eq!(one, run(2, 3));
    assert_ne!(one, run(1, 4));
}

#[test]
fn an_unrecorded_side_stays_empty_and_changes_nothing() {
    let both = found(spec(), EFFORT);
    let spec = spec().with_sides(Sides::Reflected);
    let one_side = found(spec, EFFORT);
    for (both, one_side) in both.tallies().iter().zip(one_side.tallies()) {
        for component in Component::BINS {
            let n = spec.grid().bins_per_side();
            let (both, one_side) = (
                &both[spec.grid_entries(component)],
                &one_side[spec.grid_entries(component)],
            );
            assert_eq!(both[..n], one_side[..n]);
            assert!(one_side[n..].iter().all(|&flux| flux == 0.0));
        }
        assert_eq!(one_side.budget().transmitted, 0.0);
        assert_eq!(both.budget().reflected, one_side.budget().reflected);
    }
}
