//! Tests of runs that end in any way and go on, and of files that are damaged or of others.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Effort, Estimator, Light, Quantity, Regions, Silent, StoppedBy, SurfaceSource, SurfaceStore,
    Target,
};
use asperity_surface::{HeightField, Psd, Synthesis};
use asperity_tally::{Polarimetry, TallyResult};
use asperity_tracer::Polarisation;

use super::*;

/// Writes the journal at every chance.
const ALWAYS: Pace = Pace {
    interval: Duration::ZERO,
    part: f64::INFINITY,
};

#[derive(Debug)]
enum Failure {
    Simulate(SimulateError),
    Results,
    Keep,
}

impl From<SimulateError> for Failure {
    fn from(error: SimulateError) -> Self {
        Self::Simulate(error)
    }
}

impl From<ResultsError> for Failure {
    fn from(_: ResultsError) -> Self {
        Self::Results
    }
}

/// Counts rays and drawings, and interrupts a run after so many rays.
struct After {
    rays: u64,
    traced: AtomicU64,
    drawn: AtomicU64,
}

impl After {
    const fn rays(rays: u64) -> Self {
        Self {
            rays,
            traced: AtomicU64::new(0),
            drawn: AtomicU64::new(0),
        }
    }
}

impl Observer for After {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.traced.fetch_add(steps, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn surface_drawn(&self, _number: u64) {
        self.drawn.fetch_add(1, Ordering::Relaxed);
    }
    fn stop(&self) -> Option<StoppedBy> {
        let is_over = self.traced.load(Ordering::Relaxed) >= self.rays;
        is_over.then_some(StoppedBy::Interrupt)
    }
}

fn random(sigma: f64, theta: f64) -> Case {
    let psd = Psd::gaussian(sigma, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
    let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
    let glass = Material::dielectric(1.5).unwrap();
    Case::new(SurfaceSource::random(synthesis), glass, light)
}

/// Three directions on surfaces of one kind and one on those of another.
fn cases() -> Vec<Case> {
    vec![
        random(1.0, 0.0),
        random(2.0, 30.0),
        random(1.0, 30.0),
        random(1.0, 60.0),
    ]
}

fn given() -> Case {
    let field = Synthesis::new(Psd::gaussian(1.0, 4.0).unwrap(), [32; 2], [1.0; 2], false);
    let surface = SurfaceSource::height_field(field.unwrap().draw(3, 0).unwrap());
    Case {
        surface,
        ..random(1.0, 40.0)
    }
}

fn settings() -> Settings {
    Settings {
        effort: Effort::Rays {
            total: 6000,
            surfaces: 6,
        },
        mesh_quadrature: false,
        ..Settings::default()
    }
}

fn header() -> Header {
    Header::new(
        "test",
        1,
        json!({ "surface": { "tau": 4.0 }, "theta": [0, 30] }),
    )
}

fn run(set: &mut ResultSet<'_>, observer: &dyn Observer) -> Result<(), Failure> {
    set.run_missing(0, &cases(), &settings(), observer, |outcome| {
        Ok(outcome.into())
    })
}

fn whole() -> Vec<u8> {
    let mut set = ResultSet::in_memory(header());
    run(&mut set, &Silent).unwrap();
    set.comparable_bytes().unwrap()
}

fn folder(path: &Path) -> ResultFolder {
    ResultFolder::open(path, "test", &[]).unwrap()
}

/// All that is found of a case, and how long its debug text is told apart by.
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
            Ok::<_, Failure>(CaseResult {
                outcome,
                findings: json!({ "name": "x", "distance": 0.5, "list": vec![0.25; 40] }),
            })
        };
        set.run_missing(first, std::slice::from_ref(case), settings, &Silent, keep)
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
fn the_bytes_of_results_do_not_depend_on_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(whole)
    };
    assert!(with(1) == with(3));
}

