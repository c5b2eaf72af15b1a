//! Memory that may be refused.

use super::error::SynthesisError;

/// An empty vector with room for `len`, or an error where `Vec::with_capacity` would abort.
pub(super) fn reserved<T>(len: usize) -> Result<Vec<T>, SynthesisError> {
    let mut values = Vec::new();
    values
        .try_reserve_exact(len)
        .map_err(|_| SynthesisError::OutOfMemory {
            bytes: len.saturating_mul(size_of::<T>()),
        })?;
    Ok(values)
}

/// `len` zeros, whose pages the system provides when they are first written, by the threads that
/// write them.
///
/// The memory is reserved twice, since the vector that is quick to zero cannot report a refusal.
pub(super) fn zeroed<T: Copy>(zero: T, len: usize) -> Result<Vec<T>, SynthesisError> {
    drop(reserved::<T>(len)?);
    Ok(vec![zero; len])
}
