//! Output files: refuses, before any work, those that cannot be written or would replace an input or each other.

use std::path::Path;

use asperity_io::{check_output_file, is_same_file, shown_path};
use asperity_studies::settings::Document;

use crate::failure::Failure;

/// Checks that the files `outputs` can be written, and replace no file that the run of `document` reads.
pub(crate) fn check_outputs(outputs: &[&Path], document: &Document) -> Result<(), Failure> {
    for output in outputs {
        refuse_input(output, document)?;
        check_output_file(output).map_err(Failure::failed)?;
    }
    refuse_equal_names(outputs)
}

/// Refuses the name of a file for a folder that takes several files.
pub(crate) fn refuse_file_name(output: &Path, names_file: bool) -> Result<(), Failure> {
    match names_file {
        true => Err(Failure::usage(format!(
            "-o {} has the ending of a file, and several files are to be written: name a folder",
            shown_path(output)
        ))),
        false => Ok(()),
    }
}

/// Refuses to replace a file that the run of `document` reads.
pub(crate) fn refuse_input(output: &Path, document: &Document) -> Result<(), Failure> {
    let mut inputs = document.input_files().into_iter();
    match inputs.find(|input| is_same_file(output, input)) {
        Some(input) => Err(Failure::usage(format!(
            "{} is the input of this command, which would replace it; choose another output",
            shown_path(&input)
        ))),
        None => Ok(()),
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
            shown_path(path)
        ))),
        None => Ok(()),
    }
}
