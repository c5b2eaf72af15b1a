//! Image layers: tables of numbers as OpenEXR, a layer per table, for renderers and compositors.
//!
//! Single precision, ZIP compression, lossless; NaN stands for unknown values. Row 0 is on top.

use std::io::Write;
use std::path::Path;

use ::exr::compression::Compression;
use ::exr::meta::attribute::Text;
use ::exr::meta::header::LayerAttributes;

use crate::encoding::{encode_exr_layers, single};
use crate::error::{WriteError, WriteProblem};
use crate::files::replace_alone;

/// One layer of an image: a table of named channels.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLayer {
    /// Its name, which no other layer of the image has.
    pub name: String,
    /// Channels: names, and values row by row.
    pub channels: Vec<(&'static str, Vec<f64>)>,
}

/// Writes layers of `size` columns and rows as OpenEXR, as [`crate::write_atomically`] does. Several layers are the parts of a file.
///
/// `comment`: meaning of rows, columns and channels, an attribute of every layer.
///
/// ```
/// use asperity_io::{ImageLayer, write_image_layers};
///
/// let folder = tempfile::tempdir()?;
/// let layer = |name: &str, value| ImageLayer {
///     name: name.to_owned(),
///     channels: vec![("E", vec![value; 6])],
/// };
/// let layers = [layer("glass", 0.04), layer("gold", 0.98)];
/// write_image_layers(folder.path().join("e.exr"), [3, 2], &layers, "reflectance")?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] if a value is beyond single precision, or the file cannot be written.
///
/// # Panics
/// If a channel does not have one value per pixel.
pub fn write_image_layers(
    path: impl AsRef<Path>,
    size: [usize; 2],
    layers: &[ImageLayer],
    comment: &str,
) -> Result<(), WriteError> {
    let encode = |layer: &ImageLayer| {
        let channels = layer.channels.iter().map(|(name, values)| {
            assert_eq!(values.len(), size[0] * size[1], "one value per pixel");
            let sample = |value: &f64| match value.is_nan() {
                true => Ok(f32::NAN),
                false => single("value", *value),
            };
            let samples = values.iter().map(sample).collect::<Result<Vec<f32>, _>>()?;
            Ok::<_, WriteProblem>((*name, samples))
        });
        let attributes = LayerAttributes {
            layer_name: Some(Text::from_slice_unchecked(layer.name.as_bytes())),
            comments: Some(Text::from_slice_unchecked(comment.as_bytes())),
            ..LayerAttributes::default()
        };
        Ok((attributes, channels.collect::<Result<_, WriteProblem>>()?))
    };
    replace_alone(path.as_ref(), |out| {
        let layers = layers.iter().map(encode);
        let layers = layers.collect::<Result<_, WriteProblem>>()?;
        let file = encode_exr_layers(size, Compression::ZIP16, layers);
        Ok(out.write_all(&file?)?)
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn layers_keep_names_and_values_and_equal_images_have_equal_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("l.exr");
        let layer = |name: &str, first: f64| ImageLayer {
            name: name.to_owned(),
            channels: vec![
                ("E_T", (0..6).map(|i| first + f64::from(i)).collect()),
                ("E_R", vec![f64::NAN; 6]),
            ],
        };
        let layers = [layer("n = 1.33", 0.5), layer("n = 2", 8.5)];
        write_image_layers(&path, [3, 2], &layers, "what it is").unwrap();
        let bytes = fs::read(&path).unwrap();
        for _ in 0..8 {
            write_image_layers(&path, [3, 2], &layers, "what it is").unwrap();
            assert!(fs::read(&path).unwrap() == bytes);
        }
        let image = ::exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
        let read = image.layer_data.iter().zip(&layers);
        assert_eq!(image.layer_data.len(), 2);
        for (found, layer) in read {
            let name = found.attributes.layer_name.as_ref();
            assert_eq!(name.map(ToString::to_string), Some(layer.name.clone()));
            let [nan, values] = &found.channel_data.list[..] else {
                panic!("two channels");
            };
            assert_eq!(
                [&nan.name, &values.name].map(ToString::to_string),
                ["E_R", "E_T"]
            );
            assert!(nan.sample_data.values_as_f32().all(f32::is_nan));
            let stored = values.sample_data.values_as_f32().map(f64::from);
            assert!(stored.eq(layer.channels[0].1.iter().copied()));
        }
    }
}
