//! Rasteriser: draws a scene with smooth edges, in bands of rows that stay in the cache.

use std::mem::discriminant;

use tiny_skia::{FillRule, LineJoin, Paint, Path, PathBuilder, PixmapMut, Stroke, Transform};
use ttf_parser::OutlineBuilder;

use crate::PlotError;
use crate::elements::geometry::Xy;
use crate::elements::rgb::Rgb;
use crate::elements::scene::{Align, Item, Picture, Scene, TextItem};
use crate::elements::text::{TextLine, UNITS_PER_EM, font};

/// Rows of pixels that are drawn together.
const BAND: usize = 128;
/// Width in pixels up to which lines along the axes cover whole pixels. Curves are wider, whose parts are to be of one width.
const MAX_CRISP: f64 = 3.0;

/// Draws a scene and hands out its pixels band by band from the top: red, green and blue, row by row.
pub(super) fn draw(
    scene: &Scene,
    pixels_per_point: u32,
    mut take: impl FnMut(&[u8]) -> Result<(), PlotError>,
) -> Result<(), PlotError> {
    let [width, height] =
        [scene.width, scene.height].map(|length| (length * pixels_per_point) as usize);
    let scale = f64::from(pixels_per_point);
    let areas = areas(&scene.items, scale)?;
    let mut canvas = vec![0; 4 * width * BAND];
    let mut rgb = vec![0; 3 * width * BAND];
    for top in (0..height).step_by(BAND) {
        let bottom = height.min(top + BAND);
        let canvas = &mut canvas[..4 * width * (bottom - top)];
        canvas.fill(255);
        for picture in &scene.pictures {
            paint(picture, canvas, width, top, scale);
        }
        let mut pixmap = PixmapMut::from_bytes(canvas, width as u32, (bottom - top) as u32)
            .ok_or_else(|| PlotError::backend("a figure without pixels"))?;
        let to_band = Transform::from_translate(0.0, -(top as f32));
        for Area { path, paint } in &areas {
            let bounds = path.bounds();
            if bounds.top() < bottom as f32 && bounds.bottom() > top as f32 {
                pixmap.fill_path(path, paint, FillRule::Winding, to_band, None);
            }
        }
        let rgb = &mut rgb[..3 * width * (bottom - top)];
        for (rgb, rgba) in rgb.chunks_exact_mut(3).zip(canvas.chunks_exact(4)) {
            rgb.copy_from_slice(&rgba[..3]);
        }
        take(rgb)?;
    }
    Ok(())
}

/// An area of one colour, in pixels.
struct Area {
    path: Path,
    paint: Paint<'static>,
}

/// The areas that items cover. Consecutive items of one kind and colour are one area, which saves time; neighbouring polygons that are
/// filled one by one would show paper along their common edges.
fn areas(items: &[Item], scale: f64) -> Result<Vec<Area>, PlotError> {
    let kind = |item: &Item| (discriminant(item), item.colour());
    let mut areas = Vec::new();
    for items in items.chunk_by(|a, b| kind(a) == kind(b)) {
        let mut builder = PathBuilder::new();
        for item in items {
            if let Some(path) = outline(item, scale)? {
                builder.push_path(&path);
            }
        }
        if let Some((path, Rgb(r, g, b))) = builder.finish().zip(items[0].colour()) {
            let mut paint = Paint::default();
            paint.set_color_rgba8(r, g, b, 255);
            areas.push(Area { path, paint });
        }
    }
    Ok(areas)
}

