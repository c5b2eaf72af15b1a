//! The in-plane slice: directions near the plane of incidence, on both its halves.

use std::f64::consts::{PI, TAU};

use asperity_numerics::elementary::{cos, sin};
use asperity_optics::azimuth;
use glam::DVec3;

use super::exit_columns::{ExitColumns, InSlice};
use super::keys::{MARGIN, TINY};
use crate::spec::filters::Half;

/// All directions within an angle of the plane of incidence, on both its halves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InPlaneSlice {
    forward_azimuth: f64,
    half_width: f64,
    /// Cosine and sine of the azimuth and of the half width.
    forward: [f64; 2],
    edge: [f64; 2],
}

impl InPlaneSlice {
    /// `forward_azimuth` and `half_width` in radians, the latter at most a right angle.
    pub(crate) fn new(forward_azimuth: f64, half_width: f64) -> Self {
        let cos_sin = |angle: f64| [cos(angle), sin(angle)];
        Self {
            forward_azimuth,
            half_width,
            forward: cos_sin(forward_azimuth),
            edge: cos_sin(half_width),
        }
    }

    /// Azimuth of its forward half, and half width, radians.
    pub(crate) const fn angles(&self) -> [f64; 2] {
        [self.forward_azimuth, self.half_width]
    }

    /// Half of the slice that contains `wo`, if one does: the result of [`InPlaneSlice::by_angles`], by
    /// products wherever no edge is near.
    #[inline]
    pub(crate) fn half(&self, wo: DVec3) -> Option<Half> {
        match self.by_products(wo.x, wo.y) {
            InSlice::Unsure => self.by_angles(wo).half(),
            decided => decided.half(),
        }
    }

    /// Finds the halves of the slice that contain many directions.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns) {
        exits.slice.resize(exits.len(), InSlice::Neither);
        let [x, y, _] = &exits.wo;
        let mut are_sure = true;
        for (slice, (&x, &y)) in exits.slice.iter_mut().zip(x.iter().zip(y)) {
            *slice = self.by_products(x, y);
            are_sure &= *slice != InSlice::Unsure;
        }
        if !are_sure {
            self.locate_by_angles(exits);
        }
    }

    #[inline(never)]
    fn locate_by_angles(&self, exits: &mut ExitColumns) {
        for i in 0..exits.len() {
            if exits.slice[i] == InSlice::Unsure {
                exits.slice[i] = self.by_angles(exits.wo(i));
            }
        }
    }

    #[inline(always)]
    fn by_products(&self, x: f64, y: f64) -> InSlice {
        let [cos, sin] = self.forward;
        let along = cos * x + sin * y;
        let across = (cos * y - sin * x).abs();
        let [cos, sin] = self.edge;
        let inside = sin * along.abs() - cos * across;
        let length = along.abs() + across;
        let margin = MARGIN * length;
        let is_inside = inside > margin;
        // Selected, not branched to, so that loops take vector instructions.
        let known = if inside < -margin {
            InSlice::Neither
        } else if is_inside & (along > margin) {
            InSlice::Forward
        } else if is_inside & (along < -margin) {
            InSlice::Backward
        } else {
            InSlice::Unsure
        };
        if length < TINY {
            InSlice::Unsure
        } else {
            known
        }
    }

    /// The definition: within the half width of one of the two halves of the plane of incidence. A
    /// vertical direction lies in every plane, on the forward side of it.
    fn by_angles(&self, wo: DVec3) -> InSlice {
        let vertical = wo.x == 0.0 && wo.y == 0.0;
        let azimuth = if vertical {
            self.forward_azimuth
        } else {
            azimuth(wo)
        };
        let relative = (azimuth - self.forward_azimuth).rem_euclid(TAU);
        let (half, off_plane) = if (0.5 * PI..1.5 * PI).contains(&relative) {
            (InSlice::Backward, (relative - PI).abs())
        } else {
            (InSlice::Forward, relative.min(TAU - relative))
        };
        if off_plane <= self.half_width {
            half
        } else {
            InSlice::Neither
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

    #[test]
    fn products_decide_as_angles_do() {
        for forward_deg in [0.0, 30.0, 123.4, 180.0, 280.0, 540.0, -77.0] {
            for half_width_deg in [1e-7, 0.5, 5.0, 45.0, 89.999, 90.0] {
                let [forward, half_width] =
                    [forward_deg, half_width_deg].map(|deg: f64| deg.to_radians());
                let slice = InPlaneSlice::new(forward, half_width);
                let mut azimuths: Vec<f64> = (0..3000)
                    .map(|i| TAU * (f64::from(i) * 0.618_033_988_7).fract())
                    .collect();
                for edge in [0.0, half_width, -half_width, 0.5 * PI] {
                    for turn in [0.0, PI] {
                        for off in [0.0, 1e-16, 1e-15, 1e-12, 1e-9, 1e-8, 2e-8, 1e-6] {
                            azimuths.push(forward + turn + edge + off);
                            azimuths.push(forward + turn + edge - off);
                        }
                    }
                }
                for phi in azimuths {
                    for theta in [1e-320, 1e-300, 1e-12, 0.3, 1.5, 3.0] {
                        let wo = from_spherical(theta, phi);
                        assert_eq!(
                            slice.half(wo),
                            slice.by_angles(wo).half(),
                            "{slice:?} {wo:?}"
                        );
                    }
                }
                for wo in [DVec3::Z, DVec3::new(-0.0, 0.0, -1.0)] {
                    assert_eq!(slice.half(wo), Some(Half::Forward));
                }
            }
        }
    }
}
