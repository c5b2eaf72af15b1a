//! Which checkpoints of cells are believed.

use asperity_io::ResultFolder;
use asperity_tally::Side;

use super::*;
use crate::comparison::peak::PeakDifference;
use crate::output::Found;

fn plan() -> CellPlan {
    let text = "[compare]\nmodels = ['heitz', 'smith']\n[light]\ntheta = 30";
    MapConfig::from_toml(text)
        .unwrap()
        .cells()
        .unwrap()
        .remove(0)
}

fn results() -> CellResults {
    let distances = CellDistances {
        total_variation: 0.25,
        noise_95: Some(0.02),
        mesh: 0.003,
        sides: vec![CellSide {
            side: Side::Reflected,
            explicit: 0.5,
            model: 0.375,
            difference: 0.125,
            difference_se: Some(0.01),
            mesh: 0.002,
            peak: Some(PeakDifference {
                explicit_deg: 32.0,
                model_deg: 30.5,
                half_width_deg: 12.0,
                se_deg: Some(0.25),
                unresolved_deg: 1.5,
            }),
        }],
    };
    let model = |name: &str| CellModel {
        name: name.to_owned(),
        all_orders: true,
        rays: 1000,
        own: distances.clone(),
        all: distances.clone(),
    };
    CellResults {
        surfaces: 20,
        rays: 1000,
        size: [64, 64],
        spacing: [1.0, 1.0],
        deviation_bound: None,
        lost: 0.0,
        tracked_less_averaged: None,
        models: vec![model("heitz"), model("smith")],
    }
}

/// What is believed of a checkpoint of such results, whose checksum is right.
fn believed(results: &CellResults) -> Result<CellResults, String> {
    let place = tempfile::tempdir().unwrap();
    let folder = ResultFolder::open(place.path(), "map", &[]).unwrap();
    let (plan, checkpoints) = (plan(), checkpoints(&folder));
    checkpoints.write(&plan, results).unwrap();
    match checkpoints.read(&plan).unwrap() {
        Found::Results(results) => Ok(results),
        Found::Damaged(reason) => Err(reason),
        Found::OtherRounding => panic!("the file is of this machine"),
        Found::Missing => panic!("the file is missing"),
    }
}

#[test]
fn what_was_found_is_read_as_it_was_written() {
    assert_eq!(believed(&results()), Ok(results()));
    let mut known = results();
    (known.surfaces, known.rays, known.deviation_bound) = (0, 0, Some(1e-7));
    assert_eq!(believed(&known), Ok(known));
}

#[test]
fn other_models_than_those_asked_for_are_not_believed() {
    let mut cases = vec![results(); 4];
    cases[0].models[1].name = "unshadowed".to_owned();
    cases[1].models.swap(0, 1);
    cases[2].models.truncate(1);
    let twice = cases[3].models[1].clone();
    cases[3].models.push(twice);
    for case in cases {
        let names: Vec<&str> = case.models.iter().map(|m| m.name.as_str()).collect();
        let reason = believed(&case).expect_err(&names.join(", "));
        assert_eq!(reason, "it has other models than it says", "{names:?}");
    }
}

/// Each of these has a checksum of its own that is right.
#[test]
fn numbers_that_no_run_finds_are_not_believed() {
    type Spoil = fn(&mut CellResults, &mut CellDistances);
    fn peak(d: &mut CellDistances) -> &mut PeakDifference {
        d.sides[0].peak.as_mut().unwrap()
    }
    let impossible: [(&str, Spoil); 18] = [
        ("total variation < 0", |_, d| d.total_variation = -0.1),
        ("total variation huge", |_, d| d.total_variation = 1e4),
        ("noise < 0", |_, d| d.noise_95 = Some(-0.1)),
        ("mesh < 0", |_, d| d.mesh = -0.1),
        ("explicit huge", |_, d| {
            (d.sides[0].explicit, d.sides[0].difference) = (1e4, 1e4 - 0.375);
        }),
        ("model huge", |_, d| {
            (d.sides[0].model, d.sides[0].difference) = (1e4, 0.5 - 1e4);
        }),
        ("no difference of both", |_, d| d.sides[0].difference = 0.12),
        ("its error < 0", |_, d| {
            d.sides[0].difference_se = Some(-0.1);
        }),
        ("mesh of a side < 0", |_, d| d.sides[0].mesh = -0.1),
        ("peak below ground", |_, d| peak(d).explicit_deg = 90.5),
        ("peak of the model", |_, d| peak(d).model_deg = -90.5),
        ("width < 0", |_, d| peak(d).half_width_deg = -1.0),
        ("error of a peak < 0", |_, d| peak(d).se_deg = Some(-1.0)),
        ("unresolved < 0", |_, d| peak(d).unresolved_deg = -1.0),
        ("nothing traced", |r, _| r.surfaces = 0),
        ("no ray", |r, _| r.rays = 0),
        ("lost huge", |r, _| r.lost = 1e4),
        ("bound < 0", |r, _| r.deviation_bound = Some(-0.1)),
    ];
    for (what, spoil) in impossible {
        for (model, all) in [(0, false), (1, true)] {
            let mut case = results();
            let mut distances = case.models[model].own.clone();
            spoil(&mut case, &mut distances);
            let place = &mut case.models[model];
            *if all { &mut place.all } else { &mut place.own } = distances;
            let reason = believed(&case).expect_err(what);
            assert!(
                reason.contains("not those that were written"),
                "{what}: {reason}"
            );
        }
    }
    // What is no number has none in a file either.
    for no_number in [f64::NAN, f64::INFINITY] {
        let mut case = results();
        case.models[0].own.total_variation = no_number;
        assert!(believed(&case).is_err());
        let mut case = results();
        case.lost = no_number;
        assert!(believed(&case).is_err());
    }
}
