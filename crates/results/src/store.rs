//! Part store: finished surfaces and cases during a run, in memory and in a journal.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use asperity_io::{Journal, ResultFolder};
use asperity_simulate::{SurfaceKey, SurfaceSource, SurfaceStore, SurfaceTallies};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::case_result::Stored;
use crate::error::ResultsError;
use crate::header::Header;

/// The journal of a run, in its result folder.
pub(crate) const JOURNAL: &str = "results.journal";

/// Schedule of writes to the journal, which bounds what a killed run loses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Least time between two writes.
    pub(crate) interval: Duration,
    /// Fraction of the run time that all writes together may take.
    pub(crate) part: f64,
}

impl Pace {
    /// Every 10 s, and half a per cent of the time, so that writes that take longer than those before stay below one.
    pub(crate) const DEFAULT: Self = Self {
        interval: Duration::from_secs(10),
        part: 0.005,
    };
}

/// A record of the journal after the first, which is the header as JSON.
#[derive(Serialize, Deserialize)]
pub(crate) enum Record<C, P> {
    Case(usize, C),
    Part(SurfaceKey, P),
}

/// A record that was read.
pub(crate) type ReadRecord<C> = Record<Box<C>, Box<SurfaceTallies>>;

/// Bytes of records per write.
const BYTES_AT_ONCE: usize = 4 << 20;

/// A finished part.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Held(Box<SurfaceTallies>),
    /// In the journal: the offset of its record.
    Journal(u64),
}

/// Finished parts of a run, and its journal.
#[derive(Debug)]
pub(crate) struct PartStore<'a, C> {
    state: Mutex<State<C>>,
    /// The folder that the journal is written to; `None` in memory alone.
    folder: Option<&'a ResultFolder>,
    /// Offset of the case numbers of keys: the number of the first case of the current simulation.
    first: usize,
}

#[derive(Debug)]
pub(crate) struct State<C> {
    pub(crate) parts: BTreeMap<SurfaceKey, Part>,
    /// Parts and cases that are not in the journal yet.
    new_parts: VecDeque<SurfaceKey>,
    new_cases: VecDeque<(usize, Arc<C>)>,
    /// Given surfaces, and what is written in their place.
    described: Vec<(SurfaceSource, SurfaceSource)>,
    /// Header of the journal; `None` in memory alone.
    header: Option<Header>,
    journal: Option<Journal>,
    /// End of the journal of an earlier run; 0 to begin a new one.
    end: u64,
    /// `true` if parts of complete cases are kept, so that a run with more surfaces goes on from them.
    pub(crate) keeps_parts: bool,
    /// `true` if anything came that is not in the file of results.
    pub(crate) is_changed: bool,
    /// When the journal is to be written next, if there is a clock that goes so far.
    due: Option<Instant>,
    began: Instant,
    pace: Pace,
    failure: Option<ResultsError>,
    /// Time spent on the journal.
    pub(crate) journal_time: Duration,
}

impl<'a, C: Stored> PartStore<'a, C> {
    /// `target`: header of the journal, and its folder; `None` in memory alone. `end`: where the journal of an earlier run ends, or 0.
    pub(crate) fn new(target: Option<(Header, &'a ResultFolder)>, end: u64, pace: Pace) -> Self {
        let (header, folder) = target.unzip();
        Self {
            folder,
            state: Mutex::new(State {
                parts: BTreeMap::new(),
                new_parts: VecDeque::new(),
                new_cases: VecDeque::new(),
                described: Vec::new(),
                header,
                journal: None,
                end,
                keeps_parts: false,
                is_changed: end > 0,
                due: Instant::now().checked_add(pace.interval),
                began: Instant::now(),
                pace,
                failure: None,
                journal_time: Duration::ZERO,
            }),
            first: 0,
        }
    }

    pub(crate) fn state(&self) -> MutexGuard<'_, State<C>> {
        // What is kept is changed in one step, so a panic of another thread leaves it whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a case that is finished, of which no parts are needed any more.
    pub(crate) fn add_case(&self, number: usize, case: &Arc<C>) {
        let mut state = self.state();
        state.is_changed = true;
        if !case.is_cut_short() && !state.keeps_parts {
            state.parts.retain(|key, _| key.case != number);
            state.new_parts.retain(|key| key.case != number);
        }
        if state.header.is_some() {
            state.new_cases.push_back((number, case.clone()));
        }
        state.write_if_due(self.folder);
    }

    /// Begins a simulation whose first case has this number.
    pub(crate) const fn begin(&mut self, first: usize) {
        self.first = first;
    }

    fn key(&self, key: SurfaceKey) -> SurfaceKey {
        SurfaceKey {
            case: self.first + key.case,
            ..key
        }
    }
}

impl<C: Stored + Send + Sync> SurfaceStore for PartStore<'_, C> {
    fn load(&self, key: SurfaceKey) -> Option<SurfaceTallies> {
        let mut state = self.state();
        let part = state.parts.get(&self.key(key)).cloned()?;
        state.part(&part)
    }

