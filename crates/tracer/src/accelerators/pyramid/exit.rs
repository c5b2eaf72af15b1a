//! Exit: where a ray leaves a node or cell, and what it finds there; in f32, one ray at a time.

/// Where a ray leaves the node that it is in.
pub(super) struct Exit {
    pub(super) t: f32,
    /// Height there.
    pub(super) z: f32,
    /// Whether through the edge across x.
    pub(super) across_x: bool,
    /// Column and row ahead, at the level of the node.
    pub(super) ahead: [i32; 2],
    /// By how much rounding may have changed heights.
    pub(super) margin: f32,
}

/// What a ray finds in a node or cell.
pub(super) enum Test {
    /// The surface in the cell.
    Met,
    /// It passes over all of it, by so much.
    Clear(f32),
    /// The node has to be looked at more closely.
    Unknown,
}

/// One comparison, where `f32::min` takes care of a NaN.
pub(super) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// One comparison, where `f32::max` takes care of a NaN.
pub(super) fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
