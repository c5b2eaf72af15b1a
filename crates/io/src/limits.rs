//! Limits of readers: sizes are checked before memory is taken, and panics of decoders are caught.

use asperity_surface::check_grid;

use crate::error::ReadProblem;
use crate::files::available_memory;

/// Size in bytes from which the available memory is checked first: systems that overcommit would kill the program, and an
/// allocator that ends it leaves no choice.
const LARGE: usize = 1 << 20;

/// Room for `nx * ny` numbers, or an error where there is none.
pub(crate) fn room<T>(nx: u64, ny: u64) -> Result<Vec<T>, ReadProblem> {
    let refuse = || ReadProblem::OutOfMemory { nx, ny };
    let count = nx
        .checked_mul(ny)
        .and_then(|n| usize::try_from(n).ok())
        .ok_or_else(refuse)?;
    let bytes = count.saturating_mul(size_of::<T>());
    if bytes > LARGE && available_memory().is_some_and(|available| bytes as u64 > available) {
        return Err(refuse());
    }
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(count).map_err(|_| refuse())?;
    Ok(numbers)
}

/// Checks a claimed grid against the bytes that are there for it, before anything is allocated.
///
/// `bytes_each` is the least that one sample takes.
pub(crate) fn check_claim(
    [ny, nx]: [u64; 2],
    bytes_each: u64,
    length: u64,
) -> Result<(), ReadProblem> {
    match bytes_of([ny, nx], bytes_each) {
        Some(bytes) if bytes <= length => Ok(()),
        _ => Err(too_large([ny, nx], length)),
    }
}

/// More than a lossless method compresses (deflate at most by 1032).
pub(crate) const COMPRESSION_LIMIT: u64 = 1100;

/// [`check_claim`] for data that may be compressed, by [`COMPRESSION_LIMIT`] at most.
pub(crate) fn check_packed_claim(
    [ny, nx]: [u64; 2],
    bytes_each: u64,
    length: u64,
) -> Result<(), ReadProblem> {
    check_claim(
        [ny, nx],
        bytes_each,
        length.saturating_mul(COMPRESSION_LIMIT),
    )
    .map_err(|_| too_large([ny, nx], length))
}

/// Checks grid and spacing of data that are not compressed and end with the file: `data_length`
/// of its `length` bytes are left for samples of `bytes_each`. Returns the shape `[ny, nx]`.
pub(crate) fn check_plain_data(
    [ny, nx]: [u64; 2],
    spacing: [f64; 2],
    bytes_each: u64,
    [data_length, length]: [u64; 2],
) -> Result<[usize; 2], ReadProblem> {
    let needed = bytes_of([ny, nx], bytes_each)
        // Truncation rarely leaves less than a thousandth of a file: such a header is wrong.
        .filter(|needed| needed / 1024 <= length)
        .ok_or_else(|| too_large([ny, nx], length))?;
    let shape = [ny, nx].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    check_grid(shape, spacing)?;
    if needed > data_length {
        return Err(ReadProblem::truncated(format_args!(
            "{nx} x {ny} samples of {bytes_each} bytes were expected, but only {data_length} bytes are there"
        )));
    }
    if needed < data_length {
        let extra = data_length - needed;
        return Err(ReadProblem::malformed(format_args!(
            "{extra} bytes follow its {nx} x {ny} samples"
        )));
    }
    Ok(shape)
}

fn bytes_of([ny, nx]: [u64; 2], bytes_each: u64) -> Option<u64> {
    nx.checked_mul(ny)?.checked_mul(bytes_each)
}

fn too_large([ny, nx]: [u64; 2], length: u64) -> ReadProblem {
    ReadProblem::TooLarge { nx, ny, length }
}

/// Runs a decoder of another crate so that a panic inside it becomes `None`.
///
/// The EXR and NPY decoders assert, multiply and index by what the file says. The checks before
/// them leave no way to such a panic that the tests with damaged files would have found; should
/// there be one, its message goes to standard error and the file is reported as damaged.
pub(crate) fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    // What the closure borrows is dropped after a panic, never used again.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)).ok()
}

/// Runs the decoder of a height map in [`guarded`]: a file on which it panics is reported as damaged.
pub(crate) fn read_guarded<T>(
    decode: impl FnOnce() -> Result<T, ReadProblem>,
) -> Result<T, ReadProblem> {
    guarded(decode).unwrap_or_else(|| Err(ReadProblem::malformed("its content is damaged")))
}
