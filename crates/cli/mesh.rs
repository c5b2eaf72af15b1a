//! `asperity mesh`: the triangles that are traced.

use asperity_io::{MeshFormat, MeshView, write_mesh};
use asperity_studies::MeasuredConfig;
use asperity_studies::settings::Document;
use asperity_surface::LengthUnit;
use asperity_tracer::{Surface, TriangleMesh};
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::input::{read_surface, required_file};
use crate::output::print;

/// What is read.
#[derive(Deserialize)]
struct Settings {
    measured: MeasuredConfig,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    document.check_required().map_err(Failure::usage)?;
    let Settings { measured } = document.read().map_err(Failure::usage)?;
    let output = Results::of(document).map_err(Failure::usage)?.required();
    if MeshFormat::from_path(&output).is_none() {
        return Err(Failure::usage(format!(
            "{}: a mesh is written as .ply, .obj or .stl",
            output.display()
        )));
    }
    let file = required_file(&measured, document.command())?;
    let input = read_surface(file, &measured, common)?;
    let unit = match input.field.unit() {
        LengthUnit::Arbitrary => "arbitrary units",
        unit => unit.symbol(),
    };
    let mesh = TriangleMesh::new(&Surface::new(input.field)).map_err(Failure::failed)?;
    let view = MeshView {
        vertices: &mesh.vertices,
        triangles: &mesh.triangles,
    };
    write_mesh(&output, &view).map_err(Failure::failed)?;
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}: {} vertices, {} triangles, lengths in {unit}\n",
        output.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
    ))
}
