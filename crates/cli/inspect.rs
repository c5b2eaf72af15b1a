//! `asperity inspect`: roughness statistics of a height map.

use std::path::Path;

use asperity_io::{HeightMapFormat, write_bytes};
use asperity_studies::settings::Document;
use asperity_studies::{
    InspectConfig, Texture, check_height_map_ending, file_name, height_map_figure, inspect_report,
    texture_files, wrapped, write_surface,
};
use asperity_surface::HeightField;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::{note_lines, result_folder};
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = InspectConfig::new(document).map_err(refused)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let file = config.measured.required_file(document.command());
    let file = file.map_err(Failure::usage)?;
    let plot = results.plot.as_deref();
    let format = plot.map(PlotFormat::from_path).transpose()?;
    let output = results.output.as_deref().map(Output::of).transpose()?;
    let outputs = [output.and_then(Output::file), plot];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().collect();
    check_outputs(&outputs, document)?;
    let folder = match output {
        Some(Output::Folder(path)) => Some(result_folder(path, document, &texture_files())?),
        _ => None,
    };
    let mut found = config.inspect(document, common).map_err(refused)?;
    let (field, name) = (&found.field, file_name(file));
    if let (Some(path), Some(format)) = (plot, format) {
        draw(path, format, field, &name)?;
        common.say(|| format!("{} drawn", path.display()));
    }
    if let Some(Output::HeightMap(path)) = output {
        let note = write_surface(path, field).map_err(|error| refused(error.into()))?;
        found.notes.extend(note);
        common.say(|| format!("{} written", path.display()));
    }
    if let Some(folder) = folder {
        let texture = Texture::of(field)
            .map_err(|error| Failure::failed(format!("{}: {error}", file.display())))?;
        inspect_report(&folder, field, &name, &texture, &found.statistics)
            .map_err(Failure::failed)?;
        folder.finish(true).map_err(Failure::failed)?;
    }
    let text = || {
        let notes = note_lines(&found.notes);
        let statistics = found.statistics.text();
        wrapped(&format!("{}: {statistics}{notes}", file.display()))
    };
    match output {
        Some(Output::Folder(_)) => results.print(common, || &found.statistics, text)?,
        _ => results.print_file(common, || &found.statistics, text)?,
    }
    Ok(End::Complete)
}

/// Target of `-o`.
#[derive(Clone, Copy)]
enum Output<'a> {
    /// A folder for tables and figures: a name without an ending, or a folder that exists.
    Folder(&'a Path),
    /// A height map.
    HeightMap(&'a Path),
}

impl<'a> Output<'a> {
    fn of(path: &'a Path) -> Result<Self, Failure> {
        let is_file = HeightMapFormat::from_path(path).is_some();
        if path.extension().is_none() || path.is_dir() && !is_file {
            return Ok(Self::Folder(path));
        }
        check_height_map_ending(path).map_err(Failure::usage)?;
        Ok(Self::HeightMap(path))
    }

    /// The path of a single file.
    const fn file(self) -> Option<&'a Path> {
        match self {
            Self::Folder(_) => None,
            Self::HeightMap(path) => Some(path),
        }
    }
}

/// Formats of a plot, by file ending.
#[derive(Clone, Copy)]
enum PlotFormat {
    Svg,
    Png,
}

impl PlotFormat {
    fn from_path(path: &Path) -> Result<Self, Failure> {
        match path.extension() {
            Some(ending) if ending.eq_ignore_ascii_case("svg") => Ok(Self::Svg),
            Some(ending) if ending.eq_ignore_ascii_case("png") => Ok(Self::Png),
            _ => Err(Failure::usage(format!(
                "{}: a plot is written as .svg or .png",
                path.display()
            ))),
        }
    }
}

fn draw(path: &Path, format: PlotFormat, field: &HeightField, name: &str) -> Result<(), Failure> {
    let figure = height_map_figure(field, name).map_err(Failure::failed)?;
    let bytes = match format {
        PlotFormat::Svg => figure.svg().map_err(Failure::failed)?.into_bytes(),
        PlotFormat::Png => figure.png().map_err(Failure::failed)?,
    };
    write_bytes(path, &bytes).map_err(Failure::failed)
}
