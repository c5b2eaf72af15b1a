//! `asperity inspect`: roughness statistics of a height map.

use std::path::Path;

use asperity_io::write_bytes;
use asperity_studies::settings::Document;
use asperity_studies::{MeasuredConfig, height_map_figure, realisation_table, roughness_table};
use asperity_surface::{HeightField, Roughness};
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::input::{check_height_map_output, name_of, read_surface, required_file, write_surface};
use crate::output::note_lines;
use crate::output_files::{refuse_equal_names, refuse_input};

/// What is read.
#[derive(Deserialize)]
struct Settings {
    measured: MeasuredConfig,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    let Settings { measured } = document.read().map_err(Failure::usage)?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let file = required_file(&measured, document.command())?;
    let plot = results
        .plot
        .as_deref()
        .map(PlotFormat::from_path)
        .transpose()?;
    if let Some(path) = &results.output {
        check_height_map_output(path)?;
    }
    let outputs = [results.output.as_deref(), results.plot.as_deref()];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().collect();
    for path in &outputs {
        refuse_input(path, file)?;
    }
    refuse_equal_names(&outputs)?;
    let mut input = read_surface(file, &measured, common)?;
    let roughness = Roughness::of(&input.field);
    if let (Some(path), Some(format)) = (&results.plot, plot) {
        draw(path, format, &input.field, &name_of(file))?;
        common.say(|| format!("{} drawn", path.display()));
    }
    if let Some(path) = &results.output {
        input.notes.extend(write_surface(path, &input.field)?);
        common.say(|| format!("{} written", path.display()));
    }
    results.print_file(
        common,
        || &roughness,
        || {
            let (table, realisation) = (roughness_table(&roughness), realisation_table(&roughness));
            let notes = note_lines(&input.notes);
            format!("{}: {table}{realisation}{notes}", file.display())
        },
    )
}

/// Formats of a plot, by file ending.
#[derive(Clone, Copy)]
enum PlotFormat {
    Svg,
    Png,
}

impl PlotFormat {
    fn from_path(path: &Path) -> Result<Self, Failure> {
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
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
