//! `asperity attenuation`: shadowing and masking on explicit surfaces.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{
    AttenuationConfig, AttenuationError, attenuation, attenuation_report, attenuation_summary,
    attenuation_table,
};

use crate::common::{Common, Results};
use crate::completion::open_results;
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::input::{refuse_config, refuse_simulation};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: AttenuationConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    if document.is_given("view.phi") && !document.is_given("view.theta") {
        return Err(Failure::usage(
            "--view-phi: the viewer is straight above, where the azimuth has no meaning; give --view-theta too",
        ));
    }
    // Everything is checked before a surface is drawn; the folder is made when there are results.
    let plan = config.plan().map_err(|error| match error {
        AttenuationError::Simulate(error) => refuse_simulation(document.own_unit(), error),
        error => refuse_config(document, &error),
    })?;
    let (inputs, names) = ([document.file()], config.files());
    let folder = results.output.as_ref();
    let folder = folder.map(|path| result_folder(path, "attenuation", &inputs, &names));
    let folder = folder.transpose()?;
    let mut found = open_results(folder.as_ref(), plan.header())?;

    let progress = Progress::begin_run(common);
    let outcome = attenuation(&plan, &mut found, &progress).map_err(Failure::failed)?;
    if let Some(folder) = &folder {
        attenuation_report(folder, &outcome, &progress).map_err(Failure::failed)?;
    }
    let ended = EndedRun {
        stopped_by: outcome.stopped_by,
        so_far: &format!(
            "results are of {} that finished",
            counted(outcome.work.realisations, "surface")
        ),
        again: match &folder {
            Some(_) => Again::Resumes,
            None => Again::ResumesWithOutput,
        },
    };
    let end = ended.close(folder.as_ref())?;
    common.say(|| {
        let work = &outcome.work;
        format!(
            "{} of {} points by {} in {:.2} s",
            counted(work.realisations, "surface"),
            work.points,
            work.method,
            work.seconds
        )
    });
    results.print(
        common,
        || attenuation_summary(&outcome),
        || attenuation_table(&outcome),
    )?;
    Ok(end)
}
