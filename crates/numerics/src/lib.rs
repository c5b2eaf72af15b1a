//! Numerics: quadrature, roots, elementary and special functions, Fourier transforms of grids, vector instructions, and hashing. It knows nothing of optics or surfaces.

mod columns;
pub mod elementary;
mod fourier;
mod hash;
pub mod quadrature;
pub mod random;
mod roots;
mod special;
pub mod vector;

pub use columns::columns;
pub use fourier::{
    ComplexPair, FourierTransform, HalfPlane, RealFourierTransform, power_plane, transform_plane,
};
pub use hash::{fnv1a, hash_numbers};
pub use roots::{quadratic_roots, root};
pub use special::{beta_of_one_plus, exponential_integral, ln_normal_cdf};
