//! Graded edges: bins that are narrow about one angle and grow with the distance from it.

/// Factor from one width to the next.
const RATIO: f64 = 1.3;

/// Edges are multiples of this, degrees.
const STEP: f64 = 1e-6;

/// Place where bins are narrow, and their widths there and elsewhere; degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grading {
    /// The angle in the middle of the narrowest bin.
    pub(crate) centre: f64,
    /// Width of the narrowest bin.
    pub(crate) finest: f64,
    /// Width that none exceeds.
    pub(crate) coarsest: f64,
}

impl Grading {
    /// Edges from `first` to `last`, both included, ascending.
    pub(crate) fn edges(self, [first, last]: [f64; 2]) -> Vec<f64> {
        let upward = self.distances(last - self.centre);
        let downward = self.distances(self.centre - first);
        let below = downward.iter().rev().map(|off| self.centre - off);
        let above = upward.iter().map(|off| self.centre + off);
        let mut edges: Vec<f64> = below.chain(above).map(rounded).collect();
        edges.retain(|edge| first < *edge && *edge < last);
        edges.insert(0, first);
        edges.push(last);
        edges
    }

    /// Distances from the centre of the edges on both sides of it, up to half a turn: the same on either side.
    pub(crate) fn half_turn(self) -> Vec<f64> {
        let mut distances: Vec<f64> = self.distances(180.0).into_iter().map(rounded).collect();
        if let Some(last) = distances.last_mut() {
            *last = 180.0;
        }
        distances
    }

    /// Distances of edges on one side of the centre, the last of them `reach` exactly; none if all that lies there belongs to the
    /// central bin.
    fn distances(self, reach: f64) -> Vec<f64> {
        let half = 0.5 * self.finest;
        // Less than a quarter of the finest bin is left to it.
        if reach <= 1.5 * half {
            return vec![reach.max(0.0)];
        }
        let mut widths = Vec::new();
        let mut width = self.finest;
        let mut sum = 0.0;
        while sum < (reach - half) * (1.0 - 1e-9) {
            width = (width * RATIO).min(self.coarsest);
            widths.push(width);
            sum += width;
        }
        let scale = (reach - half) / sum;
        let mut distance = half;
        let mut distances = vec![half];
        for width in widths {
            distance += width * scale;
            distances.push(distance);
        }
        distances
    }
}

/// Divides the widest of the bins between ascending edges until there are as many as `count`.
pub(crate) fn divide(edges: &mut Vec<f64>, count: usize) {
    while edges.len() <= count {
        let widths = edges.windows(2).map(|pair| pair[1] - pair[0]);
        let widest = widths.enumerate().fold((0, 0.0), |widest, (i, width)| {
            // Of widths that agree but for rounding the first.
            if width > widest.1 + 2.0 * STEP {
                (i, width)
            } else {
                widest
            }
        });
        let i = widest.0;
        edges.insert(i + 1, rounded(0.5 * (edges[i] + edges[i + 1])));
    }
}

fn rounded(angle: f64) -> f64 {
    (angle / STEP).round() * STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    fn widths(edges: &[f64]) -> Vec<f64> {
        edges.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    #[test]
    fn bins_grow_from_the_finest_to_the_coarsest() {
        let grading = Grading {
            centre: 30.0,
            finest: 0.1,
            coarsest: 5.0,
        };
        let edges = grading.edges([0.0, 90.0]);
        assert_eq!((edges[0], edges.last()), (0.0, Some(&90.0)));
        let widths = widths(&edges);
        let central = widths.iter().position(|w| (w - 0.1).abs() < 1e-5).unwrap();
        assert!((edges[central] - 29.95).abs() < 1e-5, "{edges:?}");
        for (i, pair) in widths.windows(2).enumerate() {
            let growth = if i < central {
                pair[0] / pair[1]
            } else {
                pair[1] / pair[0]
            };
            assert!((0.99..RATIO * 1.01).contains(&growth) || i + 1 == central || i == central);
            assert!(pair[0] > 0.05 && pair[0] < 5.0 + 1e-5);
        }
        assert!(edges.len() < 60, "{}", edges.len());
    }

    #[test]
    fn the_bin_at_an_end_holds_what_lies_there() {
        for (centre, first) in [(0.0, 0.05), (0.02, 0.07), (0.06, 0.01)] {
            let grading = Grading {
                centre,
                finest: 0.1,
                coarsest: 5.0,
            };
            let edges = grading.edges([0.0, 90.0]);
            if centre < 0.05 {
                assert!((edges[1] - first).abs() < 1e-5, "{centre}: {edges:?}");
            }
            assert!(widths(&edges).iter().all(|w| *w > 0.02));
        }
    }

    #[test]
    fn without_a_narrow_bin_all_are_about_the_coarsest() {
        let grading = Grading {
            centre: 180.0,
            finest: 10.0,
            coarsest: 10.0,
        };
        let distances = grading.half_turn();
        assert_eq!(distances.last(), Some(&180.0));
        assert_eq!(distances[0], 5.0);
        assert!(widths(&distances).iter().all(|w| *w > 9.0 && *w <= 10.0));
    }

    #[test]
    fn the_widest_bins_are_divided_first() {
        let mut edges = vec![0.0, 1.0, 3.0, 90.0];
        divide(&mut edges, 5);
        assert_eq!(edges, [0.0, 1.0, 3.0, 24.75, 46.5, 90.0]);
        divide(&mut edges, 3);
        assert_eq!(edges.len(), 6);
    }
}
