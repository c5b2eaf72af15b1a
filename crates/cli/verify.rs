//! `asperity verify`: random surfaces against the scattering models.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{VerifyConfig, resume_verify, verify_report, verify_summary, verify_table};

use crate::common::{Common, Results};
use crate::completion::say_notes;
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::input::{read_surface_files, refuse_config, refuse_verification};
use crate::output::{result_folder, say};
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let refuse = |error: &dyn std::fmt::Display| refuse_config(document, error);
    let mut config: VerifyConfig = document.read().map_err(Failure::usage)?;
    say_notes(&read_surface_files(&mut config.surface)?);
    config.choose_models(document);
    let results = Results::of(document).map_err(Failure::usage)?;
    // Everything is checked before a ray is traced; the folder is made when there are results.
    config.cases().map_err(|error| refuse(&error))?;
    config.ray_settings().map_err(|error| refuse(&error))?;
    config
        .check_surfaces()
        .map_err(|error| refuse_verification(document, error))?;
    let names = config.files().map_err(|error| refuse(&error))?;
    let folder = result_folder(&results.required(), "verify", &[document.file()], &names)?;

    let checkpoints = config.checkpoints(&folder).map_err(Failure::failed)?;
    say_notes(checkpoints.notes());
    if checkpoints.resumed() > 0 {
        say(&format!(
            "resumed with {} of the run that was ended",
            counted(checkpoints.resumed() as u64, "surface")
        ));
    }
    let progress = Progress::begin_run(common);
    let outcome = resume_verify(&config, &checkpoints, &progress)
        .map_err(|error| refuse_verification(document, error))?;
    verify_report(&folder, &outcome, &progress).map_err(Failure::failed)?;
    let stopped_by = outcome.stopped_by();
    let closed = checkpoints.close(stopped_by.is_some());
    closed.map_err(Failure::failed)?;
    let ended = EndedRun {
        stopped_by,
        so_far: "the results so far are written",
        again: Again::Resumes,
    };
    let end = ended.close(Some(folder))?;
    common.say(|| {
        let cases = counted(outcome.cases.len() as u64, "case");
        format!("{cases} in {:.1} s", outcome.seconds)
    });
    results.print(
        common,
        || verify_summary(&outcome),
        || verify_table(&outcome),
    )?;
    Ok(end)
}
