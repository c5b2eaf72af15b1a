//! Rendering of a laid-out figure.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, RGBColor, ShapeStyle, TextStyle};

use crate::PlotError;
use crate::elements::scene::{Align, Item, Picture, Scene, Xy};
use crate::elements::text::{self, LINE_HEIGHT_PER_EM};
use crate::elements::theme;

/// A figure, laid out and ready to be rendered. Equal figures render to equal bytes.
#[derive(Debug, Clone)]
pub struct Figure {
    scene: Scene,
}

impl Figure {
    pub(crate) fn new(scene: Scene) -> Self {
        Figure { scene }
    }

    /// Width and height in SVG pixels. A PNG has twice as many pixels each way.
    pub fn size(&self) -> (u32, u32) {
        (self.scene.width, self.scene.height)
    }

    /// The figure as an SVG document. Texts stay texts.
    ///
    /// # Errors
    /// [`PlotError::Backend`] if the drawing library fails.
    pub fn svg(&self) -> Result<String, PlotError> {
        let Scene { width, height, .. } = self.scene;
        let units = theme::SVG_UNITS_PER_POINT;
        let mut document = String::new();
        {
            let mut backend =
                SVGBackend::with_string(&mut document, (width * units, height * units));
            replay(&self.scene.items, &mut backend, SVG_FONT, f64::from(units))?;
            backend.present().map_err(backend_error)?;
        }
        // The library knows neither fractions of a pixel nor embedded pictures: its opening tag, the first
        // line, gives way to one with a view box in finer units, and the pictures go beneath its shapes.
        let body = document.split_once('\n').map_or("", |(_, body)| body);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {} {}\" role=\"img\" stroke-linejoin=\"round\">\n<title>{}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
            width * units,
            height * units,
            escape(&self.scene.title),
        );
        for picture in &self.scene.pictures {
            svg.push_str(&svg_image(picture, f64::from(units))?);
        }
        svg.push_str(body);
        Ok(svg)
    }

    /// The figure as a PNG file, 8-bit RGB at two pixels a point.
    ///
    /// # Errors
    /// [`PlotError::Backend`] if the drawing library or the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        let scale = theme::PNG_PIXELS_PER_POINT * theme::PNG_OVERSAMPLING;
        let (width, height) = (self.scene.width * scale, self.scene.height * scale);
        let mut pixels = vec![255u8; width as usize * height as usize * 3];
        for picture in &self.scene.pictures {
            paint(picture, &mut pixels, width as usize, f64::from(scale));
        }
        {
            let mut backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
            replay(
                &self.scene.items,
                &mut backend,
                BITMAP_FONT,
                f64::from(scale),
            )?;
            backend.present().map_err(backend_error)?;
        }
        let averaged = average_blocks(
            &pixels,
            width as usize * 3,
            theme::PNG_OVERSAMPLING as usize,
        );
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(
            &mut file,
            self.scene.width * theme::PNG_PIXELS_PER_POINT,
            self.scene.height * theme::PNG_PIXELS_PER_POINT,
        );
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        // A point is 1/96 inch, as in CSS.
        let pixels_per_metre = 96.0 * f64::from(theme::PNG_PIXELS_PER_POINT) / 0.0254;
        encoder.set_pixel_dims(Some(png::PixelDimensions {
            xppu: pixels_per_metre.round() as u32,
            yppu: pixels_per_metre.round() as u32,
            unit: png::Unit::Meter,
        }));
        write_png(encoder, &averaged)?;
        Ok(file)
    }
}

/// How a renderer of the library places text anchored at its top.
#[derive(Clone, Copy)]
struct FontMetrics {
    /// Font size as the library counts it, over the em.
    size_per_em: f64,
    /// Depth of the baseline below the anchor, over the em.
    baseline_per_em: f64,
}

/// The SVG writer divides sizes by 1.24 and lowers text by 0.76 em.
const SVG_FONT: FontMetrics = FontMetrics {
    size_per_em: 1.24,
    baseline_per_em: 0.76,
};

/// The rasteriser takes the line height for the size and puts the baseline at half of it.
const BITMAP_FONT: FontMetrics = FontMetrics {
    size_per_em: LINE_HEIGHT_PER_EM,
    baseline_per_em: 0.5 * LINE_HEIGHT_PER_EM,
};

