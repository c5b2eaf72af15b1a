//! Vector instructions (SIMD): detects those of the machine, and compiles code for each set.
//!
//! Two kinds of code use them. A [`Stage`] is a loop over arrays in plain Rust: it is compiled anew for every
//! instruction set, and the compiler makes vector instructions of it. Since products and sums are neither
//! contracted nor reordered, it gives the same bytes with all of them. A [`lanes::Task`] is written in terms of
//! [`lanes::Lanes`], where lanes go different ways, as in searches.

#[cfg(target_arch = "x86_64")]
pub(crate) mod interleaved;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes;
mod stage;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

use std::fmt;

#[cfg(target_arch = "x86_64")]
use self::x86::{Avx2, Avx512};

pub(crate) use self::stage::{MAX_LANES, Stage};

/// Instruction sets for which searches and paths are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// Any machine.
    Portable,
    /// AVX2 and FMA: eight rays at a time.
    Avx2,
    /// AVX-512: sixteen rays at a time.
    Avx512,
}

impl Instructions {
    /// The widest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        [Self::Avx512, Self::Avx2]
            .into_iter()
            .find(|instructions| instructions.are_available())
            .unwrap_or(Self::Portable)
    }

    /// Returns `true` if this machine has them.
    #[must_use]
    pub fn are_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Avx512::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Runs a stage with these instructions, or portably where the machine lacks them.
    #[inline]
    pub(crate) fn run(self, stage: impl Stage) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if let Some(lanes) = Avx512::detect() => lanes.run_stage(stage),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if let Some(lanes) = Avx2::detect() => lanes.run_stage(stage),
            _ => stage.run(),
        }
    }
}

/// Asks for the cache line of an entry of a table, which is about to be read, where the machine can.
#[inline(always)]
pub(crate) fn prefetch<T>(table: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(table, index);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (table, index);
}

impl fmt::Display for Instructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}
