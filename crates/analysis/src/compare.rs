//! Comparison of models with explicit results: tests of hypotheses on whole surfaces.

pub(crate) mod comparison;
pub(crate) mod flips;
pub(crate) mod input;
pub(crate) mod multiple_tests;
pub(crate) mod sign_flip;
pub(crate) mod verdict;
