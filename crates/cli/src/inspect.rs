//! `asperity inspect`: roughness statistics of a height map.

use std::path::Path;

use asperity_io::{HeightMapFormat, check_ending, shown_path};
use asperity_studies::settings::Document;
use asperity_studies::{InspectConfig, inspection_files, names_folder};

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::result_folder;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = InspectConfig::new(document).map_err(refused)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let plot = results.plot.as_deref();
    if let Some(path) = plot {
        check_ending(path, "plots", &["svg", "png"]).map_err(Failure::usage)?;
    }
    let (folder, map) = match results.output.as_deref() {
        Some(path) if names_folder(path) => (Some(path), None),
        map => (None, map),
    };
    if let Some(path) = map {
        HeightMapFormat::of_output(path).map_err(Failure::usage)?;
    }
    let outputs: Vec<&Path> = map.into_iter().chain(plot).collect();
    check_outputs(&outputs, document)?;
    let folder = folder.map(|path| result_folder(path, document, &inspection_files()));
    let folder = folder.transpose()?;
    let mut found = config.inspect(document, common).map_err(refused)?;
    if let Some(path) = plot {
        found.draw(path).map_err(Failure::failed)?;
        common.say(|| format!("{} drawn", shown_path(path)));
    }
    if let Some(path) = map {
        found.write(path).map_err(refused)?;
        common.say(|| format!("{} written", shown_path(path)));
    }
    let Some(folder) = folder else {
        results.print_file(common, || &found.statistics, || found.text())?;
        return Ok(End::Complete);
    };
    let report = found.report().map_err(refused)?;
    report.write(&folder).map_err(Failure::failed)?;
    folder.finish(true).map_err(Failure::failed)?;
    results.print(common, || &found.statistics, || found.text())?;
    Ok(End::Complete)
}
