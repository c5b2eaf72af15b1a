//! Errors of the TIFF decoder as read errors.

use ::tiff::{TiffError, TiffUnsupportedError};

use crate::error::ReadProblem;

impl From<TiffError> for ReadProblem {
    fn from(error: TiffError) -> Self {
        match error {
            TiffError::IoError(error) => error.into(),
            TiffError::UnsupportedError(TiffUnsupportedError::UnsupportedCompressionMethod(
                method,
            )) => Self::unsupported(format_args!(
                "compression method {method:?} is not supported; bring it to one that is with gdal_translate -co COMPRESS=DEFLATE"
            )),
            TiffError::UnsupportedError(what) => Self::unsupported(what),
            TiffError::FormatError(what) => Self::malformed(what),
            other => Self::malformed(other),
        }
    }
}
