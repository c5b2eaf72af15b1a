//! Vector instructions (SIMD) of searches and paths.
//!
//! Two kinds of code use them. Most is a [`Stage`], a loop over arrays in plain Rust, which the compiler makes vector instructions of.
//! Searches are written in terms of [`lanes::Lanes`], since their lanes go different ways.

#[cfg(target_arch = "x86_64")]
pub(crate) mod interleaved;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

pub use asperity_numerics::vector::Instructions;
pub(crate) use asperity_numerics::vector::Stage;

/// Most lanes of any search: twice those of the widest instruction set.
pub(crate) const MAX_LANES: usize = 32;

/// Asks for the cache line of an entry of a table, which is about to be read, where the machine can.
#[inline(always)]
pub(crate) fn prefetch<T>(table: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(table, index);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (table, index);
}
