//! Studies: `verify`, `map`, `gonio`, `trace`, `converge` and `attenuation` take the same steps.

use asperity_io::ResultFolder;
use asperity_results::Container;
use asperity_simulate::{Observer, counted};
use asperity_studies::settings::Document;
use asperity_studies::{Findings, Study, StudyError};

use crate::common::{Common, Results};
use crate::end::{Again, End, EndedRun, stopped_without_results};
use crate::failure::Failure;
use crate::output::{result_folder, say, say_notes};
use crate::progress::Progress;

/// Plans a study, resumes what an earlier run has finished, runs the rest, writes and prints all of it.
pub(crate) fn run<S: Study>(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let results = Results::of(document).map_err(Failure::usage)?;
    let progress = Progress::new(common);
    let study = S::plan(document, &progress).map_err(refused)?;
    say_notes(study.notes());
    let names = study
        .views()
        .map_err(|error| refused(error.into()))?
        .names();
    let folder = results.output.as_ref();
    let folder = folder.map(|path| result_folder(path, document, &names));
    let folder = folder.transpose()?;

    progress.begin_run();
    let mut found = match &folder {
        Some(folder) => study.open(folder).map_err(refused)?,
        None => Container::in_memory(study.header().map_err(|error| refused(error.into()))?),
    };
    say_notes(found.notes());
    let resumed = found.resumed();
    if resumed.parts > 0 {
        say("resumed from the rays that an interrupted run had finished");
    }
    if resumed.cases > 0 {
        common.say(|| format!("{} resumed", counted(resumed.cases as u64, "case")));
    }
    let shown = Shown {
        results: &results,
        common,
        progress: &progress,
        folder: folder.as_ref(),
    };
    let error = match run_and_show(&study, &mut found, &shown) {
        Err(Stop::Study(error)) => error,
        Err(Stop::Failure(failure)) => return Err(failure),
        Ok(end) => return Ok(end),
    };
    if !error.is_stopped() {
        return Err(refused(error));
    }
    let is_kept = found.close_early().map_err(Failure::failed)?;
    let left = match &folder {
        Some(folder) if is_kept => {
            folder.finish(false).map_err(Failure::failed)?;
            "what was traced so far is kept, and the same command resumes"
        }
        _ => "nothing is written",
    };
    Err(stopped_without_results(progress.stop(), &error, left))
}

/// Where the results of a run go.
struct Shown<'a> {
    results: &'a Results,
    common: &'a Common,
    progress: &'a Progress,
    folder: Option<&'a ResultFolder>,
}

/// Reason why a run has no results.
enum Stop {
    Study(StudyError),
    Failure(Failure),
}

/// Runs what is not there yet, writes and prints all of it.
fn run_and_show<S: Study>(
    study: &S,
    found: &mut Container<'_, S::Kept>,
    shown: &Shown<'_>,
) -> Result<End, Stop> {
    let findings = study.run(found, shown.progress).map_err(Stop::Study)?;
    if let Some(folder) = shown.folder {
        let views = study.views().map_err(|error| Stop::Study(error.into()))?;
        views
            .write(folder, &findings, shown.progress)
            .map_err(|error| Stop::Failure(Failure::failed(error)))?;
    }
    let end = ended(&findings, shown.folder).map_err(Stop::Failure)?;
    shown.common.say_if(findings.work());
    shown
        .results
        .print(shown.common, || findings.summary(), || findings.text())
        .map_err(Stop::Failure)?;
    Ok(end)
}

fn ended(findings: &impl Findings, folder: Option<&ResultFolder>) -> Result<End, Failure> {
    let (so_far, again) = match folder {
        Some(_) => ("the results so far are written", Again::Resumes),
        None => ("these are the results so far", Again::ResumesWithOutput),
    };
    let progress = findings.progress();
    let ended = EndedRun {
        stopped_by: findings.stopped_by(),
        so_far: progress.as_deref().unwrap_or(so_far),
        again,
    };
    ended.close(folder)
}