fn replay<B: DrawingBackend>(
    items: &[Item],
    backend: &mut B,
    metrics: FontMetrics,
    scale: f64,
) -> Result<(), PlotError> {
    text::ensure_font()?;
    // Saturates far outside the figure, where the library's integer arithmetic is still safe.
    let whole = |v: f64| (v * scale).round().clamp(-1e5, 1e5) as i32;
    let pixel = |p: Xy| (whole(p.0), whole(p.1));
    for item in items {
        match item {
            Item::Line {
                path,
                colour,
                width,
            } => {
                let style = ShapeStyle {
                    color: colour.to_rgba(),
                    filled: false,
                    stroke_width: (width * scale).round().max(1.0) as u32,
                };
                let mut path: Vec<_> = path.iter().copied().map(pixel).collect();
                path.dedup();
                if path.len() > 1 {
                    backend.draw_path(path, &style).map_err(backend_error)?;
                }
            }
            Item::Polygon { corners, colour } => {
                let style = ShapeStyle::from(*colour).filled();
                backend
                    .fill_polygon(corners.iter().copied().map(pixel), &style)
                    .map_err(backend_error)?;
            }
            Item::Disc {
                centre,
                radius,
                colour,
            } => {
                let style = ShapeStyle::from(*colour).filled();
                let radius = (radius * scale).round().max(1.0) as u32;
                backend
                    .draw_circle(pixel(*centre), radius, &style, true)
                    .map_err(backend_error)?;
            }
            Item::Text {
                text,
                anchor,
                align,
                size,
                colour,
                upwards,
            } => {
                let h_pos = match align {
                    Align::Left => HPos::Left,
                    Align::Centre => HPos::Center,
                    Align::Right => HPos::Right,
                };
                let drop = metrics.baseline_per_em * size;
                let (top, transform) = if *upwards {
                    ((anchor.0 - drop, anchor.1), FontTransform::Rotate270)
                } else {
                    ((anchor.0, anchor.1 - drop), FontTransform::None)
                };
                let style = TextStyle::from(text::font(size * metrics.size_per_em * scale))
                    .color(colour)
                    .transform(transform)
                    .pos(Pos::new(h_pos, VPos::Top));
                backend
                    .draw_text(text, &style, pixel(top))
                    .map_err(backend_error)?;
            }
        }
    }
    Ok(())
}

/// Stretches a picture into an RGB buffer, `width` pixels to a row; each pixel takes the colour below its centre.
fn paint(picture: &Picture, buffer: &mut [u8], width: usize, scale: f64) {
    let rows = picture.pixels.len() / picture.columns.max(1);
    let Picture { frame, columns, .. } = picture;
    let span = |from: f64, to: f64| (from * scale).round() as usize..(to * scale).round() as usize;
    let cell = |pixel: usize, from: f64, length: f64, cells: usize| {
        let t = ((pixel as f64 + 0.5) / scale - from) / length;
        ((t * cells as f64) as usize).min(cells.saturating_sub(1))
    };
    for y in span(frame.top, frame.bottom) {
        let row = cell(y, frame.top, frame.height(), rows);
        for x in span(frame.left, frame.right) {
            let column = cell(x, frame.left, frame.width(), *columns);
            let index = picture.pixels[row * columns + column];
            let RGBColor(r, g, b) = picture.palette[usize::from(index)];
            if let Some(pixel) = buffer.get_mut(3 * (y * width + x)..3 * (y * width + x) + 3) {
                pixel.copy_from_slice(&[r, g, b]);
            }
        }
    }
}

/// Averages blocks of `n` by `n` pixels of an RGB buffer with `stride` bytes to a row.
fn average_blocks(pixels: &[u8], stride: usize, n: usize) -> Vec<u8> {
    let count = (n * n) as u32;
    pixels
        .chunks_exact(stride * n)
        .flat_map(|rows| {
            (0..stride / n).map(move |i| {
                let (column, channel) = (i / 3, i % 3);
                let sum: u32 = (0..n * n)
                    .map(|k| u32::from(rows[(k / n) * stride + (column * n + k % n) * 3 + channel]))
                    .sum();
                ((sum + count / 2) / count) as u8
            })
        })
        .collect()
}

fn write_png(encoder: png::Encoder<'_, &mut Vec<u8>>, data: &[u8]) -> Result<(), PlotError> {
    let failed = |e: png::EncodingError| PlotError::Backend(e.to_string());
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(data).map_err(failed)?;
    writer.finish().map_err(failed)
}

/// A picture as an SVG element that carries its own PNG.
fn svg_image(picture: &Picture, scale: f64) -> Result<String, PlotError> {
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
    write_png(encoder, &picture.pixels)?;
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

fn backend_error(error: impl std::fmt::Display) -> PlotError {
    PlotError::Backend(error.to_string())
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

    #[test]
    fn averaging_keeps_the_mean_of_each_channel() {
        // Two by two pixels of one block: red 0..=3, green constant, blue alternating.
        let pixels = [0, 9, 0, 1, 9, 8, 2, 9, 0, 3, 9, 8];
        assert_eq!(average_blocks(&pixels, 6, 2), vec![2, 9, 4]);
    }
}
