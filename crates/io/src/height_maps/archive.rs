//! Parts of a ZIP archive: reads them within limits.

use std::borrow::Cow;
use std::io::{Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::ReadProblem;
use crate::limits::{COMPRESSION_LIMIT, room};
use crate::text_lines::short;

/// The parts of the archive.
pub(super) struct Parts<R> {
    archive: ZipArchive<R>,
    /// Folder of the archive that all parts are in; empty for none.
    folder: String,
    pub(super) length: u64,
}

impl<R: Read + Seek> Parts<R> {
    /// Opens the archive in a file of `length` bytes.
    pub(super) fn open(reader: R, length: u64) -> Result<Self, ReadProblem> {
        let archive = ZipArchive::new(reader).map_err(|_| {
            ReadProblem::malformed("it is not a complete ZIP archive; it may be cut short")
        })?;
        Ok(Self {
            archive,
            folder: String::new(),
            length,
        })
    }

    /// Takes names of parts as those of the folder that the part `main` is in, and returns its name.
    pub(super) fn enter(&mut self, main: &str) -> Result<String, ReadProblem> {
        let names = self.names().filter_map(|name| {
            let name = with_slashes(&name);
            let (folder, last) = name.rsplit_once('/').unwrap_or(("", &name));
            // A Mac adds a folder of its own files.
            let is_main = last.eq_ignore_ascii_case(main) && !folder.starts_with("__MACOSX");
            is_main.then(|| folder.to_owned())
        });
        let mut folders: Vec<String> = names.collect();
        folders.sort_by_key(String::len);
        match folders.as_slice() {
            [first, second, ..] if !first.is_empty() => {
                return Err(ReadProblem::unsupported(format_args!(
                    "it has a part `{main}` in two folders, `{}` and `{}`",
                    short(first),
                    short(second)
                )));
            }
            [first, ..] => self.folder.clone_from(first),
            [] => {}
        }
        Ok(self.resolve(main))
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.archive.index_for_name(name).is_some()
    }

    /// Reads a whole part whose claimed length `allowed` accepts.
    pub(super) fn read(
        &mut self,
        name: &str,
        allowed: impl Fn(u64) -> bool,
    ) -> Result<Vec<u8>, ReadProblem> {
        self.take(name, allowed, |size, reader| {
            let mut bytes: Vec<u8> = room(size, 1)?;
            bytes.resize(size as usize, 0);
            reader
                .read_exact(&mut bytes)
                .map_err(|e| unpacking(name, e))?;
            Ok(bytes)
        })
    }

    /// Reads a part with `take`, and checks that all of it is taken.
    pub(super) fn take<T>(
        &mut self,
        name: &str,
        allowed: impl Fn(u64) -> bool,
        take: impl FnOnce(u64, &mut dyn Read) -> Result<T, ReadProblem>,
    ) -> Result<T, ReadProblem> {
        let mut part = self.archive.by_name(name).map_err(|error| match error {
            ZipError::FileNotFound => {
                ReadProblem::malformed(format_args!("it has no part `{name}`"))
            }
            ZipError::Io(error) => unpacking(name, error),
            other => {
                ReadProblem::malformed(format_args!("its part `{name}` cannot be read ({other})"))
            }
        })?;
        let size = part.size();
        let packed = part.compressed_size().min(self.length);
        if size > packed.saturating_mul(COMPRESSION_LIMIT) || !allowed(size) {
            return Err(ReadProblem::malformed(format_args!(
                "its part `{name}` claims {size} bytes, which is more than it can hold or not what its grid needs"
            )));
        }
        let taken = take(size, &mut part)?;
        // The end of a part is where its own checksum is verified.
        match part.read(&mut [0]) {
            Ok(0) => Ok(taken),
            Ok(_) => Err(ReadProblem::malformed(format_args!(
                "its part `{name}` is longer than the {size} bytes it claims"
            ))),
            Err(error) => Err(unpacking(name, error)),
        }
    }

    /// The name of a part as the archive spells it: some programs write `\` into one of the two.
    pub(super) fn resolve(&self, name: &str) -> String {
        let name = with_slashes(name);
        let name = name.trim_start_matches("./").trim_start_matches('/');
        let whole = match self.folder.as_str() {
            "" => name.to_owned(),
            folder => format!("{folder}/{name}"),
        };
        let mut names = self.names();
        let found = names.find(|own| with_slashes(own).eq_ignore_ascii_case(&whole));
        found.map_or_else(|| name.to_owned(), Cow::into_owned)
    }

    fn names(&self) -> impl Iterator<Item = Cow<'_, str>> {
        self.archive.file_names().filter_map(Result::ok)
    }
}

fn with_slashes(name: &str) -> String {
    name.replace('\\', "/")
}

pub(super) fn unpacking(name: &str, error: std::io::Error) -> ReadProblem {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            ReadProblem::truncated(format_args!("its part `{name}` stops in its middle"))
        }
        std::io::ErrorKind::InvalidData
        | std::io::ErrorKind::InvalidInput
        | std::io::ErrorKind::Other => {
            ReadProblem::malformed(format_args!("its part `{name}` is damaged ({error})"))
        }
        _ => error.into(),
    }
}
