//! Shards of a run: each traces a part of it, and their results are merged into those of the whole.

use std::path::{Path, PathBuf};

use asperity_io::{ResultFolder, exists, read_text, shown_path};
use asperity_results::{Container, Header, Shards, has_results};
use asperity_simulate::{Observer, Share, counted};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::config::values::OneOrMany;
use crate::error::StudyError;
use crate::settings::{Command, Document};
use crate::study::Study;

/// File that every folder of judged results has.
const SUMMARY: &str = "summary.json";

/// File of a result folder with the plan of its work.
pub(crate) const PLAN_FILE: &str = "plan.json";

/// Shards to be merged, as the settings of `merge` name them.
#[derive(Debug, Deserialize)]
struct MergeConfig {
    folders: Option<OneOrMany<PathBuf>>,
    #[serde(default)]
    partial: bool,
}

/// Shards of a run that is known.
#[derive(Clone, Debug)]
pub struct ShardFolders {
    /// The run, as it was requested of each shard.
    pub document: Document,
    folders: Vec<PathBuf>,
    is_partial: bool,
}

/// The part of its run that a document names; `None` if it is a whole run.
#[must_use]
pub fn share_of(document: &Document) -> Option<Share> {
    let share = document.value("results.shard")?;
    share.as_str()?.parse().ok()
}

/// Opens the results of a study in a folder: those of a shard, or of a whole run.
///
/// # Errors
/// [`StudyError`] as of [`Study::open`].
pub fn open_results<'f, S: Study>(
    study: &S,
    document: &Document,
    folder: &'f ResultFolder,
) -> Result<Container<'f, S::Kept>, StudyError> {
    let share = share_of(document).filter(|_| !is_plan_only(document));
    if (share.is_some() || is_plan_only(document)) && exists(folder.path().join(SUMMARY)) {
        return Err(StudyError::Shards(format!(
            "{} holds the results of a run, which neither a shard nor a plan replaces; choose another folder",
            shown_path(folder.path())
        )));
    }
    let plan = document.value("results.plan").filter(|_| share.is_some());
    let plan = plan.as_ref().and_then(|plan| plan.as_str()).map(Path::new);
    let seconds = plan.map(seconds_of_plan).transpose()?;
    let settings = json!({ "settings": document.settings()?, "plan": seconds });
    let header = Header {
        shards: share.map(|share| Shards::one(share, document.request(), settings)),
        ..study.header()?
    };
    let mut found = study.open(folder, header)?;
    if let (Some(plan), Some(seconds)) = (plan, seconds) {
        let planned = Container::read(plan)?;
        let followed = found.follow_plan(planned, seconds);
        followed.map_err(|difference| {
            let plan = shown_path(plan);
            StudyError::Shards(format!(
                "the plan in {plan} is of another run: {difference}"
            ))
        })?;
    }
    if document.is_given("results.extendable") {
        found.keep_parts();
    }
    Ok(found)
}

/// Returns `true` if a document asks for a plan alone.
#[must_use]
pub fn is_plan_only(document: &Document) -> bool {
    document.is_given("results.plan_only")
}

/// Summary of a traced shard.
#[derive(Clone, Debug, Serialize)]
pub struct TracedShard {
    /// Number of the shard, from 1.
    pub shard: u64,
    /// Number of shards.
    pub of: u64,
    /// `false` if it was stopped before all of it was traced.
    pub finished: bool,
    /// Cases of which it has traced all.
    pub complete_cases: u64,
    /// Cases of the run.
    pub cases: u64,
}

impl TracedShard {
    /// Line for people.
    #[must_use]
    pub fn text(&self) -> String {
        let (shard, of, complete) = (self.shard, self.of, self.complete_cases);
        let is = if self.finished { "is" } else { "is not" };
        let cases = counted(self.cases, "case");
        format!("shard {shard}/{of} {is} finished; {complete} of {cases} complete\n")
    }
}

/// Traces the share of a run that `found` was opened with, and writes its results for a merge.
///
/// # Errors
/// [`StudyError`] as of [`Study::compute`], and if the results cannot be written.
pub fn trace_shard<S: Study>(
    study: &S,
    share: Share,
    found: &mut Container<'_, S::Kept>,
    observer: &dyn Observer,
) -> Result<TracedShard, StudyError> {
    study.compute(found, observer)?;
    found.close()?;
    let complete = (0..found.len()).filter(|&case| found.is_complete(case));
    Ok(TracedShard {
        shard: share.number(),
        of: share.of(),
        finished: found.stopped_by().is_none(),
        complete_cases: complete.count() as u64,
        cases: found.len() as u64,
    })
}

