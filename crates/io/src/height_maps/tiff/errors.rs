//! Errors of the TIFF decoder as read errors.

use std::fmt::Display;
use std::path::Path;

use ::tiff::{TiffError, TiffUnsupportedError};

use crate::error::ReadError;
use crate::formats::HeightMapFormat;

pub(super) fn malformed(path: &Path, what: impl Display) -> ReadError {
    ReadError::malformed(path, HeightMapFormat::Tiff, what)
}

pub(super) fn decoding(path: &Path, error: TiffError) -> ReadError {
    match error {
        TiffError::IoError(error) => ReadError::io(path, error),
        TiffError::UnsupportedError(TiffUnsupportedError::UnsupportedCompressionMethod(method)) => {
            let advice = "bring it to one that is with gdal_translate -co COMPRESS=DEFLATE";
            ReadError::unsupported(
                path,
                format!("compression method {method:?} is not supported; {advice}"),
            )
        }
        TiffError::UnsupportedError(what) => ReadError::unsupported(path, what),
        TiffError::FormatError(what) => malformed(path, what),
        other => malformed(path, other),
    }
}
