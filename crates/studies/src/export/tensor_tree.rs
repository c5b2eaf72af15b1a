//! Tensor tree: Radiance's XML of a slab with cells that are as fine as lobes need.
//!
//! A file of samples without a direction of their own (`TensorTree3`) has one axis for the polar angle of the light and two for the direction in which light
//! leaves; one of samples with a direction (`TensorTree4`) has two for each. Directions are projected onto the mean plane, and the disc is laid
//! out on the unit square so that equal areas stay equal: cells have equal projected solid angles. The value of a cell is a mean BSDF, 1/sr. Where
//! the values of a block of `2^k` cells per axis hardly differ, it is one cell.

mod disc;
mod grid;
mod resolution;

use std::f64::consts::PI;

use asperity_numerics::elementary::{asin, atan2};
use asperity_simulate::Outcome;
use asperity_tracer::HalfSpace;
use glam::DVec2;

use self::disc::{PARTS, disc, middle};
use self::grid::{Grid, flux_of};
use self::resolution::resolving;
use super::contents::{Agreement, Contents};
use super::directions::{Directions, azimuths_deg};
use super::interpolation::Interpolated;
use super::measurement::Measurement;
use super::moved_lobes::{Mixed, MovedLobes};
use super::planned::{OfCase, Planned, check_light};
use super::window_element::{
    BLOCKS, Block, Weighted, WindowElement, check_slab, in_visible, weighted_flux,
};

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let outcomes = measurement.outcomes()?;
    let weighted = in_visible(&outcomes)?;
    let functions = BLOCKS.map(|block| Function::of(block, &weighted));
    let functions = functions.into_iter().collect::<Result<Vec<_>, _>>()?;
    // Of samples with a direction 64 cells take some 100 MB: they are not worth it where they do not resolve the lobes either
    let (structure, candidates, otherwise): (_, &[usize], _) = match functions[0].is_isotropic() {
        true => ("TensorTree3", &[64, 128], 128),
        false => ("TensorTree4", &[16, 32, 64], 32),
    };
    let (cells, moved) = resolving(
        candidates,
        otherwise,
        functions.iter().flat_map(Function::lobes),
    );
    let mut file = WindowElement::new(outcomes[0], structure, "");
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
        structure,
        100.0 * moved,
        factors[0],
        factors[1]
    ));
    notes.extend(functions[0].directions.sparse_note("tensor-tree"));
    let last = asin(1.0 - 2.0 / cells as f64).to_degrees();
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

/// Checks that a file can hold such cases.
pub(super) fn check(cases: &[Planned]) -> Result<(), String> {
    check_light(cases)?;
    check_slab(cases)?;
    for from in [HalfSpace::Above, HalfSpace::Below] {
        let mut lit = cases.to_vec();
        lit.retain(|one| one.case.light.from == from);
        let is_symmetric = lit.iter().all(|one| one.case.light.random_azimuth);
        if !is_symmetric && azimuths_deg(&lit).len() < 4 {
            return Err("needs light from four azimuths or more, as by --phi 0:345:15, or from random ones, by --light-azimuth random".to_owned());
        }
        directions(&lit)?;
    }
    Ok(())
}

/// The directions of the light, at the first wavelength.
fn directions<T: OfCase + Copy>(lit: &[T]) -> Result<Directions<T>, String> {
    let wavelength = |one: &T| one.case().at.wavelength_nm();
    let mut of_one = lit.to_vec();
    of_one.retain(|one| wavelength(one) == wavelength(&lit[0]));
    let directions = Directions::of(&of_one)?;
    directions.check_polar_angles("tensor-tree")?;
    Ok(directions)
}

/// Light from one side that leaves on a side.
struct Function<'a> {
    block: Block,
    directions: Directions<&'a Outcome>,
    /// Outcomes of all wavelengths with their weights, in the order of the directions.
    bands: Vec<Vec<Weighted<'a>>>,
}

impl<'a> Function<'a> {
    fn of(block: Block, weighted: &[Weighted<'a>]) -> Result<Self, String> {
        let lit = block.lit(weighted);
        let outcomes: Vec<&Outcome> = lit.iter().map(|(outcome, _)| *outcome).collect();
        let directions = directions(&outcomes)?;
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

    /// The BSDF of each outcome over directions projected onto the mean plane.
    fn lobes(&self) -> impl Iterator<Item = impl Fn(DVec2) -> f64> {
        let is_isotropic = self.is_isotropic();
        self.directions.outcomes.iter().map(move |outcome| {
            let bsdf = Interpolated::of(outcome, self.block.side);
            let turn = match is_isotropic {
                true => outcome.case.light.incidence.phi() - PI,
                false => 0.0,
            };
            move |at: DVec2| bsdf.at(asin(at.length().min(1.0)), atan2(at.y, at.x) + turn)
        })
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
