//! File set: several files of one kind in a folder, each put in place as soon as it is finished.

use std::path::Path;

use asperity_io::{RESULTS_EPOCH, ResultFolderError};
use asperity_simulate::counted;
use asperity_studies::settings::Document;
use serde_json::Value;

use crate::failure::Failure;
use crate::interrupt;
use crate::output::{print, result_folder, say};

/// Writes the files of these `names` into the folder `path`, each by `write`, which is given its number, the path to write it to and the one
/// that it will have, and returns text to print. Those that an earlier run of the same settings and inputs has finished are kept if it `resumes`.
pub(crate) fn write_files(
    path: &Path,
    names: &[String],
    document: &Document,
    resumes: bool,
    mut write: impl FnMut(usize, &Path, &Path) -> Result<Option<String>, Failure>,
) -> Result<(), Failure> {
    let folder = result_folder(path, document, names)?;
    let settings = settings(document)?;
    let mut kept = folder.resume(&settings, names).map_err(Failure::failed)?;
    kept.retain(|_| resumes);
    let mut done = kept.len();
    if done > 0 {
        let files = counted(done as u64, "file");
        say(&format!(
            "{files} of an earlier run with these settings are kept"
        ));
    }
    for (number, name) in names.iter().enumerate() {
        if kept.contains(name) {
            continue;
        }
        let file = folder.claim(name).map_err(Failure::failed)?;
        let text = write(number, &file, &path.join(name))?;
        done += 1;
        interrupt::put_in_place(|| {
            folder.finish(false)?;
            Ok(format!("{done} of {} files are written", names.len()))
        })
        .map_err(|error: ResultFolderError| Failure::failed(error))?;
        text.map_or(Ok(()), |text| print(&text))?;
    }
    folder.finish(true).map_err(Failure::failed)
}

/// All settings on which the files depend, and the results epoch.
fn settings(document: &Document) -> Result<String, Failure> {
    let mut settings: Value = document.read().map_err(Failure::usage)?;
    if let Some(sections) = settings.as_object_mut() {
        sections.retain(|name, _| !["program", "results"].contains(&name.as_str()));
    }
    Ok(format!("epoch {RESULTS_EPOCH} {settings}"))
}
