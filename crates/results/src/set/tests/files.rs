//! Files: every field read back, damaged and foreign ones, and a foreign reader.

use std::io::{Cursor, Read, Write};
use std::process::Command;

use asperity_io::Journal;
use asperity_simulate::{Quantity, Regions, Target};
use asperity_surface::HeightField;
use asperity_tally::{Polarimetry, TallyResult};
use asperity_tracer::Polarisation;

use super::*;
use crate::found::EARLIER;

/// All fields of an outcome as text, by which two are compared.
fn text(outcome: &Outcome) -> String {
    let Outcome {
        statistics,
        errors_from,
        surfaces,
        errors,
        deviation_bound,
        work,
        stopping,
        seed,
        number,
        ..
    } = outcome;
    format!(
        "{number} {statistics:?} {errors_from:?} {surfaces:?} {errors:?} {deviation_bound:?} {work:?} {stopping:?} {seed}"
    )
}

#[test]
fn every_field_is_read_back_as_it_was() {
    let target = |error, of| Effort::TargetError(Target::new(error, of).unwrap());
    let refined = Settings {
        refine: true,
        mesh_quadrature: true,
        ..settings()
    };
    let mut mueller = settings();
    mueller.tally = mueller.tally.with_polarimetry(Polarimetry::Mueller);
    mueller.paths = mueller.paths.with_polarisation(Polarisation::Mueller);
    let regions = Settings {
        regions: Some(Regions {
            columns: 2,
            rows: 2,
        }),
        estimator: Estimator::Plain,
        effort: Effort::rays(4000),
        ..settings()
    };
    let runs = [
        (random(1.0, 30.0), refined),
        (random(1.0, 30.0), mueller),
        (
            random(1.0, 30.0),
            Settings {
                effort: target(3e-2, Quantity::Bins),
                ..settings()
            },
        ),
        // Analytic: nothing is traced, and squares of errors by rays are NaN.
        (
            random(1e-9, 0.0),
            Settings {
                effort: target(1e-2, Quantity::Reflected),
                ..settings()
            },
        ),
        (given(), regions),
        (
            given(),
            Settings {
                effort: Effort::rays(100),
                ..settings()
            },
        ),
    ];
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut set = ResultSet::open(&folder, header()).unwrap();
    for (first, (case, settings)) in runs.iter().enumerate() {
        let keep = |outcome: Outcome| {
            Ok::<_, SimulateError>(Some(CaseResult {
                outcome,
                findings: json!({ "name": "x", "distance": 0.5, "list": vec![0.25; 40] }),
            }))
        };
        let simulation = set.prepare(first, std::slice::from_ref(case), settings);
        let numbers = first..first + 1;
        set.run_and_keep(simulation.unwrap(), numbers, &Silent, 6, keep)
            .unwrap();
    }
    let bounded = set.case(3).unwrap().outcome.clone();
    assert!(bounded.deviation_bound.is_some());
    set.close().unwrap();
    let read = ResultSet::read(place.path()).unwrap();
    assert_eq!(read.len(), 6);
    for (number, case) in set.cases() {
        let found = read.case(number).unwrap();
        assert!(text(&found.outcome) == text(&case.outcome), "case {number}");
        assert_eq!(found.findings, case.findings);
        let source = case.outcome.case.surface.described();
        assert_eq!(
            found.outcome.case,
            Case {
                surface: source,
                ..case.outcome.case.clone()
            }
        );
    }
    assert_eq!(read.header, set.header);
    assert!(read.comparable_bytes().unwrap() == set.comparable_bytes().unwrap());
    // Without details, errors are none and means are the same.
    let moments = bounded.clone().without_details();
    let entry = moments.statistics.spec().entries().next().unwrap();
    assert_eq!(moments.errors.at(entry).total, None);
    assert!(moments.surfaces.is_empty() && !bounded.surfaces.is_empty());
}

