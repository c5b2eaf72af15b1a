//! Surface checkpoints: the finished parts of a run, by which an interrupted or killed run resumes.
//!
//! Files `checkpoints/N.json` in the result folder hold what was finished since the file before: a line with the
//! settings and the build that it follows from, and a line with the surfaces. A file whose surfaces were all saved
//! again, as that of rays on a given surface, is removed. Files are written at most as often as [`Pace`] says, so that
//! short runs write none, and removed when the run has come to its end. Files of another results epoch or of other
//! settings are refused by name, so that no run removes the work of another. Files of a machine that rounds differently
//! are computed again.

#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use asperity_analysis::fnv1a;
use asperity_io::{
    Build, ReadError, ResultFolder, ResultFolderError, names_in, read_text, write_bytes,
};
use asperity_simulate::{
    Observer, Outcome, SavedSurface, SimulateError, Simulation, SurfaceKey, SurfaceStore,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::checkpoints::{CHANGED, CheckpointError, Found, first_difference, other_build};
use asperity_results::rounding;

/// Folder of the files within the result folder.
const FOLDER: &str = "checkpoints";

/// How often files are written, and thus what a killed run may lose.
#[derive(Clone, Copy)]
struct Pace {
    /// Least time between two files.
    interval: Duration,
    /// So many times what the last file took to write, at least, lies between two files.
    rest: u32,
}

/// Every 10 s, and no more than 1 % of the time.
const PACE: Pace = Pace {
    interval: Duration::from_secs(10),
    rest: 99,
};

/// Form of the files; another number is another form.
const SCHEMA: u64 = 2;

/// First line of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    schema: u64,
    study: String,
    build: Build,
    /// How the machine rounds that computed it.
    rounding: String,
    config: Value,
    /// Of the second line, so that a changed number is noticed.
    checksum: String,
}

/// Surfaces as they are written.
type Surfaces = Vec<(SurfaceKey, SavedSurface)>;

/// Keeps the finished surfaces of one run in its result folder.
pub struct SurfaceCheckpoints<'a> {
    folder: &'a ResultFolder,
    study: &'static str,
    config: Value,
    pace: Pace,
    /// Those of an earlier run that were not loaded yet.
    earlier: Mutex<HashMap<SurfaceKey, SavedSurface>>,
    resumed: usize,
    notes: Vec<String>,
    pending: Mutex<Pending>,
}

/// Surfaces that are finished and not written yet, and the files so far.
struct Pending {
    surfaces: Surfaces,
    /// When the next file is due, if there is a clock that goes so far.
    due: Option<Instant>,
    /// Number of the next file.
    number: usize,
    /// Number of the file that holds a surface as it was saved last.
    files: HashMap<SurfaceKey, usize>,
    failure: Option<CheckpointError>,
}

impl Pending {
    fn is_due(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }
}

impl<'a> SurfaceCheckpoints<'a> {
    /// Reads the surfaces that an earlier run of `study` with these settings has left in `folder`.
    ///
    /// # Errors
    /// [`CheckpointError`] if a file cannot be read, or is of another study, other settings or another results epoch.
    pub fn open(
        folder: &'a ResultFolder,
        study: &'static str,
        config: Value,
    ) -> Result<Self, CheckpointError> {
        let names = names_in(folder.path().join(FOLDER));
        let number_of = |name: &String| name.strip_suffix(".json")?.parse::<usize>().ok();
        let mut numbers: Vec<usize> = names.iter().filter_map(number_of).collect();
        // A later file holds what was saved later.
        numbers.sort_unstable();
        let (mut earlier, mut files) = (HashMap::new(), HashMap::new());
        let mut notes = Vec::new();
        for &number in &numbers {
            let found = read(folder, study, &config, number)?;
            notes.extend(found.note(&folder.path().join(file_name(number))));
            if let Found::Results(surfaces) = found {
                folder.keep(&file_name(number));
                files.extend(surfaces.iter().map(|(key, _)| (*key, number)));
                earlier.extend(surfaces);
            }
        }
        Ok(Self {
            folder,
            study,
            config,
            pace: PACE,
            resumed: earlier.len(),
            notes,
            earlier: Mutex::new(earlier),
            pending: Mutex::new(Pending {
                surfaces: Vec::new(),
                due: Instant::now().checked_add(PACE.interval),
                number: numbers.last().map_or(0, |last| last + 1),
                files,
                failure: None,
            }),
        })
    }

    /// Runs a simulation with these checkpoints, and holds all outcomes.
    pub(crate) fn resume(
        &self,
        simulation: Simulation,
        observer: &dyn Observer,
    ) -> Result<Vec<Outcome>, SimulateError> {
        let mut outcomes = Vec::new();
        simulation.resume(Some(self), observer, |outcome| {
            outcomes.push(outcome);
            Ok::<_, SimulateError>(())
        })?;
        outcomes.sort_unstable_by_key(|outcome| outcome.number);
        Ok(outcomes)
    }

    /// Number of surfaces that an earlier run has left.
    #[must_use]
    pub const fn resumed(&self) -> usize {
        self.resumed
    }

