//! Regions: equal parts of a given surface, each lit on its own.

use asperity_surface::Border;
use asperity_tracer::Window;

/// Equal rectangles that the tile of a given surface is divided into.
///
/// Each is lit on its own and has a tally of its own, so that tallies of regions are like those of small surfaces; but light
/// meets whatever surrounds a region, and leaves by way of that.
///
/// # Examples
/// ```
/// use asperity_simulate::Regions;
///
/// assert_eq!(Regions { columns: 8, rows: 4 }.count(), 32);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regions {
    /// Regions along x, 1 or more.
    pub columns: u32,
    /// Regions along y, 1 or more.
    pub rows: u32,
}

impl Regions {
    /// Number of regions, which are numbered row by row.
    #[must_use]
    pub const fn count(self) -> u64 {
        self.columns as u64 * self.rows as u64
    }

    /// Windows of a region in the period: one, or, in a mirrored tile, as many as the tile has images.
    pub(crate) fn windows(self, number: u64, border: Border) -> Vec<Window> {
        let [columns, rows] = [self.columns, self.rows].map(u64::from);
        let along = |place: u64, count: u64| -> Vec<[f64; 2]> {
            let range = |i: u64, of: u64| [i, i + 1].map(|edge| edge as f64 / of as f64);
            match border {
                Border::Mirrored => vec![
                    range(place, 2 * count),
                    range(2 * count - 1 - place, 2 * count),
                ],
                Border::Periodic | Border::Open => vec![range(place, count)],
            }
        };
        let (along_x, along_y) = (
            along(number % columns, columns),
            along(number / columns, rows),
        );
        let windows = along_y.iter().flat_map(|y| {
            along_x.iter().map(|x| Window {
                from: [x[0], y[0]],
                to: [x[1], y[1]],
            })
        });
        windows.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Areas add up to one, and a mirrored tile has each region in its four images.
    #[test]
    fn regions_divide_the_period() {
        let regions = Regions {
            columns: 3,
            rows: 2,
        };
        for (border, images) in [
            (Border::Periodic, 1),
            (Border::Open, 1),
            (Border::Mirrored, 4),
        ] {
            let mut area = 0.0;
            for number in 0..regions.count() {
                let windows = regions.windows(number, border);
                assert_eq!(windows.len(), images);
                for Window { from, to } in windows {
                    area += (to[0] - from[0]) * (to[1] - from[1]);
                }
            }
            assert!((area - 1.0).abs() < 1e-12, "{border}: {area}");
        }
        let [first, .., last] = regions.windows(5, Border::Mirrored)[..] else {
            panic!("a mirrored region has four windows");
        };
        assert_eq!((first.from, first.to), ([2.0 / 6.0, 0.25], [0.5, 0.5]));
        assert_eq!((last.from, last.to), ([0.5, 0.5], [4.0 / 6.0, 0.75]));
    }
}
