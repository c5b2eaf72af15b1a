//! Pictures: radiance by pixel, as OpenEXR for numbers and as PNG for viewing.
//!
//! EXR (.exr): the channels `Y`, radiance, `error`, its standard error, and `A`, the fraction of the pixel in
//! which the camera sees the surface; single precision, ZIP compression, lossless. Radiance is linear, and
//! relative to a unit that the text attribute `comments` names. PNG (.png): greyscale of 8 bits, radiance
//! times the exposure by the curve of sRGB, cut off at white. Row 0 is on top in both.

use std::io::{self, Write};
use std::path::Path;

use ::exr::meta::attribute::Text;
use ::exr::meta::header::LayerAttributes;

use crate::encoding::{encode_exr, png_error, single};
use crate::endings::check_ending;
use crate::error::{WriteError, WriteProblem};
use crate::files::replace_alone;

/// Radiance by pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns and rows; every vector has their product of values.
    pub size: [usize; 2],
    /// Radiance, linear.
    pub radiance: Vec<f64>,
    /// Its standard error; NaN where it is unknown.
    pub error: Vec<f64>,
    /// Fraction of the pixel in which the camera sees the surface, `[0, 1]`.
    pub coverage: Vec<f64>,
}

/// A file format of pictures, chosen by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// OpenEXR: all numbers.
    Exr,
    /// PNG, for viewing.
    Png,
}

impl PictureFormat {
    /// The format of the ending of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`WriteProblem::WrongEnding`] if no format has this ending.
    pub fn from_path(path: &Path) -> Result<Self, WriteError> {
        Ok(match check_ending(path, "pictures", &["exr", "png"])? {
            "exr" => Self::Exr,
            _ => Self::Png,
        })
    }
}

/// Writes a picture in the format of the ending of `path`, as
/// [`crate::write_atomically`] does.
///
/// `exposure`: what radiance is multiplied by for PNG, where one is white; `comment`: what the values are,
/// for EXR.
///
/// # Errors
/// [`WriteError`] if the ending is unknown, a value is beyond single precision, or the file
/// cannot be written.
///
/// # Panics
/// If a vector does not have one value per pixel.
pub fn write_picture(
    path: impl AsRef<Path>,
    picture: &Picture,
    exposure: f64,
    comment: &str,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let pixels = picture.size[0] * picture.size[1];
    for values in [&picture.radiance, &picture.error, &picture.coverage] {
        assert_eq!(values.len(), pixels, "one value per pixel");
    }
    match PictureFormat::from_path(path)? {
        PictureFormat::Exr => replace_alone(path, |out| write_exr(picture, comment, out)),
        PictureFormat::Png => replace_alone(path, |out| Ok(write_png(picture, exposure, out)?)),
    }
}

fn write_exr(picture: &Picture, comment: &str, out: &mut dyn Write) -> Result<(), WriteProblem> {
    let channel = |name: &'static str, values: &[f64]| {
        let samples = values.iter().map(|value| single(name, *value));
        Ok::<_, WriteProblem>((name, samples.collect::<Result<Vec<f32>, _>>()?))
    };
    let channels = vec![
        channel("A", &picture.coverage)?,
        channel("Y", &picture.radiance)?,
        errors(&picture.error)?,
    ];
    let attributes = LayerAttributes {
        comments: Some(Text::from_slice_unchecked(comment.as_bytes())),
        ..LayerAttributes::default()
    };
    Ok(out.write_all(&encode_exr(picture.size, attributes, channels)?)?)
}

/// The channel of errors, which may be unknown.
fn errors(values: &[f64]) -> Result<(&'static str, Vec<f32>), WriteProblem> {
    let sample = |value: &f64| match value.is_nan() {
        true => Ok(f32::NAN),
        false => single("error", *value),
    };
    let samples = values.iter().map(sample).collect::<Result<_, _>>()?;
    Ok(("error", samples))
}

fn write_png(picture: &Picture, exposure: f64, out: &mut dyn Write) -> io::Result<()> {
    // The format counts with 31 bits.
    let [width, height] = picture.size.map(|n| {
        let n = i32::try_from(n).map_err(|_| io::Error::other("too many columns or rows"))?;
        Ok::<_, io::Error>(n.cast_unsigned())
    });
    let mut encoder = ::png::Encoder::new(out, width?, height?);
    encoder.set_color(::png::ColorType::Grayscale);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::High);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(png_error)?;
    let grey: Vec<u8> = picture
        .radiance
        .iter()
        .map(|radiance| (255.0 * srgb(exposure * radiance)).round() as u8)
        .collect();
    writer.write_image_data(&grey).map_err(png_error)?;
    writer.finish().map_err(png_error)
}

/// The curve of sRGB: from linear values to stored ones, both cut off to `[0, 1]`.
///
/// # Source
/// IEC 61966-2-1:1999.
fn srgb(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::read_height_map;

    fn picture() -> Picture {
        Picture {
            size: [3, 2],
            radiance: vec![0.0, 0.1, 0.25, 0.5, 1.0, 2.0],
            error: vec![0.01; 6],
            coverage: vec![1.0; 6],
        }
    }

    #[test]
    fn exr_holds_radiance_row_by_row_from_the_top() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.exr");
        write_picture(&path, &picture(), 1.0, "unit").unwrap();
        // The channel Y is read as heights are.
        let read = read_height_map(&path).unwrap();
        let field = read
            .into_height_field(
                asperity_surface::MissingPolicy::Refuse,
                asperity_surface::Border::Open,
            )
            .unwrap();
        assert_eq!(field.shape(), [2, 3]);
        let stored = picture().radiance.into_iter().map(|r| f64::from(r as f32));
        assert!(field.heights().iter().copied().eq(stored));
        let image = ::exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
        let names: Vec<String> = image.layer_data[0]
            .channel_data
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        assert_eq!(names, ["A", "Y", "error"]);
    }

    #[test]
    fn unknown_errors_are_written_and_unknown_radiance_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.exr");
        let mut unknown = picture();
        unknown.error = vec![f64::NAN; 6];
        write_picture(&path, &unknown, 1.0, "unit").unwrap();
        unknown.radiance[0] = f64::NAN;
        let error = write_picture(&path, &unknown, 1.0, "unit").unwrap_err();
        assert!(
            matches!(error.problem, WriteProblem::OutOfRange { .. }),
            "{error}"
        );
    }

    #[test]
    fn equal_pictures_give_equal_bytes() {
        let folder = tempfile::tempdir().unwrap();
        for ending in ["exr", "png"] {
            let bytes = ["a", "b"].map(|name| {
                let path = folder.path().join(format!("{name}.{ending}"));
                write_picture(&path, &picture(), 0.5, "unit").unwrap();
                fs::read(path).unwrap()
            });
            assert!(bytes[0] == bytes[1], "{ending}");
        }
    }

    #[test]
    fn png_follows_the_curve_of_srgb() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.png");
        write_picture(&path, &picture(), 1.0, "").unwrap();
        let decoder = ::png::Decoder::new(io::BufReader::new(fs::File::open(path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut grey = vec![0; 6];
        reader.next_frame(&mut grey).unwrap();
        // Linear 0.1, 0.25 and 0.5 are stored as 0.3492, 0.5371 and 0.7354.
        assert_eq!(grey, [0, 89, 137, 188, 255, 255]);
    }

    #[test]
    fn other_endings_are_refused() {
        for name in ["p.jpg", "p"] {
            let error = write_picture(name, &picture(), 1.0, "").unwrap_err();
            assert!(error.to_string().contains(".exr and .png"), "{error}");
        }
    }
}