/// A run is interrupted and closed, or killed with its journal, again and again, and goes on to the bytes of the whole run.
#[test]
fn ended_runs_go_on_to_the_bytes_of_the_whole() {
    let whole = whole();
    for is_closed in [true, false] {
        let place = tempfile::tempdir().unwrap();
        for runs in 1.. {
            let folder = folder(place.path());
            folder.check([FILE]).unwrap();
            let mut set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
            assert!(set.notes().is_empty());
            let after = After::rays(5000 * runs);
            match run(&mut set, &after) {
                Ok(()) | Err(Failure::Simulate(SimulateError::Interrupted)) => {}
                other => panic!("{other:?}"),
            }
            let is_whole = (0..4).all(|case| set.is_complete(case));
            if is_closed || is_whole {
                set.close().unwrap();
                assert!(!place.path().join(JOURNAL).exists());
            }
            let bytes = set.comparable_bytes().unwrap();
            if is_closed || is_whole {
                folder.finish(is_whole).unwrap();
            }
            if is_whole {
                assert!(runs > 2, "{runs}");
                assert!(bytes == whole, "other bytes");
                break;
            }
            assert!(runs < 20);
        }
        let read = ResultSet::read(place.path()).unwrap();
        assert!(read.comparable_bytes().unwrap() == whole, "other bytes");
        // All is there: nothing is run, and the file stays.
        let folder = folder(place.path());
        let mut set = ResultSet::open(&folder, header()).unwrap();
        assert_eq!(set.resumed(), Resumed { cases: 4, parts: 0 });
        let after = After::rays(u64::MAX);
        run(&mut set, &after).unwrap();
        assert_eq!(after.drawn.into_inner(), 0);
    }
}

/// A journal of a killed run, and where its records begin.
fn killed(place: &Path) -> Vec<u64> {
    let folder = folder(place);
    let mut set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
    // Complete are the three cases of the first group; the last record is what there is of the other.
    let _ = run(&mut set, &After::rays(21_000));
    assert!(set.is_complete(0) && !set.is_complete(1));
    let journal = read_journal(place.join(JOURNAL)).unwrap();
    journal
        .records
        .into_iter()
        .map(|(begin, _)| begin)
        .collect()
}

#[test]
fn a_torn_or_flipped_record_is_dropped_with_those_behind_it_and_computed_again() {
    let place = tempfile::tempdir().unwrap();
    let begins = killed(place.path());
    let path = place.path().join(JOURNAL);
    let journal = fs::read(&path).unwrap();
    let last = *begins.last().unwrap() as usize;
    let opened = || {
        let folder = folder(place.path());
        let set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
        (set.resumed(), set.notes().to_vec(), set.case(1).is_some())
    };
    let (all, notes, has_last) = opened();
    assert!(has_last);
    assert!(
        notes.is_empty() && all.cases == 3 && all.parts > 0,
        "{all:?}"
    );
    for length in [last + 1, last + 24, last + 1000, journal.len() - 1] {
        fs::write(&path, &journal[..length]).unwrap();
        let (resumed, notes, has_last) = opened();
        assert_eq!(resumed, all);
        assert!(!has_last);
        assert!(notes[0].contains("no whole record"), "{notes:?}");
    }
    // In a part of the first group, before its cases.
    let mut flipped = journal.clone();
    flipped[begins[2] as usize + 100] ^= 4;
    fs::write(&path, &flipped).unwrap();
    let (resumed, notes, _) = opened();
    assert_eq!(resumed, Resumed { cases: 0, parts: 1 });
    assert_eq!(notes.len(), 1);
    let folder = folder(place.path());
    let mut set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
    run(&mut set, &Silent).unwrap();
    assert!(set.comparable_bytes().unwrap() == whole(), "other bytes");
}

