//! Mesh: height maps as triangles.

use std::path::Path;

use asperity_io::{MeshFormat, MeshView, WriteError, shown_path, write_mesh};
use asperity_simulate::{Cells, Observer, check_memory, short};
use asperity_surface::{HeightField, LengthUnit, SplineSurface};
use asperity_tracer::{Surface, TriangleMesh};
use serde::Deserialize;

use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::trace::CellsConfig;
use crate::error::StudyError;
use crate::output::wrapped;
use crate::settings::Document;

/// Bytes per cell of the height field and its triangles.
const BYTES_PER_CELL: usize = 64;

/// A height map, and how fine its triangles are.
#[derive(Clone, Debug, Deserialize)]
pub struct MeshConfig {
    /// The cells between heights.
    pub surface: CellsConfig,
    /// The height map.
    pub measured: MeasuredConfig,
    /// The triangles of smooth cells.
    pub mesh: FinenessConfig,
}

/// `[mesh]`: how fine the triangles of smooth cells are.
#[derive(Clone, Debug, Deserialize)]
pub struct FinenessConfig {
    /// Parts of a cell along each axis.
    pub subdivide: Option<usize>,
    /// Largest distance from the smooth surface, in the unit of the heights.
    pub deviation: Option<f64>,
    /// Ending of the files of several meshes.
    pub format: String,
}

/// The triangles of a height map.
pub struct MeshedSurface {
    mesh: TriangleMesh,
    /// Unit of the lengths.
    unit: LengthUnit,
    /// The surface and the distance from it, where cells are smooth.
    comment: String,
}

impl MeshedSurface {
    /// Writes the triangles.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written, or its format cannot hold the mesh.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let view = MeshView {
            vertices: &self.mesh.vertices,
            triangles: &self.mesh.triangles,
            comment: &self.comment,
        };
        write_mesh(path, &view)
    }

    /// Text on the mesh that was written as `path`.
    #[must_use]
    pub fn text(&self, path: &Path) -> String {
        let unit = match self.unit {
            LengthUnit::Arbitrary => "arbitrary units",
            unit => unit.symbol(),
        };
        let mut text = format!(
            "{}: {} vertices, {} triangles, lengths in {unit}\n",
            shown_path(path),
            self.mesh.vertices.len(),
            self.mesh.triangles.len(),
        );
        if !self.comment.is_empty() {
            text.push_str(&format!("{}\n", self.comment));
            if MeshFormat::from_path(path) == Some(MeshFormat::Stl) {
                text.push_str(
                    "note: STL rounds coordinates to single precision, which this distance leaves out\n",
                );
            }
        }
        wrapped(&text)
    }
}

impl MeshConfig {
    /// The height maps, and the names that their meshes have in a folder.
    ///
    /// # Errors
    /// [`StudyError`] if no height map is given, or two meshes would have the same name.
    pub fn files(&self, document: &Document) -> Result<Vec<(&Path, String)>, StudyError> {
        self.measured.required_file(document)?;
        let mut files: Vec<(&Path, String)> = Vec::new();
        for path in self.measured.files() {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let name = format!("{stem}.{}", self.mesh.format);
            if let Some((other, _)) = files.iter().find(|(_, given)| *given == name) {
                return Err(ConfigError::unsuitable(
                    format!("{} and {}", shown_path(other), shown_path(path)),
                    format!("the meshes of both would be {name}; mesh them one by one"),
                )
                .into());
            }
            files.push((path, name));
        }
        Ok(files)
    }

    /// Reads the height map `file`, and divides it into triangles. `document` is that of the configuration.
    ///
    /// # Errors
    /// [`StudyError`] if it cannot be read, or the triangles cannot be as near as requested or held in memory.
    pub fn triangles(
        &self,
        file: &Path,
        document: &Document,
        observer: &dyn Observer,
    ) -> Result<MeshedSurface, StudyError> {
        let field = self.measured.read_height_map(file, observer)?.field;
        let unit = field.unit();
        let (field, comment) = match self.surface.cells.of_given() {
            Cells::Flat => (field, String::new()),
            Cells::Smooth => {
                let config: Self = document.clone().in_unit(unit)?.read()?;
                config.mesh.tessellated(&field)?
            }
        };
        Ok(MeshedSurface {
            mesh: TriangleMesh::new(&Surface::new(field))?,
            unit,
            comment,
        })
    }
}

impl FinenessConfig {
    /// The heights of the smooth surface on a finer grid, and how far its triangles are from it.
    fn tessellated(self, field: &HeightField) -> Result<(HeightField, String), StudyError> {
        let surface = SplineSurface::through(field);
        let unit = field.unit().suffix();
        let per_cell = match (self.deviation, self.subdivide) {
            (Some(most), _) => surface.per_cell_within(most).ok_or_else(|| {
                let least = rounded_up(surface.deviation(usize::MAX));
                ConfigError::unsuitable(
                    format!("--deviation {}{unit}", short(most)),
                    format!(
                        "must be above {least}{unit}, to which heights of this surface are rounded"
                    ),
                )
            })?,
            (None, subdivide) => subdivide.unwrap_or(1),
        };
        let [cx, cy] = surface.cells().map(|cells| cells.saturating_mul(per_cell));
        let bytes = cx.saturating_mul(cy).saturating_mul(BYTES_PER_CELL);
        check_memory("this mesh", bytes)?;
        let fine = surface.tessellated(per_cell)?;
        let deviation = rounded_up(surface.deviation(per_cell));
        let comment = format!(
            "bicubic B-spline, {per_cell} x {per_cell} parts per cell, at most {deviation}{unit} off"
        );
        Ok((fine, comment))
    }
}

/// Four digits of a length, no less than it.
fn rounded_up(length: f64) -> String {
    // Printing rounds down by half a unit of the last digit at most
    format!("{:.3e}", length * (1.0 + 5.01e-4))
}
