//! Verdicts as signs, which differ by shape and read in grey.

use super::colour_scale::ColourScale;
use super::geometry::{Rect, Xy};
use super::scene::{Align, Level, Pen, Scene, TextStyle};
use super::theme;

/// The verdict on a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapVerdict {
    /// Within the tolerances: a white disc.
    Within,
    /// Beyond a tolerance: a cross.
    Beyond,
    /// Errors too large to tell: a question mark.
    NotResolved,
}

impl MapVerdict {
    pub(crate) fn words(self) -> &'static str {
        match self {
            MapVerdict::Within => "within tolerance",
            MapVerdict::Beyond => "beyond tolerance",
            MapVerdict::NotResolved => "not resolved at this budget",
        }
    }
}

const SIGN: f64 = 4.4;

/// A triangle whose tip, at `at`, points to the right.
pub(crate) fn draw_tolerance_mark(scene: &mut Scene, (x, y): Xy) {
    let corners = vec![(x, y), (x - 7.0, y - 4.5), (x - 7.0, y + 4.5)];
    scene.polygon(corners, theme::INK);
}

pub(crate) fn draw_swatch(scene: &mut Scene, at: Xy, verdict: MapVerdict) {
    let colour = ColourScale::linear(0.0, 1.0).colour(0.45);
    scene.rect(Rect::around(at, 9.0, 9.0), colour);
    draw_sign(scene, at, verdict);
}

/// The sign of a verdict, with an edge that keeps it apart from any colour beneath.
pub(crate) fn draw_sign(scene: &mut Scene, (x, y): Xy, verdict: MapVerdict) {
    match verdict {
        MapVerdict::Within => {
            scene.disc((x, y), SIGN + 1.0, theme::INK);
            scene.disc((x, y), SIGN, theme::WHITE);
        }
        MapVerdict::Beyond => {
            for (pen, r) in [
                (Pen::solid(theme::WHITE, 4.2), SIGN + 0.9),
                (Pen::solid(theme::INK, 2.0), SIGN),
            ] {
                scene.line(&[(x - r, y - r), (x + r, y + r)], pen);
                scene.line(&[(x - r, y + r), (x + r, y - r)], pen);
            }
        }
        MapVerdict::NotResolved => {
            scene.disc((x, y), SIGN + 3.2, theme::WHITE);
            let style = TextStyle::new(theme::TICK_SIZE, Align::Centre, Level::Middle);
            scene.text("?", (x, y), style);
        }
    }
}
