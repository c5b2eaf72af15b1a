//! Sharp corners of lines: where a line is cut, so that each piece bends gently.
//!
//! The rasteriser turns a thick line into one polygon. At a sharp corner the inner edges of that polygon meet far from the line, which shows as
//! a spike. Pieces without sharp corners, joined by discs, have the round joins of the SVG.

/// A pixel of the backend.
pub(super) type Pixel = (i32, i32);

/// Cuts `path` at each vertex where it turns by more than a right angle. Neighbouring pieces share that vertex.
pub(super) fn gentle_pieces(path: &[Pixel]) -> Vec<&[Pixel]> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for (i, corner) in path.windows(3).enumerate() {
        if is_sharp(corner) {
            pieces.push(&path[start..=i + 1]);
            start = i + 1;
        }
    }
    pieces.push(&path[start..]);
    pieces
}

fn is_sharp(corner: &[Pixel]) -> bool {
    let step = |from: Pixel, to: Pixel| [i64::from(to.0 - from.0), i64::from(to.1 - from.1)];
    let [before, after] = [step(corner[0], corner[1]), step(corner[1], corner[2])];
    before[0] * after[0] + before[1] * after[1] < 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_cut_where_they_turn_back() {
        // A right angle stays; the way back does not.
        let path = [(0, 0), (9, 0), (9, 9), (8, 0), (8, -9)];
        assert_eq!(gentle_pieces(&path), [&path[..=2], &path[2..]]);
        assert_eq!(gentle_pieces(&path[..3]), [&path[..3]]);
    }
}
