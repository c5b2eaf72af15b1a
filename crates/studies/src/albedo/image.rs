//! The tables as an image: albedo.exr, a layer per material, with a column per cosine and a row per roughness.

use asperity_io::ImageLayer;

use super::array::{CHANNELS, channels};
use super::outcome::AlbedoOutcome;

/// Meaning of rows, columns and channels.
pub(super) const COMMENT: &str = "directional albedos: columns are cosines of incidence, rows are values of alpha, both in the order of \
albedo.csv; E: all orders, single: single scattering, ratio: E over single";

/// The layers, one per material.
pub(super) fn layers(outcome: &AlbedoOutcome<'_>) -> Vec<ImageLayer> {
    let layer = |material| {
        let points: Vec<[f64; 8]> = outcome
            .table(material)
            .map(|point| channels(&point))
            .collect();
        let channel = |(i, name)| (name, points.iter().map(|point| point[i]).collect());
        ImageLayer {
            name: outcome.material(material),
            channels: CHANNELS.into_iter().enumerate().map(channel).collect(),
        }
    };
    (0..outcome.materials()).map(layer).collect()
}