#[test]
fn results_of_another_run_are_refused_by_the_first_key_that_differs() {
    let place = tempfile::tempdir().unwrap();
    killed(place.path());
    let with = |document| Header::new("test", 1, document);
    let mut other_epoch = header();
    other_epoch.build.results_epoch += 1;
    let mut other_format = header();
    other_format.format += 1;
    let others = [
        (
            Header::new("other", 1, header().document),
            "study test in place of other",
        ),
        (
            Header::new("test", 2, header().document),
            "seed 1 in place of 2",
        ),
        (
            with(json!({ "surface": { "tau": 5.0 }, "theta": [0, 30] })),
            "surface.tau 4.0 in place of 5.0",
        ),
    ];
    // The journal, then the file.
    for is_closed in [false, true] {
        let folder = folder(place.path());
        for (header, expected) in &others {
            let refused = ResultSet::open(&folder, header.clone()).err();
            let text = refused.unwrap().to_string();
            assert!(text.contains(expected), "{text}");
        }
        if !is_closed {
            let mut set = ResultSet::open(&folder, header()).unwrap();
            set.close().unwrap();
        }
    }
    for (header, expected) in [
        (other_epoch, "results epoch"),
        (other_format, "format 2, this program writes 1"),
    ] {
        let place = tempfile::tempdir().unwrap();
        let folder = folder(place.path());
        // A header that this program never writes.
        let mut set = ResultSet::in_memory(header);
        set.folder = Some(&folder);
        set.close().unwrap();
        let refused = ResultSet::open_at(&folder, self::header(), ALWAYS, Complete::Refused)
            .err()
            .unwrap()
            .to_string();
        assert!(refused.contains(expected), "{refused}");
        let unread = ResultSet::read(place.path()).err().unwrap().to_string();
        assert!(unread.contains(expected), "{unread}");
    }
}

#[test]
fn damaged_files_are_computed_again_and_old_ones_refused() {
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut set = ResultSet::in_memory(header());
    set.folder = Some(&folder);
    run(&mut set, &Silent).unwrap();
    set.close().unwrap();
    let path = place.path().join(FILE);
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let set = ResultSet::open(&folder, header()).unwrap();
    assert_eq!(set.resumed(), Resumed::default());
    assert!(set.notes()[0].contains("damaged"), "{:?}", set.notes());
    assert!(ResultSet::read(&path).is_err());

    for place_of_old in EARLIER {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir(place.path().join(place_of_old)).unwrap();
        fs::write(place.path().join(place_of_old).join("0.json"), "{}").unwrap();
        let folder = super::folder(place.path());
        let refused = ResultSet::open(&folder, header())
            .err()
            .unwrap()
            .to_string();
        assert!(refused.contains("earlier version"), "{refused}");
    }
}

