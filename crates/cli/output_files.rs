//! Output files: refuses, before any work, those that cannot be written or would replace an input or each other.

use std::path::{Path, PathBuf};

use asperity_io::check_output_file;

use crate::failure::Failure;

/// Checks that the files `outputs` of a command that reads `inputs` can be written.
pub(crate) fn check_outputs(outputs: &[&Path], inputs: &[Option<&Path>]) -> Result<(), Failure> {
    for output in outputs {
        for input in inputs.iter().flatten() {
            refuse_input(output, input)?;
        }
        check_output_file(output).map_err(Failure::failed)?;
    }
    refuse_equal_names(outputs)
}

/// Refuses to replace a file that is read.
fn refuse_input(output: &Path, input: &Path) -> Result<(), Failure> {
    match is_same_file(output, input) {
        true => Err(Failure::usage(format!(
            "{} is the input of this command, which would replace it; choose another output",
            input.display()
        ))),
        false => Ok(()),
    }
}

/// Refuses two outputs of one name.
fn refuse_equal_names(outputs: &[&Path]) -> Result<(), Failure> {
    let named_before = |(i, path): (usize, &&Path)| {
        let mut before = outputs[..i].iter();
        before.any(|other| is_same_file(other, path))
    };
    let mut all = outputs.iter().enumerate();
    match all.find(|output| named_before(*output)) {
        Some((_, path)) => Err(Failure::usage(format!(
            "{} is given as two outputs, one of which would replace the other; choose another name",
            path.display()
        ))),
        None => Ok(()),
    }
}

/// Whether both paths name one file, which need not exist.
pub(crate) fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || place(a).is_some_and(|place_of_a| Some(place_of_a) == place(b))
}

/// The file without links, or the name that a new one has in its folder; `None` if there is no such folder.
fn place(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let path = std::path::absolute(path).ok()?;
        let folder = path.parent()?.canonicalize().ok()?;
        Some(folder.join(path.file_name()?))
    })
}
