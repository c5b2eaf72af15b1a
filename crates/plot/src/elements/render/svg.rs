//! SVG documents. Pictures become embedded PNG files.

use plotters::backend::SVGBackend;

use super::replay::{Joins, Replay, backend_error};
use crate::PlotError;
use crate::elements::scene::{Picture, Scene};
use crate::elements::theme;

/// The scene as an SVG document.
pub(super) fn render(scene: &Scene) -> Result<String, PlotError> {
    let Scene { width, height, .. } = scene;
    let units = theme::SVG_UNITS_PER_POINT;
    let mut document = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut document, (width * units, height * units));
        // The SVG writer divides sizes by 1.24 and lowers text by 0.76 em.
        Replay {
            backend: &mut backend,
            scale: f64::from(units),
            size_per_em: 1.24,
            baseline_per_em: 0.76,
            joins: Joins::Viewer,
        }
        .all(&scene.items)?;
    }
    // The library knows neither fractions of a pixel nor embedded pictures: its opening tag, the first line, gives
    // way to one with a view box in finer units, and the pictures go beneath its shapes.
    let body = document.split_once('\n').map_or("", |(_, body)| body);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {} {}\" role=\"img\" stroke-linejoin=\"round\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
        width * units,
        height * units,
        escape(&scene.title),
    );
    for picture in &scene.pictures {
        svg.push_str(&image(picture, f64::from(units))?);
    }
    svg.push_str(body);
    Ok(svg)
}

/// A picture as an SVG element that carries its own PNG.
fn image(picture: &Picture, scale: f64) -> Result<String, PlotError> {
    let rows = picture.pixels.len() / picture.columns.max(1);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.columns as u32, rows as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    let palette: Vec<u8> = picture
        .palette
        .iter()
        .flat_map(|c| [c.0, c.1, c.2])
        .collect();
    encoder.set_palette(palette);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&picture.pixels))
        .map_err(backend_error)?;
    let frame = picture.frame;
    Ok(format!(
        "<image x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" preserveAspectRatio=\"none\" \
         image-rendering=\"pixelated\" href=\"data:image/png;base64,{}\"/>\n",
        frame.left * scale,
        frame.top * scale,
        frame.width() * scale,
        frame.height() * scale,
        base64(&file),
    ))
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            // One byte gives two digits, two give three: the rest is padding.
            if i <= chunk.len() {
                text.push(char::from(DIGITS[(bits >> (18 - 6 * i)) as usize & 63]));
            } else {
                text.push('=');
            }
        }
    }
    text
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_pads_as_rfc_4648_says() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
