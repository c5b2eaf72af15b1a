//! Vector instructions (SIMD): detects those of the machine, and compiles loops for each set.
//!
//! A [`Stage`] is a loop over arrays in plain Rust: it is compiled anew for every instruction set, and the compiler makes vector
//! instructions of it. Since products and sums are neither contracted nor reordered, it gives the same bytes with all of them.

mod stage;
#[cfg(target_arch = "x86_64")]
pub mod x86;

use std::fmt;
use std::sync::OnceLock;

#[cfg(target_arch = "x86_64")]
use self::x86::{Avx2, Avx512};

pub use self::stage::Stage;

/// Instruction sets for which loops are compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// Any machine.
    Portable,
    /// AVX2 and FMA: lanes of 256 bits.
    Avx2,
    /// AVX-512: lanes of 512 bits.
    Avx512,
}

impl Instructions {
    /// All sets, the widest first.
    pub const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Portable];

    /// Environment variable with the name of the set to take in place of the widest.
    pub const VARIABLE: &'static str = "ASPERITY_INSTRUCTIONS";

    /// The set of [`Self::VARIABLE`] if this machine has it, otherwise the widest that it has, whatever the variable says.
    #[must_use]
    pub fn best() -> Self {
        static BEST: OnceLock<Instructions> = OnceLock::new();
        *BEST.get_or_init(|| {
            let requested = Self::requested().ok().flatten();
            let mut available = Self::ALL.into_iter().filter(|set| set.are_available());
            requested.or(available.next()).unwrap_or(Self::Portable)
        })
    }

    /// The set of [`Self::VARIABLE`]; `None` if it is not set.
    ///
    /// # Errors
    /// The text of the variable, if it is not the name of a set that this machine has.
    pub fn requested() -> Result<Option<Self>, String> {
        let Some(name) = std::env::var_os(Self::VARIABLE) else {
            return Ok(None);
        };
        let mut available = Self::ALL.into_iter().filter(|set| set.are_available());
        let found = available.find(|set| name == *set.to_string());
        found
            .map(Some)
            .ok_or_else(|| name.to_string_lossy().into_owned())
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
    pub fn run(self, stage: impl Stage) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if let Some(lanes) = Avx512::detect() => lanes.run(stage),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if let Some(lanes) = Avx2::detect() => lanes.run(stage),
            _ => stage.run(),
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
