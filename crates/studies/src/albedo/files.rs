//! The files of tables of albedos: CSV, NPY, EXR, a C header, figures, report.txt and summary.json.

use asperity_io::{write_array, write_image_layers};

use super::array::array;
use super::config::AlbedoConfig;
use super::figures::{ShownLight, figure};
use super::header::header;
use super::image::{COMMENT, layers};
use super::json::albedo_summary;
use super::outcome::AlbedoOutcome;
use super::tables;
use crate::report::views::Views;
use crate::study::Findings;

impl AlbedoConfig {
    /// Files of the study, for this number of materials.
    pub(super) fn views<'a>(&self, materials: usize) -> Views<'a, AlbedoOutcome<'a>> {
        let mut views: Views<'a, AlbedoOutcome<'a>> = Views::new();
        views.csv("albedo.csv", |outcome| Some(tables::points(outcome)));
        views.csv("mean.csv", |outcome| Some(tables::means(outcome)));
        views.other(vec!["albedo.npy".to_owned()], |outcome, place, _| {
            let (shape, values) = array(outcome);
            write_array(place.claim("albedo.npy")?, &shape, &values)?;
            Ok(0)
        });
        views.other(vec!["albedo.exr".to_owned()], |outcome, place, _| {
            let size = [outcome.axes.cosines.len(), outcome.axes.alphas.len()];
            write_image_layers(place.claim("albedo.exr")?, size, &layers(outcome), COMMENT)?;
            Ok(0)
        });
        views.text("albedo.h", header);
        let drawn = if self.output.plots { materials } else { 0 };
        for material in 0..drawn {
            for light in ShownLight::ALL {
                let name = light.name(material, materials);
                views.figure(name, move |outcome| figure(outcome, material, light));
            }
        }
        views.text("report.txt", |outcome| Some(outcome.text()));
        views.json("summary.json", |outcome| Some(albedo_summary(outcome)));
        views
    }
}
