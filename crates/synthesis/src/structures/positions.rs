//! Positions of features: on a lattice, at random, or at random without overlap.

use asperity_numerics::elementary::hypot;
use serde::{Deserialize, Serialize};

use super::error::StructureError;
use super::limits;
use super::random::Streams;

/// Arrangement of features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Arrangement {
    /// On a lattice: hexagonal for round features, square for square ones.
    Lattice,
    /// At random, each independent of the others, so that features overlap.
    #[default]
    Random,
    /// At random, one after the other, each where it overlaps none placed before (random sequential adsorption).
    Separate,
}

/// The lattice of a tile: its rows and columns, as whole numbers allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    columns: usize,
    rows: usize,
    /// `true` if odd rows are displaced by half a column.
    staggered: bool,
}

impl Lattice {
    /// A square lattice with about `pitch` between neighbours.
    pub(super) fn square(lengths: [f64; 2], pitch: f64) -> Result<Self, StructureError> {
        Ok(Self {
            columns: whole_periods('x', lengths[0], pitch)?,
            rows: whole_periods('y', lengths[1], pitch)?,
            staggered: false,
        })
    }

    /// A hexagonal lattice with about `pitch` between neighbours, rows along x.
    pub(super) fn hexagonal(lengths: [f64; 2], pitch: f64) -> Result<Self, StructureError> {
        Ok(Self {
            columns: whole_periods('x', lengths[0], pitch)?,
            rows: 2 * whole_periods('y', lengths[1], 3_f64.sqrt() * pitch)?,
            staggered: true,
        })
    }

    /// Number of positions.
    pub(super) const fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Distances between columns and between rows, length units.
    pub(super) fn pitches(&self, lengths: [f64; 2]) -> [f64; 2] {
        [
            lengths[0] / self.columns as f64,
            lengths[1] / self.rows as f64,
        ]
    }

    /// The smallest distance between neighbours, length units.
    pub(super) fn least_pitch(&self, lengths: [f64; 2]) -> f64 {
        let [x, y] = self.pitches(lengths);
        if self.staggered {
            x.min(hypot(0.5 * x, y)).min(2.0 * y)
        } else {
            x.min(y)
        }
    }

    /// Position `i`; the first lies at the origin.
    pub(super) fn position(&self, lengths: [f64; 2], i: usize) -> [f64; 2] {
        let [x, y] = self.pitches(lengths);
        let (column, row) = (i % self.columns, i / self.columns);
        let displaced = if self.staggered && row % 2 == 1 {
            0.5
        } else {
            0.0
        };
        [(column as f64 + displaced) * x, row as f64 * y]
    }
}

/// The number of periods in a side that changes the period least.
pub(super) fn whole_periods(axis: char, side: f64, period: f64) -> Result<usize, StructureError> {
    let periods = side / period;
    let whole = periods.round().max(1.0);
    if (periods / whole - 1.0).abs() > limits::MAX_ADJUSTMENT {
        let below = periods.floor() * period;
        return Err(StructureError::NoWholePeriods {
            axis,
            period: period.into(),
            side: side.into(),
            below: (below > 0.0).then_some(below.into()),
            above: (periods.ceil() * period).into(),
        });
    }
    if whole > limits::MAX_FEATURES as f64 {
        return Err(StructureError::TooManyFeatures { features: whole });
    }
    Ok(whole as usize)
}

/// Most positions tried for one feature that must not overlap others.
const MAX_TRIALS: usize = 20_000;

/// Places of discs of the given `radii` that do not overlap, one after the other in their order.
///
/// # Source
/// J. Feder, *Random sequential adsorption*, J. Theor. Biol. 87, 237 (1980): equal discs jam at a coverage of 0.547.
pub(super) fn separate(
    streams: &Streams,
    lengths: [f64; 2],
    radii: &[f64],
) -> Result<Vec<[f64; 2]>, StructureError> {
    let widest = radii.iter().fold(0.0_f64, |a, r| a.max(*r));
    // Discs of neighbouring squares alone can overlap
    let counts = lengths.map(|length| (length / (2.0 * widest)).floor().max(1.0) as usize);
    let mut squares = vec![Vec::new(); counts[0] * counts[1]];
    let square = |p: [f64; 2]| {
        [0, 1].map(|i| ((p[i] / lengths[i] * counts[i] as f64) as usize).min(counts[i] - 1))
    };
    let mut positions: Vec<[f64; 2]> = Vec::with_capacity(radii.len());
    for (i, radius) in radii.iter().enumerate() {
        // Beyond the streams that sizes are drawn from
        let mut stream = streams.of(radii.len() + i);
        let is_free = |p: [f64; 2], positions: &[[f64; 2]], squares: &[Vec<usize>]| {
            let [column, row] = square(p);
            let near = |centre: usize, count: usize| {
                let around = [centre + count - 1, centre, centre + 1];
                around.map(|k| k % count)
            };
            near(row, counts[1]).iter().all(|row| {
                near(column, counts[0]).iter().all(|column| {
                    squares[row * counts[0] + column].iter().all(|&other| {
                        let q = positions[other];
                        let [x, y] = [0, 1].map(|i| {
                            let d = (p[i] - q[i]).abs();
                            d.min(lengths[i] - d)
                        });
                        hypot(x, y) >= radius + radii[other]
                    })
                })
            })
        };
        // An image of its own must not overlap it either
        let fits = 2.0 * radius <= lengths[0].min(lengths[1]);
        let position = (0..MAX_TRIALS)
            .map(|_| stream.position(lengths))
            .find(|p| fits && is_free(*p, &positions, &squares))
            .ok_or(StructureError::Crowded {
                placed: i,
                requested: radii.len(),
            })?;
        let [column, row] = square(position);
        squares[row * counts[0] + column].push(i);
        positions.push(position);
    }
    Ok(positions)
}
