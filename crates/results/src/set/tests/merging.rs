//! Shards of one run, merged.

use asperity_simulate::{Division, Share, SurfaceKey};

use super::*;

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

/// A finished shard.
pub(super) fn shard_of(number: u64, of: u64) -> Shards {
    Shards {
        finished: true,
        ..Shards::one(Share::new(number, of).unwrap(), json!(null), json!(null))
    }
}

/// The shards of a run, merged.
fn merged<'a>(shards: Vec<ResultSet<'a>>) -> Result<ResultSet<'a>, ResultsError> {
    let mut merged = ResultSet::in_memory(header());
    let of = shards.len();
    let finished = (1..).zip(shards).map(|(number, mut shard)| {
        shard.header.shards = Some(shard_of(number, of as u64));
        (format!("shard {number}"), shard)
    });
    merged.merge(finished.collect())?;
    Ok(merged)
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
        .resume(Some(&keeper.store), &Silent, 0, drop_all)
        .unwrap();
    let parts: Vec<(SurfaceKey, Part)> = keeper.store.state().parts.clone().into_iter().collect();
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
            shards[shard].store.save(*key, (**surface).clone());
        }
        let mut all = merged(shards).unwrap();
        let after = After::rays(u64::MAX);
        run(&mut all, &after).unwrap();
        assert_eq!(after.drawn.into_inner(), 0);
        assert!(
            all.comparable_bytes().unwrap() == whole,
            "surfaces, division {division}"
        );

        // Each shard runs the cases that are dealt to it, some twice.
        let shard = |_| ResultSet::in_memory(header());
        let mut shards: Vec<ResultSet<'_>> = (0..count).map(shard).collect();
        for (number, case) in full.cases() {
            for _ in 0..=shuffle.below(2) {
                let shard = &mut shards[shuffle.below(count) as usize];
                shard.cases.resize(4, None);
                shard.cases[number] = Some(Arc::new(case.clone()));
            }
        }
        let all = merged(shards).unwrap();
        assert!(
            all.comparable_bytes().unwrap() == whole,
            "cases, division {division}"
        );
    }
    let other = Header::new("test", 2, header().document);
    let shards = vec![ResultSet::in_memory(header()), ResultSet::in_memory(other)];
    let refused = merged(shards).err().unwrap().to_string();
    assert!(refused.contains("seed 2 in place of 1"), "{refused}");
}

/// Shards of a sweep with moments alone, each of which simulates its own cases.
#[test]
fn shards_that_simulate_some_cases_merge_to_the_whole() {
    let of = |is_mine: &dyn Fn(usize) -> bool| {
        let mut set = ResultSet::in_memory(header());
        set.cases.resize(4, None);
        let is_other = |case| !is_mine(case);
        let mine =
            Simulation::of_missing(&cases(), &settings(), &Division::WHOLE, is_other).unwrap();
        let sink = |outcome: Outcome| {
            let number = outcome.number;
            set.cases[number] = Some(Arc::new(outcome.without_details().into()));
            Ok::<_, SimulateError>(())
        };
        mine.resume(None, &Silent, 0, sink).unwrap();
        set
    };
    let whole = of(&|_| true).comparable_bytes().unwrap();
    for mask in [0b0001, 0b0101, 0b1110, 0b1001] {
        let is_first = |case: usize| mask >> case & 1 == 1;
        let shards = vec![of(&is_first), of(&|case| !is_first(case))];
        let all = merged(shards).unwrap();
        assert!(all.comparable_bytes().unwrap() == whole, "{mask:b}");
    }
}
