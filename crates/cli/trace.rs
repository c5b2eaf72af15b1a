//! `asperity trace`: light on given surfaces.

use asperity_studies::settings::Document;
use asperity_studies::{
    TraceConfig, TraceError, TracePlan, TracedSurfaces, trace, trace_report, trace_summary,
    trace_table,
};

use crate::common::{Common, Results};
use crate::completion::open_results;
use crate::end::{Again, End, EndedRun};
use crate::failure::Failure;
use crate::given::{read_like, required_surfaces, settings_for};
use crate::input::{refuse_config, refuse_simulation};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let config: TraceConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let refuse = |error: TraceError| match error {
        TraceError::Config(error) => refuse_config(document, &error),
        TraceError::Simulate(error) => refuse_simulation(document.own_unit(), error),
        TraceError::Results(error) => Failure::failed(error),
        error => Failure::usage(error),
    };
    // Everything that can be is checked before the surfaces are read.
    config.check().map_err(|error| refuse(error.into()))?;
    let surfaces = read(&config, document, common)?;
    let config: TraceConfig = settings_for(document, surfaces.tops.first.unit)?;
    let plan = TracePlan::new(&config, surfaces).map_err(refuse)?;
    // Everything is checked before a ray is traced; the folder is made when there are results.
    let names = config.files().map_err(|error| refuse(error.into()))?;
    let inputs = config.measured.files().chain(document.file());
    let bottom = config.medium.as_ref().and_then(|m| m.bottom_surface.file());
    let inputs: Vec<_> = inputs.chain(bottom).map(Some).collect();
    let folder = results.output.as_ref();
    let folder = folder.map(|path| result_folder(path, "trace", &inputs, &names));
    let folder = folder.transpose()?;
    let mut found = open_results(folder.as_ref(), plan.header())?;

    let progress = Progress::begin_run(common);
    let outcome = trace(&plan, &mut found, &progress).map_err(refuse)?;
    if let Some(folder) = &folder {
        trace_report(folder, &outcome).map_err(Failure::failed)?;
    }
    let (so_far, again) = match &folder {
        Some(_) => ("the results so far are written", Again::Resumes),
        None => ("these are the results so far", Again::ResumesWithOutput),
    };
    let ended = EndedRun {
        stopped_by: outcome.stopped_by,
        so_far,
        again,
    };
    let end = ended.close(folder.as_ref())?;
    common.say(|| {
        let work = &outcome.outcome.work.machine;
        format!(
            "built in {:.3} s, traced in {:.3} s",
            work.build_seconds, work.trace_seconds
        )
    });
    results.print(common, || trace_summary(&outcome), || trace_table(&outcome))?;
    Ok(end)
}

/// Reads the surfaces, and the one below them if that is a file.
fn read(
    config: &TraceConfig,
    document: &Document,
    common: &Common,
) -> Result<TracedSurfaces, Failure> {
    let tops = required_surfaces(&config.measured, document, common)?;
    let medium = config.medium.as_ref();
    let bottom = medium
        .and_then(|medium| medium.bottom_surface.file())
        .map(|path| read_like(&tops.first, path, &config.measured, common))
        .transpose()?;
    Ok(TracedSurfaces { tops, bottom })
}
