//! The files of an inspected surface.

use asperity_io::ResultFolder;
use asperity_simulate::Silent;
use asperity_surface::HeightField;
use serde::Serialize;
use serde_json::Value;

use super::Texture;
use crate::output::Head;
use crate::report::error::ReportError;
use crate::report::figures::height_map_figure;
use crate::report::views::Views;

/// An inspected surface.
struct Inspected<'a, S> {
    field: &'a HeightField,
    name: &'a str,
    texture: &'a Texture,
    parameters: &'a S,
}

/// Names of all files of [`inspect_report`].
#[must_use]
pub fn texture_files() -> Vec<String> {
    views::<()>().names()
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

fn views<'a, S: Serialize + Sync>() -> Views<'a, Inspected<'a, S>> {
    let mut views: Views<'a, Inspected<'a, S>> = Views::new();
    views.csv("psd.csv", |one| Some(one.texture.spectrum_table()));
    views.csv("autocorrelation.csv", |one| {
        Some(one.texture.correlation_table())
    });
    views.csv("heights.csv", |one| Some(one.texture.heights_table()));
    views.csv("slopes.csv", |one| Some(one.texture.slopes_table()));
    views.figure("psd", |one| {
        let figure = one.texture.spectrum_figure(one.name);
        Ok(figure.map(|figure| figure.draw()).transpose()?)
    });
    views.figure("autocorrelation", |one| {
        Ok(Some(one.texture.correlation_figure(one.name).draw()?))
    });
    views.figure("heights", |one| {
        Ok(Some(one.texture.heights_figure(one.name).draw()?))
    });
    views.figure("slopes", |one| {
        Ok(Some(one.texture.slopes_figure(one.name).draw()?))
    });
    views.figure("height_map", |one| {
        Ok(Some(height_map_figure(one.field, one.name)?))
    });
    views.json("summary.json", |one| Some(summary(one)));
    views
}

fn summary<'a, S: Serialize + Sync>(one: &Inspected<'a, S>) -> Summary<'a, S> {
    Summary {
        head: Head::of("inspect"),
        surface: one.parameters,
        wave_area: one.texture.wave_area,
        steeper: [0, 1].map(|axis| one.texture.slopes[axis].outside),
        columns: views::<S>().columns(one),
    }
}

/// Writes tables and figures of the surface called `name` into `folder`, and, last, summary.json, which also holds `parameters`.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a figure drawn.
pub fn inspect_report<S: Serialize + Sync>(
    folder: &ResultFolder,
    field: &HeightField,
    name: &str,
    texture: &Texture,
    parameters: &S,
) -> Result<(), ReportError> {
    let inspected = Inspected {
        field,
        name,
        texture,
        parameters,
    };
    views().write(folder, &inspected, &Silent)
}
