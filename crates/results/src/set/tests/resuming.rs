//! Runs that end in any way, and their continuation.

use asperity_io::names_in;

use super::*;

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
        let mut before = Resumed::default();
        for runs in 1.. {
            let folder = folder(place.path());
            folder.check([FILE]).unwrap();
            let mut set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
            assert!(set.notes().is_empty());
            let resumed = set.resumed();
            let is_kept = resumed.cases > before.cases || resumed.parts >= before.parts;
            assert!(is_kept, "{resumed:?} after {before:?}");
            before = resumed;
            let after = After::rays(5000 * runs);
            match run(&mut set, &after) {
                Ok(()) | Err(SimulateError::Interrupted) => {}
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

#[test]
fn results_that_a_killed_run_was_to_replace_are_not_read_with_its_own() {
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let mut first = ResultSet::open(&folder, header()).unwrap();
    run(&mut first, &Silent).unwrap();
    first.close().unwrap();
    let other = Header::new("test", 1, json!("other settings"));
    let mut second = ResultSet::open_at(&folder, other, ALWAYS, Complete::Replaced).unwrap();
    let _ = run(&mut second, &After::rays(5000));
    let read = ResultSet::read(place.path()).unwrap();
    assert_eq!(read.header.document, "other settings");
    assert!(read.case(1).is_none());
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
        assert!(notes[0].contains("damaged or incomplete"), "{notes:?}");
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
    drop(folder_of_first);
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

/// An error of a study.
#[derive(Debug)]
struct Failure;

impl From<SimulateError> for Failure {
    fn from(error: SimulateError) -> Self {
        panic!("{error}");
    }
}

#[test]
fn an_error_of_a_study_ends_the_run_and_leaves_what_is_complete() {
    let moments = |set: &mut ResultSet<'_>, mut left: usize| {
        set.run_missing_moments(&cases(), &settings(), &Silent, |_| {
            left = left.checked_sub(1).ok_or(Failure)?;
            Ok(Some(Value::Null))
        })
    };
    let mut whole = ResultSet::in_memory(header());
    moments(&mut whole, 4).unwrap();
    let mut set = ResultSet::in_memory(header());
    assert!(matches!(moments(&mut set, 1), Err(Failure)));
    let numbers = |set: &ResultSet<'_>| set.cases().map(|(number, _)| number).collect::<Vec<_>>();
    assert_eq!(numbers(&set), [0]);
    moments(&mut set, 3).unwrap();
    assert!(
        set.comparable_bytes().unwrap() == whole.comparable_bytes().unwrap(),
        "other bytes"
    );
    let angle = json!(30);
    assert_eq!(set.select("phi_deg", &json!(0.0)).count(), set.len());
    let inclined = set.select("theta_deg", &angle);
    let inclined: Vec<usize> = inclined.map(|(number, _)| number).collect();
    assert_eq!(inclined, [1, 2]);
}

/// Each of six groups of surfaces fits into memory, all together do not.
#[test]
fn surfaces_of_all_cases_must_fit_into_memory_but_moments_need_not() {
    let cases: Vec<Case> = (1..=6).map(|i| random(f64::from(i) / 4.0, 30.0)).collect();
    let surfaces = (1 << 30) / (16 * settings().spec_of(&cases[0]).len() as u64);
    let settings = Settings {
        effort: Effort::Rays {
            total: surfaces,
            surfaces,
        },
        estimator: Estimator::Plain,
        ..settings()
    };
    let at_once = After::rays(0);
    let set = || ResultSet::in_memory(header());
    let refused = set().run_missing(0, &cases, &settings, &at_once);
    assert!(
        matches!(refused, Err(SimulateError::TooManyResults { cases: 6, .. })),
        "{refused:?}"
    );
    let one = set().run_missing(0, &cases[..1], &settings, &at_once);
    assert!(matches!(one, Err(SimulateError::Interrupted)), "{one:?}");
    let null = |_: &Outcome| Ok::<_, SimulateError>(Some(Value::Null));
    let moments = set().run_missing_moments(&cases, &settings, &at_once, null);
    assert!(
        matches!(moments, Err(SimulateError::Interrupted)),
        "{moments:?}"
    );
}
