//! The files of an inspected surface.

use std::ffi::OsStr;
use std::path::Path;

use asperity_io::{HeightMapFormat, ResultFolder, shown_path};
use asperity_simulate::Silent;
use serde::Serialize;
use serde_json::Value;

use super::Texture;
use super::config::Inspection;
use super::statistics::Statistics;
use crate::error::StudyError;
use crate::given::{file_name, write_surface};
use crate::output::{Head, note_lines, wrapped};
use crate::report::error::ReportError;
use crate::report::figures::{height_map_figure, write_by_ending};
use crate::report::headline::with_tables;
use crate::report::views::Views;

/// The tables and figures of an inspected surface.
pub struct InspectReport<'a> {
    inspection: &'a Inspection,
    name: String,
    texture: Texture,
}

/// Names of all files of an [`InspectReport`].
#[must_use]
pub fn inspection_files() -> Vec<String> {
    views().names()
}

/// Longest ending of a file, letters.
const LONGEST_ENDING: usize = 4;

/// Returns `true` if `path` names a folder for tables and figures, rather than a height map: it is a folder that exists, ends as one, or has
/// no ending that a file might have, as `run.v1`.
#[must_use]
pub fn names_folder(path: &Path) -> bool {
    let is_ending = |ending: &OsStr| {
        let ending = ending.to_string_lossy();
        ending.len() <= LONGEST_ENDING && ending.chars().all(char::is_alphabetic)
    };
    let ends_as_folder = path.to_string_lossy().ends_with('/');
    let is_file = HeightMapFormat::from_path(path).is_some()
        || path.extension().is_some_and(is_ending) && !path.is_dir();
    ends_as_folder || !is_file
}

impl Inspection {
    /// Draws the heights, as SVG or PNG by the ending of `path`.
    ///
    /// # Errors
    /// [`ReportError`] if the file cannot be written or the figure drawn.
    pub fn draw(&self, path: &Path) -> Result<(), ReportError> {
        let figure = height_map_figure(&self.field, &file_name(&self.file), self.y_is_north)?;
        write_by_ending(path, &figure)
    }

    /// Writes the heights, and notes what the format leaves out.
    ///
    /// # Errors
    /// [`StudyError`] if the file cannot be written.
    pub fn write(&mut self, path: &Path) -> Result<(), StudyError> {
        self.statistics
            .notes
            .extend(write_surface(path, &self.field)?);
        Ok(())
    }

    /// Measures spectrum, autocorrelation and histograms.
    ///
    /// # Errors
    /// [`StudyError`] if all heights are equal, or so large that their sums overflow.
    pub fn report(&self) -> Result<InspectReport<'_>, StudyError> {
        let texture = Texture::of(&self.field);
        Ok(InspectReport {
            inspection: self,
            name: file_name(&self.file),
            texture: texture.map_err(|problem| problem.at(&self.file))?,
        })
    }

    /// Text: roughness and shadows, then notes.
    #[must_use]
    pub fn text(&self) -> String {
        let (file, statistics) = (shown_path(&self.file), self.statistics.text());
        let notes = note_lines(&self.statistics.notes);
        let tables = wrapped(&format!("{file}: {statistics}{notes}"));
        with_tables(&self.statistics.headline(), &tables)
    }
}

impl InspectReport<'_> {
    /// Writes tables and figures into `folder`, and, last, summary.json, which also holds the roughness.
    ///
    /// # Errors
    /// [`ReportError`] if a file cannot be written or a figure drawn.
    pub fn write(&self, folder: &ResultFolder) -> Result<(), ReportError> {
        views().write(folder, self, &Silent).map(|_| ())
    }
}

#[derive(Serialize)]
struct Summary<'a> {
    #[serde(flatten)]
    head: Head,
    headline: Vec<String>,
    /// Parameters and whatever else is known of the surface.
    surface: &'a Statistics,
    /// Area of the plane of wave vectors that each wave of `psd.csv` stands for.
    wave_area: f64,
    /// Fractions of facets too steep for `slopes.csv`, along x and y.
    steeper: [f64; 2],
    columns: Value,
}

fn views<'a>() -> Views<'a, InspectReport<'a>> {
    let mut views: Views<'a, InspectReport<'a>> = Views::new();
    views.csv("psd.csv", |one| Some(one.texture.spectrum_table()));
    views.csv("autocorrelation.csv", |one| {
        Some(one.texture.correlation_table())
    });
    views.csv("heights.csv", |one| Some(one.texture.heights_table()));
    views.csv("slopes.csv", |one| Some(one.texture.slopes_table()));
    views.figure("psd", |one| {
        let figure = one.texture.spectrum_figure(&one.name);
        Ok(figure.map(|figure| figure.draw()).transpose()?)
    });
    views.figure("autocorrelation", |one| {
        Ok(Some(one.texture.correlation_figure(&one.name).draw()?))
    });
    views.figure("heights", |one| {
        Ok(Some(one.texture.heights_figure(&one.name).draw()?))
    });
    views.figure("slopes", |one| {
        Ok(Some(one.texture.slopes_figure(&one.name).draw()?))
    });
    views.figure("height_map", |one| {
        let Inspection {
            field, y_is_north, ..
        } = one.inspection;
        Ok(Some(height_map_figure(field, &one.name, *y_is_north)?))
    });
    views.json("summary.json", |one| Some(summary(one)));
    views
}

fn summary<'a>(one: &InspectReport<'a>) -> Summary<'a> {
    Summary {
        head: Head::of("inspect"),
        headline: one.inspection.statistics.headline(),
        surface: &one.inspection.statistics,
        wave_area: one.texture.wave_area,
        steeper: [0, 1].map(|axis| one.texture.slopes[axis].outside),
        columns: views().columns(one),
    }
}
