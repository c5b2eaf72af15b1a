//! `asperity converge`: run time against error.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{
    ConvergeConfig, converge, converge_report, converge_summary, converge_table,
};

use crate::common::{Common, Results};
use crate::completion::{open_results, say_notes};
use crate::end::{Again, End, EndedRun, finished};
use crate::failure::Failure;
use crate::input::{read_surface_files, refuse_verification};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut config: ConvergeConfig = document.read().map_err(Failure::usage)?;
    say_notes(&read_surface_files(&mut config.surface)?);
    let results = Results::of(document).map_err(Failure::usage)?;
    // Everything is checked before a ray is traced; the folder is made when there are results.
    let plan = config
        .plan()
        .map_err(|error| refuse_verification(document, error))?;
    let names = config.files(&plan);
    let folder = result_folder(&results.required(), "converge", &[document.file()], &names)?;

    let progress = Progress::begin_run(common);
    let mut found = open_results(Some(&folder), config.header())?;
    let outcome = converge(&config, &plan, &mut found, &progress).map_err(Failure::failed)?;
    converge_report(&folder, &outcome, &progress).map_err(Failure::failed)?;
    let done = outcome.cases.len();
    let ended = EndedRun {
        stopped_by: outcome.found.stopped_by(),
        so_far: &finished(done, plan.cases.len(), "case"),
        again: Again::Resumes,
    };
    let end = ended.close(Some(&folder))?;
    common.say(|| {
        let cases = counted(done as u64, "case");
        format!("{cases} in {:.1} s", outcome.seconds)
    });
    results.print(
        common,
        || converge_summary(&outcome),
        || converge_table(&outcome),
    )?;
    Ok(end)
}
