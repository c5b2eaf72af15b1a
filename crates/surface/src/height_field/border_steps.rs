//! Steps of heights from the last samples to the first, as a periodic border has them.

use rayon::prelude::*;

use super::field::HeightField;

/// Columns that one task takes.
const COLUMNS: usize = 256;

impl HeightField {
    /// Root mean square step of the heights from the last sample to the first, over that between neighbours, along x
    /// and along y: about 1 where opposite borders fit.
    ///
    /// Zero where heights of the border are equal, infinite where only those between neighbours are.
    #[must_use]
    pub fn border_steps(&self) -> [f64; 2] {
        let [ny, nx] = self.shape();
        let row = |iy: usize| &self.heights()[iy * nx..][..nx];
        let step = |(a, b): (&f64, &f64)| (a - b).powi(2);
        let along_x = |iy: usize| {
            let heights = row(iy);
            let inside: f64 = heights[1..].iter().zip(heights).map(step).sum();
            [
                step((&heights[0], &heights[nx - 1])),
                inside / (nx - 1) as f64,
            ]
        };
        let along_y = |block: usize| {
            let columns = block * COLUMNS..nx.min((block + 1) * COLUMNS);
            let mut inside = vec![0.0; columns.len()];
            for iy in 1..ny {
                let steps = row(iy)[columns.clone()]
                    .iter()
                    .zip(&row(iy - 1)[columns.clone()]);
                for (sum, step) in inside.iter_mut().zip(steps.map(step)) {
                    *sum += step;
                }
            }
            let over = row(0)[columns.clone()].iter().zip(&row(ny - 1)[columns]);
            let of_columns = over.map(step).zip(inside);
            of_columns
                .map(|(border, inside)| [border, inside / (ny - 1) as f64])
                .collect::<Vec<_>>()
        };
        let rows: Vec<[f64; 2]> = (0..ny).into_par_iter().map(along_x).collect();
        let blocks = (0..nx.div_ceil(COLUMNS)).into_par_iter().map(along_y);
        let blocks: Vec<Vec<[f64; 2]>> = blocks.collect();
        [ratio(rows.into_iter()), ratio(blocks.into_iter().flatten())]
    }
}

/// Root of the ratio of two sums; zero over zero is zero.
fn ratio(squares: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [border, inside] = squares.fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
    if border == 0.0 {
        0.0
    } else {
        (border / inside).sqrt()
    }
}
