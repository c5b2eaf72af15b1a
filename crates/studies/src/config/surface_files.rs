//! `[surface]`: spectra and distributions of heights that come from files.

mod error;
mod source;

use std::path::Path;

use asperity_io::{NumberTable, ReadProblem, read_number_table, shown_path};
use asperity_numerics::fnv1a;
use asperity_surface::LengthUnit;
use asperity_synthesis::{HeightTable, Psd, PsdError, RadialTable};
use serde::Serialize;

pub use self::error::SurfaceFileError;
use self::source::Source;
use super::surface::SurfaceConfig;
use super::surface_choices::{HeightsChoice, Spectrum};
use crate::settings::LIKE;

impl SurfaceConfig {
    /// Reads the files that `psd` and `heights` name, if they do. A surface without a unit takes that of a height map; tables are in the unit
    /// of the surface. Returns what a reader of the results should know about height maps.
    ///
    /// # Errors
    /// [`SurfaceFileError`].
    pub fn read_files(&mut self) -> Result<Vec<String>, SurfaceFileError> {
        let mut notes = Vec::new();
        if let Spectrum::File { psd: path } = &self.spectrum {
            let path = path.clone();
            let psd = match like(&path) {
                Some(map) => self.read_map(map, &mut notes)?.psd,
                None => {
                    let names = "gaussian, exponential, matern and power-law";
                    psd_of(&read_table("--psd", names, &path)?)?
                }
            };
            self.files.hashes.push(hash_of(&psd));
            self.files.psd = Some(psd);
        }
        let heights = self.heights.as_ref().and_then(HeightsChoice::file);
        if let Some(path) = heights.map(Path::to_owned) {
            let heights = match like(&path) {
                Some(map) => {
                    let field = self.read_map(map, &mut notes)?.field;
                    let path = map.to_owned();
                    HeightTable::like(&field)
                        .map_err(|error| SurfaceFileError::Heights { path, error })?
                }
                None => heights_of(&read_table("--heights", "gaussian", &path)?)?,
            };
            self.files.hashes.push(hash_of(&heights));
            self.files.heights = Some(heights);
        }
        Ok(notes)
    }

    /// A height map in the unit of the surface. Adds its notes, those of one map once.
    fn read_map(
        &mut self,
        path: &Path,
        notes: &mut Vec<String>,
    ) -> Result<Source, SurfaceFileError> {
        let source = Source::read(path, self.unit)?;
        if self.unit == LengthUnit::Arbitrary {
            self.unit = source.field.unit();
        }
        for note in &source.notes {
            if !notes.contains(note) {
                notes.push(note.clone());
            }
        }
        Ok(source)
    }
}

fn hash_of(read: &impl Serialize) -> String {
    let text = serde_json::to_vec(read).unwrap_or_default();
    format!("{:016x}", fnv1a(text))
}

/// The height map of `like:FILE`.
fn like(path: &Path) -> Option<&Path> {
    path.to_str()?.strip_prefix(LIKE).map(Path::new)
}

fn read_table(
    setting: &'static str,
    names: &'static str,
    path: &Path,
) -> Result<NumberTable, SurfaceFileError> {
    match read_number_table(path) {
        Err(error)
            if path.extension().is_none() && matches!(error.problem, ReadProblem::NotFound) =>
        {
            Err(SurfaceFileError::Unknown {
                setting,
                name: shown_path(path),
                names,
            })
        }
        table => Ok(table?),
    }
}

/// A radial table, or one over the plane of wave vectors.
fn psd_of(table: &NumberTable) -> Result<Psd, SurfaceFileError> {
    let failed = |error: PsdError| SurfaceFileError::Spectrum {
        path: table.path().to_owned(),
        error: error.into(),
    };
    let column = |name| table.column(name).map(<[f64]>::to_vec);
    let density = column("density");
    if let (Some(k), Some(density)) = (column("k"), density.clone()) {
        let table = RadialTable::new(k, density).map_err(|error| failed(error.into()))?;
        return Psd::of_radial_table(table, None).map_err(failed);
    }
    let (Some(kx), Some(ky), Some(density)) = (column("kx"), column("ky"), density) else {
        return Err(wrong_columns(
            table,
            "--psd",
            "k and density, or kx, ky and density",
        ));
    };
    let columns = ky.iter().take_while(|k| **k == ky[0]).count();
    let is_grid = columns > 0
        && kx.len().is_multiple_of(columns)
        && kx.chunks(columns).all(|row| row == &kx[..columns])
        && ky
            .chunks(columns)
            .all(|row| row.iter().all(|k| *k == row[0]));
    if !is_grid {
        return Err(SurfaceFileError::Content {
            path: table.path().to_owned(),
            subject: "--psd",
            needed: "the rows kx, ky of a grid, each pair once and in order of ky, then kx"
                .to_owned(),
            found: "others".to_owned(),
        });
    }
    let rows = ky.iter().step_by(columns).copied().collect();
    Psd::of_plane_table(kx[..columns].to_vec(), rows, density, None).map_err(failed)
}

/// Cumulative probabilities, or densities.
fn heights_of(table: &NumberTable) -> Result<HeightTable, SurfaceFileError> {
    let distribution = match (
        table.column("height"),
        table.column("probability"),
        table.column("density"),
    ) {
        (Some(heights), Some(probabilities), _) => {
            HeightTable::of_probabilities(heights, probabilities)
        }
        (Some(heights), None, Some(densities)) => HeightTable::of_densities(heights, densities),
        _ => {
            return Err(wrong_columns(
                table,
                "--heights",
                "height and probability, or height and density",
            ));
        }
    };
    distribution.map_err(|error| SurfaceFileError::Heights {
        path: table.path().to_owned(),
        error,
    })
}

fn wrong_columns(
    table: &NumberTable,
    subject: &'static str,
    expected: &'static str,
) -> SurfaceFileError {
    SurfaceFileError::Content {
        path: table.path().to_owned(),
        subject,
        needed: format!("the columns {expected}"),
        found: table.names().join(", "),
    }
}
