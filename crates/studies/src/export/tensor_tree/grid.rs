//! Grid: mean values over cells of equal widths, and the text of the tree in which blocks of hardly differing values are one cell.

use std::f64::consts::PI;
use std::fmt::Write;

use asperity_numerics::elementary::sin;
use asperity_optics::{Incidence, horizontal};

use super::disc::square;

/// Spread of the values of a block that is one cell: relative to their mean, and to the BSDF of a diffuse sample with the least flux of its directions
/// of the light.
const SPREAD: [f64; 2] = [0.2, 0.03];

/// Flux of the values of a column.
pub(super) fn flux_of(column: &[f32]) -> f64 {
    let sum: f64 = column.iter().map(|value| f64::from(*value)).sum();
    sum * PI / column.len() as f64
}

/// Values over cells of equal widths on three or four axes, the last fastest.
pub(super) struct Grid {
    axes: usize,
    cells: usize,
    pub(super) values: Vec<f32>,
    /// Fractions of the light of each column, the cells of light from one direction, that leaves.
    pub(super) fluxes: Vec<f64>,
}

impl Grid {
    pub(super) fn empty(axes: usize, cells: usize) -> Self {
        Self {
            axes,
            cells,
            values: vec![0.0; cells.pow(axes as u32)],
            fluxes: vec![0.0; cells.pow(axes as u32 - 2)],
        }
    }

    /// Values of light from the direction of incidence.
    pub(super) fn column(&self, light: Incidence) -> &[f32] {
        let cell = |at: f64| ((at * self.cells as f64) as usize).min(self.cells - 1);
        let sin = sin(light.theta());
        let column = match self.axes {
            // From the middle, the normal, down: the other half is not used
            3 => self.cells / 2 - 1 - cell(0.5 * sin).min(self.cells / 2 - 1),
            _ => {
                let [x, y] = square(-horizontal(light.phi()) * sin).map(cell);
                x * self.cells + y
            }
        };
        let size = self.cells * self.cells;
        &self.values[column * size..(column + 1) * size]
    }

    /// Writes the tree, and sets all values to those that were written.
    pub(super) fn write(&mut self, text: &mut String) {
        self.write_block(text, 0, self.cells);
        text.push('\n');
    }

    /// Number of the first cell of each part of a block, with bit `i` of the number of the part for the upper half of axis `i`.
    fn halves(&self, first: usize, width: usize) -> impl Iterator<Item = usize> + use<> {
        let (axes, cells) = (self.axes, self.cells);
        (0..1_usize << axes).map(move |part| {
            let steps = (0..axes).filter(|axis| part >> axis & 1 == 1);
            first
                + steps
                    .map(|axis| width / 2 * cells.pow((axes - 1 - axis) as u32))
                    .sum::<usize>()
        })
    }

    /// First cells of the rows along the last axis of a block.
    fn rows(&self, first: usize, width: usize) -> impl Iterator<Item = usize> + use<> {
        let (axes, cells) = (self.axes, self.cells);
        (0..width.pow(axes as u32 - 1)).map(move |row| {
            let place = |axis: u32| row / width.pow(axis) % width * cells.pow(axis + 1);
            first + (0..axes as u32 - 1).map(place).sum::<usize>()
        })
    }

    fn write_block(&mut self, text: &mut String, first: usize, width: usize) {
        let (mut sum, mut least, mut most) = (0.0, f32::INFINITY, 0.0_f32);
        let mut flux = f64::INFINITY;
        for row in self.rows(first, width) {
            flux = flux.min(self.fluxes[row / self.cells.pow(2)]);
            for value in &self.values[row..row + width] {
                sum += f64::from(*value);
                least = least.min(*value);
                most = most.max(*value);
            }
        }
        let mean = sum / width.pow(self.axes as u32) as f64;
        text.push('{');
        if f64::from(most - least) <= (SPREAD[0] * mean).max(SPREAD[1] * flux / PI) {
            for row in self.rows(first, width) {
                self.values[row..row + width].fill(mean as f32);
            }
            push_number(text, mean as f32);
        } else if width == 2 {
            // In a grid the first axis is the slowest, in a tree it has the lowest bit
            let mut cells: Vec<usize> = self.halves(first, 2).collect();
            cells.sort_unstable();
            for cell in cells {
                push_number(text, self.values[cell]);
                text.push(' ');
            }
        } else {
            text.push('\n');
            for part in self.halves(first, width) {
                self.write_block(text, part, width / 2);
            }
        }
        text.push_str("}\n");
    }
}

/// Four digits.
fn push_number(text: &mut String, value: f32) {
    let _ = match value > 0.0 {
        true => write!(text, "{value:.3e}"),
        false => write!(text, "0"),
    };
}
