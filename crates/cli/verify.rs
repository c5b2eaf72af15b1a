//! `asperity verify`: random surfaces against the scattering models.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{VerifyConfig, verify, verify_report, verify_summary, verify_table};

use crate::common::{Common, Results};
use crate::completion::{open_results, say_notes};
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::input::{read_surface_files, refuse_config, refuse_verification};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut config: VerifyConfig = document.read().map_err(Failure::usage)?;
    say_notes(&read_surface_files(&mut config.surface)?);
    config.choose_models(document);
    let results = Results::of(document).map_err(Failure::usage)?;
    // Everything is checked before a ray is traced; the folder is made when there are results.
    let plan = config
        .plan()
        .map_err(|error| refuse_verification(document, error))?;
    let names = config
        .files(&plan.cases)
        .map_err(|error| refuse_config(document, &error))?;
    let folder = result_folder(&results.required(), "verify", &[document.file()], &names)?;

    let progress = Progress::begin_run(common);
    let mut found = open_results(Some(&folder), config.header())?;
    let outcome = verify(&config, &plan, &mut found, &progress)
        .map_err(|error| refuse_verification(document, error))?;
    verify_report(&folder, &outcome, &progress).map_err(Failure::failed)?;
    let ended = EndedRun {
        stopped_by: outcome.found.stopped_by(),
        so_far: "the results so far are written",
        again: Again::Resumes,
    };
    let end = ended.close(Some(&folder))?;
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
