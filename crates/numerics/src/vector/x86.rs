//! AVX2 and AVX-512: runs loops that are compiled for these instructions of x86-64.
#![allow(
    unsafe_code,
    reason = "functions of an instruction set may run only where the processor has it: a value of `Avx2` or `Avx512` is the proof, and is made by `detect` alone"
)]

use super::stage::Stage;

/// The instructions of AVX2 and FMA, found on this machine.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// The proof that this machine has these instructions, if it has.
    #[must_use]
    pub fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
    }

    /// Runs `stage` compiled for this instruction set.
    pub fn run(self, stage: impl Stage) {
        #[target_feature(enable = "avx2,fma")]
        fn compiled(stage: impl Stage) {
            stage.run();
        }
        // SAFETY: `self` is the proof that the processor has these instructions.
        unsafe { compiled(stage) }
    }
}

/// The instructions of AVX-512 (F, BW, DQ, VL) and FMA, found on this machine.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(());

impl Avx512 {
    /// The proof that this machine has these instructions, if it has.
    #[must_use]
    pub fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("fma"))
        .then_some(Self(()))
    }

    /// Runs `stage` compiled for this instruction set.
    pub fn run(self, stage: impl Stage) {
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,fma")]
        fn compiled(stage: impl Stage) {
            stage.run();
        }
        // SAFETY: `self` is the proof that the processor has these instructions.
        unsafe { compiled(stage) }
    }
}
