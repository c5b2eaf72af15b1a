//! Disc: directions projected onto the mean plane, laid out on the unit square so that equal areas stay equal.
//!
//! # Source
//! P. Shirley and K. Chiu, A low distortion map between disk and square, J. Graphics Tools 2 (1997).

use std::f64::consts::FRAC_PI_4;

use asperity_numerics::elementary::atan;
use asperity_optics::horizontal;
use glam::DVec2;

/// Parts of a cell, per axis of the directions in which light leaves.
pub(super) const PARTS: usize = 2;

/// Middle of a part of a cell of the unit square.
pub(super) fn middle(cell: [usize; 2], part: [usize; 2], cells: usize) -> [f64; 2] {
    let at =
        |axis: usize| (cell[axis] as f64 + (part[axis] as f64 + 0.5) / PARTS as f64) / cells as f64;
    [at(0), at(1)]
}

/// The point of the unit disc that a point of the unit square stands for.
pub(super) fn disc(square: [f64; 2]) -> DVec2 {
    let [a, b] = square.map(|one| 2.0 * one - 1.0);
    let (radius, angle) = match a.abs() > b.abs() {
        true => (a, FRAC_PI_4 * b / a),
        false if b == 0.0 => (0.0, 0.0),
        false => (b, FRAC_PI_4 * (2.0 - a / b)),
    };
    radius * horizontal(angle)
}

/// The point of the unit square that stands for a point of the unit disc.
pub(super) fn square(disc: DVec2) -> [f64; 2] {
    let radius = disc.length();
    let (a, b) = match disc.x.abs() > disc.y.abs() {
        true => (
            radius.copysign(disc.x),
            atan(disc.y / disc.x) / FRAC_PI_4 * radius.copysign(disc.x),
        ),
        false if radius == 0.0 => (0.0, 0.0),
        false => (
            atan(disc.x / disc.y) / FRAC_PI_4 * radius.copysign(disc.y),
            radius.copysign(disc.y),
        ),
    };
    [a, b].map(|one| 0.5 * (one + 1.0))
}