#[test]
fn a_kill_between_the_file_and_the_end_of_the_journal_loses_and_doubles_nothing() {
    let place = tempfile::tempdir().unwrap();
    killed(place.path());
    let path = place.path().join(JOURNAL);
    let journal = fs::read(&path).unwrap();
    let folder_of_first = folder(place.path());
    let mut set = ResultSet::open(&folder_of_first, header()).unwrap();
    let before = set.resumed();
    // A part is new, so that there is something to write.
    run(&mut set, &After::rays(21_000)).unwrap();
    set.close().unwrap();
    fs::write(&path, &journal).unwrap();
    let folder = folder(place.path());
    folder.check([FILE]).unwrap();
    let mut set = ResultSet::open(&folder, header()).unwrap();
    assert_eq!(set.resumed().cases, before.cases);
    assert!(set.resumed().parts >= before.parts);
    run(&mut set, &Silent).unwrap();
    set.close().unwrap();
    folder.finish(true).unwrap();
    let names = names_in(place.path());
    assert_eq!(names, ["manifest.json", FILE]);
    let read = ResultSet::read(place.path().join(FILE)).unwrap();
    assert!(read.comparable_bytes().unwrap() == whole(), "other bytes");
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
            "document.surface.tau 4.0 in place of 5.0",
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
fn damaged_files_and_those_of_other_rounding_are_computed_again_and_old_ones_refused() {
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut elsewhere = ResultSet::in_memory(Header {
        rounding: "0123".to_owned(),
        ..header()
    });
    elsewhere.folder = Some(&folder);
    run(&mut elsewhere, &Silent).unwrap();
    elsewhere.close().unwrap();
    let set = ResultSet::open(&folder, header()).unwrap();
    assert_eq!(set.resumed(), Resumed::default());
    assert!(
        set.notes()[0].contains("rounds differently"),
        "{:?}",
        set.notes()
    );

    let path = place.path().join(FILE);
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let mut set = ResultSet::open(
        &folder,
        Header {
            rounding: "0123".to_owned(),
            ..header()
        },
    );
    // The same rounding as the file has, but not as this machine.
    assert!(set.as_mut().unwrap().notes()[0].contains("rounds differently"));
    let mut set = ResultSet::in_memory(header());
    set.folder = Some(&folder);
    run(&mut set, &Silent).unwrap();
    set.close().unwrap();
    let mut bytes = fs::read(&path).unwrap();
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
        let folder = folder_of(place.path());
        let refused = ResultSet::open(&folder, header())
            .err()
            .unwrap()
            .to_string();
        assert!(refused.contains("earlier version"), "{refused}");
    }
}

use folder as folder_of;

#[test]
fn an_error_of_keeping_ends_the_run_and_leaves_what_is_complete() {
    let mut set = ResultSet::in_memory(header());
    let mut left = 2;
    let failed = set.run_missing(0, &cases(), &settings(), &Silent, |outcome| {
        left -= 1;
        match left {
            0 => Err(Failure::Keep),
            _ => Ok(outcome.into()),
        }
    });
    assert!(matches!(failed, Err(Failure::Keep)));
    assert_eq!(
        set.cases().map(|(number, _)| number).collect::<Vec<_>>(),
        [0]
    );
    run(&mut set, &Silent).unwrap();
    assert!(set.comparable_bytes().unwrap() == whole(), "other bytes");
    let steep = set.select(|case| case.light.incidence.theta_deg() == 30.0);
    assert_eq!(steep.map(|(number, _)| number).collect::<Vec<_>>(), [1, 2]);
}

/// Numbers that are the same in every run.
struct Shuffle(u64);

impl Shuffle {
    fn below(&mut self, count: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }
}

/// Finished surfaces of one run, dealt to shards at random, and cases likewise.
#[test]
fn merged_shards_have_the_bytes_of_the_undivided_run() {
    let whole = whole();
    let mut full = ResultSet::in_memory(header());
    run(&mut full, &Silent).unwrap();
    // All parts: those of a run that no case ends.
    let keeper = ResultSet::in_memory(header());
    let simulation = Simulation::new(&cases(), &settings()).unwrap();
    let drop_all = |_| Ok::<_, SimulateError>(());
    simulation
        .resume(Some(keeper.parts()), &Silent, drop_all)
        .unwrap();
    let parts: Vec<(SurfaceKey, Part)> = keeper.parts().state().parts.clone().into_iter().collect();
    assert_eq!(parts.len(), 2 * 6);
    let mut shuffle = Shuffle(7);
    for division in 0..20 {
        let count = 1 + shuffle.below(4);
        let shards: Vec<ResultSet<'_>> =
            (0..count).map(|_| ResultSet::in_memory(header())).collect();
        for (key, part) in &parts {
            let Part::Held(surface) = part else {
                panic!("in memory")
            };
            let shard = shuffle.below(count) as usize;
            shards[shard].parts().save(*key, (**surface).clone());
        }
        let mut merged = ResultSet::merge(shards).unwrap();
        let after = After::rays(u64::MAX);
        run(&mut merged, &after).unwrap();
        assert_eq!(after.drawn.into_inner(), 0);
        assert!(
            merged.comparable_bytes().unwrap() == whole,
            "surfaces, division {division}"
        );

        // Each shard runs the cases that are dealt to it, some twice.
        let shard = |_| ResultSet::in_memory(full.header.clone());
        let mut shards: Vec<ResultSet<'_>> = (0..count).map(shard).collect();
        for (number, case) in full.cases() {
            for _ in 0..=shuffle.below(2) {
                let shard = &mut shards[shuffle.below(count) as usize];
                shard.cases.resize(4, None);
                shard.cases[number] = Some(Arc::new(case.clone()));
            }
        }
        let merged = ResultSet::merge(shards).unwrap();
        assert!(
            merged.comparable_bytes().unwrap() == whole,
            "cases, division {division}"
        );
    }
    let other = Header::new("test", 2, header().document);
    let shards = vec![ResultSet::in_memory(header()), ResultSet::in_memory(other)];
    let refused = ResultSet::merge(shards).err().unwrap().to_string();
    assert!(refused.contains("seed 2 in place of 1"), "{refused}");
}

