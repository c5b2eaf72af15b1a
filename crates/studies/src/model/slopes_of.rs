//! The slopes of a file: those of a height map, or a table of their density.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity_analysis::{
    SlopeCovariance, SlopeDistribution, SlopeGrid, SlopeTable, SlopeTableError, SmithSlopes,
};
use asperity_io::{NumberTable, ReadError, read_height_map, read_number_table, shown_path};
use asperity_simulate::short;
use asperity_surface::{Border, MissingError, MissingPolicy};
use asperity_tally::Estimate;

use crate::config::isotropy::Isotropy;

/// Reasons for which a file gives no slopes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A table has other columns.
    #[error(
        "{}: a table of slopes needs the columns x, y and density, but it has {found}",
        shown_path(path)
    )]
    Columns {
        /// The file.
        path: PathBuf,
        /// Names of the columns that the table has.
        found: String,
    },
    /// Slopes of a table are missing, there twice or out of order.
    #[error(
        "{}: the rows x, y are not those of a grid of at least 2 x 2 slopes, each pair once and in order of y, then x",
        shown_path(path)
    )]
    NoGrid {
        /// The file.
        path: PathBuf,
    },
    /// Missing points of a height map cannot be filled.
    #[error("{}: {error}", shown_path(path))]
    Missing {
        /// The file.
        path: PathBuf,
        /// Reason.
        error: MissingError,
    },
    /// The numbers do not make a table.
    #[error("{}: {error}", shown_path(path))]
    Table {
        /// The file.
        path: PathBuf,
        /// Reason.
        error: SlopeTableError,
    },
    /// A flat surface; or grooves, for a model of Gaussian slopes.
    #[error(
        "{}: the slopes lie along one direction at most, which smith-slopes alone takes, unless all are zero",
        shown_path(path)
    )]
    OneDirection {
        /// The file.
        path: PathBuf,
    },
}

/// Slopes of a file.
pub(super) struct FileSlopes {
    path: PathBuf,
    /// Their density.
    table: SlopeTable,
    covariance: SlopeCovariance,
    /// Notes on the results, one sentence each.
    pub(super) notes: Vec<String>,
}

/// Ratio of the determinant of the slope covariance to the square of its trace below which slopes count as those of grooves.
const GROOVES: f64 = 1e-6;

impl FileSlopes {
    /// The slopes that a height map has, of its facets and less their mean, or those of a table that ends in `.csv`. The table is a density
    /// over the slopes along x and y at points of a grid, on any scale.
    pub(super) fn read(path: &Path) -> Result<Self, SlopeFileError> {
        let is_table = path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
        let mut notes = Vec::new();
        let table = match is_table {
            true => table_of(&read_number_table(path)?)?,
            false => table_of_map(path, &mut notes)?,
        };
        let [xx, xy, yy] = table.second_moments();
        let covariance = SlopeCovariance::new(xx, yy, xy);
        let covariance = covariance.map_err(|_| SlopeFileError::OneDirection {
            path: path.to_owned(),
        })?;
        Ok(Self {
            path: path.to_owned(),
            table,
            covariance,
            notes,
        })
    }

    /// Slopes that the model `name` is made for: the density, or for models of Gaussian slopes their covariance, the same along all directions if
    /// it nearly is.
    ///
    /// # Errors
    /// [`SlopeFileError::OneDirection`] of grooves, whose slopes have no covariance that a model of Gaussian slopes could take.
    pub(super) fn of_model(&mut self, name: &str) -> Result<SlopeDistribution, SlopeFileError> {
        let covariance = self.covariance;
        if name == SmithSlopes::NAME {
            return Ok(SlopeDistribution::Table {
                table: Arc::new(self.table.clone()),
                covariance,
            });
        }
        let determinant = covariance.xx() * covariance.yy() - covariance.xy().powi(2);
        if determinant < GROOVES * (covariance.xx() + covariance.yy()).powi(2) {
            let path = self.path.clone();
            return Err(SlopeFileError::OneDirection { path });
        }
        let terms = [covariance.xx(), covariance.xy(), covariance.yy()];
        let isotropy = Isotropy::of(terms.map(|mean| Estimate { mean, se: None }));
        let mean = 0.5 * (covariance.xx() + covariance.yy());
        Ok(match SlopeCovariance::new(mean, mean, 0.0) {
            Ok(isotropic) if isotropy.is_near => {
                let [larger, smaller] = isotropy.variances.map(short);
                self.notes.push(format!(
                    "slopes are taken as isotropic: their variances along the principal axes are {larger} and {smaller}"
                ));
                isotropic.into()
            }
            _ => covariance.into(),
        })
    }
}

/// Missing points are filled; beyond the border of a map lies nothing.
fn table_of_map(path: &Path, notes: &mut Vec<String>) -> Result<SlopeTable, SlopeFileError> {
    let mut raw = read_height_map(path)?;
    notes.append(&mut raw.notes);
    notes.extend(raw.spacing_note());
    if raw.missing() > 0 {
        notes.push(format!("missing points, {}, were filled", raw.missing()));
    }
    let field = raw.into_height_field(MissingPolicy::Fill, Border::Open);
    let field = field.map_err(|error| SlopeFileError::Missing {
        path: path.to_owned(),
        error,
    })?;
    let slopes = field.slope_samples([1, 1]).concat();
    let mean = |axis: usize| slopes.iter().map(|s| s[axis]).sum::<f64>() / slopes.len() as f64;
    notes.push(format!(
        "the mean slopes, {} along x and {} along y, are taken off",
        short(mean(0)),
        short(mean(1))
    ));
    SlopeTable::of_slopes(&slopes).map_err(|error| SlopeFileError::Table {
        path: path.to_owned(),
        error,
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
