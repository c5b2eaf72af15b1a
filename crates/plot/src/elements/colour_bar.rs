//! The bar that says what the colours of discs mean.

use crate::PlotError;
use crate::elements::axis::{Axis, display_exponent, per_steradian};
use crate::elements::disc::{BEYOND, palette};
use crate::elements::scene::{Align, Level, Pen, Picture, Rect, Scene, TextLook};
use crate::elements::theme;

const WIDTH: f64 = 16.0;
/// Of the box of the colour of what lies beyond, and between it and the bar.
const BOX: f64 = 10.0;
const BOX_GAP: f64 = 7.0;

/// Draws the bar of a scale from zero to `most`, in 1/sr, at `left` between `top` and `bottom`, with a box of the colour
/// of values beyond if there are some.
pub(crate) fn draw(
    scene: &mut Scene,
    (left, [top, bottom]): (f64, [f64; 2]),
    quantity: &str,
    (most, clipped): (f64, bool),
) -> Result<(), PlotError> {
    let bar = Rect {
        left,
        top,
        right: left + WIDTH,
        bottom,
    };
    scene.pictures.push(Picture {
        frame: bar,
        columns: 1,
        pixels: (1..=254).rev().collect(),
        palette: palette(),
    });
    let pen = Pen::solid(theme::INK, theme::FRAME_WIDTH);
    scene.rect_outline(bar, pen);
    let beside = TextLook::new(theme::TICK_SIZE, Align::Left, Level::Middle);
    let texts = bar.right + theme::TICK_LENGTH + 4.0;
    if clipped {
        let patch = Rect {
            top: top - BOX_GAP - BOX,
            bottom: top - BOX_GAP,
            ..bar
        };
        scene.polygon(patch.corners().to_vec(), BEYOND);
        scene.rect_outline(patch, pen);
        scene.text("beyond", (texts, patch.centre().1), beside);
    }
    let exponent = display_exponent(most);
    let count = (bar.height() / 34.0).floor().clamp(2.0, 8.0) as usize;
    let axis = Axis::linear(0.0, most, count, exponent);
    for (value, text) in &axis.major {
        let Some(t) = axis.fraction(*value) else {
            continue;
        };
        let y = bar.bottom - t * bar.height();
        scene.line(&[(bar.right, y), (bar.right + theme::TICK_LENGTH, y)], pen);
        scene.text(text, (texts, y), beside);
    }
    let x = texts + axis.text_width()? + 9.0;
    let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Top);
    let title = format!("{quantity} {}", per_steradian(exponent));
    scene.text_upwards(&title, (x, bar.centre().1), look);
    Ok(())
}
