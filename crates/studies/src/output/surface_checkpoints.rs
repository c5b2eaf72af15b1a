//! Surface checkpoints: the finished surfaces of a run, by which an interrupted or killed run resumes.
//!
//! Files `checkpoints/N.json` in the result folder hold the surfaces that were finished since the file before: a
//! line with the settings and the build that they follow from, and a line with the surfaces. They are written at
//! most every [`INTERVAL`], so that short runs write none, and removed when the run has come to its end. Files of
//! another results epoch or of other settings are refused by name, so that no run removes the work of another.

#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use asperity_analysis::fnv1a;
use asperity_io::{
    Build, ReadError, ResultFolder, ResultFolderError, names_in, read_text, write_bytes,
};
use asperity_simulate::{Observer, SavedSurface, StoppedBy, SurfaceKey, SurfaceStore};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::checkpoints::{CheckpointError, first_difference, other_build};

/// Folder of the files within the result folder.
const FOLDER: &str = "checkpoints";

/// Least time between two files: what a killed run may lose.
const INTERVAL: Duration = Duration::from_secs(10);

/// Form of the files; another number is another form.
const SCHEMA: u64 = 1;

/// First line of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    schema: u64,
    study: String,
    build: Build,
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
    interval: Duration,
    /// Those of an earlier run that were not loaded yet.
    earlier: Mutex<HashMap<SurfaceKey, SavedSurface>>,
    resumed: usize,
    pending: Mutex<Pending>,
}

/// Surfaces that are finished and not written yet.
struct Pending {
    surfaces: Surfaces,
    written: Instant,
    /// Number of the next file.
    number: usize,
    failure: Option<CheckpointError>,
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
        let mut earlier = HashMap::new();
        let mut number = 0;
        for name in names_in(folder.path().join(FOLDER)) {
            let stem = name.strip_suffix(".json");
            let Some(index) = stem.and_then(|stem| stem.parse::<usize>().ok()) else {
                continue;
            };
            number = number.max(index + 1);
            if let Some(surfaces) = read(folder, study, &config, &name)? {
                folder.keep(&format!("{FOLDER}/{name}"));
                earlier.extend(surfaces);
            }
        }
        Ok(Self {
            folder,
            study,
            config,
            interval: INTERVAL,
            resumed: earlier.len(),
            earlier: Mutex::new(earlier),
            pending: Mutex::new(Pending {
                surfaces: Vec::new(),
                written: Instant::now(),
                number,
                failure: None,
            }),
        })
    }

    /// Number of surfaces that an earlier run has left.
    #[must_use]
    pub const fn resumed(&self) -> usize {
        self.resumed
    }

    /// Tells `observer` of a run whose surfaces are kept here.
    #[must_use]
    pub const fn observing<'b>(&'b self, observer: &'b dyn Observer) -> Resuming<'b> {
        Resuming {
            store: self,
            observer,
        }
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
                self.folder.discard(&format!("{FOLDER}/{number}.json"))?;
            }
        }
        pending.failure.take().map_or(Ok(()), Err)
    }

    /// Writes the pending surfaces. A failure is kept for the end: the run itself needs no checkpoints.
    fn write(&self, pending: &mut Pending) {
        let surfaces = std::mem::take(&mut pending.surfaces);
        pending.written = Instant::now();
        if surfaces.is_empty() || pending.failure.is_some() {
            return;
        }
        match self.write_file(pending.number, &surfaces) {
            Ok(()) => pending.number += 1,
            Err(error) => pending.failure = Some(error),
        }
    }

    fn write_file(&self, number: usize, surfaces: &Surfaces) -> Result<(), CheckpointError> {
        let path = self.folder.claim(&format!("{FOLDER}/{number}.json"))?;
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
            config: self.config.clone(),
            checksum: checksum(&surfaces),
        };
        let header = serde_json::to_string(&header).map_err(json)?;
        let text = format!("{header}\n{surfaces}\n");
        Ok(write_bytes(&path, text.as_bytes()).map_err(ResultFolderError::from)?)
    }
}

/// The surfaces of a file; `None` if it is damaged.
fn read(
    folder: &ResultFolder,
    study: &str,
    config: &Value,
    name: &str,
) -> Result<Option<Surfaces>, CheckpointError> {
    let place = folder.path().join(FOLDER);
    let path = place.join(name);
    let text = match read_text(&path) {
        Err(ReadError::Text { .. }) => return Ok(None),
        text => text?,
    };
    let Some((header, surfaces)) = text.trim_end().split_once('\n') else {
        return Ok(None);
    };
    let Ok(header) = serde_json::from_str::<Value>(header) else {
        return Ok(None);
    };
    if let Some(difference) = other_build(&header, SCHEMA, study) {
        return Err(CheckpointError::OtherRun {
            path,
            folder: place,
            difference,
        });
    }
    let Ok(header) = serde_json::from_value::<Header>(header) else {
        return Ok(None);
    };
    if let Some(difference) = first_difference(&header.config, config, "") {
        return Err(CheckpointError::OtherRun {
            path,
            folder: place,
            difference,
        });
    }
    if header.checksum != checksum(surfaces) {
        return Ok(None);
    }
    Ok(serde_json::from_str(surfaces).ok())
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

    fn save(&self, key: SurfaceKey, surface: &SavedSurface) {
        let mut pending = lock(&self.pending);
        pending.surfaces.push((key, surface.clone()));
        if pending.written.elapsed() >= self.interval {
            self.write(&mut pending);
        }
    }
}

/// Passes everything on to an observer, and keeps surfaces beside it.
pub struct Resuming<'a> {
    store: &'a SurfaceCheckpoints<'a>,
    observer: &'a dyn Observer,
}

impl Observer for Resuming<'_> {
    fn begin(&self, stage: &str, total: u64) {
        self.observer.begin(stage, total);
    }
    fn advance(&self, steps: u64) {
        self.observer.advance(steps);
    }
    fn end(&self) {
        self.observer.end();
    }
    fn note(&self, text: &str) {
        self.observer.note(text);
    }
    fn expect(&self, total: u64) {
        self.observer.expect(total);
    }
    fn surface_drawn(&self, number: u64) {
        self.observer.surface_drawn(number);
    }
    fn store(&self) -> Option<&dyn SurfaceStore> {
        Some(self.store)
    }
    fn stop(&self) -> Option<StoppedBy> {
        self.observer.stop()
    }
}
