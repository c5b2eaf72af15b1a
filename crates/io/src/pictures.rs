//! Pictures: radiance by pixel as OpenEXR, and pixels for viewing as PNG.
//!
//! EXR: the channels `Y`, radiance, `error`, its standard error, and `A`, the fraction of the pixel in
//! which the camera sees the surface, and `R`, `G` and `B`, linear sRGB, of pictures in colour; single precision, ZIP
//! compression, lossless. Radiance is linear, and relative to a unit that the text attribute `comments` names. PNG:
//! greyscale or RGB of 8 bits, stored by the curve of sRGB; the text chunk `Comment` says what they mean. Row 0 is on top in both.

use std::io::{self, Write};
use std::path::Path;

use ::exr::compression::Compression;
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
    /// Radiance, linear; of a picture in colour its Y, the luminance.
    pub radiance: Vec<f64>,
    /// Its standard error; NaN where it is unknown.
    pub error: Vec<f64>,
    /// Fraction of the pixel in which the camera sees the surface, `[0, 1]`.
    pub coverage: Vec<f64>,
    /// Linear sRGB in the unit of `radiance`, of a picture in colour; a channel is negative where a colour is outside of sRGB.
    pub colour: Option<Vec<[f64; 3]>>,
}

/// Pixels of 8 bits for viewing, row by row from the top, stored by the curve of sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Columns and rows.
    pub size: [usize; 2],
    /// `true` for three bytes per pixel, red, green and blue; `false` for one, grey.
    pub is_rgb: bool,
    /// The bytes.
    pub bytes: Vec<u8>,
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

/// Writes a picture as OpenEXR, as [`crate::write_atomically`] does; `comment`: what the values are.
///
/// # Errors
/// [`WriteError`] if a value is beyond single precision, or the file cannot be written.
///
/// # Panics
/// If a vector does not have one value per pixel.
pub fn write_picture_exr(
    path: impl AsRef<Path>,
    picture: &Picture,
    comment: &str,
) -> Result<(), WriteError> {
    let pixels = picture.size[0] * picture.size[1];
    for values in [&picture.radiance, &picture.error, &picture.coverage] {
        assert_eq!(values.len(), pixels, "one value per pixel");
    }
    let colours = picture.colour.as_ref().map_or(pixels, Vec::len);
    assert_eq!(colours, pixels, "one colour per pixel");
    replace_alone(path.as_ref(), |out| write_exr(picture, comment, out))
}

/// Writes pixels as PNG, as [`crate::write_atomically`] does; `comment`: what their brightness means, in ASCII.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_picture_png(
    path: impl AsRef<Path>,
    pixels: &Pixels,
    comment: &str,
) -> Result<(), WriteError> {
    replace_alone(path.as_ref(), |out| Ok(write_png(pixels, comment, out)?))
}

fn write_exr(picture: &Picture, comment: &str, out: &mut dyn Write) -> Result<(), WriteProblem> {
    let channel = |name: &'static str, values: &[f64]| {
        let samples = values.iter().map(|value| single(name, *value));
        Ok::<_, WriteProblem>((name, samples.collect::<Result<Vec<f32>, _>>()?))
    };
    let mut channels = vec![
        channel("A", &picture.coverage)?,
        channel("Y", &picture.radiance)?,
        errors(&picture.error)?,
    ];
    if let Some(colour) = &picture.colour {
        for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
            let values: Vec<f64> = colour.iter().map(|rgb| rgb[i]).collect();
            channels.push(channel(name, &values)?);
        }
    }
    let attributes = LayerAttributes {
        comments: Some(Text::from_slice_unchecked(comment.as_bytes())),
        ..LayerAttributes::default()
    };
    let file = encode_exr(picture.size, Compression::ZIP16, attributes, channels);
    Ok(out.write_all(&file?)?)
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

fn write_png(pixels: &Pixels, comment: &str, out: &mut dyn Write) -> io::Result<()> {
    // The format counts with 31 bits.
    let [width, height] = pixels.size.map(|n| {
        let n = i32::try_from(n).map_err(|_| io::Error::other("too many columns or rows"))?;
        Ok::<_, io::Error>(n.cast_unsigned())
    });
    let mut encoder = ::png::Encoder::new(out, width?, height?);
    encoder.set_color(match pixels.is_rgb {
        true => ::png::ColorType::Rgb,
        false => ::png::ColorType::Grayscale,
    });
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::High);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let text = encoder.add_text_chunk("Comment".to_owned(), comment.to_owned());
    text.map_err(png_error)?;
    let mut writer = encoder.write_header().map_err(png_error)?;
    writer.write_image_data(&pixels.bytes).map_err(png_error)?;
    writer.finish().map_err(png_error)
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
            colour: None,
        }
    }

    fn channels(path: &Path) -> Vec<String> {
        let image = ::exr::prelude::read_all_flat_layers_from_file(path).unwrap();
        let channels = &image.layer_data[0].channel_data.list;
        channels.iter().map(|one| one.name.to_string()).collect()
    }

    #[test]
    fn exr_holds_radiance_row_by_row_from_the_top() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.exr");
        write_picture_exr(&path, &picture(), "unit").unwrap();
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
        assert_eq!(channels(&path), ["A", "Y", "error"]);
        let mut coloured = picture();
        coloured.colour = Some(vec![[0.1, 0.2, -0.3]; 6]);
        write_picture_exr(&path, &coloured, "unit").unwrap();
        assert_eq!(channels(&path), ["A", "B", "G", "R", "Y", "error"]);
    }

    #[test]
    fn unknown_errors_are_written_and_unknown_radiance_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.exr");
        let mut unknown = picture();
        unknown.error = vec![f64::NAN; 6];
        write_picture_exr(&path, &unknown, "unit").unwrap();
        unknown.radiance[0] = f64::NAN;
        let error = write_picture_exr(&path, &unknown, "unit").unwrap_err();
        assert!(
            matches!(error.problem, WriteProblem::OutOfRange { .. }),
            "{error}"
        );
    }

    #[test]
    fn equal_pictures_give_equal_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = ["a", "b"].map(|name| {
            let path = folder.path().join(name);
            write_picture_exr(&path, &picture(), "unit").unwrap();
            fs::read(path).unwrap()
        });
        assert!(bytes[0] == bytes[1]);
    }

    #[test]
    fn png_holds_pixels_and_says_what_they_mean() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.png");
        for is_rgb in [false, true] {
            let bytes: Vec<u8> = (0..if is_rgb { 18 } else { 6 }).map(|i| 9 * i).collect();
            let pixels = Pixels {
                size: [3, 2],
                is_rgb,
                bytes: bytes.clone(),
            };
            write_picture_png(&path, &pixels, "white: 2").unwrap();
            let file = io::BufReader::new(fs::File::open(&path).unwrap());
            let mut reader = ::png::Decoder::new(file).read_info().unwrap();
            let mut found = vec![0; bytes.len()];
            reader.next_frame(&mut found).unwrap();
            assert_eq!(found, bytes);
            let texts = &reader.info().uncompressed_latin1_text;
            assert_eq!(
                (texts[0].keyword.as_str(), texts[0].text.as_str()),
                ("Comment", "white: 2")
            );
        }
    }

    #[test]
    fn other_endings_are_refused() {
        for name in ["p.jpg", "p"] {
            let error = PictureFormat::from_path(Path::new(name)).unwrap_err();
            assert!(error.to_string().contains(".exr and .png"), "{error}");
        }
    }
}
