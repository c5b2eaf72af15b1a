//! `asperity attenuation`: shadowing and masking on explicit surfaces.

use asperity_simulate::counted;
use asperity_studies::settings::Document;
use asperity_studies::{
    AttenuationConfig, AttenuationError, attenuation, attenuation_report, attenuation_summary,
    attenuation_table,
};

use crate::common::{Common, Results};
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::input::{refuse_config, refuse_surface};
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
    config.check().map_err(|error| match error {
        AttenuationError::Synthesis(error) => refuse_surface(document.own_unit(), error),
        AttenuationError::Run(error) => Failure::failed(error),
        error => refuse_config(document, &error),
    })?;
    let folder = match &results.output {
        Some(path) => {
            let (inputs, names) = ([document.file()], config.files());
            Some(result_folder(path, "attenuation", &inputs, &names)?)
        }
        None => None,
    };

    let progress = Progress::begin_run(common);
    let outcome = attenuation(&config, &progress).map_err(Failure::failed)?;
    if let Some(folder) = &folder {
        attenuation_report(folder, &outcome, &progress).map_err(Failure::failed)?;
    }
    let ended = EndedRun {
        stopped_by: outcome.stopped_by,
        so_far: &format!(
            "results are of {} that finished",
            counted(outcome.work.realisations, "surface")
        ),
        again: Again::Restarts,
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
