//! `asperity gonio`: the whole BRDF and BTDF.

use asperity_studies::settings::Document;
use asperity_studies::{GonioConfig, Sample, gonio, gonio_report, gonio_summary, gonio_table};

use crate::common::{Common, Results};
use crate::completion::{close_cases, open_cases, say_notes};
use crate::end::End;
use crate::failure::Failure;
use crate::given::{given_surfaces, settings_for};
use crate::input::{read_surface_files, refuse_config, refuse_simulation, refuse_verification};
use crate::output::result_folder;
use crate::progress::Progress;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let mut config: GonioConfig = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let surfaces = given_surfaces(&config.measured, document, common)?;
    if let Some(surfaces) = &surfaces {
        config = settings_for(document, surfaces.first.unit)?;
    }
    say_notes(&read_surface_files(&mut config.surface)?);
    let (form, cells) = (config.measured.remove, config.surface.cells.of_given());
    let sample = surfaces
        .map(|surfaces| Sample::of(surfaces, form, cells))
        .transpose()
        .map_err(|error| refuse_simulation(document.own_unit(), error))?;
    let sample = sample.as_ref();
    // Everything is checked before a ray is traced.
    let plan = config
        .plan(sample)
        .map_err(|error| refuse_verification(document, error))?;
    let names = config
        .files(&plan)
        .map_err(|error| refuse_config(document, &error))?;
    let inputs = config.measured.files().chain(document.file());
    let inputs: Vec<_> = inputs.map(Some).collect();
    let folder = result_folder(&results.required(), "gonio", &inputs, &names)?;

    let progress = Progress::begin_run(common);
    let header = config.header(sample);
    let header = header.map_err(|error| refuse_config(document, &error))?;
    let mut found = open_cases(&folder, header, &plan.cases, common)?;
    let about = sample.map(|sample| &sample.about);
    let outcome = gonio(&config, about, &plan, &mut found, &progress)
        .map_err(|error| refuse_verification(document, error))?;
    gonio_report(&folder, &outcome).map_err(Failure::failed)?;
    let end = close_cases(outcome.found, "direction", &folder)?;
    results.print(
        common,
        || gonio_summary(&outcome),
        || gonio_table(&outcome) + "\n",
    )?;
    Ok(end)
}
