//! Output: result folders, and standard output, which may be a closed pipe or a full disk.

use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use asperity_io::{ResultFolder, ResultFolderError, json_text, printable};
use asperity_studies::settings::Document;
use asperity_studies::share_of;
use serde::Serialize;

use crate::failure::Failure;
use crate::output_files::refuse_input;

/// Arguments of the command line, without the name of the program.
static ARGUMENTS: OnceLock<Vec<String>> = OnceLock::new();

/// Keeps the arguments of the command line for the manifests of result folders.
pub(crate) fn keep_arguments(arguments: &[OsString]) {
    let own = arguments.iter().skip(1);
    let own = own.map(|argument| argument.to_string_lossy().into_owned());
    ARGUMENTS.get_or_init(|| own.collect());
}

/// Prints `text`; a reader that has gone away is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out
        .write_all(printable(text).as_bytes())
        .and_then(|()| out.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::failed(format!(
            "standard output could not be written: {error}"
        ))),
        _ => Ok(()),
    }
}

/// Prints `value` as JSON.
pub(crate) fn print_json<T: Serialize>(value: &T) -> Result<(), Failure> {
    let mut text = json_text(value).map_err(Failure::failed)?;
    text.push('\n');
    print(&text)
}

/// Prints a line on standard error; a closed standard error is ignored.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(text));
}

/// Prints a note on standard error for each of `notes`.
pub(crate) fn say_notes(notes: &[String]) {
    for note in notes {
        say(&format!("note: {note}"));
    }
}

/// Times that a shard tries again to open a folder which another run uses, and the time between them.
const TRIES: u32 = 20;
const BETWEEN_TRIES: Duration = Duration::from_millis(500);

/// Opens the folder `path` for the results of the command of `document`, which writes files of these `names`.
/// Refuses a folder in which one of them would replace an input, or a file that is not a result of that command.
pub(crate) fn result_folder(
    path: &Path,
    document: &Document,
    names: &[String],
) -> Result<ResultFolder, Failure> {
    refuse_input(path, document)?;
    let inputs = document.input_files();
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let command = document.command().name();
    let arguments = ARGUMENTS.get().cloned().unwrap_or_default();
    let mut tries = 0;
    let folder = loop {
        match ResultFolder::open(path, command, &inputs) {
            // A queue may start a lost shard again before the system has ended it elsewhere.
            Err(ResultFolderError::InUse { .. })
                if tries < TRIES && share_of(document).is_some() =>
            {
                tries += 1;
                std::thread::sleep(BETWEEN_TRIES);
            }
            opened => break opened.map_err(Failure::failed)?.with_arguments(arguments),
        }
    };
    folder.check(names).map_err(Failure::failed)?;
    Ok(folder)
}
