//! The tables of an inspected surface.

use super::{SpectrumRow, Texture, ggx, normal};
use crate::output::{Column, Table, unit_of_lengths};
use crate::report::views::Csv;

/// A lag in whole samples.
struct LagRow {
    samples: usize,
    along_x: Option<f64>,
    along_y: Option<f64>,
}

/// A bin of heights.
struct HeightRow {
    height: f64,
    density: f64,
}

/// A bin of slopes.
struct SlopeRow {
    slope: f64,
    along: [f64; 2],
}

impl Texture {
    /// Table psd.csv.
    pub(super) fn spectrum_table(&self) -> Csv<'_> {
        let length = unit_of_lengths(self.unit);
        let [k, density] = [format!("rad/{length}"), format!("{length}^4")];
        Table::new()
            .column(
                Column::new(
                    "k",
                    "mean length of the wave vectors in the ring",
                    |row: &SpectrumRow| row.ring.k,
                )
                .unit(k),
            )
            .column(
                Column::new(
                    "density",
                    "mean power spectral density, two-sided",
                    |row: &SpectrumRow| row.ring.density,
                )
                .unit(density.clone()),
            )
            .column(Column::new(
                "waves",
                "waves in the ring, a wave vector and its opposite counted as two",
                |row: &SpectrumRow| row.ring.waves,
            ))
            .column(
                Column::new(
                    "requested",
                    "density requested of a generated surface, mean over azimuths at k",
                    |row: &SpectrumRow| row.requested,
                )
                .unit(density),
            )
            .with_rows(&self.spectrum)
    }

    /// Table autocorrelation.csv.
    pub(super) fn correlation_table(&self) -> Csv<'_> {
        let length = unit_of_lengths(self.unit);
        let squared = format!("{length}^2");
        let [dx, dy] = self.spacing;
        Table::new()
            .column(
                Column::new("lag_x", "lag along x", move |row: &LagRow| {
                    row.along_x.map(|_| row.samples as f64 * dx)
                })
                .unit(length),
            )
            .column(
                Column::new(
                    "along_x",
                    "autocorrelation of heights at lag_x along x",
                    |row: &LagRow| row.along_x,
                )
                .unit(squared.clone()),
            )
            .column(
                Column::new("lag_y", "lag along y", move |row: &LagRow| {
                    row.along_y.map(|_| row.samples as f64 * dy)
                })
                .unit(length),
            )
            .column(
                Column::new(
                    "along_y",
                    "autocorrelation of heights at lag_y along y",
                    |row: &LagRow| row.along_y,
                )
                .unit(squared),
            )
            .with_rows(self.lags())
    }

    fn lags(&self) -> impl Iterator<Item = LagRow> {
        let [x, y] = [&self.correlation.along_x, &self.correlation.along_y];
        (0..x.len().max(y.len())).map(|samples| LagRow {
            samples,
            along_x: x.get(samples).copied(),
            along_y: y.get(samples).copied(),
        })
    }

    /// Table heights.csv.
    pub(super) fn heights_table(&self) -> Csv<'_> {
        let length = unit_of_lengths(self.unit);
        let per_length = format!("1/{length}");
        let mean_square = self.sq * self.sq;
        Table::new()
            .column(
                Column::new(
                    "height",
                    "middle of the bin, about the mean height",
                    |row: &HeightRow| row.height,
                )
                .unit(length),
            )
            .column(
                Column::new(
                    "density",
                    "fraction of samples over the width of the bin",
                    |row: &HeightRow| row.density,
                )
                .unit(per_length.clone()),
            )
            .column(
                Column::new(
                    "normal",
                    "normal density of the same root mean square",
                    move |row: &HeightRow| normal(row.height, mean_square),
                )
                .unit(per_length),
            )
            .with_rows(self.heights())
    }

    fn heights(&self) -> impl Iterator<Item = HeightRow> {
        let bins = self.heights.middles();
        bins.map(|(height, density)| HeightRow { height, density })
    }

    /// Table slopes.csv.
    pub(super) fn slopes_table(&self) -> Csv<'_> {
        let [xx, yy] = self.mean_square_slopes;
        let beside =
            |slope: f64, mean_square: f64| (mean_square > 0.0).then(|| normal(slope, mean_square));
        let alpha = self.ggx_alpha;
        let requested = move |slope: f64, axis: usize| alpha.map(|alpha| ggx(slope, alpha[axis]));
        Table::new()
            .column(Column::new(
                "slope",
                "middle of the bin, a tangent",
                |row: &SlopeRow| row.slope,
            ))
            .column(Column::new(
                "along_x",
                "fraction of facets by their slope along x, over the width of the bin",
                |row: &SlopeRow| row.along[0],
            ))
            .column(Column::new(
                "along_y",
                "fraction of facets by their slope along y, over the width of the bin",
                |row: &SlopeRow| row.along[1],
            ))
            .column(Column::new(
                "normal_x",
                "normal density of the root mean square slope along x",
                move |row: &SlopeRow| beside(row.slope, xx),
            ))
            .column(Column::new(
                "normal_y",
                "normal density of the root mean square slope along y",
                move |row: &SlopeRow| beside(row.slope, yy),
            ))
            .column(Column::new(
                "ggx_x",
                "density of GGX along x, requested of a surface generated with such slopes",
                move |row: &SlopeRow| requested(row.slope, 0),
            ))
            .column(Column::new(
                "ggx_y",
                "density of GGX along y, requested of a surface generated with such slopes",
                move |row: &SlopeRow| requested(row.slope, 1),
            ))
            .with_rows(self.slopes())
    }

    fn slopes(&self) -> impl Iterator<Item = SlopeRow> {
        let [x, y] = &self.slopes;
        x.middles()
            .zip(&y.densities)
            .map(|((slope, x), y)| SlopeRow {
                slope,
                along: [x, *y],
            })
    }
}