/// The results of a run, whose member `name` is as `change` makes it; its checksum is right.
fn changed(name: &str, change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(Cursor::new(whole())).unwrap();
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for number in 0..archive.len() {
        let mut member = archive.by_index(number).unwrap();
        let (member_name, mut bytes) = (member.name().unwrap().into_owned(), Vec::new());
        member.read_to_end(&mut bytes).unwrap();
        if member_name == name {
            change(&mut bytes);
        }
        let options = zip::write::SimpleFileOptions::default();
        writer.start_file(member_name, options).unwrap();
        writer.write_all(&bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn replace(bytes: &mut Vec<u8>, [old, new]: [&str; 2]) {
    let text = String::from_utf8_lossy(bytes);
    assert!(text.contains(old), "{text}");
    *bytes = text.replacen(old, new, 1).into_bytes();
}

#[test]
fn members_that_are_damaged_are_refused_in_one_line_and_claim_no_memory() {
    const ARRAY: &str = "cases/000000/outcome/surfaces/values.npy";
    let header = |parts| changed("header.json", |bytes| replace(bytes, parts));
    let array = |parts| {
        changed(ARRAY, |bytes| {
            let numbers = bytes.split_off(128);
            let mut text = bytes.split_off(10);
            replace(&mut text, parts);
            text.truncate(118);
            bytes.extend([text, numbers].concat());
        })
    };
    let huge = "\"cases\":18446744073709551615";
    let cases = [
        (
            header(["\"cases\":4", huge]),
            "it claims 18446744073709551615 cases",
        ),
        (
            changed("header.json", |bytes| {
                replace(bytes, ["\"complete\":true", "\"complete\":false"]);
                replace(bytes, ["\"test\"", "\"\u{7f}\u{202e}\""]);
            }),
            "study \\u{7f}",
        ),
        (array(["'shape': (", "'shape': (("]), "syntax error"),
        (
            array(["'shape': (6, ", "'shape': (9, "]),
            "claims more numbers",
        ),
        (
            array(["'shape': (6, ", "'shape': (0, 99999999999, "]),
            "claims more numbers",
        ),
        (
            changed(ARRAY, |bytes| bytes[6] = 2),
            "another version of NPY",
        ),
    ];
    let place = tempfile::tempdir().unwrap();
    for (bytes, words) in cases {
        let path = place.path().join(FILE);
        fs::write(&path, bytes).unwrap();
        let error = ResultSet::read(&path)
            .map(drop)
            .map_err(|error| error.to_string());
        let folder = folder(place.path());
        let opened = ResultSet::open(&folder, self::header());
        let said = match opened {
            Ok(set) => set.notes().concat(),
            Err(error) => error.to_string(),
        };
        let read = error.err().unwrap_or_default();
        assert!(
            read.contains(words) || said.contains(words),
            "{words}: {read} {said}"
        );
        assert!(![read, said].concat().contains(char::is_control), "{words}");
    }
}

#[test]
fn a_case_of_a_number_beyond_all_ends_the_journal() {
    let place = tempfile::tempdir().unwrap();
    let begins = killed(place.path());
    let path = place.path().join(JOURNAL);
    // {"Case": [number, ..]} in CBOR
    let is_case = |record: &Vec<u8>| record.starts_with(b"\xa1\x64Case\x82");
    let records = read_journal(&path).unwrap().records.into_iter();
    let mut record = records.map(|(_, record)| record).find(is_case).unwrap();
    record.splice(7..8, [&[0x1b][..], &u64::MAX.to_be_bytes()].concat());
    let mut journal = Journal::open(&path, begins[1]).unwrap();
    journal.append(&[record]).unwrap();
    assert!(ResultSet::read(place.path()).unwrap().is_empty());
}

#[test]
fn numpy_opens_the_file() {
    let has_numpy = Command::new("python3")
        .args(["-c", "import numpy"])
        .output();
    if !has_numpy.is_ok_and(|output| output.status.success()) {
        println!("skipped: there is no python3 with numpy");
        return;
    }
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut set = ResultSet::open(&folder, header()).unwrap();
    run(&mut set, &Silent).unwrap();
    set.close().unwrap();
    let script = r#"
import json, sys
import numpy as np
results = np.load(sys.argv[1])
header = json.loads(results["header.json"])
assert header["study"] == "test" and header["cases"] == 4
case = json.loads(results["cases/000002.json"])
surfaces = results[case["outcome"]["surfaces"]["values"]["$array"]]
means = results["cases/000002/outcome/statistics/means/values"]
assert surfaces.shape == (6, means.size)
assert np.allclose(surfaces.mean(axis=0), means)
print(repr(float(means[0])))
"#;
    let output = Command::new("python3")
        .args(["-c", script])
        .arg(place.path().join(FILE))
        .output();
    let output = output.unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{error}");
    let reflected = set
        .case(2)
        .unwrap()
        .outcome
        .statistics
        .budget()
        .reflected
        .mean;
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text.trim().parse::<f64>().unwrap(), reflected);
}

#[test]
fn a_level_surface_is_described_without_its_points() {
    let field = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
    let level = Case {
        surface: SurfaceSource::height_field(field),
        ..random(1.0, 0.0)
    };
    let few = Settings {
        effort: Effort::rays(100),
        ..settings()
    };
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut set = ResultSet::open(&folder, header()).unwrap();
    let run = |set: &mut ResultSet<'_>| {
        let case = std::slice::from_ref(&level);
        set.run_missing(0, case, &few, &Silent).unwrap();
    };
    run(&mut set);
    set.close().unwrap();
    let mut again = ResultSet::open(&folder, header()).unwrap();
    let surface = |set: &ResultSet<'_>| set.case(0).unwrap().outcome.case.surface.clone();
    assert!(surface(&again).is_level() && surface(&again).heights().is_none());
    // A run that has the surface gives it back.
    run(&mut again);
    assert_eq!(surface(&again), level.surface);
}
