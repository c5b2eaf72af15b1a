//! Height blocks: heights of one surface, from which follows what part of a wave stays coherent.

use std::f64::consts::{LN_2, PI, TAU};

use asperity_numerics::elementary::{exp, sin_cos};
use num_complex::Complex;
use rayon::prelude::*;

use crate::HeightField;

/// Blocks of a tile along each axis.
const BLOCKS: usize = 8;

/// Bins of heights, over the range of the surface.
const BINS: usize = 512;

/// Diffraction orders of the tile next to the coherent one that tell the speckle, along each axis.
const NEAREST: i32 = 2;

/// Multiple of the speckle below which light of the coherent order is taken for speckle: speckle exceeds it with the probability `e^-4`.
const SPECKLE: f64 = 4.0;

/// Parts of the tile, and of the range of heights, that no piece of a facet exceeds.
const PIECES: [f64; 3] = [2.0 * BLOCKS as f64, 2.0 * BLOCKS as f64, 32.0];

/// Heights of one surface over the mean plane, by block of its tile.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightBlocks(Vec<Vec<Bin>>);

/// Points of one block with nearly the same height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bin {
    /// Area in the mean plane.
    area: f64,
    /// Mean height.
    height: f64,
    /// Variance of heights.
    variance: f64,
    /// Mean distance in height from what is next.
    step: f64,
}

impl HeightBlocks {
    /// Measures the samples of a height map, which follow a smooth profile, and one with steps, better than facets between them.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let range = field.range();
        let [ny, nx] = field.shape();
        let first = |block: usize, n: usize| (block * n).div_ceil(BLOCKS);
        let row_of_blocks = |block_row: usize| {
            let mut sums = Sums::within(range, BLOCKS);
            for iy in first(block_row, ny)..first(block_row + 1, ny) {
                let row = |iy: usize| &field.heights()[iy % ny * nx..][..nx];
                let [below, own, above] = [row(iy + ny - 1), row(iy), row(iy + 1)];
                for block in 0..BLOCKS {
                    for ix in first(block, nx)..first(block + 1, nx) {
                        let height = own[ix];
                        // The nearer neighbour along each axis, since a step may lie on the other side
                        let near = |a: f64, b: f64| (a - height).abs().min((b - height).abs());
                        let left = if ix > 0 { ix - 1 } else { nx - 1 };
                        let right = if ix + 1 < nx { ix + 1 } else { 0 };
                        let along_x = near(own[left], own[right]);
                        let along_y = near(below[ix], above[ix]);
                        sums.add_point(block, height, 1.0, along_x.max(along_y));
                    }
                }
            }
            sums.blocks()
        };
        let rows: Vec<Vec<Vec<Bin>>> = (0..BLOCKS).into_par_iter().map(row_of_blocks).collect();
        Self(rows.concat())
    }

    /// Measures facets by their corners: places along x and y from 0 to 1 over the tile, and heights within `range`.
    #[must_use]
    pub fn of_facets(facets: impl Iterator<Item = [[f64; 3]; 3]>, range: [f64; 2]) -> Self {
        let mut sums = Sums::within(range, BLOCKS * BLOCKS);
        for facet in facets {
            let [a, b, c] = facet;
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            sums.add(facet, 0.5 * area.abs());
        }
        Self(sums.blocks())
    }

    /// Fraction of a wave that stays coherent if a height `h` shifts its phase by `wave_number * h`: `|mean exp(i wave_number h)|^2` over
    /// the mean plane.
    ///
    /// Heights whose phase is more than half a turn from that of the next ones are not resolved and count as incoherent.
    ///
    /// That of a patch of `n` independent parts of a rough surface is larger by `1 / n`, the speckle of the patch. The orders next
    /// to the coherent one tell it, by their median, since a profile that repeats leaves most of them dark. It is subtracted; what does
    /// not exceed it by far counts as zero.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::{HeightBlocks, HeightField};
    ///
    /// // Half of the columns are higher by three radians
    /// let heights = (0..64 * 64).map(|i| f64::from(i % 2)).collect();
    /// let field = HeightField::new(heights, [64, 64], [1.0, 1.0])?;
    /// let fraction = HeightBlocks::of(&field).coherent_fraction(3.0);
    /// assert!((fraction - 1.5_f64.cos().powi(2)).abs() < 1e-12);
    /// # Ok::<(), asperity_surface::HeightFieldError>(())
    /// ```
    #[must_use]
    pub fn coherent_fraction(&self, wave_number: f64) -> f64 {
        let mean = |bins: &Vec<Bin>| {
            let area: f64 = bins.iter().map(|bin| bin.area).sum();
            let resolved = bins.iter().filter(|bin| wave_number.abs() * bin.step <= PI);
            let waves = resolved.map(|bin| {
                let spread = exp(-0.5 * wave_number.powi(2) * bin.variance);
                bin.area * spread * cis(wave_number * bin.height)
            });
            (area, waves.sum::<Complex<f64>>())
        };
        let blocks: Vec<(f64, Complex<f64>)> = self.0.iter().map(mean).collect();
        let area: f64 = blocks.iter().map(|(area, _)| area).sum();
        if area == 0.0 {
            return 0.0;
        }
        let all: Complex<f64> = blocks.iter().map(|(_, wave)| wave).sum();
        let coherent = (all / area).norm_sqr();
        // Blocks count alike, so that those of an incomplete tile are no pattern
        let covered = blocks.iter().filter(|(area, _)| *area > 0.0).count() as f64;
        let order = |x: i32, y: i32| {
            let waves = blocks
                .iter()
                .enumerate()
                .filter(|(_, (area, _))| *area > 0.0);
            let turned = waves.map(|(i, (area, wave))| {
                let [column, row] = [i % BLOCKS, i / BLOCKS].map(|k| k as f64 / BLOCKS as f64);
                wave / area * cis(TAU * (f64::from(x) * column + f64::from(y) * row))
            });
            (turned.sum::<Complex<f64>>() / covered).norm_sqr()
        };
        let near = -NEAREST..=NEAREST;
        let places = near.clone().flat_map(|y| near.clone().map(move |x| [x, y]));
        let others = places.filter(|place| *place != [0, 0]);
        let mut orders: Vec<f64> = others.map(|[x, y]| order(x, y)).collect();
        orders.sort_by(f64::total_cmp);
        // The median of exponentially distributed powers is ln 2 of their mean
        let speckle = orders[orders.len() / 2] / LN_2;
        match coherent > SPECKLE * speckle {
            true => (coherent - speckle) / (1.0 - speckle),
            false => 0.0,
        }
    }
}

