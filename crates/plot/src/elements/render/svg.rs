//! SVG documents: shapes in tenths of a point. Pictures become embedded PNG files.

use std::fmt::Write as _;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::PlotError;
use crate::elements::geometry::Xy;
use crate::elements::rgb::Rgb;
use crate::elements::scene::{Align, Item, Picture, Scene, TextItem};
use crate::elements::theme;

const UNITS_PER_POINT: u32 = theme::SVG_UNITS_PER_POINT;

/// The scene as an SVG document.
pub(super) fn render(scene: &Scene) -> Result<String, PlotError> {
    let Scene { width, height, .. } = scene;
    let mut document = Document::default();
    document.element(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {} {}\" role=\"img\" font-family=\"{}\" fill=\"none\" stroke-linejoin=\"round\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>",
        width * UNITS_PER_POINT,
        height * UNITS_PER_POINT,
        theme::FONT_FAMILY,
        escape(&scene.title),
    ));
    for picture in &scene.pictures {
        document.element(&image(picture)?);
    }
    for item in &scene.items {
        document.add(item);
    }
    document.element("</svg>");
    Ok(document.text)
}

/// A document as it is written. Consecutive shapes with the same attributes share one path, which keeps files small.
#[derive(Default)]
struct Document {
    text: String,
    /// Attributes and data of the path that is not yet in `text`.
    attributes: String,
    path: PathData,
}

impl Document {
    fn add(&mut self, item: &Item) {
        match item {
            Item::Line {
                path,
                colour,
                width,
            } => {
                let mut points = units(path);
                points.dedup();
                if points.len() > 1 {
                    self.path_of(stroke(*colour, *width)).outline(&points);
                }
            }
            Item::Polygon { corners, colour } => {
                let mut points = units(corners);
                points.dedup();
                if points.len() > 2 {
                    self.path_of(fill(*colour)).area(&points);
                }
            }
            Item::Circle {
                centre,
                radius,
                colour,
                width,
            } => {
                let attributes =
                    width.map_or_else(|| fill(*colour), |width| stroke(*colour, width));
                self.element(&circle(*centre, *radius, &attributes));
            }
            Item::Text(item) => self.element(&text(item)),
            Item::Tooltip { rect, text } => {
                let [(x, y), _, (right, bottom), _] = rect.corners().map(unit);
                self.element(&format!(
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" pointer-events=\"all\" \
                     tabindex=\"0\"><title>{}</title></rect>",
                    right - x,
                    bottom - y,
                    escape(text),
                ));
            }
        }
    }

    /// The path with these attributes, to be continued.
    fn path_of(&mut self, attributes: String) -> &mut PathData {
        if attributes != self.attributes {
            self.end_path();
            self.attributes = attributes;
        }
        &mut self.path
    }

    fn end_path(&mut self) {
        let (attributes, path) = (
            std::mem::take(&mut self.attributes),
            std::mem::take(&mut self.path),
        );
        if !attributes.is_empty() {
            self.element(&format!("<path{attributes} d=\"{}\"/>", path.data));
        }
    }

    fn element(&mut self, element: &str) {
        self.end_path();
        self.text.push_str(element);
        self.text.push('\n');
    }
}

/// Data of a path, in relative commands: steps have fewer digits than places.
#[derive(Default)]
struct PathData {
    data: String,
    /// Where the next command starts.
    at: (i32, i32),
    /// The command that further numbers continue.
    command: char,
}

impl PathData {
    fn outline(&mut self, points: &[(i32, i32)]) {
        self.go('m', points[0]);
        for to in &points[1..] {
            self.go('l', *to);
        }
    }

    fn area(&mut self, corners: &[(i32, i32)]) {
        self.outline(corners);
        self.data.push('z');
        (self.command, self.at) = ('z', corners[0]);
    }

    fn go(&mut self, command: char, to: (i32, i32)) {
        match (command, to.0 - self.at.0, to.1 - self.at.1) {
            ('l', x, 0) => self.write('h', &[x]),
            ('l', 0, y) => self.write('v', &[y]),
            (_, x, y) => self.write(command, &[x, y]),
        }
        self.at = to;
    }

    fn write(&mut self, command: char, numbers: &[i32]) {
        if command != self.command {
            self.data.push(command);
        }
        // Numbers after those of `m` are lines.
        self.command = if command == 'm' { 'l' } else { command };
        for number in numbers {
            if *number >= 0 && self.data.ends_with(|c: char| c.is_ascii_digit()) {
                self.data.push(' ');
            }
            // Writing to a string does not fail.
            let _ = write!(self.data, "{number}");
        }
    }
}

