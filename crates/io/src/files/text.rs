//! Configurations and results: files, text and JSON, read whole.

use std::io::Read;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::open::open;
use crate::error::{ReadError, ReadProblem};

/// Reads a whole file, which may be empty.
///
/// # Errors
/// [`ReadError`] if it does not exist or is not a regular file.
pub fn read_bytes(path: impl AsRef<Path>) -> Result<Vec<u8>, ReadError> {
    let path = path.as_ref();
    let read = || {
        let (mut file, length) = match open(path) {
            Err(ReadProblem::Empty) => return Ok(Vec::new()),
            other => other?,
        };
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        file.read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|problem: ReadProblem| problem.at(path))
}

/// Reads a whole text file in UTF-8, which may be empty.
///
/// # Errors
/// [`ReadError`] if it does not exist, is not a regular file or not UTF-8.
pub fn read_text(path: impl AsRef<Path>) -> Result<String, ReadError> {
    let path = path.as_ref();
    String::from_utf8(read_bytes(path)?).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|byte| **byte == b'\n').count();
        let column = 1 + valid
            .iter()
            .rev()
            .take_while(|byte| **byte != b'\n')
            .count();
        let what = "bytes that are not UTF-8 text were found".to_owned();
        ReadProblem::Text { line, column, what }.at(path)
    })
}

/// Reads a value from a JSON file.
///
/// # Errors
/// [`ReadError`] if [`read_text`] fails, with [`ReadProblem::Malformed`] if the text does not hold such a value.
pub(crate) fn read_json<T: DeserializeOwned>(path: impl AsRef<Path>) -> Result<T, ReadError> {
    let path = path.as_ref();
    let value = serde_json::from_str(&read_text(path)?);
    value.map_err(|error| ReadProblem::malformed(error).in_format(path, "JSON file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_is_read_back_and_errors_name_line_and_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        crate::write_json(&path, &[0.1, 1.0 / 3.0]).unwrap();
        assert_eq!(
            read_text(&path).unwrap(),
            "[\n  0.1,\n  0.3333333333333333\n]\n"
        );
        assert_eq!(read_json::<Vec<f64>>(&path).unwrap(), [0.1, 1.0 / 3.0]);
        let error = read_json::<Vec<String>>(&path).unwrap_err().to_string();
        assert!(
            error.contains("a.json") && error.contains("line 2"),
            "{error}"
        );
        crate::write_bytes(&path, b"ab\nc\xff").unwrap();
        let error = read_text(&path).unwrap_err();
        assert!(
            matches!(
                error.problem,
                ReadProblem::Text {
                    line: 2,
                    column: 2,
                    ..
                }
            ),
            "{error}"
        );
        crate::write_bytes(&path, b"").unwrap();
        assert_eq!(read_text(&path).unwrap(), "");
    }
}
