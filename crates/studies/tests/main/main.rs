//! Whole studies.

mod true_models;
