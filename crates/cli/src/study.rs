//! Studies: `verify`, `map`, `gonio`, `albedo`, `trace`, `converge` and `attenuation` take the same steps.

use asperity_io::ResultFolder;
use asperity_results::Container;
use asperity_simulate::{Deadline, Observer, Share, counted};
use asperity_studies::settings::Document;
use asperity_studies::{
    ChosenEngine, Findings, ShardFolders, Study, StudyError, Views, WorkPlan, is_plan_only,
    open_results, share_of, time_limit, trace_shard,
};

use crate::common::{Common, Results};
use crate::end::{Again, End, EndedRun, stopped_without_results};
use crate::failure::Failure;
use crate::output::{result_folder, say, say_notes};
use crate::progress::Progress;
use crate::report::{check_page, write_page};

/// Plans a study, resumes what an earlier run has finished, runs the rest, writes and prints all of it.
pub(crate) fn run<S: Study>(document: &Document, common: &Common) -> Result<End, Failure> {
    let results = Results::of(document).map_err(Failure::usage)?;
    let is_plan_only = is_plan_only(document);
    let share = share_of(document).filter(|_| !is_plan_only);
    if let (Some(share), None) = (share, &results.output) {
        let reason = format!("--shard {share} needs -o DIR, from which merge reads its results");
        return Err(Failure::usage(reason));
    }
    run_from::<S>(document, None, &results, common)
}

/// Merges shards into the results of a run, and traces what they lack. Where results go is told by `results`.
pub(crate) fn merge<S: Study>(
    shards: &ShardFolders,
    results: &Results,
    common: &Common,
) -> Result<End, Failure> {
    run_from::<S>(&shards.document, Some(shards), results, common)
}

fn run_from<S: Study>(
    document: &Document,
    shards: Option<&ShardFolders>,
    results: &Results,
    common: &Common,
) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    if let Some(page) = &results.report {
        check_page(page, document)?;
        if results.output.is_none() || share_of(document).is_some() || is_plan_only(document) {
            let reason = "--report needs -o DIR, without --shard and --plan-only: the page is made of the files of the results";
            return Err(Failure::usage(reason));
        }
    }
    let engine = ChosenEngine::open(document).map_err(refused)?;
    let progress = Progress::new(common);
    let time = time_limit(document).map_err(Failure::usage)?;
    let observer = Deadline::new(&progress, time);
    let study = S::plan(document, &observer).map_err(|error| match error.is_stopped() {
        true => stopped_without_results(observer.stop(), &error, "nothing is written"),
        false => refused(error),
    })?;
    say_notes(study.notes());
    let is_plan_only = is_plan_only(document);
    let share = share_of(document).filter(|_| !is_plan_only);
    let names = match share {
        _ if is_plan_only => WorkPlan::views().names(),
        Some(_) => Vec::new(),
        None => study
            .views()
            .map_err(|error| refused(error.into()))?
            .names(),
    };
    let folder = results.output.as_ref();
    let folder = folder.map(|path| result_folder(path, document, &names));
    let folder = folder.transpose()?;

    progress.begin_run();
    let found = match &folder {
        Some(folder) => open_results(&study, document, folder).map_err(refused)?,
        None => Container::in_memory(study.header().map_err(|error| refused(error.into()))?),
    };
    let mut found = found.on(engine.engine());
    say_notes(found.notes());
    if let Some(shards) = shards {
        say_notes(&shards.merge_into::<S>(&mut found).map_err(refused)?);
    }
    let resumed = found.resumed();
    if resumed.parts > 0 {
        say("resumed from surfaces or rays that an earlier run had finished");
    }
    if resumed.cases > 0 {
        common.say(|| format!("{} resumed", counted(resumed.cases as u64, "case")));
    }
    let shown = Shown {
        results,
        common,
        observer: &observer,
        folder: folder.as_ref(),
    };
    let ran = match share {
        _ if is_plan_only => plan_work(&study, document, &mut found, &shown),
        Some(share) => run_shard(&study, share, &mut found, &shown),
        None => run_and_show(&study, &mut found, &shown),
    };
    common.say_if(engine.work());
    say_notes(engine.note().as_slice());
    let error = match ran {
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
    let views = study.views().map_err(|error| Stop::Study(error.into()))?;
    show(&findings, &views, shown).map_err(Stop::Failure)
}

/// Plans the work of a study, writes and prints the plan.
fn plan_work<S: Study>(
    study: &S,
    document: &Document,
    found: &mut Container<'_, S::Kept>,
    shown: &Shown<'_>,
) -> Result<End, Stop> {
    let plan = WorkPlan::of(study, document, found, shown.observer).map_err(Stop::Study)?;
    show(&plan, &WorkPlan::views(), shown).map_err(Stop::Failure)
}

/// Writes and prints findings.
fn show<F: Findings + Sync>(
    findings: &F,
    views: &Views<'_, F>,
    shown: &Shown<'_>,
) -> Result<End, Failure> {
    let mut undrawn = 0;
    if let Some(folder) = shown.folder {
        undrawn = views
            .write(folder, findings, shown.observer)
            .map_err(Failure::failed)?;
    }
    let end = ended(findings, shown, undrawn)?;
    if let (Some(page), Some(folder)) = (&shown.results.report, &shown.results.output) {
        write_page(&[folder], page, shown.common)?;
    }
    shown.common.say_if(findings.work());
    shown
        .results
        .print(shown.common, || findings.summary(), || findings.text())?;
    Ok(end)
}

/// Traces the share of a run, and keeps its results for a merge.
fn run_shard<S: Study>(
    study: &S,
    share: Share,
    found: &mut Container<'_, S::Kept>,
    shown: &Shown<'_>,
) -> Result<End, Stop> {
    let traced = trace_shard(study, share, found, shown.observer).map_err(Stop::Study)?;
    let end = EndedRun {
        stopped_by: found.stopped_by(),
        so_far: "what was traced so far is kept",
        again: Again::Resumes,
    };
    if let Some(folder) = shown.folder {
        let finished = folder.finish(false).map_err(Failure::failed);
        finished.map_err(Stop::Failure)?;
    }
    let end = match end.close(None).map_err(Stop::Failure)? {
        // A merge that waits for all shards to succeed is not to begin.
        End::Complete if !traced.finished => End::Interrupted,
        end => end,
    };
    let printed = shown
        .results
        .print(shown.common, || &traced, || traced.text());
    printed.map_err(Stop::Failure)?;
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