/// `exp(i angle)`.
fn cis(angle: f64) -> Complex<f64> {
    let (sin, cos) = sin_cos(angle);
    Complex::new(cos, sin)
}

/// Sums over the points of each bin of each block.
struct Sums {
    lowest: f64,
    /// Bins per length unit; zero of a level surface.
    per_height: f64,
    /// Area, and its products with the height above the bottom of the bin, the square of that, and the step.
    bins: Vec<[f64; 4]>,
}

impl Sums {
    /// Empty sums of `blocks` blocks, with bins between the lowest and the highest height.
    fn within([lowest, highest]: [f64; 2], blocks: usize) -> Self {
        let per_height = match highest > lowest {
            true => BINS as f64 / (highest - lowest),
            false => 0.0,
        };
        Self {
            lowest,
            per_height,
            bins: vec![[0.0; 4]; blocks * BINS],
        }
    }

    /// Adds a facet in pieces, each by the middles of its edges, which is exact to second order.
    fn add(&mut self, facet: [[f64; 3]; 3], area: f64) {
        let heights = PIECES[2] * self.per_height / BINS as f64;
        let length = |a: [f64; 3], b: [f64; 3]| {
            let pieces = [0, 1, 2].map(|i| (a[i] - b[i]).abs());
            (PIECES[0] * pieces[0])
                .max(PIECES[1] * pieces[1])
                .max(heights * pieces[2])
        };
        let [a, b, c] = facet;
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        let longest = turns.map(|[a, b, _]| length(a, b));
        let first = (0..3).fold(0, |k, i| if longest[i] > longest[k] { i } else { k });
        // Rounding divides no piece without end
        if longest[first] > 1.0 + 1e-9 {
            let [a, b, c] = turns[first];
            let between = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
            self.add([a, between, c], 0.5 * area);
            self.add([between, b, c], 0.5 * area);
            return;
        }
        let [column, row] = [0, 1].map(|i| {
            let centroid = (a[i] + b[i] + c[i]) / 3.0;
            ((centroid * BLOCKS as f64) as usize).min(BLOCKS - 1)
        });
        for [a, b, _] in turns {
            let (height, step) = (0.5 * (a[2] + b[2]), (a[2] - b[2]).abs());
            self.add_point(row * BLOCKS + column, height, area / 3.0, step);
        }
    }

    fn add_point(&mut self, block: usize, height: f64, area: f64, step: f64) {
        let above = height - self.lowest;
        let bin = ((above * self.per_height) as usize).min(BINS - 1);
        let within = height - self.bottom(bin);
        let sums = &mut self.bins[block * BINS + bin];
        let moments = [area, area * within, area * within * within, area * step];
        *sums = [0, 1, 2, 3].map(|i| sums[i] + moments[i]);
    }

    fn bottom(&self, bin: usize) -> f64 {
        match self.per_height > 0.0 {
            true => self.lowest + bin as f64 / self.per_height,
            false => self.lowest,
        }
    }

    fn blocks(&self) -> Vec<Vec<Bin>> {
        let blocks = self.bins.chunks(BINS).map(|block| {
            let found = block
                .iter()
                .enumerate()
                .filter(|(_, [area, ..])| *area > 0.0);
            let bins = found.map(|(bin, &[area, first, second, steps])| {
                let mean = first / area;
                Bin {
                    area,
                    height: self.bottom(bin) + mean,
                    variance: (second / area - mean * mean).max(0.0),
                    step: steps / area,
                }
            });
            bins.collect()
        });
        blocks.collect()
    }
}

