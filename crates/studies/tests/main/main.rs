//! Whole studies.
#![cfg(test)]

mod true_models;
