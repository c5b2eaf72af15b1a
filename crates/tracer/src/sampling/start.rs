//! Start: the position and the number of a path.

use asperity_numerics::elementary::sin_cos_of_turn;
use glam::DVec2;

/// Start of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    /// `[u, v, azimuth]`, each at least 0 and below 1, or 1 where rounding makes it so: fractions of the period along x and y, and
    /// of a full turn. Each start taken at random is uniform; where no azimuth is requested, it is 0.
    pub(crate) position: [f64; 3],
    /// Number of the path, counted from the first of its stream.
    pub(crate) ray: u32,
}

impl Start {
    /// Cosine and sine of the azimuth: `(1, 0)` where none is requested.
    #[inline(always)]
    pub(crate) fn turn(&self) -> DVec2 {
        let [sin, cos] = sin_cos_of_turn(self.position[2]);
        DVec2::new(cos, sin)
    }
}
