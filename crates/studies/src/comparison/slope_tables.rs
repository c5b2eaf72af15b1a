//! Slope tables: slopes of any density of surfaces, or of the regions of one, for models made of them.
//!
//! The table that a model is made of is an estimate, from the very surfaces that it is compared with. What the slopes of
//! each surface explain of its light is taken from its tally: the change of the model if that surface alone is left out of the table, times the
//! number of the others. The mean stays as it is, since the changes sum up to zero, and what is left of the scatter is the error of the difference
//! between light and model, with that of the table in it.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_analysis::{
    ModelError, SlopeCovariance, SlopeDistribution, SlopeGrid, SlopeTable, SlopeTableError,
    region_influence,
};
use asperity_numerics::elementary::{hypot, sin_cos};
use asperity_optics::{Incidence, Material};
use asperity_tally::{Mirror, TallySpec, TallyValues};
use asperity_tracer::HalfSpace;
use rayon::prelude::*;

/// Azimuths that a slope is turned to where light comes from any.
const TURNS: usize = 8;

/// The golden angle, in turns: azimuths of one slope after another fill the circle evenly.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// Slopes that count as much as those that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlopeSymmetry {
    /// None but those.
    None,
    /// Images in both axes, as of mirrored tiles.
    Mirrored,
    /// Slopes averaged over azimuth, as light from any azimuth meets them.
    Turned,
}

/// The slopes of surfaces, or of regions of one, in a table.
#[derive(Clone, Debug)]
pub(crate) struct SlopeTables {
    table: Arc<SlopeTable>,
    /// Weights of the cells of the table by each surface or region, whose sum is one.
    weights: Vec<Vec<f64>>,
}

impl SlopeTables {
    /// The slopes of `count` surfaces or regions. `samples`: slopes of equal areas of one of them, by its number; each is requested twice,
    /// so that those of one at a time are held by a thread. `from`: where light comes from; from below, the surface is upside down.
    ///
    /// # Errors
    /// Errors of `samples`; [`SlopeTableError`] without slopes.
    pub(crate) fn new<E: From<SlopeTableError> + Send>(
        count: usize,
        samples: impl Fn(usize) -> Result<Vec<[f64; 2]>, E> + Sync,
        symmetry: SlopeSymmetry,
        from: HalfSpace,
    ) -> Result<Self, E> {
        let found = (0..count).into_par_iter().map(|number| {
            let samples = samples(number)?;
            Ok(Extent::of(&samples))
        });
        let found = found.collect::<Result<Vec<_>, E>>()?;
        let (mean_slope, grid) = cells(&found, symmetry)?;
        let [mean_x, mean_y] = mean_slope;
        let sign = from.sign();
        let level = |[x, y]: [f64; 2]| [sign * (x - mean_x), sign * (y - mean_y)];
        let weights = (0..count).into_par_iter().map(|number| {
            let samples = samples(number)?;
            let level = samples.into_iter().map(level);
            let mut weights = grid.weights(images(level, symmetry));
            let sum = weights.iter().sum::<f64>().max(1.0);
            weights.iter_mut().for_each(|weight| *weight /= sum);
            Ok(weights)
        });
        let weights = weights.collect::<Result<Vec<Vec<f64>>, E>>()?;
        let mut mean = vec![0.0; grid.len()];
        for weights in &weights {
            mean.iter_mut().zip(weights).for_each(|(a, b)| *a += b);
        }
        let table = SlopeTable::new(grid, &mean)?;
        Ok(Self {
            table: Arc::new(table),
            weights,
        })
    }

    /// The slopes of all, with their `covariance`.
    pub(crate) fn distribution(&self, covariance: SlopeCovariance) -> SlopeDistribution {
        SlopeDistribution::Table {
            table: Arc::clone(&self.table),
            covariance,
        }
    }

    /// Cells of the table along x and y.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.table.grid().size()
    }

    /// The tallies less what the slopes of each explain. `mirror`: between bins that are averaged.
    pub(crate) fn adjusted(
        &self,
        tallies: &[TallyValues],
        material: Material,
        incidence: Incidence,
        mirror: Option<Mirror>,
    ) -> Result<Vec<TallyValues>, ModelError> {
        // One alone explains nothing of a scatter.
        let ([first, _, ..], [_, _, ..]) = (tallies, self.weights.as_slice()) else {
            return Ok(tallies.to_vec());
        };
        let spec: &TallySpec = first.spec();
        let mut explained =
            region_influence(&self.table, &self.weights, material, incidence, spec)?;
        if let Some(mirror) = mirror {
            explained.iter_mut().for_each(|tally| mirror.fold(tally));
        }
        let pairs = tallies.iter().zip(&explained);
        Ok(pairs
            .map(|(tally, explained)| tally.zip_map(explained, |value, part| value - part))
            .collect())
    }
}

/// About the most slopes of each surface or region that the spread is estimated from.
const MOST_FOR_SPREAD: usize = 1 << 16;

/// Sums of one surface or region that the cells of a table depend on.
struct Extent {
    count: usize,
    sum: [f64; 2],
    /// Least and largest slope along x and y.
    range: [[f64; 2]; 2],
    /// Some of the slopes.
    some: Vec<[f64; 2]>,
}