#[cfg(test)]
mod tests {
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;
    use crate::Border;

    /// Heights `profile(phase)` of `periods` along x, on 96 x 64 samples.
    fn grooves(periods: f64, profile: impl Fn(f64) -> f64) -> HeightField {
        let heights = (0..64 * 96).map(|i| profile((f64::from(i % 96) * periods / 96.0).fract()));
        HeightField::new(heights.collect(), [64, 96], [1.0, 1.0]).unwrap()
    }

    fn sinc_squared(half: f64) -> f64 {
        (half.sin() / half).powi(2)
    }

    #[test]
    fn grooves_leave_the_fractions_of_their_profiles_coherent() {
        // One, three and eight of them over the tile
        for periods in [1.0, 3.0, 8.0] {
            let v = HeightBlocks::of(&grooves(periods, |p| (2.0 * p - 1.0).abs()));
            let sine = HeightBlocks::of(&grooves(periods, |p| 0.5 * (TAU * p).sin()));
            for wave_number in [0.3, 2.0, 5.5, 9.0] {
                // Sums over the samples of a flank are those of a trapezium rule
                let half = wave_number * periods / 96.0;
                let exact = sinc_squared(0.5 * wave_number) * (half / half.tan()).powi(2);
                let found = v.coherent_fraction(wave_number);
                assert!((found - exact).abs() < 1e-4, "{periods}: {found} {exact}");
                let exact = asperity_numerics::elementary::j0(0.5 * wave_number).powi(2);
                let found = sine.coherent_fraction(wave_number);
                assert!((found - exact).abs() < 1e-4, "{periods}: {found} {exact}");
            }
        }
    }

    /// Sixteen samples per period tell phases of a turn apart, and nothing of those of a hundred.
    #[test]
    fn heights_that_samples_do_not_resolve_are_not_coherent() {
        let coarse = HeightBlocks::of(&grooves(6.0, |p| 0.5 * (TAU * p).sin()));
        assert!(coarse.coherent_fraction(TAU) > 0.09);
        for wave_number in [100.0, 321.0, 1234.5] {
            assert!(coarse.coherent_fraction(TAU * wave_number) < 1e-9);
        }
    }

    /// Two level halves cancel where their distance shifts the phase by half a turn, and add up at a whole one.
    #[test]
    fn level_parts_stay_coherent_whatever_lies_between_their_heights() {
        let steps = HeightBlocks::of_facets(
            [0.0, 1.0].into_iter().flat_map(|h| {
                let [from, to] = [0.5 * h, 0.5 * h + 0.5];
                let [a, b] = [[from, 0.0, h], [to, 0.0, h]];
                let [c, d] = [[to, 1.0, h], [from, 1.0, h]];
                [[a, b, c], [a, c, d]]
            }),
            [0.0, 1.0],
        );
        for wave_number in [1.0, 3.0, 1000.5] {
            let exact = (0.5_f64 * wave_number).cos().powi(2);
            let found = steps.coherent_fraction(wave_number);
            assert!((found - exact).abs() < 1e-9, "{found} {exact}");
        }
    }

    /// The speckle of a patch with some hundred independent parts is not taken for coherent light; where there is coherent light, its mean is right.
    #[test]
    fn speckle_of_a_small_patch_is_not_coherent_light() {
        let synthesis =
            Synthesis::new(Psd::gaussian(1.0, 8.0).unwrap(), [64, 64], [1.0, 1.0], true).unwrap();
        let mut means = [0.0; 2];
        let mut raw = 0.0;
        let surfaces = 100;
        for number in 0..surfaces {
            let heights = synthesis.draw(7, number).unwrap().into_heights();
            let open = HeightField::new(heights, [64, 64], [1.0, 1.0]).unwrap();
            let open = open.with_border(Border::Open);
            let blocks = HeightBlocks::of(&open);
            for (mean, wave_number) in means.iter_mut().zip([1.0, 3.5]) {
                *mean += blocks.coherent_fraction(wave_number) / surfaces as f64;
            }
            let heights = open.heights().iter();
            let waves: Complex<f64> = heights.map(|h| Complex::cis(3.5 * h)).sum();
            raw += (waves / 4096.0).norm_sqr() / surfaces as f64;
        }
        // About its own mean a surface has a variance smaller by pi tau^2 / area, which scatters by a part (2 pi tau^2 / area / 2)^(1/2)
        let part = PI * 64.0 / 4096.0;
        let exact = (part - 1.0).exp();
        let scatter = exact * (2.0 * part / 2.0 / surfaces as f64).sqrt();
        assert!(
            (means[0] - exact).abs() < 3.0 * scatter,
            "{means:?} {exact}"
        );
        assert!(means[1] < 0.2 * raw, "{means:?} {raw}");
    }
}
