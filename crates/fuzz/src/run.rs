//! Run: damaged inputs of one target, and what its reader made of them.

use std::collections::BTreeSet;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::containers::damage;
use crate::seeds::seeds_of;
use crate::targets::Target;

/// Most inputs that are kept to be damaged further.
const MAX_KEPT: usize = 2000;

/// Most failures of one target, each with a file.
const MAX_FAILURES: usize = 10;

/// The end of a run.
#[derive(Clone, Copy, Debug)]
pub enum Limit {
    /// Number of inputs; equal seeds give equal inputs.
    Inputs(u64),
    /// So much time.
    Time(Duration),
}

/// Counts of a run.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Inputs that were read.
    pub inputs: u64,
    /// Inputs without an error.
    pub accepted: u64,
    /// Inputs with an error.
    pub refused: u64,
    /// Refusals in different words, numbers and quotations aside.
    pub refusals: usize,
    /// Panics of decoders that readers caught.
    pub caught: u64,
    /// Panics that readers did not catch.
    pub panics: u64,
    /// Longest time of one input.
    pub longest: Duration,
    /// Failures, each in other words, with the file of the input.
    pub failures: Vec<(String, PathBuf)>,
}

/// A run of one target.
#[derive(Debug)]
pub struct Run<'a> {
    /// Target.
    pub target: &'a Target,
    /// Seed of the damage.
    pub seed: u64,
    /// End.
    pub limit: Limit,
    /// Folder of [`write_seeds`](crate::write_seeds).
    pub made: &'a Path,
    /// Folder in which inputs are read.
    pub folder: &'a Path,
    /// Folder of inputs that failed.
    pub failures: &'a Path,
}

static PANICS: AtomicU64 = AtomicU64::new(0);
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

impl Run<'_> {
    /// Damages inputs until the limit or ten failures.
    ///
    /// # Errors
    /// If a file cannot be read or written, or the target has no seeds.
    pub fn run(&self) -> io::Result<Tally> {
        let seeds = seeds_of(self.target, self.made)?;
        if seeds.is_empty() {
            return Err(io::Error::other("it has no seeds"));
        }
        std::panic::set_hook(Box::new(|info| {
            PANICS.fetch_add(1, Ordering::Relaxed);
            *LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string();
        }));
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let path = self.folder.join(&self.target.file);
        let (mut kept, mut said) = (seeds.clone(), BTreeSet::new());
        let mut tally = Tally::default();
        let began = Instant::now();
        while tally.failures.len() < MAX_FAILURES && !self.is_over(&tally, began) {
            let from = match rng.random() {
                true => &seeds,
                false => &kept,
            };
            let mut bytes = from[rng.random_range(0..from.len())].clone();
            // The first inputs are the seeds themselves.
            match seeds.get(tally.inputs as usize) {
                Some(seed) => bytes.clone_from(seed),
                None => damage(&mut rng, &mut bytes, &kept, self.folder),
            }
            std::fs::write(&path, &bytes)?;
            let clock = Instant::now();
            let before = PANICS.load(Ordering::Relaxed);
            let read = catch_unwind(AssertUnwindSafe(|| (self.target.read)(&path)));
            tally.caught += PANICS.load(Ordering::Relaxed) - before;
            tally.longest = tally.longest.max(clock.elapsed());
            tally.inputs += 1;
            let failure = match read {
                Ok(Ok(())) => {
                    tally.accepted += 1;
                    None
                }
                Ok(Err(text)) => {
                    tally.refused += 1;
                    if said.insert(shape(&text)) && kept.len() < MAX_KEPT {
                        kept.push(bytes.clone());
                    }
                    let is_line = !text.trim().is_empty() && !text.contains(char::is_control);
                    (!is_line).then(|| format!("a refusal that is not one line: {text:?}"))
                }
                Err(_) => {
                    tally.panics += 1;
                    tally.caught -= 1;
                    Some(
                        LAST_PANIC
                            .lock()
                            .unwrap_or_else(PoisonError::into_inner)
                            .clone(),
                    )
                }
            };
            if let Some(failure) = failure {
                let is_known = |(known, _): &(String, _)| shape(known) == shape(&failure);
                if !tally.failures.iter().any(is_known) {
                    let file = self.keep(tally.failures.len())?;
                    tally.failures.push((failure, file));
                }
            }
        }
        tally.refusals = said.len();
        Ok(tally)
    }

    fn is_over(&self, tally: &Tally, began: Instant) -> bool {
        match self.limit {
            Limit::Inputs(inputs) => tally.inputs >= inputs,
            Limit::Time(time) => began.elapsed() >= time,
        }
    }

    /// Keeps the current input as a file of failures, whose ending is that of the target.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep(&self, number: usize) -> io::Result<PathBuf> {
        std::fs::create_dir_all(self.failures)?;
        let Target { name, file, .. } = self.target;
        let kept = self
            .failures
            .join(format!("{name}-{}-{number}-{file}", self.seed));
        std::fs::copy(self.folder.join(file), &kept)?;
        Ok(kept)
    }
}

/// Text without numbers, and without what stands in quotation marks.
fn shape(text: &str) -> String {
    let parts = text.split(['"', '`']).step_by(2);
    let letters = parts.flat_map(str::chars).filter(|c| !c.is_ascii_digit());
    letters.collect()
}
