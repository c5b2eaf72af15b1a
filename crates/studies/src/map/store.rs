//! The files of cells, by which a map goes on where it was left.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::MapError;
use super::cell::CellResults;
use super::config::CellPlan;
use crate::store::{self, CHANGED, StoreError};

/// Folder of the files within that of the map.
const FOLDER: &str = "cells";

/// What is there of a cell.
pub(super) type Stored = store::Stored<CellResults>;

/// The file of a cell.
pub(super) fn path_of(folder: &Path, cell: &CellPlan) -> PathBuf {
    folder
        .join(FOLDER)
        .join(format!("{}.json", cell.case.folder()))
}

/// The folder of all files.
pub(super) fn folder_of(folder: &Path) -> PathBuf {
    folder.join(FOLDER)
}

/// Writes the results of a cell; the file is complete or not there.
pub(super) fn write(folder: &Path, cell: &CellPlan, results: &CellResults) -> Result<(), MapError> {
    let (path, case) = (path_of(folder, cell), cell.case.to_string());
    Ok(store::write(&path, &case, json!(cell.config), results)?)
}

/// Reads what is there of a cell.
///
/// # Errors
/// [`MapError::Foreign`] for the whole cell of another configuration or version, which is not ours to
/// overwrite; [`MapError::Read`] if a file cannot be read at all.
pub(super) fn read(folder: &Path, cell: &CellPlan) -> Result<Stored, MapError> {
    let doubt = |results: &CellResults| {
        let names = results.models.iter().map(|model| &model.name);
        if !results.is_sound() {
            Some(CHANGED)
        } else if !names.eq(&cell.config.compare.models) {
            Some("it has other models than it says")
        } else {
            None
        }
    };
    store::read(&path_of(folder, cell), &json!(cell.config), doubt).map_err(|error| match error {
        StoreError::Read(error) => MapError::Read(error),
        StoreError::Foreign { path, what } => MapError::Foreign { path, what },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::cell::{CellDistances, CellModel, CellSide};
    use crate::map::config::MapConfig;
    use crate::peak::PeakDifference;
    use asperity_tally::Side;

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
            models: vec![model("heitz"), model("smith")],
        }
    }

    /// What is believed of a file of such results, whose checksum is right.
    fn believed(results: &CellResults) -> Result<CellResults, String> {
        let folder = tempfile::tempdir().unwrap();
        asperity_io::create_output_folder(folder_of(folder.path())).unwrap();
        let plan = plan();
        write(folder.path(), &plan, results).unwrap();
        match read(folder.path(), &plan).unwrap() {
            Stored::Results(results) => Ok(results),
            Stored::Damaged(reason) => Err(reason),
            Stored::Missing => panic!("the file is not there"),
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
}
