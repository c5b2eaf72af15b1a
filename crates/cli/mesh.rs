//! `asperity mesh`: height maps as triangles.

use asperity_io::MeshFormat;
use asperity_studies::MeshConfig;
use asperity_studies::settings::Document;

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output::{print, result_folder};
use crate::output_files::{check_outputs, refuse_file_name};

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config: MeshConfig = document.read().map_err(Failure::usage)?;
    let output = Results::of(document).map_err(Failure::usage)?.required();
    let files = config.files(document).map_err(refused)?;
    let folder = match files.as_slice() {
        [_] => {
            MeshFormat::of_output(&output).map_err(Failure::usage)?;
            check_outputs(&[&output], document)?;
            None
        }
        _ => {
            refuse_file_name(&output, MeshFormat::from_path(&output).is_some())?;
            let names: Vec<String> = files.iter().map(|(_, name)| name.clone()).collect();
            Some(result_folder(&output, document, &names)?)
        }
    };
    for (file, name) in &files {
        let surface = config.triangles(file, document, common).map_err(refused)?;
        let path = match &folder {
            Some(folder) => folder.claim(name).map_err(Failure::failed)?,
            None => output.clone(),
        };
        surface.write(&path).map_err(Failure::failed)?;
        if !common.quiet {
            print(&surface.text(&path))?;
        }
    }
    if let Some(folder) = folder {
        folder.finish(true).map_err(Failure::failed)?;
    }
    Ok(End::Complete)
}
