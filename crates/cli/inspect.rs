//! `asperity inspect`: roughness statistics of a height map.

use std::path::Path;

use asperity_io::{HeightMapFormat, write_bytes};
use asperity_optics::Incidence;
use asperity_simulate::Cells;
use asperity_studies::settings::Document;
use asperity_studies::{
    CellsConfig, MeasuredConfig, Number, OneOrMany, ShadowShares, Texture, areal_table,
    height_map_figure, inspect_report, realisation_table, roughness_table, smooth_table,
    texture_files, wrapped,
};
use asperity_surface::{HeightField, Iso25178, SplineRoughness, SplineSurface};
use asperity_synthesis::DrawnRoughness;
use serde::{Deserialize, Serialize};

use crate::common::{Common, Results};
use crate::end::End;
use crate::erosion::eroded;
use crate::failure::Failure;
use crate::input::{
    check_height_map_output, name_of, read_surface, refuse_simulation, required_file, write_surface,
};
use crate::output::{note_lines, result_folder};
use crate::output_files::check_outputs;

/// What is read.
#[derive(Deserialize)]
struct Settings {
    surface: CellsConfig,
    measured: MeasuredConfig,
    light: Light,
}

/// The lights whose shadow is measured.
#[derive(Deserialize)]
struct Light {
    theta: Option<OneOrMany<Number>>,
    phi: Number,
}

impl Light {
    fn directions(&self) -> Result<Vec<Incidence>, Failure> {
        let thetas = self.theta.as_ref().map(|list| list.values("theta"));
        let thetas = thetas.transpose().map_err(Failure::usage)?;
        let direction = |theta: &Number| Incidence::from_degrees(theta.0, self.phi.0);
        let thetas = thetas.unwrap_or_default();
        let directions = thetas.iter().map(direction).collect::<Result<_, _>>();
        directions.map_err(Failure::usage)
    }
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let Settings {
        surface,
        measured,
        light,
    } = document.read().map_err(Failure::usage)?;
    let lights = light.directions()?;
    let results = Results::of(document).map_err(Failure::usage)?;
    let file = required_file(&measured, document.command())?;
    let plot = results
        .plot
        .as_deref()
        .map(PlotFormat::from_path)
        .transpose()?;
    let output = results.output.as_deref().map(Output::of).transpose()?;
    let outputs = [output.and_then(Output::file), results.plot.as_deref()];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().collect();
    let inputs = [Some(file), document.file()];
    check_outputs(&outputs, &inputs)?;
    let folder = match output {
        Some(Output::Folder(path)) => {
            Some(result_folder(path, "inspect", &inputs, &texture_files())?)
        }
        _ => None,
    };
    let mut input = read_surface(file, &measured, common)?;
    let (field, note) = eroded(document, input.field)?;
    input.field = field;
    input.notes.extend(note);
    let cells = surface.cells.of_given();
    let statistics = Statistics::of(&input.field, cells, &lights)?;
    if let (Some(path), Some(format)) = (&results.plot, plot) {
        draw(path, format, &input.field, &name_of(file))?;
        common.say(|| format!("{} drawn", path.display()));
    }
    if let Some(Output::HeightMap(path)) = output {
        input.notes.extend(write_surface(path, &input.field)?);
        common.say(|| format!("{} written", path.display()));
    }
    let (field, name) = (&input.field, name_of(file));
    if let Some(folder) = folder {
        let texture = Texture::of(field)
            .map_err(|error| Failure::failed(format!("{}: {error}", file.display())))?;
        inspect_report(&folder, field, &name, &texture, &statistics).map_err(Failure::failed)?;
        folder.finish(true).map_err(Failure::failed)?;
    }
    let text = || {
        let notes = note_lines(&input.notes);
        wrapped(&format!("{}: {}{notes}", file.display(), statistics.text()))
    };
    match output {
        Some(Output::Folder(_)) => results.print(common, || &statistics, text)?,
        _ => results.print_file(common, || &statistics, text)?,
    }
    Ok(End::Complete)
}

/// What `-o` names.
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
        check_height_map_output(path)?;
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

/// Roughness of the samples and facets, and of the smooth cells through the same heights.
#[derive(Serialize)]
struct Statistics {
    #[serde(flatten)]
    facets: DrawnRoughness,
    #[serde(flatten)]
    areal: Iso25178,
    cells: Cells,
    #[serde(skip_serializing_if = "Option::is_none")]
    smooth: Option<SplineRoughness>,
    /// Lit and shadowed fractions, one per light.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shadows: Vec<ShadowShares>,
}

impl Statistics {
    fn of(field: &HeightField, cells: Cells, lights: &[Incidence]) -> Result<Self, Failure> {
        let smooth = || SplineRoughness::of(&SplineSurface::through(field));
        Ok(Self {
            facets: DrawnRoughness::of(field),
            areal: Iso25178::of(field),
            cells,
            smooth: (cells == Cells::Smooth).then(smooth),
            shadows: ShadowShares::of(field, cells, lights)
                .map_err(|error| refuse_simulation(field.unit(), error))?,
        })
    }

    fn text(&self) -> String {
        let facets = &self.facets.roughness;
        let (table, realisation) = (roughness_table(facets), realisation_table(&self.facets));
        let areal = areal_table(&self.areal, facets.unit);
        let cells = match &self.smooth {
            None => CELLS.to_owned(),
            Some(smooth) => smooth_table(facets, smooth),
        };
        let shadows = self.shadows.iter().map(|shares| shares.text() + "\n");
        format!(
            "{table}{areal}{realisation}{cells}{}",
            shadows.collect::<String>()
        )
    }
}

/// What a given surface is traced with.
const CELLS: &str = "traced with flat cells by default, two triangles each; see --cells smooth\n";

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