impl ShardFolders {
    /// The shards that the document of `merge` names. The run is that of the first of them.
    ///
    /// # Errors
    /// [`StudyError`] if there are none, or one is no shard.
    pub fn of(document: &Document) -> Result<Self, StudyError> {
        #[derive(Deserialize)]
        struct Whole {
            merge: MergeConfig,
        }
        let MergeConfig { folders, partial } = document.read::<Whole>()?.merge;
        let folders = folders.as_ref().map_or(&[][..], OneOrMany::as_slice);
        let Some(first) = folders.first() else {
            return Err(StudyError::Shards(
                "give the folders of the shards".to_owned(),
            ));
        };
        let read = |folder| Header::read(folder).ok();
        let of_shard = |header: &Header| header.shards.is_some();
        let header = match folders.iter().filter_map(read).find(of_shard) {
            Some(header) => header,
            None => Header::read(first)?,
        };
        let study = Command::ALL
            .into_iter()
            .find(|one| one.name() == header.study);
        let (Some(command), Some(shards)) = (study, &header.shards) else {
            return Err(StudyError::Shards(format!(
                "{} holds no shard; give the folders of runs with --shard",
                shown_path(first)
            )));
        };
        Ok(Self {
            document: Document::of_request(command, &shards.request)?,
            folders: folders.to_vec(),
            is_partial: partial,
        })
    }

    /// The folders.
    #[must_use]
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// Adds the results of all shards to `found`, and returns notes for the user on what is missing.
    ///
    /// # Errors
    /// [`StudyError`] if shards are missing or not finished and that is not allowed, or they are not of one run.
    pub fn merge_into<S: Study>(
        &self,
        found: &mut Container<'_, S::Kept>,
    ) -> Result<Vec<String>, StudyError> {
        let mut notes = Vec::new();
        let mut shards = Vec::new();
        for folder in &self.folders {
            let is_empty = folder.is_dir() && !has_results(folder);
            if is_empty && !self.is_partial {
                let folder = shown_path(folder);
                let reason = format!("{folder} holds no results: run its shard again");
                return Err(StudyError::Shards(reason));
            }
            let shard = match is_empty {
                true => None,
                false => Some(Container::<S::Kept>::read(folder)?),
            };
            let is_finished = |shard: &Container<'_, S::Kept>| {
                let shards = shard.header.shards.as_ref();
                shards.is_none_or(|shards| shards.finished)
            };
            match shard.filter(|shard| !self.is_partial || is_finished(shard)) {
                Some(shard) => shards.push((folder, shard)),
                None => {
                    let folder = shown_path(folder);
                    notes.push(format!("{folder} is not finished and is left out"));
                }
            }
        }
        if shards.is_empty() {
            return Err(StudyError::Shards(
                "no shard is finished: run them again".to_owned(),
            ));
        }
        found.merge(shards)?;
        if let Some(shards) = &found.header.shards {
            let missing = missing(shards);
            if !self.is_partial {
                return Err(StudyError::Shards(format!(
                    "{missing}; --partial merges the others"
                )));
            }
            notes.push(format!("{missing}: the results are those of the others"));
        }
        Ok(notes)
    }
}

/// Times of the cases by the plan in a result folder, in seconds.
///
/// # Errors
/// [`StudyError::Shards`] if there is no plan, or it cannot be read.
fn seconds_of_plan(folder: &Path) -> Result<Vec<f64>, StudyError> {
    #[derive(Deserialize)]
    struct Plan {
        seconds: Vec<f64>,
    }
    let path = folder.join(PLAN_FILE);
    let text = read_text(&path).map_err(|error| StudyError::Shards(error.to_string()))?;
    let plan: Plan = serde_json::from_str(&text).map_err(|error| {
        let path = shown_path(&path);
        StudyError::Shards(format!("{path} is no plan ({error})"))
    })?;
    let are_times = plan.seconds.iter().all(|one| *one >= 0.0);
    match are_times && plan.seconds.iter().sum::<f64>().is_finite() {
        true => Ok(plan.seconds),
        false => Err(StudyError::Shards("a plan has invalid times".to_owned())),
    }
}

/// Clause on the shards that are missing.
fn missing(shards: &Shards) -> String {
    /// Numbers that are listed at most.
    const MOST: usize = 20;
    let numbers: Vec<String> = shards.missing().map(|number| number.to_string()).collect();
    let listed = numbers[..numbers.len().min(MOST)].join(", ");
    let more = if numbers.len() > MOST { ", ..." } else { "" };
    let are = if numbers.len() == 1 { "is" } else { "are" };
    let count = counted(numbers.len() as u64, "shard");
    format!("{count} of {} {are} missing ({listed}{more})", shards.of)
}