/// Outline of what an item covers, to be filled; `None` if it covers nothing.
fn outline(item: &Item, scale: f64) -> Result<Option<Path>, PlotError> {
    Ok(match item {
        Item::Line { path, width, .. } => line(path, width * scale, scale),
        Item::Polygon { corners, .. } => {
            let mut pixels: Vec<_> = corners.iter().map(|at| pixel(*at, scale)).collect();
            // Rectangles cover whole pixels, unless nothing was left of them
            if corners.len() == 4 && is_along_axes(corners) {
                let rounded = pixels.iter().map(|(x, y)| (x.round(), y.round()));
                let rounded: Vec<_> = rounded.collect();
                if rounded[0].0 != rounded[2].0 && rounded[0].1 != rounded[2].1 {
                    pixels = rounded;
                }
            }
            let mut builder = polyline(pixels.into_iter());
            builder.close();
            builder.finish()
        }
        Item::Circle {
            centre,
            radius,
            width,
            ..
        } => {
            let (x, y) = pixel(*centre, scale);
            let disc = PathBuilder::from_circle(x, y, (radius * scale) as f32);
            match width {
                Some(width) => stroke(disc, width * scale),
                None => disc,
            }
        }
        Item::Text(item) => text(item, scale)?,
        Item::Tooltip { .. } => None,
    })
}

/// A place in pixels. Saturates far outside the figure.
fn pixel((x, y): Xy, scale: f64) -> (f32, f32) {
    let pixel = |v: f64| (v * scale).clamp(-1e5, 1e5) as f32;
    (pixel(x), pixel(y))
}

/// A path through pixels, from the first one on.
fn polyline(corners: impl Iterator<Item = (f32, f32)>) -> PathBuilder {
    let mut builder = PathBuilder::new();
    for (x, y) in corners {
        match builder.is_empty() {
            true => builder.move_to(x, y),
            false => builder.line_to(x, y),
        }
    }
    builder
}

/// Returns `true` if all edges from one corner to the next are level or upright.
fn is_along_axes(corners: &[Xy]) -> bool {
    let mut edges = corners.windows(2);
    edges.all(|ends| ends[0].0 == ends[1].0 || ends[0].1 == ends[1].1)
}

/// A line `width` pixels wide. Thin ones along the axes cover whole pixels, or they would blur.
fn line(corners: &[Xy], width: f64, scale: f64) -> Option<Path> {
    let is_crisp = width <= MAX_CRISP && is_along_axes(corners);
    let width = if is_crisp {
        width.round().max(1.0)
    } else {
        width
    };
    let half = 0.5 * width as f32;
    let crisp = |v: f32| (v - half).round() + half;
    let mut builder = polyline(corners.iter().map(|at| match pixel(*at, scale) {
        (x, y) if is_crisp => (crisp(x), crisp(y)),
        place => place,
    }));
    if corners.first() == corners.last() {
        builder.close();
    }
    stroke(builder.finish(), width)
}

