//! PNG files, drawn larger than asked and averaged, which smooths every edge alike.

use std::sync::{Mutex, MutexGuard, PoisonError};

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
    let mut pixels = std::mem::take(&mut *canvas());
    pixels.clear();
    pixels.resize(width as usize * height as usize * 3, 255);
    for picture in &scene.pictures {
        paint(picture, &mut pixels, width as usize, f64::from(scale));
    }
    Replay {
        backend: BitMapBackend::with_buffer(&mut pixels, (width, height)),
        scale: f64::from(scale),
    }
    .all(&scene.items)?;
    const BLOCK: usize = theme::PNG_OVERSAMPLING as usize;
    let averaged = average_blocks::<BLOCK>(&pixels, width as usize * 3);
    *canvas() = pixels;
    Ok(averaged)
}

/// Memory of the last canvas, for the next one: new pages of it cost as much time as drawing.
fn canvas() -> MutexGuard<'static, Vec<u8>> {
    static CANVAS: Mutex<Vec<u8>> = Mutex::new(Vec::new());
    CANVAS.lock().unwrap_or_else(PoisonError::into_inner)
}

fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PlotError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Files as large as those of the default, in a third of its time.
    encoder.set_filter(png::Filter::Up);
    encoder.set_deflate_compression(png::DeflateCompression::Level(3));
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
    let across = span(frame.left, frame.right);
    let cells: Vec<usize> = (across.start..across.end.min(width))
        .map(|x| cell(x, frame.left, frame.width(), *columns))
        .collect();
    let mut line: Vec<u8> = Vec::new();
    let mut drawn = None;
    for y in span(frame.top, frame.bottom) {
        let row = cell(y, frame.top, frame.height(), rows);
        if drawn != Some(row) {
            let colour = |column: &usize| {
                let index = picture.pixels[row * columns + column];
                let RGBColor(r, g, b) = picture.palette[usize::from(index)];
                [r, g, b]
            };
            line.clear();
            line.extend(cells.iter().flat_map(colour));
            drawn = Some(row);
        }
        let at = 3 * (y * width + across.start);
        if let Some(pixels) = buffer.get_mut(at..at + line.len()) {
            pixels.copy_from_slice(&line);
        }
    }
}

/// Pixels of the result that are averaged, or found blank, together.
const TOGETHER: usize = 16;

/// Averages blocks of `N` by `N` pixels of an RGB buffer with `stride` bytes to a row.
fn average_blocks<const N: usize>(pixels: &[u8], stride: usize) -> Vec<u8> {
    // Sums of a block fit into 16 bits
    const { assert!(N <= 16) };
    let count = (N * N) as u16;
    let mut averaged = vec![255; pixels.len() / (N * N)];
    let mut sums = [0_u16; 3 * TOGETHER * 16];
    let blocks = averaged.chunks_exact_mut(stride / N);
    for (averaged, rows) in blocks.zip(pixels.chunks_exact(stride * N)) {
        for (i, averaged) in averaged.chunks_mut(3 * TOGETHER).enumerate() {
            let start = i * 3 * TOGETHER * N;
            let sums = &mut sums[..averaged.len() * N];
            let rows = rows.chunks_exact(stride).map(|row| &row[start..]);
            // Most of a page is blank
            let is_blank = |row: &[u8]| row[..sums.len()].iter().fold(255, |all, v| all & v) == 255;
            if rows.clone().all(is_blank) {
                continue;
            }
            sums.fill(0);
            // Each shift by a pixel adds the next column of a block at its first one.
            for row in rows {
                for column in 0..N {
                    for (sum, value) in sums.iter_mut().zip(&row[3 * column..]) {
                        *sum += u16::from(*value);
                    }
                }
            }
            for (pixel, sums) in averaged.chunks_exact_mut(3).zip(sums.chunks_exact(3 * N)) {
                for (mean, sum) in pixel.iter_mut().zip(sums) {
                    *mean = ((sum + count / 2) / count) as u8;
                }
            }
        }
    }
    averaged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::geometry::Rect;
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

    /// Blocks one by one, channel by channel.
    fn plain_average(pixels: &[u8], stride: usize, n: usize) -> Vec<u8> {
        let rows = pixels.len() / stride;
        let at = |row: usize, byte: usize| u32::from(pixels[row * stride + byte]);
        let mean = |row: usize, column: usize, channel: usize| {
            let of_row =
                |y: usize| (0..n).map(move |x| at(n * row + y, 3 * (n * column + x) + channel));
            let sum: u32 = (0..n).flat_map(of_row).sum();
            let count = (n * n) as u32;
            ((sum + count / 2) / count) as u8
        };
        let columns = stride / 3 / n;
        (0..rows / n * columns * 3)
            .map(|i| mean(i / 3 / columns, i / 3 % columns, i % 3))
            .collect()
    }

    #[test]
    fn averages_are_those_of_blocks_one_by_one() {
        // Six rows of twelve pixels.
        let pixels: Vec<u8> = (0..216_u32).map(|i| (i * i * 37 / 11) as u8).collect();
        assert_eq!(
            average_blocks::<2>(&pixels, 36),
            plain_average(&pixels, 36, 2)
        );
        assert_eq!(
            average_blocks::<3>(&pixels, 36),
            plain_average(&pixels, 36, 3)
        );
        // Two by two pixels of one block: red 0..=3, green constant, blue alternating.
        let pixels = [0, 9, 0, 1, 9, 8, 2, 9, 0, 3, 9, 8];
        assert_eq!(average_blocks::<2>(&pixels, 6), vec![2, 9, 4]);
    }

    /// Cells of 2.5 by 1.5 pixels, whose last columns lie beyond the buffer.
    #[test]
    fn pixels_take_the_colour_below_their_centres() {
        let picture = Picture {
            frame: Rect::at((1.0, 2.0), 5.0, 1.5),
            columns: 4,
            pixels: (0..8).collect(),
            palette: (0..8).map(|i| RGBColor(i, 10 * i, 20 + i)).collect(),
        };
        let mut buffer = vec![255; 3 * 10 * 8];
        paint(&picture, &mut buffer, 10, 2.0);
        for (i, pixel) in buffer.chunks_exact(3).enumerate() {
            let (x, y) = (i % 10, i / 10);
            let cell = |at: usize, cells: f64, length: f64| (at as f64 + 0.5) * cells / length;
            let expected = match (x.checked_sub(2), y.checked_sub(4)) {
                (Some(x), Some(y)) if x < 10 && y < 3 => {
                    let index = 4 * cell(y, 2.0, 3.0) as u8 + cell(x, 4.0, 10.0) as u8;
                    [index, 10 * index, 20 + index]
                }
                _ => [255; 3],
            };
            assert_eq!(pixel, expected, "{x} {y}");
        }
    }
}
