//! Places and rectangles in points of the figure, origin at the top left, y down.

/// A place in the figure, points.
pub(crate) type Xy = (f64, f64);

/// A rectangle in points; `top < bottom`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    /// A rectangle by its top left corner and its size.
    pub(crate) fn at((left, top): Xy, width: f64, height: f64) -> Self {
        Rect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        }
    }

    /// A rectangle by its centre and half of its sides.
    pub(crate) fn around((x, y): Xy, half_width: f64, half_height: f64) -> Self {
        Rect::at(
            (x - half_width, y - half_height),
            2.0 * half_width,
            2.0 * half_height,
        )
    }

    /// Returns `true` if a place lies in the rectangle, its border included.
    pub(crate) fn contains(&self, (x, y): Xy) -> bool {
        (self.left - 0.01..=self.right + 0.01).contains(&x)
            && (self.top - 0.01..=self.bottom + 0.01).contains(&y)
    }

    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn centre(&self) -> Xy {
        (
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }

    pub(crate) fn corners(&self) -> [Xy; 4] {
        [
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
        ]
    }

    /// The part of the segment `a b` inside the rectangle (Liang and Barsky 1984).
    pub(crate) fn clip(&self, a: Xy, b: Xy) -> Option<(Xy, Xy)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let edges = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
        for (p, q) in edges {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                t0 = t0.max(q / p);
            } else {
                t1 = t1.min(q / p);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (t0 <= t1).then(|| (at(t0), at(t1)))
    }

    /// The pieces of a polyline inside the rectangle.
    pub(crate) fn clip_path(&self, path: &[Xy]) -> Vec<Vec<Xy>> {
        let mut pieces: Vec<Vec<Xy>> = Vec::new();
        for ends in path.windows(2) {
            let Some((a, b)) = self.clip(ends[0], ends[1]) else {
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&a) => piece.push(b),
                _ => pieces.push(vec![a, b]),
            }
        }
        pieces
    }
}

/// Cuts a polyline into the "on" pieces of a pattern.
pub(crate) fn dashes(path: &[Xy], pattern: &[f64]) -> Vec<Vec<Xy>> {
    let mut pieces: Vec<Vec<Xy>> = Vec::new();
    let (mut index, mut left) = (0, pattern[0]);
    let mut piece: Vec<Xy> = path.first().copied().into_iter().collect();
    for ends in path.windows(2) {
        let (mut a, b) = (ends[0], ends[1]);
        loop {
            let rest = (b.0 - a.0).hypot(b.1 - a.1);
            // A path that is not finite must not be cut for ever.
            if rest <= left || !rest.is_finite() {
                left -= rest;
                if index % 2 == 0 {
                    piece.push(b);
                }
                break;
            }
            let t = left / rest;
            a = (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
            if index % 2 == 0 {
                piece.push(a);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![a];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect {
        left: 0.0,
        top: 0.0,
        right: 10.0,
        bottom: 10.0,
    };

    #[test]
    fn clipping_keeps_the_inside_and_splits_at_the_border() {
        let path = [
            (-5.0, 5.0),
            (5.0, 5.0),
            (5.0, 50.0),
            (8.0, 50.0),
            (8.0, 1.0),
        ];
        let pieces = UNIT.clip_path(&path);
        assert_eq!(
            pieces,
            vec![
                vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)],
                vec![(8.0, 10.0), (8.0, 1.0)]
            ]
        );
    }

    #[test]
    fn dashes_cover_their_fraction_of_the_path() {
        let path: Vec<Xy> = (0..=100).map(|i| (f64::from(i), 0.0)).collect();
        let drawn: f64 = dashes(&path, &[3.0, 2.0])
            .iter()
            .map(|piece| piece[piece.len() - 1].0 - piece[0].0)
            .sum();
        assert!((drawn - 60.0).abs() < 1e-9, "{drawn}");
    }
}
