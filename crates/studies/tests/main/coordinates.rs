//! A further quantity that cases differ in: once it is a coordinate of theirs, every output names it.

use std::fs;
use std::path::Path;
use std::sync::Mutex;

use asperity_io::ResultFolder;
use asperity_results::ResultSet;
use asperity_simulate::{Coordinate, Observer, Silent};
use asperity_studies::{
    GonioConfig, GonioStudy, MapConfig, MapStudy, Plan, Study, VerifyConfig, VerifyStudy,
};

const SETTINGS: &str = "
    [surface]
    smoothness = 2
    tau = 4
    size = 32
    [material]
    eta = 1.5
    [light]
    theta = [20, 70]
    [run]
    realisations = 12
    rays = 6000
    bins = \"6x8\"
";

/// The settings with models of few rays.
fn compared() -> String {
    format!("{SETTINGS}[compare]\nmodel_rays = 1e4")
}

/// A quantity that no command has.
fn tint(value: f64) -> Coordinate {
    Coordinate {
        name: "tint".to_owned(),
        symbol: "tau_c".to_owned(),
        value,
        unit: "nm".to_owned(),
        about: "tint of the light".to_owned(),
    }
}

/// Puts the cases of a plan in each of two tints.
fn in_two_tints(plan: &mut Plan) {
    let count = plan.cases.len();
    plan.cases.extend_from_within(..);
    plan.lobes.extend_from_within(..);
    for (number, case) in plan.cases.iter_mut().enumerate() {
        let value = if number < count { 450.0 } else { 650.0 };
        case.at.others.push(tint(value));
    }
}

/// Keeps the numbers of the surfaces that are drawn.
#[derive(Default)]
struct Drawn(Mutex<Vec<u64>>);

impl Observer for Drawn {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn surface_drawn(&self, number: u64) {
        self.0.lock().unwrap().push(number);
    }
}

/// Number of surfaces of a run of [`SETTINGS`].
const SURFACES: u64 = 12;

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Asserts that a table has the column and both values in its rows, half of the rows each.
fn assert_in_table(folder: &Path, name: &str) {
    let table = text(folder, name);
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let column = header.iter().position(|name| *name == "tint_nm");
    let column = column.unwrap_or_else(|| panic!("{name} has the columns {header:?}"));
    let values: Vec<f64> = rows.map(|row| row[column].parse().unwrap()).collect();
    for value in [450.0, 650.0] {
        let count = values.iter().filter(|found| **found == value).count();
        assert_eq!(2 * count, values.len(), "{name}");
    }
}

/// Asserts that files contain both values with their symbol and unit.
fn assert_in_text(folder: &Path, names: &[&str]) {
    for name in names {
        let text = text(folder, name);
        for value in ["tau_c = 450 nm", "tau_c = 650 nm"] {
            assert!(text.contains(value), "{name} lacks {value}:\n{text}");
        }
    }
}

fn assert_in_json(folder: &Path) {
    let summary: serde_json::Value = serde_json::from_str(&text(folder, "summary.json")).unwrap();
    let mut found = Vec::new();
    collect(&summary, &mut found);
    assert!(
        found.contains(&450.0) && found.contains(&650.0),
        "{summary}"
    );
}

/// All numbers that are members with the name of the coordinate.
fn collect(value: &serde_json::Value, found: &mut Vec<f64>) {
    match value {
        serde_json::Value::Object(members) => {
            found.extend(members.get("tint_nm").and_then(serde_json::Value::as_f64));
            members.values().for_each(|member| collect(member, found));
        }
        serde_json::Value::Array(items) => items.iter().for_each(|item| collect(item, found)),
        _ => {}
    }
}

