//! PNG files, drawn larger than asked and averaged, which smooths every edge alike.

use plotters::backend::BitMapBackend;
use plotters::style::RGBColor;

use super::replay::{Replay, backend_error};
use crate::PlotError;
use crate::elements::scene::{Picture, Scene};
use crate::elements::theme;

/// The scene as a PNG file.
pub(super) fn render(scene: &Scene) -> Result<Vec<u8>, PlotError> {
    let per_point = theme::PNG_PIXELS_PER_POINT;
    let pixels = rgb(scene, per_point)?;
    encode(&pixels, scene.width * per_point, scene.height * per_point)
}

/// The pixels of the scene, red, green and blue, row by row.
pub(super) fn rgb(scene: &Scene, pixels_per_point: u32) -> Result<Vec<u8>, PlotError> {
    let scale = pixels_per_point * theme::PNG_OVERSAMPLING;
    let (width, height) = (scene.width * scale, scene.height * scale);
    let mut pixels = vec![255u8; width as usize * height as usize * 3];
    for picture in &scene.pictures {
        paint(picture, &mut pixels, width as usize, f64::from(scale));
    }
    Replay {
        backend: BitMapBackend::with_buffer(&mut pixels, (width, height)),
        scale: f64::from(scale),
    }
    .all(&scene.items)?;
    let block = theme::PNG_OVERSAMPLING as usize;
    Ok(average_blocks(&pixels, width as usize * 3, block))
}

fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PlotError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // A point is 1/96 inch, as in CSS.
    let per_metre = (96.0 * f64::from(theme::PNG_PIXELS_PER_POINT) / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header().map_err(backend_error)?;
    writer.write_image_data(pixels).map_err(backend_error)?;
    writer.finish().map_err(backend_error)?;
    Ok(file)
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
    let mut averaged = Vec::with_capacity(pixels.len() / (n * n));
    let mut sums = vec![0_u32; stride / n];
    for rows in pixels.chunks_exact(stride * n) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, block) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * n)) {
                for pixel in block.chunks_exact(3) {
                    for (sum, channel) in sum.iter_mut().zip(pixel) {
                        *sum += u32::from(*channel);
                    }
                }
            }
        }
        averaged.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    averaged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::scene::Pen;

    /// Two segments that double back, a few degrees apart: no pixel may be inked beyond half the width of the line about its vertices.
    #[test]
    fn sharp_corners_have_no_spikes() {
        let mut scene = Scene::new("");
        (scene.width, scene.height) = (200, 200);
        let pen = Pen::solid(theme::INK, 2.0);
        for i in 0..40 {
            let x = 100.0 + 0.5 * f64::from(i) - 10.0;
            scene.line(&[(100.0, 150.0), (x, 50.0), (101.0, 150.0)], pen);
        }
        let file = super::render(&scene).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let inked = |rows: &[u8]| rows.iter().any(|value| *value < 255);
        let row = |y: usize| y * 400 * 3;
        assert!(inked(&pixels[row(110)..row(290)]));
        assert!(!inked(&pixels[..row(97)]) && !inked(&pixels[row(303)..]));
    }

    #[test]
    fn averaging_keeps_the_mean_of_each_channel() {
        // Two by two pixels of one block: red 0..=3, green constant, blue alternating.
        let pixels = [0, 9, 0, 1, 9, 8, 2, 9, 0, 3, 9, 8];
        assert_eq!(average_blocks(&pixels, 6, 2), vec![2, 9, 4]);
    }
}
