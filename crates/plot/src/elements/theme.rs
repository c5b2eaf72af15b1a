//! Sizes, colours and patterns shared by all figures. Lengths are in points of the figure: one SVG pixel, two PNG pixels.

use super::rgb::Rgb;

/// PNG pixels per point: figures stay readable on dense screens and in print.
pub(crate) const PNG_PIXELS_PER_POINT: u32 = 2;
/// SVG coordinates are integers, which are short; a tenth of a point keeps curves smooth.
pub(crate) const SVG_UNITS_PER_POINT: u32 = 10;

/// The embedded font, then fonts of equal metrics for viewers of the SVG.
pub(crate) const FONT_FAMILY: &str = "DejaVu Sans,Verdana,sans-serif";

pub(crate) const TITLE_SIZE: f64 = 18.0;
pub(crate) const SUBTITLE_SIZE: f64 = 13.0;
pub(crate) const LABEL_SIZE: f64 = 14.0;
pub(crate) const TICK_SIZE: f64 = 12.5;
pub(crate) const LEGEND_SIZE: f64 = 13.0;
pub(crate) const NOTE_SIZE: f64 = 11.5;

/// Outer margin of every figure.
pub(crate) const MARGIN: f64 = 22.0;
pub(crate) const TICK_LENGTH: f64 = 5.0;
pub(crate) const FRAME_WIDTH: f64 = 1.0;
pub(crate) const GRID_WIDTH: f64 = 0.8;
pub(crate) const CURVE_WIDTH: f64 = 1.8;
pub(crate) const BAR_WIDTH: f64 = 1.2;
pub(crate) const MARKER_RADIUS: f64 = 2.8;

pub(crate) const WHITE: Rgb = Rgb(255, 255, 255);
pub(crate) const INK: Rgb = Rgb(25, 25, 25);
pub(crate) const MUTED: Rgb = Rgb(90, 90, 90);
pub(crate) const GRID: Rgb = Rgb(222, 222, 222);
/// Faint guide lines, a little stronger than the grid.
pub(crate) const FAINT: Rgb = Rgb(190, 190, 190);

// Okabe and Ito (2008), "Color universal design": distinct for the common kinds of colour vision. Yellow is
// left out, it vanishes on white.
const BLACK: Rgb = Rgb(0, 0, 0);
const ORANGE: Rgb = Rgb(230, 159, 0);
const SKY_BLUE: Rgb = Rgb(86, 180, 233);
const BLUISH_GREEN: Rgb = Rgb(0, 158, 115);
const BLUE: Rgb = Rgb(0, 114, 178);
const VERMILLION: Rgb = Rgb(213, 94, 0);
const REDDISH_PURPLE: Rgb = Rgb(204, 121, 167);
// Apart from theirs, and from each other, in the common kinds of colour vision too.
const BROWN: Rgb = Rgb(115, 62, 10);
const VIOLET: Rgb = Rgb(112, 40, 190);
const PLUM: Rgb = Rgb(150, 20, 110);
const DARK_GREEN: Rgb = Rgb(0, 72, 48);
const NAVY: Rgb = Rgb(24, 36, 110);
const LEAF_GREEN: Rgb = Rgb(95, 185, 95);

/// Colours of explicit results by component: black for all light. The first four are no colour of a model.
pub(crate) const COMPONENT_COLOURS: [Rgb; 8] = [
    BLACK,
    ORANGE,
    SKY_BLUE,
    REDDISH_PURPLE,
    BLUE,
    VERMILLION,
    DARK_GREEN,
    BROWN,
];
/// Colours of models. With the patterns of [`LINE_DASHES`] and as many markers, models that are close in a list differ in all three.
pub(crate) const MODEL_COLOURS: [Rgb; 9] = [
    BLUE,
    BROWN,
    BLUISH_GREEN,
    VERMILLION,
    NAVY,
    PLUM,
    DARK_GREEN,
    LEAF_GREEN,
    VIOLET,
];
/// Colour of the model of that number, as in `#0072B2`; numbers wrap around.
#[must_use]
pub fn model_colour(number: usize) -> String {
    MODEL_COLOURS[number % MODEL_COLOURS.len()].hex()
}
/// Colours of anything else that is counted.
pub(crate) const PLAIN_COLOURS: [Rgb; 8] = [
    BLUE,
    VERMILLION,
    BLUISH_GREEN,
    REDDISH_PURPLE,
    ORANGE,
    SKY_BLUE,
    BLACK,
    MUTED,
];
/// Lengths on and off; as many patterns as make, with [`MODEL_COLOURS`], 63 different lines.
pub(crate) const LINE_DASHES: [&[f64]; 7] = [
    &[],
    &[9.0, 4.0],
    &[9.0, 3.5, 2.0, 3.5],
    &[2.5, 2.5],
    &[16.0, 4.0],
    &[9.0, 3.0, 2.0, 3.0, 2.0, 3.0],
    &[13.0, 3.0, 4.5, 3.0],
];
/// Thin lines of flat-surface directions.
pub(crate) const GUIDE_DASH: &[f64] = &[4.0, 4.0];