/// Outline of a line along a path, `width` pixels wide.
fn stroke(path: Option<Path>, width: f64) -> Option<Path> {
    let stroke = Stroke {
        width: width as f32,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    path?.stroke(&stroke, 1.0)
}

/// Outlines of the glyphs of a text.
fn text(item: &TextItem, scale: f64) -> Result<Option<Path>, PlotError> {
    let (font, line) = (font()?, TextLine::new(&item.text)?);
    let before = match item.align {
        Align::Left => 0.0,
        Align::Centre => 0.5,
        Align::Right => 1.0,
    } * line.width as f32;
    let mut pen = GlyphPen {
        path: PathBuilder::new(),
        left: 0.0,
    };
    for (glyph, left) in line.glyphs {
        pen.left = left as f32 - before;
        font.outline_glyph(glyph, &mut pen);
    }
    let (x, y) = pixel(item.anchor, scale);
    let size = (item.size * scale / UNITS_PER_EM) as f32;
    // Font units have y up.
    let to_pixels = match item.upwards {
        false => Transform::from_row(size, 0.0, 0.0, -size, x, y),
        true => Transform::from_row(0.0, -size, -size, 0.0, x, y),
    };
    Ok(pen.path.finish().and_then(|path| path.transform(to_pixels)))
}

/// Adds outlines of glyphs to a path, in font units.
struct GlyphPen {
    path: PathBuilder,
    /// Left end of the glyph.
    left: f32,
}

impl OutlineBuilder for GlyphPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.left + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.left + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.left + x1, y1, self.left + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let left = self.left;
        self.path
            .cubic_to(left + x1, y1, left + x2, y2, left + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// Stretches a picture into rows of RGBA, `width` pixels each, that begin at row `top` of the figure. Each pixel takes the colour below its
/// centre.
fn paint(picture: &Picture, canvas: &mut [u8], width: usize, top: usize, scale: f64) {
    let rows = picture.pixels.len() / picture.columns.max(1);
    let Picture { frame, columns, .. } = picture;
    let span = |from: f64, to: f64, most: usize| {
        let [from, to] = [from, to].map(|end| ((end * scale).round() as usize).min(most));
        from..to
    };
    let cell = |pixel: usize, from: f64, length: f64, cells: usize| {
        let t = ((pixel as f64 + 0.5) / scale - from) / length;
        ((t * cells as f64) as usize).min(cells.saturating_sub(1))
    };
    let across = span(frame.left, frame.right, width);
    let cells: Vec<usize> = across
        .clone()
        .map(|x| cell(x, frame.left, frame.width(), *columns))
        .collect();
    let down = span(frame.top, frame.bottom, usize::MAX);
    for (i, row) in canvas.chunks_exact_mut(4 * width).enumerate() {
        if !down.contains(&(top + i)) {
            continue;
        }
        let first = columns * cell(top + i, frame.top, frame.height(), rows);
        let pixels = row[4 * across.start..4 * across.end].chunks_exact_mut(4);
        for (pixel, column) in pixels.zip(&cells) {
            let Rgb(r, g, b) = picture.palette[usize::from(picture.pixels[first + column])];
            pixel.copy_from_slice(&[r, g, b, 255]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::geometry::Rect;
    use crate::elements::scene::{Level, Pen, TextStyle};
    use crate::elements::text::text_width;
    use crate::elements::theme;

    const PAPER: [u8; 3] = [255; 3];

    fn scene(width: u32, height: u32) -> Scene {
        let mut scene = Scene::new("");
        (scene.width, scene.height) = (width, height);
        scene
    }

    /// Rows of pixels.
    fn rows(scene: &Scene, pixels_per_point: u32) -> Vec<Vec<[u8; 3]>> {
        let mut pixels = Vec::new();
        let take = |rgb: &[u8]| {
            pixels.extend(rgb.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]));
            Ok(())
        };
        draw(scene, pixels_per_point, take).unwrap();
        let width = (scene.width * pixels_per_point) as usize;
        pixels.chunks(width).map(<[_]>::to_vec).collect()
    }

    /// First and last column and row with ink, `[left, right, top, bottom]`.
    fn inked(scene: &Scene) -> [usize; 4] {
        let rows = rows(scene, 1);
        let places = rows.iter().enumerate().flat_map(|(y, row)| {
            let inked = row.iter().enumerate().filter(|(_, rgb)| **rgb != PAPER);
            inked.map(move |(x, _)| (x, y))
        });
        places.fold([usize::MAX, 0, usize::MAX, 0], |all, (x, y)| {
            [all[0].min(x), all[1].max(x), all[2].min(y), all[3].max(y)]
        })
    }

    #[test]
    fn paper_is_blank_and_areas_have_their_exact_colour() {
        let mut scene = scene(40, 300);
        scene.line(&[(9.0, 9.0), (9.0, 9.0)], Pen::solid(theme::INK, 4.0));
        assert!(rows(&scene, 1).iter().flatten().all(|rgb| *rgb == PAPER));
        scene.rect(Rect::at((10.0, 20.0), 5.0, 250.0), Rgb(1, 128, 254));
        for (y, row) in rows(&scene, 1).iter().enumerate() {
            for (x, rgb) in row.iter().enumerate() {
                let is_inside = (10..15).contains(&x) && (20..270).contains(&y);
                let expected = if is_inside { [1, 128, 254] } else { PAPER };
                assert_eq!(*rgb, expected, "{x} {y}");
            }
        }
    }

    /// Two segments that double back, a few degrees apart or thirty: no pixel may be inked beyond half the width of the line about its
    /// vertices.
    #[test]
    fn sharp_corners_have_no_spikes() {
        let mut scene = scene(200, 200);
        let pen = Pen::solid(theme::INK, 2.0);
        for i in 0..40 {
            let x = 100.0 + 0.5 * f64::from(i) - 10.0;
            scene.line(&[(100.0, 150.0), (x, 50.0), (101.0, 150.0)], pen);
        }
        scene.line(&[(20.0, 150.0), (46.8, 50.0), (73.6, 150.0)], pen);
        let [_, _, top, bottom] = inked(&scene);
        assert!((49..=50).contains(&top) && (149..=151).contains(&bottom));
    }

    /// A frame and its ticks, whichever way round each is drawn, and a disc with its outline. The frame begins at a corner.
    #[test]
    fn items_of_one_colour_leave_no_hole_at_corners_and_where_they_cross() {
        let mut corners = Rect::at((4.0, 4.0), 30.0, 30.0).corners().to_vec();
        corners.push(corners[0]);
        let pen = Pen::solid(theme::INK, 4.0);
        for _ in 0..2 {
            let mut scene = scene(50, 50);
            scene.line(&corners, pen);
            for ends in [[20.0, 45.0], [45.0, 20.0]] {
                scene.line(&ends.map(|y| (ends[0] - 5.0, y)), pen);
            }
            scene.disc((42.0, 10.0), 3.0, theme::INK);
            scene.circle((42.0, 10.0), 3.0, Pen::solid(theme::INK, 2.0));
            let rows = rows(&scene, 1);
            let is_ink = |x: usize, y: usize| rows[y][x] == [25; 3];
            assert!((40..45).all(|x| is_ink(x, 10)));
            assert!((3..34).all(|x| is_ink(x, 34) && is_ink(x, 3)));
            assert!((20..45).all(|y| is_ink(15, y)));
            corners.reverse();
        }
    }

    /// Thin lines at any place cover whole pixels, two at two pixels per point.
    #[test]
    fn thin_lines_along_the_axes_do_not_blur() {
        for (offset, width) in [(0.0, 0.8), (0.2, 1.0), (0.25, 1.2), (0.4, 0.8)] {
            let mut scene = scene(20, 20);
            let pen = Pen::solid(theme::INK, width);
            scene.line(&[(2.0, 5.0 + offset), (18.0, 5.0 + offset)], pen);
            scene.line(&[(9.0 + offset, 2.0), (9.0 + offset, 18.0)], pen);
            let rows = rows(&scene, 2);
            let across = rows[30].iter().filter(|rgb| **rgb != PAPER);
            let down = rows.iter().map(|row| &row[8]).filter(|rgb| **rgb != PAPER);
            assert_eq!(across.collect::<Vec<_>>(), [&[25; 3]; 2], "{offset}");
            assert_eq!(down.collect::<Vec<_>>(), [&[25; 3]; 2], "{offset}");
        }
    }

    #[test]
    fn rectangles_do_not_blur_and_do_not_vanish() {
        let mut scene = scene(30, 30);
        scene.rect(Rect::at((2.3, 3.1), 5.3, 7.2), theme::INK);
        scene.rect(Rect::at((15.0, 3.3), 5.0, 0.1), theme::INK);
        let rows = rows(&scene, 1);
        let of = |left: usize, right: usize| {
            let inked = rows.iter().flat_map(|row| &row[left..right]);
            inked.filter(|rgb| **rgb != PAPER).collect::<Vec<_>>()
        };
        let sharp = of(0, 12);
        assert!(sharp.len() == 6 * 7 && sharp.iter().all(|rgb| **rgb == [25; 3]));
        assert_eq!(of(12, 30).len(), 5);
    }

    /// Strips with slanted common edges, given in either order of corners.
    #[test]
    fn neighbouring_polygons_of_one_colour_have_no_seam() {
        let mut scene = scene(60, 30);
        let edge = |i: i32| {
            let x = 2.3 + 5.37 * f64::from(i);
            [(x, -2.0), (x + 3.1, 32.0)]
        };
        for i in 0..10 {
            let ([a, d], [b, c]) = (edge(i), edge(i + 1));
            let corners = if i % 2 == 0 {
                [a, b, c, d]
            } else {
                [d, c, b, a]
            };
            scene.polygon(corners.to_vec(), theme::INK);
        }
        for row in rows(&scene, 1) {
            assert!(row[6..50].iter().all(|rgb| *rgb == [25; 3]), "{row:?}");
        }
    }

    /// Shapes within the first band, and equal ones across the border of the second.
    #[test]
    fn bands_fit_together() {
        let shapes = |y: f64| {
            let mut scene = scene(120, 2 * BAND as u32);
            let pen = Pen::solid(theme::INK, 1.8);
            scene.line(&[(3.0, y - 31.0), (60.0, y + 29.0), (90.0, y - 7.0)], pen);
            scene.disc((40.3, y + 1.2), 9.0, Rgb(0, 114, 178));
            let style = TextStyle::new(30.0, Align::Left, Level::Middle);
            scene.text("Sg8", (60.0, y), style);
            let rows = rows(&scene, 1);
            rows[y as usize - 40..y as usize + 40].to_vec()
        };
        let [within, across] = [0.5 * BAND as f64, BAND as f64].map(shapes);
        assert!(within.iter().flatten().any(|rgb| *rgb != PAPER));
        for (a, b) in within.iter().flatten().zip(across.iter().flatten()) {
            // Two of sixteen levels: curves are cut at the border, and approximated anew.
            assert!(
                a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 32),
                "{a:?} {b:?}"
            );
        }
    }

    /// A capital H as high as capitals of the font, on its baseline, at its anchor by any of its ends, and turned.
    #[test]
    fn texts_stand_on_their_anchor_and_run_upwards() {
        let drawn = |align, is_turned: bool| {
            let mut scene = scene(200, 200);
            let style = TextStyle::new(50.0, align, Level::Baseline);
            match is_turned {
                false => scene.text("H", (100.0, 100.0), style),
                true => scene.text_upwards("H", (100.0, 100.0), style),
            }
            inked(&scene)
        };
        // The stems of the letter are 0.1 em from its ends.
        let width = text_width("H", 50.0).unwrap();
        let (ink, height) = ((width - 10.0).round() as usize, 36);
        for (align, left) in [
            (Align::Left, 105.0),
            (Align::Centre, 105.0 - 0.5 * width),
            (Align::Right, 105.0 - width),
        ] {
            let left = left as usize;
            let close = |found: [usize; 4], expected: [usize; 4]| {
                let apart = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b));
                assert!(apart.max() <= Some(1), "{found:?} {expected:?}");
            };
            close(drawn(align, false), [left, left + ink, 100 - height, 99]);
            close(
                drawn(align, true),
                [100 - height, 99, 199 - left - ink, 199 - left],
            );
        }
    }

    /// Cells of 2.5 by 1.5 pixels, whose last columns lie beyond the canvas, from its first row on and from its fifth.
    #[test]
    fn pixels_take_the_colour_below_their_centres() {
        let picture = Picture {
            frame: Rect::at((1.0, 2.0), 5.0, 1.5),
            columns: 4,
            pixels: (0..8).collect(),
            palette: (0..8).map(|i| Rgb(i, 10 * i, 20 + i)).collect(),
        };
        for top in [0, 5] {
            let mut canvas = vec![255; 4 * 10 * 8];
            paint(&picture, &mut canvas, 10, top, 2.0);
            for (i, pixel) in canvas.chunks_exact(4).enumerate() {
                let (x, y) = (i % 10, top + i / 10);
                let cell = |at: usize, cells: f64, length: f64| (at as f64 + 0.5) * cells / length;
                let expected = match (x.checked_sub(2), y.checked_sub(4)) {
                    (Some(x), Some(y)) if x < 10 && y < 3 => {
                        let index = 4 * cell(y, 2.0, 3.0) as u8 + cell(x, 4.0, 10.0) as u8;
                        [index, 10 * index, 20 + index, 255]
                    }
                    _ => [255; 4],
                };
                assert_eq!(pixel, expected, "{x} {y}");
            }
        }
    }
}
