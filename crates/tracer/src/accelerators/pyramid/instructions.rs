//! Instructions: which instruction set searches the pyramid, and the choice between them.

use std::fmt;

use super::bounds::Bounds;
use super::rays::Rays;
use super::scalar;
#[cfg(target_arch = "x86_64")]
use super::wide::SearchAll;
#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2, Avx512};

/// Instruction sets for which the wide search is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// Any machine: one ray at a time.
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

    /// Whether this machine has them.
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

/// Searches all rays with the given instructions, or portably where the machine lacks them.
pub(super) fn search(bounds: &Bounds, rays: &mut Rays, instructions: Instructions) {
    match instructions {
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 if let Some(lanes) = Avx512::detect() => {
            lanes.run(SearchAll { bounds, rays })
        }
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 if let Some(lanes) = Avx2::detect() => {
            lanes.run(SearchAll { bounds, rays })
        }
        _ => scalar::search(bounds, rays),
    }
}
