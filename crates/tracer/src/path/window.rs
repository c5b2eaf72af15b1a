//! Window: the part of the period of a surface that light falls on.

/// A rectangle of the period of a surface, in fractions of the period along x and y, each from 0 to 1.
///
/// A mirrored tile and its images make a period of two tiles along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The corner with the lower coordinates.
    pub from: [f64; 2],
    /// The corner with the higher coordinates.
    pub to: [f64; 2],
}

impl Window {
    /// The whole period.
    pub const WHOLE: Self = Self {
        from: [0.0; 2],
        to: [1.0; 2],
    };
}