impl Extent {
    fn of(samples: &[[f64; 2]]) -> Self {
        let every = 1 + samples.len() / MOST_FOR_SPREAD;
        let axis = |k: usize| samples.iter().map(move |slope| slope[k]);
        let range = |k: usize| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = axis(k).fold(ends, |(low, high), s| (low.min(s), high.max(s)));
            [low, high]
        };
        Self {
            count: samples.len(),
            sum: [0, 1].map(|k| axis(k).sum()),
            range: [0, 1].map(range),
            some: samples.iter().step_by(every).copied().collect(),
        }
    }
}

/// The mean slope of all, and cells for the slopes about it.
fn cells(
    found: &[Extent],
    symmetry: SlopeSymmetry,
) -> Result<([f64; 2], SlopeGrid), SlopeTableError> {
    let count = found.iter().map(|one| one.count).sum::<usize>().max(1) as f64;
    let mean = [0, 1].map(|k| found.iter().map(|one| one.sum[k]).sum::<f64>() / count);
    let some = found.iter().flat_map(|one| &one.some);
    let level = some.map(|slope| [0, 1].map(|k| slope[k] - mean[k]));
    let some: Vec<[f64; 2]> = images(level, symmetry).collect();
    let ends = |k: usize| found.iter().flat_map(move |one| one.range[k]);
    let largest = [0, 1].map(|k| ends(k).fold(0.0, |most: f64, s| most.max((s - mean[k]).abs())));
    let largest = match symmetry {
        SlopeSymmetry::Turned => [hypot(largest[0], largest[1]); 2],
        SlopeSymmetry::None | SlopeSymmetry::Mirrored => largest,
    };
    Ok((mean, SlopeGrid::covering(&some, largest)?))
}

/// All slopes that these stand for.
fn images(
    samples: impl Iterator<Item = [f64; 2]>,
    symmetry: SlopeSymmetry,
) -> impl Iterator<Item = [f64; 2]> {
    let count = match symmetry {
        SlopeSymmetry::None => 1,
        SlopeSymmetry::Mirrored => 4,
        SlopeSymmetry::Turned => TURNS,
    };
    samples.enumerate().flat_map(move |(i, [x, y])| {
        (0..count).map(move |k| match symmetry {
            SlopeSymmetry::None => [x, y],
            SlopeSymmetry::Mirrored => {
                [if k % 2 == 0 { x } else { -x }, if k < 2 { y } else { -y }]
            }
            SlopeSymmetry::Turned => {
                let turn = (i as f64 * GOLDEN).fract() + k as f64 / TURNS as f64;
                let (sin, cos) = sin_cos(TAU * turn);
                [cos * x - sin * y, sin * x + cos * y]
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use asperity_optics::from_spherical;

    use super::*;

    fn samples() -> Vec<Vec<[f64; 2]>> {
        let one = |k: i32| {
            let slope = |i: i32| {
                let u = f64::from(i) / 100.0;
                [0.1 * f64::from(k) + u * u, (7.0 * u).sin() * 0.3]
            };
            (0..100).map(slope).collect()
        };
        (0..4).map(one).collect()
    }

    fn tables(symmetry: SlopeSymmetry, from: HalfSpace) -> SlopeTables {
        let samples = samples();
        let one = |i: usize| Ok::<_, SlopeTableError>(samples[i].clone());
        SlopeTables::new(samples.len(), one, symmetry, from).unwrap()
    }

    #[test]
    fn symmetries_keep_what_they_must() {
        let of = |symmetry| {
            let tables = tables(symmetry, HalfSpace::Above);
            (tables.table.mean(), tables.table.second_moments())
        };
        // Means of the slopes are taken off; cells of a 32nd of the spread move means by less than a tenth of that.
        let (mean, [xx, xy, yy]) = of(SlopeSymmetry::None);
        assert!(mean.iter().all(|m| m.abs() < 3e-3), "{mean:?}");
        let (_, mirrored) = of(SlopeSymmetry::Mirrored);
        assert!(xy.abs() > 0.01 && mirrored[1].abs() < 1e-12);
        assert!((mirrored[0] / xx - 1.0).abs() < 2e-3 && (mirrored[2] / yy - 1.0).abs() < 2e-3);
        let (_, turned) = of(SlopeSymmetry::Turned);
        assert!((turned[0] / turned[2] - 1.0).abs() < 2e-3 && turned[1].abs() < 1e-3 * xx);
        assert!(((turned[0] + turned[2]) / (xx + yy) - 1.0).abs() < 2e-3);
    }

    /// Light from below that comes from an azimuth meets slopes of the other sign.
    #[test]
    fn surfaces_are_upside_down_from_below() {
        let of = |from| {
            let tables = tables(SlopeSymmetry::None, from);
            tables.table
        };
        let (above, below) = (of(HalfSpace::Above), of(HalfSpace::Below));
        let [w, opposite] = [0.0, std::f64::consts::PI].map(|phi| from_spherical(1.2, phi));
        assert!((above.lambda(w) / below.lambda(opposite) - 1.0).abs() < 1e-9);
        assert!((above.lambda(w) / below.lambda(w) - 1.0).abs() > 0.1);
    }
}
