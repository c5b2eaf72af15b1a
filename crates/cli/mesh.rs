//! `asperity mesh`: the triangles that are traced.

use asperity_io::{MeshFormat, MeshView, write_mesh};
use asperity_surface::LengthUnit;
use asperity_tracer::{Surface, TriangleMesh};

use crate::args::{Common, Mesh};
use crate::failure::Failure;
use crate::input::read_surface;
use crate::output::print;

pub(crate) fn run(command: &Mesh, common: &Common) -> Result<(), Failure> {
    if MeshFormat::from_path(&command.output).is_none() {
        return Err(Failure::usage(format!(
            "{}: a mesh is written as .ply, .obj or .stl",
            command.output.display()
        )));
    }
    let input = read_surface(&command.file, &command.reading, common)?;
    let unit = match input.field.unit() {
        LengthUnit::Arbitrary => "arbitrary units",
        unit => unit.symbol(),
    };
    let mesh = TriangleMesh::new(&Surface::new(input.field)).map_err(Failure::failed)?;
    let view = MeshView {
        vertices: &mesh.vertices,
        triangles: &mesh.triangles,
    };
    write_mesh(&command.output, &view).map_err(Failure::failed)?;
    if common.quiet {
        return Ok(());
    }
    print(&format!(
        "{}: {} vertices, {} triangles, lengths in {unit}\n",
        command.output.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
    ))
}
