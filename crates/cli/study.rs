//! Studies: `verify`, `map`, `gonio`, `trace`, `converge` and `attenuation` take the same steps.

use asperity_io::ResultFolder;
use asperity_results::Container;
use asperity_simulate::{Observer, counted};
use asperity_studies::settings::Document;
use asperity_studies::{Findings, Study};

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
    let findings = match study.run(&mut found, &progress) {
        Ok(findings) => findings,
        Err(error) if error.is_stopped() => {
            let is_kept = found.close_early().map_err(Failure::failed)?;
            let left = match &folder {
                Some(folder) if is_kept => {
                    folder.finish(false).map_err(Failure::failed)?;
                    "what was traced so far is kept, and the same command resumes"
                }
                _ => "nothing is written",
            };
            return Err(stopped_without_results(progress.stop(), &error, left));
        }
        Err(error) => return Err(refused(error)),
    };
    if let Some(folder) = &folder {
        let views = study.views().map_err(|error| refused(error.into()))?;
        views
            .write(folder, &findings, &progress)
            .map_err(Failure::failed)?;
    }
    let end = ended(&findings, folder.as_ref())?;
    common.say_if(findings.work());
    results.print(common, || findings.summary(), || findings.text())?;
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