/// Shards of a sweep with moments alone, each of which simulates its own cases.
#[test]
fn shards_that_simulate_some_cases_merge_to_the_whole() {
    let of = |is_mine: &dyn Fn(usize) -> bool| {
        let mut set = ResultSet::in_memory(header());
        set.cases.resize(4, None);
        let mine = Simulation::of_missing(&cases(), &settings(), |case| !is_mine(case)).unwrap();
        let sink = |outcome: Outcome| {
            let number = outcome.number;
            set.cases[number] = Some(Arc::new(outcome.without_details().into()));
            Ok::<_, SimulateError>(())
        };
        mine.resume(None, &Silent, sink).unwrap();
        set
    };
    let whole = of(&|_| true).comparable_bytes().unwrap();
    for mask in [0b0001, 0b0101, 0b1110, 0b1001] {
        let is_first = |case: usize| mask >> case & 1 == 1;
        let shards = vec![of(&is_first), of(&|case| !is_first(case))];
        let merged = ResultSet::merge(shards).unwrap();
        assert!(merged.comparable_bytes().unwrap() == whole, "{mask:b}");
    }
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
        set.run_missing(0, case, &few, &Silent, |one| Ok::<_, Failure>(one.into()))
            .unwrap();
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

/// Sizes and times of docs/results.md: cargo test --release -p asperity-results --lib sizes -- --ignored --nocapture
#[test]
#[ignore = "a measurement"]
fn sizes_and_times() {
    let place = tempfile::tempdir().unwrap();
    let measure = |name: &str,
                   cases: &[Case],
                   settings: &Settings,
                   keep: fn(Outcome) -> Outcome| {
        let folder = folder(&place.path().join(name));
        let mut set = ResultSet::open(&folder, header()).unwrap();
        let clock = Instant::now();
        let kept = |outcome| Ok::<_, Failure>(keep(outcome).into());
        set.run_missing(0, cases, settings, &Silent, kept).unwrap();
        let ran = clock.elapsed().as_secs_f64();
        let journal = set.journal_time().as_secs_f64();
        let clock = Instant::now();
        set.close().unwrap();
        let closed = clock.elapsed().as_secs_f64();
        let file = fs::File::open(folder.path().join(FILE)).unwrap();
        let length = file.metadata().unwrap().len() as f64 / 1e6;
        let mut archive = zip::ZipArchive::new(file).unwrap();
        let stored: u64 = (0..archive.len())
            .map(|i| archive.by_index(i).unwrap().size())
            .sum();
        let clock = Instant::now();
        let read = ResultSet::read(folder.path()).unwrap();
        println!(
            "{name}: {} cases, {ran:.1} s, journal {:.2} %, closed in {closed:.2} s, read in {:.2} s, {length:.2} MB, {:.2} MB stored",
            read.len(),
            100.0 * journal / ran,
            clock.elapsed().as_secs_f64(),
            stored as f64 / 1e6
        );
    };
    let rays = |total, surfaces| Settings {
        effort: Effort::Rays { total, surfaces },
        ..settings()
    };
    let angles = |count: usize| {
        let theta = move |i| 85.0 * i as f64 / count as f64;
        (0..count).map(move |i| random(4.0 / (1.0 + (i % 10) as f64), theta(i)))
    };
    let cells: Vec<Case> = angles(200).collect();
    measure("map", &cells, &rays(200_000, 16), Outcome::without_details);
    let directions: Vec<Case> = angles(1080).step_by(10).collect();
    measure(
        "gonio",
        &directions,
        &rays(200_000, 16),
        Outcome::without_details,
    );
    measure(
        "verify",
        &directions[..6],
        &rays(4_000_000, 64),
        |outcome| outcome,
    );
}
