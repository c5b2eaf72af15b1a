//! `asperity mesh`: a height map as triangles.

use asperity_io::{MeshFormat, MeshView, write_mesh};
use asperity_simulate::{Cells, check_memory, short};
use asperity_studies::settings::Document;
use asperity_studies::{CellsConfig, MeasuredConfig, wrapped};
use asperity_surface::{HeightField, LengthUnit, SplineSurface};
use asperity_tracer::{Surface, TriangleMesh};
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::input::{read_surface, required_file};
use crate::output::print;
use crate::output_files::check_outputs;

/// Bytes per cell of the height field and its triangles.
const BYTES_PER_CELL: usize = 64;

/// What is read, and how fine its triangles are.
#[derive(Deserialize)]
struct Settings {
    surface: CellsConfig,
    measured: MeasuredConfig,
    mesh: Fineness,
}

/// How fine the triangles of smooth cells are.
#[derive(Clone, Copy, Deserialize)]
struct Fineness {
    subdivide: Option<usize>,
    deviation: Option<f64>,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    document.check_required().map_err(Failure::usage)?;
    let settings: Settings = document.read().map_err(Failure::usage)?;
    let cells = settings.surface.cells.of_given();
    if cells == Cells::Flat && document.is_given("mesh.*") {
        return Err(Failure::usage(
            "--subdivide and --deviation are for --cells smooth; flat cells are two triangles each",
        ));
    }
    let output = Results::of(document).map_err(Failure::usage)?.required();
    if MeshFormat::from_path(&output).is_none() {
        return Err(Failure::usage(format!(
            "{}: a mesh is written as .ply, .obj or .stl",
            output.display()
        )));
    }
    let measured = &settings.measured;
    let file = required_file(measured, document.command())?;
    check_outputs(&[&output], &[Some(file), document.file()])?;
    let field = read_surface(file, measured, common)?.field;
    let unit = match field.unit() {
        LengthUnit::Arbitrary => "arbitrary units",
        unit => unit.symbol(),
    };
    let (field, comment) = match cells {
        Cells::Flat => (field, String::new()),
        Cells::Smooth => {
            let document = document.clone().in_unit(field.unit());
            let settings: Settings = document
                .and_then(|document| document.read())
                .map_err(Failure::usage)?;
            settings.mesh.tessellated(&field)?
        }
    };
    let mesh = TriangleMesh::new(&Surface::new(field)).map_err(Failure::failed)?;
    let view = MeshView {
        vertices: &mesh.vertices,
        triangles: &mesh.triangles,
        comment: &comment,
    };
    write_mesh(&output, &view).map_err(Failure::failed)?;
    if common.quiet {
        return Ok(End::Complete);
    }
    let mut text = format!(
        "{}: {} vertices, {} triangles, lengths in {unit}\n",
        output.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
    );
    if !comment.is_empty() {
        text.push_str(&format!("{comment}\n"));
        if MeshFormat::from_path(&output) == Some(MeshFormat::Stl) {
            text.push_str(
                "note: STL rounds coordinates to single precision, which this distance leaves out\n",
            );
        }
    }
    print(&wrapped(&text))?;
    Ok(End::Complete)
}

impl Fineness {
    /// The heights of the smooth surface on a finer grid, and how far its triangles are from it.
    fn tessellated(self, field: &HeightField) -> Result<(HeightField, String), Failure> {
        let surface = SplineSurface::through(field);
        let per_cell = match (self.deviation, self.subdivide) {
            (Some(most), _) => surface.per_cell_within(most).ok_or_else(|| {
                let unit = field.unit().suffix();
                Failure::usage(format!(
                    "--deviation {}{unit}: must be above {}{unit}, to which heights of this surface are rounded",
                    short(most),
                    rounded_up(surface.deviation(usize::MAX))
                ))
            })?,
            (None, subdivide) => subdivide.unwrap_or(1),
        };
        let [cx, cy] = surface.cells().map(|cells| cells.saturating_mul(per_cell));
        let bytes = cx.saturating_mul(cy).saturating_mul(BYTES_PER_CELL);
        check_memory("this mesh", bytes).map_err(Failure::failed)?;
        let fine = surface.tessellated(per_cell).map_err(Failure::failed)?;
        let deviation = rounded_up(surface.deviation(per_cell));
        let unit = field.unit().suffix();
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
