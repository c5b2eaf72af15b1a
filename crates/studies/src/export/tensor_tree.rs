//! Tensor tree: Radiance's XML of a slab with cells that are as fine as lobes need.
//!
//! A file of samples without a direction of their own (`TensorTree3`) has one axis for the polar angle of the light and two for the direction in which light
//! leaves; one of samples with a direction (`TensorTree4`) has two for each. Directions are projected onto the mean plane, and the disc is laid
//! out on the unit square so that equal areas stay equal: cells have equal projected solid angles. The value of a cell is a mean BSDF, 1/sr. Where
//! the values of a block of `2^k` cells per axis hardly differ, it is one cell.
//!
//! # Source
//! The map of the disc: P. Shirley and K. Chiu, A low distortion map between disk and square, J. Graphics Tools 2 (1997).

use std::f64::consts::{FRAC_PI_4, PI};
use std::fmt::Write;

use asperity_optics::Incidence;
use asperity_simulate::Outcome;
use glam::DVec2;

use super::contents::{Agreement, Contents, coarse_note};
use super::directions::{Directions, of_one_sample};
use super::interpolation::Interpolated;
use super::measurement::Measurement;
use super::moved_lobes::{Mixed, MovedLobes};
use super::window_element::{
    BLOCKS, Block, Weighted, WindowElement, check_slab, from_where, visible, weighted_flux,
};

/// Cells per axis of a file.
struct Resolution {
    structure: &'static str,
    /// Numbers of cells per axis, ascending, of which the least is taken that resolves the lobes.
    cells: &'static [usize],
    /// The number that is taken if none resolves them.
    otherwise: usize,
}

const ISOTROPIC: Resolution = Resolution {
    structure: "TensorTree3",
    cells: &[64, 128],
    otherwise: 128,
};
const DIRECTED: Resolution = Resolution {
    structure: "TensorTree4",
    cells: &[16, 32, 64],
    otherwise: 32,
};

/// Part of the light that may move within cells.
const RESOLVED: f64 = 0.1;
/// Cells per axis of the grid on which resolution is judged.
const FINEST: usize = 256;

/// Spread of the values of a block that is one cell: relative to their mean, and to the BSDF of a diffuse sample with the least flux of its directions
/// of the light.
const SPREAD: [f64; 2] = [0.2, 0.03];

/// Parts of a cell, per axis of the directions in which light leaves.
const PARTS: usize = 2;

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let outcomes = of_one_sample(measurement)?;
    for outcome in &outcomes {
        check_slab(outcome)?;
    }
    let weighted = visible(&outcomes)?;
    let functions = BLOCKS.map(|block| Function::of(block, &weighted));
    let functions = functions.into_iter().collect::<Result<Vec<_>, _>>()?;
    let resolution = match functions[0].is_isotropic() {
        true => ISOTROPIC,
        false => DIRECTED,
    };
    let (cells, moved) = resolution.resolving(&functions);
    let mut file = WindowElement::new(outcomes[0], resolution.structure, "");
    let mut agreement = Vec::new();
    let mut factors = [f64::INFINITY, 0.0];
    for function in &functions {
        let mut grid = function.grid(cells, &mut factors);
        let mut text = String::new();
        grid.write(&mut text);
        agreement.extend(function.agreement(&grid));
        file.add("Visible", function.block, BASIS, &text);
    }
    let mut notes = file.notes();
    notes.push(format!(
        "{} of {cells} cells per axis at most, within which {:.1} % of the light moves; values of a direction were scaled by {:.4} to {:.4}",
        resolution.structure,
        100.0 * moved,
        factors[0],
        factors[1]
    ));
    notes.extend(functions[0].directions.sparse_note("tensor-tree"));
    notes.extend(coarse_note(&agreement));
    let last = (1.0 - 2.0 / cells as f64).asin().to_degrees();
    notes.push(format!(
        "light within a cell has the mean of the cell: at grazing incidence, of all light from {last:.0} to 90 degrees"
    ));
    Ok(Contents {
        bytes: file.into_bytes(),
        agreement,
        notes,
    })
}

const BASIS: &str = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";

/// Light from one side that leaves on a side.
struct Function<'a> {
    block: Block,
    directions: Directions<'a>,
    /// Outcomes of all wavelengths with their weights, in the order of the directions.
    bands: Vec<Vec<Weighted<'a>>>,
}

