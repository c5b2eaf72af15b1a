//! Files of a picture: EXR, PNG with a scale, and the figure of its errors.

use asperity_io::{
    Picture, PictureFormat, Pixels, check_ending, write_bytes, write_picture_exr, write_picture_png,
};
use asperity_plot::{BrightnessScale, CellMapFigure, PlotError};
use asperity_render::{LOG_DECADES, Tone, ToneCurve};
use asperity_simulate::short;

use super::config::PictureConfig;
use crate::error::StudyError;
use crate::given::GivenError;

/// Endings of images of errors.
const ERROR_IMAGES: [&str; 2] = ["png", "svg"];

/// Unit of radiance.
const UNIT: &str = "in the unit in which the lights were given";

/// Least radiance that errors are related to, over the mean: errors of black pixels have no meaning in proportion.
const DARKEST: f64 = 0.01;

/// Writes all files of a picture of the surface `name`.
pub(super) fn write(
    config: &PictureConfig,
    picture: &Picture,
    relative_errors: &[f64],
    tone: &ToneCurve,
    name: &str,
) -> Result<(), StudyError> {
    let denoised = match config.denoise {
        true => "; denoised by non-local means",
        false => "",
    };
    for path in config.output.as_slice() {
        match PictureFormat::from_path(path).map_err(GivenError::from)? {
            PictureFormat::Exr => {
                let comment = format!("{}{denoised}", channels(picture, config.denoise));
                write_picture_exr(path, picture, &comment)
            }
            PictureFormat::Png => {
                let mut pixels = tone.pixels(picture);
                if config.scale_bar {
                    append_scale(&mut pixels, shown_quantity(picture), tone)?;
                }
                write_picture_png(
                    path,
                    &pixels,
                    &format!("{}{denoised}", brightness(picture, tone)),
                )
            }
        }
        .map_err(GivenError::from)?;
    }
    if let Some(path) = &config.error_image {
        let [columns, rows] = picture.size;
        let figure = CellMapFigure {
            title: format!("Standard error of the pixels of {name}"),
            subtitle: format!(
                "over the radiance of the pixel, or over {} % of the mean radiance if that is more",
                100.0 * DARKEST
            ),
            quantity: match config.denoise {
                true => "standard error / radiance, before denoising".to_owned(),
                false => "standard error / radiance".to_owned(),
            },
            values: relative_errors,
            shape: [rows, columns],
            spacing: [1.0; 2],
            unit: "pixels".to_owned(),
            y_up: false,
            noun: "pixels",
            decades: true,
        };
        let figure = figure.draw()?;
        let bytes = match check_ending(path, "error images", &ERROR_IMAGES) {
            Ok("svg") => figure.svg()?.into_bytes(),
            Ok(_) => figure.png()?,
            Err(error) => return Err(GivenError::from(error).into()),
        };
        write_bytes(path, &bytes).map_err(GivenError::from)?;
    }
    Ok(())
}

/// The channels of an EXR.
fn channels(picture: &Picture, is_denoised: bool) -> String {
    let radiance = match picture.colour {
        Some(_) => "R, G, B: linear sRGB, lights having the spectrum of D65; Y: its luminance",
        None => "Y: radiance",
    };
    let error = match is_denoised {
        true => " before denoising",
        false => "",
    };
    format!(
        "{radiance}, linear, {UNIT}; error: standard error of Y{error}; A: fraction of the pixel that shows the surface"
    )
}

/// Meaning of the brightness of a PNG.
fn brightness(picture: &Picture, curve: &ToneCurve) -> String {
    let quantity = shown_quantity(picture);
    let shape = match curve.tone {
        Tone::Reinhard => {
            "x (1 + x/w^2) / (1 + x), w = exposure times the radiance of white".to_owned()
        }
        Tone::Linear => "x, clipped at 1".to_owned(),
        Tone::Log => format!("stored grey 1 + log10(x) / {LOG_DECADES}, clipped to 0 to 1"),
    };
    format!(
        "brightness: sRGB of the tone {}: {shape}, x = exposure times {quantity}; exposure {}; white: {}; radiance, {UNIT}",
        tone_name(curve.tone),
        short(curve.exposure),
        short(curve.white)
    )
}

/// The quantity that the tone curve takes.
pub(super) const fn shown_quantity(picture: &Picture) -> &'static str {
    match picture.colour {
        Some(_) => "the largest of R, G and B",
        None => "radiance",
    }
}

pub(super) const fn tone_name(tone: Tone) -> &'static str {
    match tone {
        Tone::Reinhard => "reinhard",
        Tone::Linear => "linear",
        Tone::Log => "log",
    }
}

/// Appends a scale of the brightness below the pixels.
fn append_scale(pixels: &mut Pixels, title: &str, tone: &ToneCurve) -> Result<(), PlotError> {
    let scale = BrightnessScale {
        title,
        width: u32::try_from(pixels.size[0]).unwrap_or(u32::MAX),
        range: [tone.black(), tone.white],
        place: &|radiance| tone.stored(radiance),
    };
    let figure = scale.draw()?;
    let rgb = figure.rgb()?;
    pixels.size[1] += figure.size().1 as usize;
    match pixels.is_rgb {
        true => pixels.bytes.extend(rgb),
        // The scale is drawn in grey.
        false => pixels.bytes.extend(rgb.iter().step_by(3)),
    }
    Ok(())
}

/// Standard errors over the radiance of each pixel, or over [`DARKEST`] of the mean where that is more; zero for a picture without light.
pub(super) fn relative_errors(picture: &Picture) -> Vec<f64> {
    let mean = picture.radiance.iter().sum::<f64>() / picture.radiance.len() as f64;
    let pixels = picture.error.iter().zip(&picture.radiance);
    pixels
        .map(|(error, radiance)| match radiance.max(DARKEST * mean) {
            base if base > 0.0 => error / base,
            _ => 0.0,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_the_radiance_or_to_part_of_the_mean() {
        let mut picture = Picture {
            size: [4, 1],
            radiance: vec![0.0, 0.5, 1.5, 2.0],
            error: vec![0.001, 0.1, 0.0, 0.5],
            coverage: vec![1.0; 4],
            colour: None,
        };
        let expected = [0.1, 0.2, 0.0, 0.25];
        for (found, expected) in relative_errors(&picture).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        picture.radiance.fill(0.0);
        assert_eq!(relative_errors(&picture), [0.0; 4]);
    }

    #[test]
    fn the_picture_above_its_scale_stays_as_it_is() {
        let curve = ToneCurve {
            tone: Tone::Linear,
            exposure: 1.0,
            white: 1.0,
        };
        for is_rgb in [false, true] {
            let bytes = vec![7; if is_rgb { 600 } else { 200 }];
            let mut pixels = Pixels {
                size: [200, 1],
                is_rgb,
                bytes: bytes.clone(),
            };
            append_scale(&mut pixels, "radiance", &curve).unwrap();
            assert!(pixels.size[1] > 40 && pixels.bytes.starts_with(&bytes));
            assert_eq!(pixels.bytes.len(), bytes.len() * pixels.size[1]);
        }
    }
}