/// A place in whole units. Saturates far outside the figure, where integer arithmetic is still safe.
fn unit((x, y): Xy) -> (i32, i32) {
    let whole = |v: f64| (v * f64::from(UNITS_PER_POINT)).round().clamp(-1e5, 1e5) as i32;
    (whole(x), whole(y))
}

fn units(path: &[Xy]) -> Vec<(i32, i32)> {
    path.iter().copied().map(unit).collect()
}

fn length(length: f64) -> f64 {
    (length * f64::from(UNITS_PER_POINT)).round().max(1.0)
}

fn fill(colour: Rgb) -> String {
    format!(" fill=\"{}\"", colour.hex())
}

fn stroke(colour: Rgb, width: f64) -> String {
    format!(
        " stroke=\"{}\" stroke-width=\"{}\"",
        colour.hex(),
        length(width)
    )
}

fn circle(centre: Xy, radius: f64, attributes: &str) -> String {
    let (x, y) = unit(centre);
    let r = length(radius);
    format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{attributes}/>")
}

fn text(item: &TextItem) -> String {
    let (x, y) = unit(item.anchor);
    let align = match item.align {
        Align::Left => "",
        Align::Centre => " text-anchor=\"middle\"",
        Align::Right => " text-anchor=\"end\"",
    };
    let turn = match item.upwards {
        true => format!(" transform=\"rotate(-90 {x} {y})\""),
        false => String::new(),
    };
    let (size, fill) = (length(item.size), fill(item.colour));
    let text = escape(&item.text);
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{fill}{align}{turn}>{text}</text>")
}

/// A picture as an SVG element that carries its own PNG.
fn image(picture: &Picture) -> Result<String, PlotError> {
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
    // Files as large as those of the default, in a third of its time.
    encoder.set_filter(png::Filter::Up);
    encoder.set_deflate_compression(png::DeflateCompression::Level(3));
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&picture.pixels))
        .map_err(PlotError::backend)?;
    let frame = picture.frame;
    let scale = f64::from(UNITS_PER_POINT);
    Ok(format!(
        "<image x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" preserveAspectRatio=\"none\" \
         image-rendering=\"pixelated\" href=\"data:image/png;base64,{}\"/>",
        frame.left * scale,
        frame.top * scale,
        frame.width() * scale,
        frame.height() * scale,
        STANDARD.encode(&file),
    ))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::geometry::Rect;
    use crate::elements::scene::Pen;

    /// Data of the path, in tenths of a point.
    #[test]
    fn consecutive_shapes_of_one_look_share_a_path_and_keep_their_order() {
        let mut scene = Scene::new("a & b");
        let thin = Pen::solid(theme::INK, 1.0);
        let square = |at| Rect::around((at, at), 1.0, 1.0);
        scene.line(&[(1.0, 2.0), (4.0, 2.0), (4.0, 2.01), (3.0, 1.5)], thin);
        scene.line(&[(3.0, 0.0), (3.0, 2.0)], thin);
        scene.line(&[(3.0, 3.0), (3.0, 3.0)], thin);
        scene.line(&[(0.0, 0.0), (1.0, 1.0)], Pen::solid(theme::INK, 2.0));
        scene.rect(square(1.0), theme::INK);
        // The same area, the other way round.
        let mut corners = square(2.0).corners().to_vec();
        corners.reverse();
        scene.polygon(corners, theme::INK);
        scene.disc((1.0, 1.0), 0.5, theme::INK);
        scene.rect(square(1.0), theme::INK);
        scene.tooltip(square(3.0), "<here>");
        let svg = render(&scene).unwrap();
        let lines: Vec<&str> = svg.lines().skip(1).collect();
        let expected = [
            "<title>a &amp; b</title>",
            "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>",
            "<path stroke=\"#191919\" stroke-width=\"10\" d=\"m10 20h30l-10-5m0-15v20\"/>",
            "<path stroke=\"#191919\" stroke-width=\"20\" d=\"m0 0 10 10\"/>",
            "<path fill=\"#191919\" d=\"m0 0h20v20h-20zm10 10h20v20h-20z\"/>",
            "<circle cx=\"10\" cy=\"10\" r=\"5\" fill=\"#191919\"/>",
            "<path fill=\"#191919\" d=\"m0 0h20v20h-20z\"/>",
            "<rect x=\"20\" y=\"20\" width=\"20\" height=\"20\" pointer-events=\"all\" tabindex=\"0\">\
             <title>&lt;here&gt;</title></rect>",
            "</svg>",
        ];
        assert_eq!(lines, expected);
    }
}