#[test]
fn gonio_names_a_further_coordinate_in_tables_json_text_file_names_and_figures() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path();
    let config = GonioConfig::from_toml(SETTINGS).unwrap();
    let mut study = GonioStudy::new(config, None).unwrap();
    in_two_tints(&mut study.plan);
    let folder = ResultFolder::open(out, "gonio", &[]).unwrap();
    let mut found = ResultSet::in_memory(study.header().unwrap());
    let outcome = study.run(&mut found, &Silent).unwrap();
    let views = study.views().unwrap();
    views.write(&folder, &outcome, &Silent).unwrap();
    folder.finish(true).unwrap();
    assert_in_table(out, "gonio.csv");
    assert_in_text(out, &["report.txt"]);
    assert_in_json(out);
    for name in "s2_n1.5_tint450_theta20_phi0 s2_n1.5_tint650_theta70_phi0".split(' ') {
        text(out, &format!("directions/{name}.csv"));
    }
    let figures = fs::read_dir(out.join("plots")).unwrap();
    let svg = figures.map(|file| file.unwrap().path());
    let svg = svg.filter(|path| path.extension().is_some_and(|end| end == "svg"));
    let drawn: String = svg.map(|path| fs::read_to_string(path).unwrap()).collect();
    for value in ["450 nm", "650 nm"] {
        assert!(drawn.contains(value), "no figure has {value}");
    }
}

#[test]
fn verify_and_map_name_a_further_coordinate_in_tables_json_text_folders_and_figures() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("verify");
    let config = VerifyConfig::from_toml(&compared()).unwrap();
    let mut study = VerifyStudy::new(config).unwrap();
    in_two_tints(&mut study.plan);
    let folder = ResultFolder::open(&out, "verify", &[]).unwrap();
    let mut found = ResultSet::in_memory(study.header().unwrap());
    let outcome = study.run(&mut found, &Silent).unwrap();
    let views = study.views().unwrap();
    views.write(&folder, &outcome, &Silent).unwrap();
    folder.finish(true).unwrap();
    assert_in_text(&out, &["report.txt"]);
    assert_in_json(&out);
    for value in [450, 650] {
        let case = out.join(format!("s2_n1.5_tint{value}_theta20"));
        let drawn = text(&case, "in_plane_reflected.svg");
        assert!(drawn.contains(&format!("{value} nm")));
    }

    let out = place.path().join("map");
    let config = MapConfig::from_toml(&compared()).unwrap();
    let mut study = MapStudy::new(config).unwrap();
    in_two_tints(&mut study.plan);
    let folder = ResultFolder::open(&out, "map", &[]).unwrap();
    let mut found = ResultSet::in_memory(study.header().unwrap());
    let outcome = study.run(&mut found, &Silent).unwrap();
    let views = study.views().unwrap();
    views.write(&folder, &outcome, &Silent).unwrap();
    folder.finish(true).unwrap();
    assert_in_table(&out, "map.csv");
    assert_in_json(&out);
    assert_in_text(&out, &["report.txt"]);
    let drawn = text(&out, "map_own.svg");
    for value in ["450 nm", "650 nm"] {
        assert!(drawn.contains(value), "no panel has {value}");
    }
}

#[test]
fn gonio_and_map_draw_each_surface_once_for_all_angles_and_tints() {
    let drawn = Drawn::default();
    let config = GonioConfig::from_toml(SETTINGS).unwrap();
    let mut study = GonioStudy::new(config, None).unwrap();
    in_two_tints(&mut study.plan);
    let mut found = ResultSet::in_memory(study.header().unwrap());
    study.run(&mut found, &drawn).unwrap();
    let each_once: Vec<u64> = (0..SURFACES).collect();
    let numbers = || {
        let mut numbers = std::mem::take(&mut *drawn.0.lock().unwrap());
        numbers.retain(|number| *number < SURFACES);
        numbers.sort_unstable();
        numbers
    };
    assert_eq!(numbers(), each_once);

    let config = MapConfig::from_toml(&compared()).unwrap();
    let mut study = MapStudy::new(config).unwrap();
    in_two_tints(&mut study.plan);
    let mut found = ResultSet::in_memory(study.header().unwrap());
    study.run(&mut found, &drawn).unwrap();
    assert_eq!(numbers(), each_once);
}
