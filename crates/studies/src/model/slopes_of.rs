//! The slopes of a file: those of a height map, or a table of their density.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity_analysis::{
    SlopeCovariance, SlopeDistribution, SlopeError, SlopeGrid, SlopeTable, SlopeTableError,
};
use asperity_io::{NumberTable, ReadError, read_height_map, read_number_table};
use asperity_surface::{Border, MissingError, MissingPolicy};

/// Why a file gives no slopes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeFileError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A table has other columns.
    #[error("{}: a table of slopes needs the columns x, y and density, but it has {found}", path.display())]
    Columns {
        /// The file.
        path: PathBuf,
        /// Names of the columns that the table has.
        found: String,
    },
    /// Slopes of a table are missing, there twice or out of order.
    #[error("{}: the rows x, y are not those of a grid of at least 2 x 2 slopes, each pair once and in order of y, then x", path.display())]
    NoGrid {
        /// The file.
        path: PathBuf,
    },
    /// Missing points of a height map cannot be filled.
    #[error("{}: {error}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// Why.
        error: MissingError,
    },
    /// The numbers do not make a table.
    #[error("{}: {error}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        error: SlopeTableError,
    },
    /// The slopes have no covariance, as those of a flat surface and of grooves.
    #[error("{}: models need slopes along x and along y: {error}", path.display())]
    Covariance {
        /// The file.
        path: PathBuf,
        /// Why.
        error: SlopeError,
    },
}

/// The slopes that a height map has, of its facets and less their mean, or those of a table that ends in `.csv`. The table is a density
/// over the slopes along x and y at points of a grid, on any scale.
pub(super) fn slopes_of(path: &Path) -> Result<SlopeDistribution, SlopeFileError> {
    let owned = || path.to_owned();
    let is_table = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    let table = match is_table {
        true => table_of(&read_number_table(path)?)?,
        false => {
            let field = read_height_map(path)?
                .into_height_field(MissingPolicy::Fill, Border::Open)
                .map_err(|error| SlopeFileError::Missing {
                    path: owned(),
                    error,
                })?;
            let slopes = field.slope_samples([1, 1]).concat();
            SlopeTable::of_slopes(&slopes).map_err(|error| SlopeFileError::Table {
                path: owned(),
                error,
            })?
        }
    };
    let [xx, xy, yy] = table.second_moments();
    let covariance =
        SlopeCovariance::new(xx, yy, xy).map_err(|error| SlopeFileError::Covariance {
            path: owned(),
            error,
        })?;
    Ok(SlopeDistribution::Table {
        table: Arc::new(table),
        covariance,
    })
}

/// Each density holds in the cell about its slope, which reaches halfway to the neighbours.
fn table_of(numbers: &NumberTable) -> Result<SlopeTable, SlopeFileError> {
    let path = || numbers.path().to_owned();
    let columns = ["x", "y", "density"].map(|name| numbers.column(name));
    let [Some(_), Some(_), Some(density)] = columns else {
        let found = numbers.names().join(", ");
        return Err(SlopeFileError::Columns {
            path: path(),
            found,
        });
    };
    let no_grid = || SlopeFileError::NoGrid { path: path() };
    let [x, y] = numbers.grid(["x", "y"]).ok_or_else(no_grid)?;
    let failed = |error| SlopeFileError::Table {
        path: path(),
        error,
    };
    let edges = [edges(&x), edges(&y)];
    let areas = edges
        .clone()
        .map(|edges| -> Vec<f64> { edges.windows(2).map(|pair| pair[1] - pair[0]).collect() });
    let grid = SlopeGrid::new(edges).map_err(failed)?;
    let cells = areas[1]
        .iter()
        .flat_map(|dy| areas[0].iter().map(move |dx| dx * dy));
    let weights: Vec<f64> = cells.zip(density).map(|(area, w)| area * w).collect();
    Ok(SlopeTable::new(grid, &weights).map_err(failed)?.level())
}

/// Halfway between neighbours, and as far beyond the first and the last.
fn edges(nodes: &[f64]) -> Vec<f64> {
    let (first, last) = (nodes[0], nodes.len() - 1);
    let half = |i: usize| 0.5 * (nodes[i + 1] - nodes[i]);
    let inner = (0..last).map(|i| nodes[i] + half(i));
    let outer = [first - half(0), nodes[last] + half(last - 1)];
    [outer[0]]
        .into_iter()
        .chain(inner)
        .chain([outer[1]])
        .collect()
}
