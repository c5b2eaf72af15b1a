//! Turned cells of structures in files: OpenEXR keeps them, in a channel; of other formats, those that can say that they are lost.

/// Name of the channel: 1 where a cell is split along its other diagonal, 0 elsewhere.
pub(super) const CHANNEL: &str = "turned_cells";

/// Note on a surface whose file does not keep them.
pub(super) const LOST: &str = "the cells of this structure were split along its edges, but its file does not keep along which diagonals: all are split along the same one here, which changes the light at edges; an EXR keeps them";
