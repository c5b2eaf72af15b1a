//! Height field error: reasons why numbers make no height field.

/// Largest magnitude of a height.
pub(super) const MAX_HEIGHT: f64 = 1e100;

/// Reason why a height field cannot be made of the given numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightFieldError {
    /// Fewer than two samples along an axis.
    #[error("a surface needs at least 2 x 2 samples; this one has {nx} x {ny} (columns x rows)")]
    TooSmall {
        /// Columns.
        nx: usize,
        /// Rows.
        ny: usize,
    },
    /// More samples than memory can address.
    #[error("a surface of {nx} x {ny} samples does not fit into memory")]
    TooLarge {
        /// Columns.
        nx: usize,
        /// Rows.
        ny: usize,
    },
    /// The number of heights is not `nx * ny`.
    #[error("{found} heights were given for {nx} x {ny} samples")]
    WrongCount {
        /// Number of heights.
        found: usize,
        /// Columns.
        nx: usize,
        /// Rows.
        ny: usize,
    },
    /// A spacing is zero, negative or not finite.
    #[error("the spacing along {axis} is {value}; it must be positive and finite")]
    BadSpacing {
        /// `x` or `y`.
        axis: char,
        /// The offending value.
        value: f64,
    },
    /// A height is NaN or infinite.
    #[error("the height at column {ix}, row {iy} is {value}; heights must be finite")]
    NotFinite {
        /// Column.
        ix: usize,
        /// Row.
        iy: usize,
        /// The offending value.
        value: f64,
    },
    /// A height so large that its square would overflow.
    #[error(
        "the height at column {ix}, row {iy} is {value:e}; heights up to {MAX_HEIGHT:e} are allowed"
    )]
    TooHigh {
        /// Column.
        ix: usize,
        /// Row.
        iy: usize,
        /// The offending value.
        value: f64,
    },
    /// Unknown name of a border.
    #[error("unknown border `{0}`; allowed are periodic, mirrored and open")]
    UnknownBorder(String),
    /// Unknown symbol of a unit.
    #[error("unknown length unit `{0}`; allowed are 1 (arbitrary), nm, um, mm, m and km")]
    UnknownUnit(String),
    /// Lengths cannot be converted from or into arbitrary units.
    #[error("lengths in the unit {from} cannot be converted into {to}; 1 is an arbitrary unit")]
    NoUnit {
        /// Symbol of the unit of the lengths.
        from: &'static str,
        /// Symbol of the requested unit.
        to: &'static str,
    },
}
