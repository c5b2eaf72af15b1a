//! `asperity mesh`: height maps as triangles.

use std::path::Path;

use asperity_io::MeshFormat;
use asperity_studies::MeshConfig;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::file_set::write_files;
use crate::output::print;
use crate::output_files::{check_outputs, refuse_file_name};

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config: MeshConfig = document.read().map_err(Failure::usage)?;
    let output = Results::of(document).map_err(Failure::usage)?.required();
    let files = config.files(document).map_err(refused)?;
    let write = |file: &Path, path: &Path, place: &Path| {
        let surface = config.triangles(file, document, common).map_err(refused)?;
        surface.write(path).map_err(Failure::failed)?;
        Ok((!common.quiet).then(|| surface.text(place)))
    };
    if let [(file, _)] = files.as_slice() {
        MeshFormat::of_output(&output).map_err(Failure::usage)?;
        check_outputs(&[&output], document)?;
        write(file, &output, &output)?.map_or(Ok(()), |text| print(&text))?;
    } else {
        refuse_file_name(&output, MeshFormat::from_path(&output).is_some())?;
        let names: Vec<String> = files.iter().map(|(_, name)| name.clone()).collect();
        write_files(&output, &names, document, true, |number, path, place| {
            write(files[number].0, path, place)
        })?;
    }
    Ok(End::Complete)
}
