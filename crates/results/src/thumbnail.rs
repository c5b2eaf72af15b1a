//! Thumbnail: the first surface of a study, small enough to be kept with its results and drawn without the surface itself.

use asperity_numerics::elementary::{exp2, log2};
use asperity_simulate::{SimulateError, SurfaceSource};
use asperity_surface::{HeightField, LengthUnit};
use asperity_synthesis::{GivesUp, SynthesisError};
use serde::{Deserialize, Serialize};

/// Most samples per side.
const MAX_SIDE: usize = 256;

/// Steps of stored heights over their range, at least.
const STEPS: f64 = 65536.0;

/// Heights of the first surface of a study, averaged over square blocks of samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thumbnail {
    /// Means of heights over the blocks in `unit`, shape `[ny, nx]`, row by row, rounded to steps of 1/65536 of their range or less.
    pub heights: Vec<f64>,
    /// `[ny, nx]`, at most `[256, 256]`.
    pub shape: [usize; 2],
    /// Extent `[x, y]` of the whole surface in `unit`.
    pub extent: [f64; 2],
    /// Unit of heights and extent.
    pub unit: LengthUnit,
}

impl Thumbnail {
    /// The first surface that `source` gives or draws by `seed`. `None` for triangle meshes and described surfaces, and if `gives_up` returns
    /// `true` while the surface is drawn.
    pub(crate) fn of(
        source: &SurfaceSource,
        seed: u64,
        unit: LengthUnit,
        gives_up: GivesUp<'_>,
    ) -> Result<Option<Self>, SimulateError> {
        let SurfaceSource::Random(surfaces) = source else {
            return Ok(source.heights().map(|field| Self::of_field(&field, unit)));
        };
        match surfaces.heights(seed, 0, gives_up) {
            Err(SynthesisError::GivenUp) => Ok(None),
            field => Ok(Some(Self::of_field(&field?, unit))),
        }
    }

    /// Means over blocks of as many samples along x as along y. Blocks at the far borders may have fewer.
    fn of_field(field: &HeightField, unit: LengthUnit) -> Self {
        let [ny, nx] = field.shape();
        let side = nx.max(ny).div_ceil(MAX_SIDE);
        let mut heights = Vec::new();
        for rows in field.heights().chunks(side * nx) {
            for x in (0..nx).step_by(side) {
                let parts = rows.chunks(nx).map(|row| &row[x..nx.min(x + side)]);
                let block: Vec<f64> = parts.flatten().copied().collect();
                heights.push(block.iter().sum::<f64>() / block.len() as f64);
            }
        }
        // Steps are powers of two, so that trailing bits are zero, which are compressed away.
        let [low, high] =
            [f64::min, f64::max].map(|pick| heights.iter().copied().fold(heights[0], pick));
        let step = exp2(log2((high - low) / STEPS).floor());
        if step.is_normal() {
            for height in &mut heights {
                *height = (*height / step).round() * step;
            }
        }
        Self {
            heights,
            shape: [ny.div_ceil(side), nx.div_ceil(side)],
            extent: field.extent(),
            unit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_whole_samples_keep_their_means() {
        // 300 rows and 515 columns: blocks of 3 x 3, of which the last column has 2 x 3.
        let [ny, nx] = [300, 515];
        let height = |i: usize| (i % nx) as f64 + 0.125 * (i / nx) as f64;
        let field = HeightField::new((0..nx * ny).map(height).collect(), [ny, nx], [0.5, 2.0]);
        let found = Thumbnail::of_field(&field.unwrap(), LengthUnit::Micrometre);
        assert_eq!(found.shape, [100, 172]);
        assert_eq!(found.heights.len(), 100 * 172);
        assert_eq!(found.extent, [257.5, 600.0]);
        let step = 550.0 / STEPS;
        for (i, mean) in [(0, 1.125), (171, 513.5 + 0.125), (173, 4.0 + 0.5)] {
            assert!(
                (found.heights[i] - mean).abs() <= 0.5 * step,
                "{i} {}",
                found.heights[i]
            );
        }
        // A level surface has no range.
        let level = HeightField::new(vec![0.1; 16], [4, 4], [1.0, 1.0]).unwrap();
        assert_eq!(
            Thumbnail::of_field(&level, LengthUnit::Arbitrary).heights,
            [0.1; 16]
        );
    }
}
