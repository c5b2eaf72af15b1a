//! All integration tests of the crate, in one binary.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and report as tests do"
)]

mod common;

mod compare {
    mod comparison;
    mod sampled_comparison;
}
mod integrals {
    mod energy;
    mod expectation;
    mod sampled_expectation;
    mod unshadowed;
}
mod layer {
    mod flat_layer;
    mod flat_layer_rays;
    mod flat_stack;
}
mod models {
    mod columns;
    mod ggx;
    mod heitz;
    mod heitz_explicit;
    mod heitz_polarised;
    mod heitz_rare;
    mod mueller;
    mod neumann;
    mod reference;
    mod smith_slopes;
    mod v_cavity;
    mod xu_sun_mc;
}
