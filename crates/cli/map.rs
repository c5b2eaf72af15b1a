//! `asperity map`: where each model is within tolerance.

use asperity_studies::settings::Document;
use asperity_studies::{MapConfig, map, map_report, map_summary, map_table};

use crate::common::{Common, Results};
use crate::completion::{close_cases, open_cases, say_notes};
use crate::end::End;
use crate::failure::Failure;
use crate::input::{read_surface_files, refuse_verification};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut config: MapConfig = document.read().map_err(Failure::usage)?;
    say_notes(&read_surface_files(&mut config.surface)?);
    config.choose_models(document);
    let results = Results::of(document).map_err(Failure::usage)?;
    // Everything is checked before a ray is traced.
    let plan = config
        .plan()
        .map_err(|error| refuse_verification(document, error))?;
    let names = config.files();
    let folder = result_folder(&results.required(), "map", &[document.file()], &names)?;

    let progress = Progress::begin_run(common);
    let header = config.header();
    let header = header.map_err(|error| refuse_verification(document, error.into()))?;
    let mut found = open_cases(&folder, header, &plan.cases, common)?;
    let outcome = map(&config, &plan, &mut found, &progress).map_err(Failure::failed)?;
    map_report(&folder, &outcome).map_err(Failure::failed)?;
    let end = close_cases(&found, "cell", &folder)?;
    results.print(
        common,
        || map_summary(&outcome),
        || map_table(&outcome) + "\n",
    )?;
    Ok(end)
}