impl<'a> Function<'a> {
    fn of(block: Block, weighted: &[Weighted<'a>]) -> Result<Self, String> {
        let lit = block.lit(weighted);
        let Some((first, _)) = lit.first() else {
            return Err(format!(
                "needs light from {}: measure with gonio --for tensor-tree",
                from_where(block.from)
            ));
        };
        let wavelength = |one: &Outcome| one.case.at.wavelength_nm();
        let of_one: Vec<&Outcome> = lit.iter().map(|(outcome, _)| *outcome).collect();
        let of_one: Vec<&Outcome> = of_one
            .into_iter()
            .filter(|one| wavelength(one) == wavelength(first))
            .collect();
        let directions = Directions::of(&of_one)?;
        if directions.theta_deg.len() < 2 {
            return Err(
                "needs light from several polar angles: measure with gonio --for tensor-tree"
                    .to_owned(),
            );
        }
        if !directions.are_symmetric() && directions.phi_deg.len() < 4 {
            return Err("needs light from four azimuths or more, as by --phi 0:345:15, or from random ones, by --light-azimuth random".to_owned());
        }
        let band = |outcome: &&Outcome| {
            let light = &outcome.case.light;
            let alike = lit.iter().filter(|(one, _)| one.case.light == *light);
            alike.copied().collect::<Vec<Weighted>>()
        };
        let bands: Vec<Vec<Weighted>> = directions.outcomes.iter().map(band).collect();
        if bands.iter().any(|band| band.len() != bands[0].len()) {
            return Err("needs the same directions of the light at all wavelengths".to_owned());
        }
        Ok(Self {
            block,
            directions,
            bands,
        })
    }

    fn is_isotropic(&self) -> bool {
        self.directions.are_symmetric()
    }

    /// Means over the cells of a grid.
    fn grid(&self, cells: usize, factors: &mut [f64; 2]) -> Grid {
        let side = self.block.side;
        let lobes = MovedLobes::of(&self.directions, &self.bands, side, 4 * cells + 1);
        let mut grid = Grid::empty(if self.is_isotropic() { 3 } else { 4 }, cells);
        let columns = grid.values.chunks_mut(cells * cells).zip(&mut grid.fluxes);
        for (number, (column, measured)) in columns.enumerate() {
            let lights = lights_of(number, cells, self.is_isotropic());
            let sum: f64 = lights.iter().map(|(_, weight)| weight).sum();
            if sum == 0.0 {
                continue;
            }
            let mixed: Vec<(Mixed, f64)> = lights
                .into_iter()
                .map(|(light, weight)| (lobes.of_light(light), weight / sum))
                .collect();
            for (cell, value) in column.iter_mut().enumerate() {
                let corner = [cell / cells, cell % cells];
                let parts = mixed.iter().enumerate().map(|(part, (light, weight))| {
                    let within = [part / PARTS, part % PARTS];
                    weight * light.bsdf(disc(middle(corner, within, cells)))
                });
                *value = parts.sum::<f64>().max(0.0) as f32;
            }
            let flux: f64 = mixed
                .iter()
                .map(|(light, weight)| weight * light.flux())
                .sum();
            *measured = flux.max(0.0);
            let found = flux_of(column);
            if found > 0.0 {
                let factor = *measured / found;
                *factors = [factors[0].min(factor), factors[1].max(factor)];
                column.iter_mut().for_each(|value| *value *= factor as f32);
            }
        }
        grid
    }

    fn agreement(&self, grid: &Grid) -> Vec<Agreement> {
        let rows = self.directions.outcomes.iter().zip(&self.bands);
        rows.map(|(outcome, band)| {
            let column = grid.column(outcome.case.light.incidence);
            let measured = weighted_flux(band, self.block.side);
            Agreement::of(&outcome.case, self.block.side, measured, flux_of(column))
        })
        .collect()
    }
}

impl Resolution {
    /// Fewest cells per axis that resolve the lobes of all functions, and the part of the light that moves within them.
    fn resolving(&self, functions: &[Function]) -> (usize, f64) {
        let candidates = self.cells;
        let mut moved = vec![0.0; candidates.len()];
        let mut sum = 0.0;
        for function in functions {
            for outcome in &function.directions.outcomes {
                let mut cells = FINEST;
                let bsdf = Interpolated::of(outcome, function.block.side);
                let turn = match function.is_isotropic() {
                    true => outcome.case.light.incidence.phi() - PI,
                    false => 0.0,
                };
                let value = |cell: usize| {
                    let at = [cell / cells, cell % cells].map(|k| (k as f64 + 0.5) / cells as f64);
                    let at = disc(at);
                    bsdf.at(at.length().min(1.0).asin(), at.to_angle() + turn)
                };
                let mut values: Vec<f64> = (0..cells * cells).map(value).collect();
                sum += values.iter().sum::<f64>();
                while cells > candidates[0] {
                    let half = cells / 2;
                    let mean = |i: usize| {
                        let at = 2 * (i / half) * cells + 2 * (i % half);
                        let four = [at, at + 1, at + cells, at + cells + 1];
                        0.25 * four.map(|one| values[one]).iter().sum::<f64>()
                    };
                    let means: Vec<f64> = (0..half * half).map(mean).collect();
                    if let Some(place) = candidates.iter().position(|count| *count == half) {
                        let change = values.iter().enumerate().map(|(i, value)| {
                            (value - means[i / cells / 2 * half + i % cells / 2]).abs()
                        });
                        let area = (FINEST / cells).pow(2) as f64;
                        moved[place] += 0.5 * area * change.sum::<f64>();
                    }
                    (values, cells) = (means, half);
                }
            }
        }
        let is_taken = |place: &usize| moved[*place] <= RESOLVED * sum;
        let fewest = (0..candidates.len()).find(is_taken);
        let otherwise = candidates.iter().position(|cells| *cells == self.otherwise);
        let place = fewest.or(otherwise).unwrap_or(0);
        (candidates[place], moved[place] / sum)
    }
}

/// Directions towards the light of a column, with weights; none where the column is not used.
fn lights_of(column: usize, cells: usize, is_isotropic: bool) -> Vec<(DVec2, f64)> {
    let count = PARTS * PARTS;
    let part = |k: usize| match is_isotropic {
        true => {
            let at = (column as f64 + (k as f64 + 0.5) / count as f64) / cells as f64;
            let sin = (1.0 - 2.0 * at).max(0.0);
            (DVec2::new(-sin, 0.0), sin)
        }
        false => {
            // Each part of the cell of light meets one of that of light that leaves
            let at = middle(
                [column / cells, column % cells],
                [k % PARTS, k / PARTS],
                cells,
            );
            (-disc(at), 1.0)
        }
    };
    (0..count).map(part).collect()
}

/// Middle of a part of a cell of the unit square.
fn middle(cell: [usize; 2], part: [usize; 2], cells: usize) -> [f64; 2] {
    let at =
        |axis: usize| (cell[axis] as f64 + (part[axis] as f64 + 0.5) / PARTS as f64) / cells as f64;
    [at(0), at(1)]
}

/// The point of the unit disc that a point of the unit square stands for.
fn disc(square: [f64; 2]) -> DVec2 {
    let [a, b] = square.map(|one| 2.0 * one - 1.0);
    let (radius, angle) = match a.abs() > b.abs() {
        true => (a, FRAC_PI_4 * b / a),
        false if b == 0.0 => (0.0, 0.0),
        false => (b, FRAC_PI_4 * (2.0 - a / b)),
    };
    radius * DVec2::from_angle(angle)
}

/// The point of the unit square that stands for a point of the unit disc.
fn square(disc: DVec2) -> [f64; 2] {
    let radius = disc.length();
    let (a, b) = match disc.x.abs() > disc.y.abs() {
        true => (
            radius.copysign(disc.x),
            (disc.y / disc.x).atan() / FRAC_PI_4 * radius.copysign(disc.x),
        ),
        false if radius == 0.0 => (0.0, 0.0),
        false => (
            (disc.x / disc.y).atan() / FRAC_PI_4 * radius.copysign(disc.y),
            radius.copysign(disc.y),
        ),
    };
    [a, b].map(|one| 0.5 * (one + 1.0))
}

fn flux_of(column: &[f32]) -> f64 {
    let sum: f64 = column.iter().map(|value| f64::from(*value)).sum();
    sum * PI / column.len() as f64
}

/// Values over cells of equal widths on three or four axes, the last fastest.
struct Grid {
    axes: usize,
    cells: usize,
    values: Vec<f32>,
    /// Fractions of the light of each column, the cells of light from one direction, that leaves.
    fluxes: Vec<f64>,
}

impl Grid {
    fn empty(axes: usize, cells: usize) -> Self {
        Self {
            axes,
            cells,
            values: vec![0.0; cells.pow(axes as u32)],
            fluxes: vec![0.0; cells.pow(axes as u32 - 2)],
        }
    }

    /// Values of light from the direction of incidence.
    fn column(&self, light: Incidence) -> &[f32] {
        let cell = |at: f64| ((at * self.cells as f64) as usize).min(self.cells - 1);
        let sin = light.theta().sin();
        let column = match self.axes {
            3 => cell(0.5 - 0.5 * sin - 1e-9),
            _ => {
                let [x, y] = square(-DVec2::from_angle(light.phi()) * sin).map(cell);
                x * self.cells + y
            }
        };
        let size = self.cells * self.cells;
        &self.values[column * size..(column + 1) * size]
    }

    /// Writes the tree, and sets all values to those that were written.
    fn write(&mut self, text: &mut String) {
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
