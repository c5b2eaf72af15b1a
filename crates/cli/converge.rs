//! `asperity converge`: run time against error.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{
    ConvergeConfig, ConvergeError, converge, converge_report, converge_summary, converge_table,
};

use crate::common::{Common, Results};
use crate::completion::say_notes;
use crate::end::{Again, End, EndedRun, finished};
use crate::failure::Failure;
use crate::input::{read_surface_files, refuse_config, refuse_verification};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut config: ConvergeConfig = document.read().map_err(Failure::usage)?;
    say_notes(&read_surface_files(&mut config.surface)?);
    let results = Results::of(document).map_err(Failure::usage)?;
    // Everything is checked before a ray is traced; the folder is made when there are results.
    let names = config.check().map_err(|error| match error {
        ConvergeError::Run(error) => refuse_verification(document, error),
        error => refuse_config(document, &error),
    })?;
    let folder = result_folder(&results.required(), "converge", &[document.file()], &names)?;

    let progress = Progress::begin_run(common);
    let outcome = converge(&config, &progress).map_err(Failure::failed)?;
    converge_report(&folder, &outcome, &progress).map_err(Failure::failed)?;
    let done = outcome.cases.len();
    let ended = EndedRun {
        stopped_by: outcome.stopped_by(),
        so_far: &finished(done, done + outcome.left_out, "case"),
        again: Again::Restarts,
    };
    let end = ended.close(Some(&folder))?;
    common.say(|| {
        let cases = counted(outcome.cases.len() as u64, "case");
        format!("{cases} in {:.1} s", outcome.seconds)
    });
    results.print(
        common,
        || converge_summary(&outcome),
        || converge_table(&outcome),
    )?;
    Ok(end)
}
