//! All integration tests of the crate, in one binary.

mod roughness;
mod spline;
mod structures;
mod student_slopes;
mod synthesis;
mod transformed_heights;