    fn save(&self, key: SurfaceKey, surface: SurfaceTallies) {
        let key = self.key(key);
        let mut state = self.state();
        state.is_changed = true;
        state.parts.insert(key, Part::Held(Box::new(surface)));
        if !state.new_parts.contains(&key) {
            state.new_parts.push_back(key);
        }
        state.write_if_due(self.folder);
    }

    fn is_due(&self) -> bool {
        self.state().is_due()
    }
}

impl<C: Stored> State<C> {
    /// A part as it was saved; `None` if the journal cannot be read any more.
    pub(crate) fn part(&mut self, part: &Part) -> Option<SurfaceTallies> {
        match part {
            Part::Held(surface) => Some((**surface).clone()),
            Part::Journal(begin) => {
                let record = self.journal.as_ref()?.read(*begin).ok()?;
                match ciborium::from_reader(record.as_slice()).ok()? {
                    ReadRecord::<C>::Part(_, surface) => Some(*surface),
                    ReadRecord::Case(..) => None,
                }
            }
        }
    }

    /// Names what is written in the place of given surfaces, whose points are read once for that.
    pub(crate) fn describe<'a>(&mut self, sources: impl Iterator<Item = &'a SurfaceSource>) {
        for source in sources.filter(|source| matches!(source, SurfaceSource::Given(_))) {
            if self.described_as(source).is_none() {
                self.described.push((source.clone(), source.described()));
            }
        }
    }

    /// Description that is written in the place of a given surface.
    pub(crate) fn described_as(&self, source: &SurfaceSource) -> Option<&SurfaceSource> {
        let mut known = self.described.iter();
        known.find_map(|(live, described)| (live == source).then_some(described))
    }

    /// A case as it is written.
    pub(crate) fn to_write(&self, case: &C) -> C {
        let mut case = case.clone();
        if let Some(surface) = case.surface_mut()
            && let Some(described) = self.described_as(surface)
        {
            *surface = described.clone();
        }
        case
    }

    fn is_due(&self) -> bool {
        self.header.is_some() && self.due.is_some_and(|due| Instant::now() >= due)
    }

    /// Writes what is new, if it is time to and as far as time allows. A failure is kept for the end: the run itself needs no journal.
    fn write_if_due(&mut self, folder: Option<&ResultFolder>) {
        if !self.is_due() || self.failure.is_some() {
            return;
        }
        let clock = Instant::now();
        let all = self.began.elapsed().as_secs_f64() * self.pace.part;
        let left = all - self.journal_time.as_secs_f64();
        while left > clock.elapsed().as_secs_f64() {
            match self.write_some(folder) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => {
                    self.failure = Some(error);
                    break;
                }
            }
        }
        self.journal_time += clock.elapsed();
        self.due = Instant::now().checked_add(self.pace.interval);
    }

    /// Writes some of what is new, cases first; `false` if nothing was.
    fn write_some(&mut self, folder: Option<&ResultFolder>) -> Result<bool, ResultsError> {
        let (mut records, mut keys) = (Vec::new(), Vec::new());
        while records.iter().map(Vec::len).sum::<usize>() < BYTES_AT_ONCE {
            if let Some((number, case)) = self.new_cases.pop_front() {
                records.push(bytes(&Record::<_, ()>::Case(number, self.to_write(&case)))?);
                keys.push(None);
            } else if let Some(key) = self.new_parts.pop_front() {
                if let Some(Part::Held(surface)) = self.parts.get(&key) {
                    records.push(bytes(&Record::<(), _>::Part(key, surface))?);
                    keys.push(Some(key));
                }
            } else {
                break;
            }
        }
        let (Some(header), Some(folder), false) = (&self.header, folder, records.is_empty()) else {
            return Ok(false);
        };
        let journal = match &mut self.journal {
            Some(journal) => journal,
            closed => {
                let path = folder.claim_checkpoint(JOURNAL)?;
                let mut journal = Journal::open(&path, self.end)?;
                if self.end == 0 {
                    journal.append(&[json!(header).to_string().into_bytes()])?;
                }
                closed.insert(journal)
            }
        };
        let begins = journal.append(&records)?;
        // Parts are on the disk, and need no memory.
        for (key, begin) in keys.into_iter().zip(begins) {
            if let Some(key) = key {
                self.parts.insert(key, Part::Journal(begin));
            }
        }
        Ok(true)
    }

    /// The first failure to write the journal.
    pub(crate) const fn take_failure(&mut self) -> Option<ResultsError> {
        self.failure.take()
    }

    /// Parts and all else that is needed of the journal, which is given up then.
    pub(crate) fn hold_parts(&mut self) {
        for (key, part) in self.parts.clone() {
            match self.part(&part) {
                Some(surface) => self.parts.insert(key, Part::Held(Box::new(surface))),
                None => self.parts.remove(&key),
            };
        }
        self.new_parts.clear();
        self.new_cases.clear();
        self.journal = None;
        self.end = 0;
    }
}

fn bytes(record: &impl Serialize) -> Result<Vec<u8>, ResultsError> {
    let mut bytes = Vec::new();
    let written = ciborium::into_writer(record, &mut bytes);
    written.map_err(|error| ResultsError::Unwritable(error.to_string()))?;
    Ok(bytes)
}