    /// What a reader should know of the files that an earlier run has left: a sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Ends the run. The surfaces of a stopped one are kept, those of a complete one removed.
    ///
    /// # Errors
    /// [`CheckpointError`] if a file could not be written or removed.
    pub fn close(self, is_stopped: bool) -> Result<(), CheckpointError> {
        let mut pending = lock(&self.pending);
        if is_stopped {
            self.write(&mut pending);
        } else {
            for number in 0..pending.number {
                self.folder.discard(&file_name(number))?;
            }
        }
        pending.failure.take().map_or(Ok(()), Err)
    }

    /// Writes the pending surfaces. A failure is kept for the end: the run itself needs no checkpoints.
    fn write(&self, pending: &mut Pending) {
        let surfaces = std::mem::take(&mut pending.surfaces);
        if surfaces.is_empty() || pending.failure.is_some() {
            return;
        }
        let clock = Instant::now();
        let written = self.write_file(pending.number, &surfaces);
        let written = written.and_then(|()| self.discard_superseded(pending, &surfaces));
        let rest = self.pace.interval.max(clock.elapsed() * self.pace.rest);
        pending.due = Instant::now().checked_add(rest);
        pending.number += 1;
        pending.failure = written.err();
    }

    /// Removes the files of which no surface counts any more, since these `surfaces` were written.
    fn discard_superseded(
        &self,
        pending: &mut Pending,
        surfaces: &Surfaces,
    ) -> Result<(), CheckpointError> {
        for (key, _) in surfaces {
            let Some(before) = pending.files.insert(*key, pending.number) else {
                continue;
            };
            if pending.files.values().all(|&number| number != before) {
                self.folder.discard(&file_name(before))?;
            }
        }
        Ok(())
    }

    fn write_file(&self, number: usize, surfaces: &Surfaces) -> Result<(), CheckpointError> {
        let path = self.folder.claim_checkpoint(&file_name(number))?;
        let json = |error| {
            ResultFolderError::Write(asperity_io::WriteError::Json {
                path: path.clone(),
                source: error,
            })
        };
        let surfaces = serde_json::to_string(surfaces).map_err(json)?;
        let header = Header {
            schema: SCHEMA,
            study: self.study.to_owned(),
            build: Build::current(),
            rounding: rounding().to_owned(),
            config: self.config.clone(),
            checksum: checksum(&surfaces),
        };
        let header = serde_json::to_string(&header).map_err(json)?;
        let text = format!("{header}\n{surfaces}\n");
        Ok(write_bytes(&path, text.as_bytes()).map_err(ResultFolderError::from)?)
    }
}

/// The surfaces of a file, which is there.
fn read(
    folder: &ResultFolder,
    study: &str,
    config: &Value,
    number: usize,
) -> Result<Found<Surfaces>, CheckpointError> {
    let path = folder.path().join(file_name(number));
    let text = match read_text(&path) {
        Err(error @ ReadError::Text { .. }) => return Ok(Found::Damaged(error.to_string())),
        text => text?,
    };
    let Some((header, surfaces)) = text.trim_end().split_once('\n') else {
        return Ok(Found::Damaged("it was cut short".to_owned()));
    };
    let header: Value = match serde_json::from_str(header) {
        Ok(header) => header,
        Err(error) => return Ok(Found::Damaged(error.to_string())),
    };
    if let Some(difference) = other_build(&header, SCHEMA, study) {
        return Err(CheckpointError::OtherRun { path, difference });
    }
    let header: Header = match serde_json::from_value(header) {
        Ok(header) => header,
        Err(error) => return Ok(Found::Damaged(error.to_string())),
    };
    if let Some(difference) = first_difference(&header.config, config, "") {
        return Err(CheckpointError::OtherRun { path, difference });
    }
    if header.checksum != checksum(surfaces) {
        return Ok(Found::Damaged(CHANGED.to_owned()));
    }
    Ok(match serde_json::from_str(surfaces) {
        Ok(_) if header.rounding != rounding() => Found::OtherRounding,
        Ok(surfaces) => Found::Results(surfaces),
        Err(error) => Found::Damaged(error.to_string()),
    })
}

/// Name of a file within the result folder.
fn file_name(number: usize) -> String {
    format!("{FOLDER}/{number}.json")
}

fn checksum(text: &str) -> String {
    format!("{:016x}", fnv1a(text.as_bytes()))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is kept is changed in one step, so a panic of another thread leaves it whole.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl SurfaceStore for SurfaceCheckpoints<'_> {
    fn load(&self, key: SurfaceKey) -> Option<SavedSurface> {
        lock(&self.earlier).remove(&key)
    }

    fn save(&self, key: SurfaceKey, surface: SavedSurface) {
        let mut pending = lock(&self.pending);
        pending.surfaces.retain(|(other, _)| *other != key);
        pending.surfaces.push((key, surface));
        if pending.is_due() {
            self.write(&mut pending);
        }
    }

    fn is_due(&self) -> bool {
        lock(&self.pending).is_due()
    }
}
