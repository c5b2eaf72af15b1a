//! Quadrature: rules on their own, and adaptive integration.

mod adaptive;
mod gauss_legendre;
mod gauss_rule;
mod normal;

pub use self::adaptive::{AllowedError, Breaks, Pieces, Tolerance, integrate, integrate_columns};
pub use self::gauss_legendre::gauss_legendre;
pub use self::gauss_rule::gauss_rule;
pub use self::normal::{normal_moments, normal_nodes};
