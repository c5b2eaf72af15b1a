//! Whole studies.
#![cfg(test)]

mod coordinates;
mod true_models;
