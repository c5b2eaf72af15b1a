//! Region plan: how many regions a given surface is divided into, so that their scatter tells errors.

use asperity_simulate::Regions;
use asperity_surface::{HeightField, Roughness};

use crate::given::ComparedSurfaceError;

/// Fewest regions: from fewer the error is known to no better than a fifth.
const MIN_REGIONS: u32 = 16;

/// Most regions: more tell no more of the error, and have fewer rays each.
const MAX_REGIONS: u32 = 64;

/// Width of a region in correlation lengths beyond which neighbours are nearly independent; regions are as narrow if that leaves
/// enough of them.
const WIDTH: f64 = 5.0;

/// Least width of a region in correlation lengths.
const MIN_WIDTH: f64 = 2.0;

/// Steps from [`WIDTH`] to [`MIN_WIDTH`].
const STEPS: u32 = 30;

/// The regions of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RegionPlan {
    pub(super) regions: Regions,
    /// Correlation lengths of the surface along x and y, in its unit.
    pub(super) correlation: [f64; 2],
    /// Extent of a region along x and y, in the unit of the surface.
    pub(super) extent: [f64; 2],
}

impl RegionPlan {
    /// The regions of the surface called `name`.
    pub(super) fn of(field: &HeightField, name: &str) -> Result<Self, ComparedSurfaceError> {
        let name = || name.to_owned();
        let roughness = Roughness::of(field);
        let (Some(x), Some(y)) = (roughness.tau_x, roughness.tau_y) else {
            return Err(ComparedSurfaceError::Correlated { name: name() });
        };
        let extent = field.extent();
        let widths = [extent[0] / x, extent[1] / y];
        let regions = regions(widths).ok_or_else(|| ComparedSurfaceError::FewRegions {
            name: name(),
            widths,
            regions: MIN_REGIONS,
            width: MIN_WIDTH,
        })?;
        Ok(Self {
            regions,
            correlation: [x, y],
            extent: [
                extent[0] / f64::from(regions.columns),
                extent[1] / f64::from(regions.rows),
            ],
        })
    }

    /// Widths of a region along x and y, in correlation lengths.
    pub(super) fn widths(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.extent[axis] / self.correlation[axis])
    }
}

/// The regions of a surface of these widths in correlation lengths: as wide as [`WIDTH`] where that leaves enough, narrower otherwise.
fn regions(widths: [f64; 2]) -> Option<Regions> {
    let of_width = |width: f64| {
        let along = widths.map(|all| (all / width).clamp(1.0, f64::from(MAX_REGIONS)) as u32);
        let [mut columns, mut rows] = along;
        while columns * rows > MAX_REGIONS {
            // The narrower ones become wider.
            if widths[0] / f64::from(columns) < widths[1] / f64::from(rows) {
                columns -= 1;
            } else {
                rows -= 1;
            }
        }
        Regions { columns, rows }
    };
    let step = (WIDTH - MIN_WIDTH) / f64::from(STEPS);
    (0..=STEPS)
        .map(|i| of_width(WIDTH - step * f64::from(i)))
        .find(|regions| {
            let wide = widths[0] / f64::from(regions.columns) >= MIN_WIDTH * (1.0 - 1e-9)
                && widths[1] / f64::from(regions.rows) >= MIN_WIDTH * (1.0 - 1e-9);
            wide && regions.columns * regions.rows >= MIN_REGIONS
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_wide_where_the_surface_is_and_narrow_where_it_must() {
        let of = |x: f64, y: f64| regions([x, y]).map(|found| [found.columns, found.rows]);
        // Widths of 8, 5, 2.5 and 2 correlation lengths
        assert_eq!(of(64.0, 64.0), Some([8, 8]));
        assert_eq!(of(1000.0, 1000.0), Some([8, 8]));
        assert_eq!(of(20.0, 20.0), Some([4, 4]));
        assert_eq!(of(10.0, 10.0), Some([4, 4]));
        assert_eq!(of(8.0, 8.0), Some([4, 4]));
        assert_eq!(of(7.9, 8.0), None);
        // Long strips and grooves
        assert_eq!(of(2.0, 80.0), Some([1, 16]));
        assert_eq!(of(1e6, 3.0), Some([64, 1]));
        assert_eq!(of(1.9, 1e6), None);
    }
}
