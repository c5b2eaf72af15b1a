//! Studies: `verify`, `map`, `gonio`, `albedo`, `trace`, `converge` and `attenuation` take the same steps.

use asperity_io::ResultFolder;
use asperity_results::Container;
use asperity_simulate::{Deadline, Observer, counted};
use asperity_studies::settings::Document;
use asperity_studies::{Findings, Study, StudyError, time_limit};

use crate::common::{Common, Results};
use crate::end::{Again, End, EndedRun, stopped_without_results};
use crate::failure::Failure;
use crate::output::{result_folder, say, say_notes};
use crate::progress::Progress;
use crate::report::{check_page, write_page};

/// Plans a study, resumes what an earlier run has finished, runs the rest, writes and prints all of it.
pub(crate) fn run<S: Study>(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let results = Results::of(document).map_err(Failure::usage)?;
    if let Some(page) = &results.report {
        check_page(page, document)?;
        if results.output.is_none() {
            let reason = "--report needs -o DIR: the page is made of the files of the results";
            return Err(Failure::usage(reason));
        }
    }
    let progress = Progress::new(common);
    let time = time_limit(document).map_err(Failure::usage)?;
    let observer = Deadline::new(&progress, time);
    let study = S::plan(document, &observer).map_err(|error| match error.is_stopped() {
        true => stopped_without_results(observer.stop(), &error, "nothing is written"),
        false => refused(error),
    })?;
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
        observer: &observer,
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
    Err(stopped_without_results(observer.stop(), &error, left))
}

/// Where the results of a run go.
struct Shown<'a> {
    results: &'a Results,
    common: &'a Common,
    observer: &'a dyn Observer,
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
    let findings = study.run(found, shown.observer).map_err(Stop::Study)?;
    let mut undrawn = 0;
    if let Some(folder) = shown.folder {
        let views = study.views().map_err(|error| Stop::Study(error.into()))?;
        undrawn = views
            .write(folder, &findings, shown.observer)
            .map_err(|error| Stop::Failure(Failure::failed(error)))?;
    }
    let end = ended(&findings, shown, undrawn).map_err(Stop::Failure)?;
    if let (Some(page), Some(folder)) = (&shown.results.report, &shown.results.output) {
        write_page(&[folder], page, shown.common).map_err(Stop::Failure)?;
    }
    shown.common.say_if(findings.work());
    shown
        .results
        .print(shown.common, || findings.summary(), || findings.text())
        .map_err(Stop::Failure)?;
    Ok(end)
}

/// Ends a run that left out `undrawn` figures, since its time was over or an interrupt came.
fn ended(findings: &impl Findings, shown: &Shown<'_>, undrawn: usize) -> Result<End, Failure> {
    let (all, so_far, again) = match shown.folder {
        Some(_) => (
            "the results are written",
            "the results so far are written",
            Again::Resumes,
        ),
        None => ("", "these are the results so far", Again::ResumesWithOutput),
    };
    let stopped_by = findings.stopped_by();
    let progress = findings.progress();
    let mut so_far = match stopped_by {
        Some(_) => progress.as_deref().unwrap_or(so_far).to_owned(),
        None => all.to_owned(),
    };
    if undrawn > 0 {
        let are = if undrawn == 1 { "is" } else { "are" };
        let figures = counted(undrawn as u64, "figure");
        so_far += &format!(", {figures} {are} not drawn");
    }
    let undrawn = || (undrawn > 0).then(|| shown.observer.stop()).flatten();
    let ended = EndedRun {
        stopped_by: stopped_by.or_else(undrawn),
        so_far: &so_far,
        again,
    };
    ended.close(shown.folder)
}
