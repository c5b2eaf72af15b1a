//! `asperity mesh`: a height map as triangles.

use asperity_io::{MeshFormat, MeshView, write_mesh};
use asperity_studies::settings::Document;
use asperity_studies::{MeshConfig, wrapped};
use asperity_surface::LengthUnit;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::print;
use crate::output_files::check_outputs;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config: MeshConfig = document.read().map_err(Failure::usage)?;
    let output = Results::of(document).map_err(Failure::usage)?.required();
    let format = MeshFormat::from_path(&output).ok_or_else(|| {
        let output = output.display();
        Failure::usage(format!("{output}: a mesh is written as .ply, .obj or .stl"))
    })?;
    check_outputs(&[&output], document)?;
    let meshed = config.triangles(document, common).map_err(refused)?;
    let (mesh, comment) = (&meshed.mesh, meshed.comment.as_str());
    let view = MeshView {
        vertices: &mesh.vertices,
        triangles: &mesh.triangles,
        comment,
    };
    write_mesh(&output, &view).map_err(Failure::failed)?;
    if common.quiet {
        return Ok(End::Complete);
    }
    let unit = match meshed.unit {
        LengthUnit::Arbitrary => "arbitrary units",
        unit => unit.symbol(),
    };
    let mut text = format!(
        "{}: {} vertices, {} triangles, lengths in {unit}\n",
        output.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
    );
    if !comment.is_empty() {
        text.push_str(&format!("{comment}\n"));
        if format == MeshFormat::Stl {
            text.push_str(
                "note: STL rounds coordinates to single precision, which this distance leaves out\n",
            );
        }
    }
    print(&wrapped(&text))?;
    Ok(End::Complete)
}
