//! The files of an inspected surface: tables, figures, and summary.json.

use asperity_io::{ResultFolder, write_json};
use asperity_surface::HeightField;
use serde::Serialize;
use serde_json::{Value, json};

use super::{Texture, figures};
use crate::output::{Head, Place, figure_files};
use crate::report::error::ReportError;
use crate::report::figures::{height_map, save};

const TABLES: [&str; 4] = [
    "psd.csv",
    "autocorrelation.csv",
    "heights.csv",
    "slopes.csv",
];

/// Names of all files of [`inspect_report`].
#[must_use]
pub fn texture_files() -> Vec<String> {
    let tables = TABLES.into_iter().chain(["summary.json"]);
    let drawn = figures::NAMES.into_iter().chain(["height_map"]);
    let tables = tables.map(str::to_owned);
    tables.chain(drawn.flat_map(figure_files)).collect()
}

#[derive(Serialize)]
struct Summary<'a, S> {
    #[serde(flatten)]
    head: Head,
    /// Parameters and whatever else is known of the surface.
    surface: &'a S,
    /// Area of the plane of wave vectors that each wave of `psd.csv` stands for.
    wave_area: f64,
    /// Fractions of facets too steep for `slopes.csv`, along x and y.
    steeper: [f64; 2],
    columns: Value,
}

/// Writes tables and figures of the surface called `name` into `folder`, and, last, summary.json, which also holds `parameters`.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a figure drawn.
pub fn inspect_report<S: Serialize>(
    folder: &ResultFolder,
    field: &HeightField,
    name: &str,
    texture: &Texture,
    parameters: &S,
) -> Result<(), ReportError> {
    let drawn = texture.figures(name)?;
    let place = Place::root(folder);
    let [psd, correlation, heights, slopes] = TABLES;
    let (spectrum_table, correlation_table) =
        (texture.spectrum_table(), texture.correlation_table());
    let (heights_table, slopes_table) = (texture.heights_table(), texture.slopes_table());
    spectrum_table.write_csv(&place.claim(psd)?, texture.spectrum())?;
    correlation_table.write_csv(&place.claim(correlation)?, texture.lags())?;
    heights_table.write_csv(&place.claim(heights)?, texture.heights())?;
    slopes_table.write_csv(&place.claim(slopes)?, texture.slopes())?;
    for (name, figure) in drawn {
        save(&[&place], name, &figure)?;
    }
    height_map(&[&place], field, name)?;
    let summary = Summary {
        head: Head::of("inspect"),
        surface: parameters,
        wave_area: texture.wave_area,
        steeper: [0, 1].map(|axis| texture.slopes[axis].outside),
        columns: json!({
            psd: spectrum_table.description(),
            correlation: correlation_table.description(),
            heights: heights_table.description(),
            slopes: slopes_table.description(),
        }),
    };
    write_json(place.claim("summary.json")?, &summary)?;
    Ok(())
}
