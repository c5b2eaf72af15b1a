//! Aperture windows: which apertures an exit falls into, and with what weight.

use asperity_numerics::elementary::{asin, atan2, cos, sin_cos};
use glam::DVec3;

use super::exit_columns::ExitColumns;
use crate::spec::apertures::{Aperture, ApertureShape, part_taken};
use crate::{Side, TallySpec};

/// Angle by which bounds on receptors are widened against rounding, radians.
const MARGIN: f64 = 1e-9;

/// Apertures of a spec, turned to the azimuth of the light.
#[derive(Clone, Debug)]
pub(crate) struct ApertureWindows {
    each: Vec<Window>,
    /// Horizontal directions: that in which the light travels, and that across.
    along: DVec3,
    across: DVec3,
}

/// One aperture, for an engine that sums light elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApertureWindow {
    /// Side of the light.
    pub side: Side,
    /// Direction of its centre.
    pub centre: [f64; 3],
    /// Least cosine of the angle to the centre.
    pub cos_reach: f64,
    /// Polar angle of its centre, radians.
    pub theta: f64,
    /// Widths of source and receptor in the plane of incidence and across, radians; `None` for a cone, which takes all light within its reach.
    pub receptor: Option<[[f64; 2]; 2]>,
}

#[derive(Clone, Copy, Debug)]
struct Window {
    aperture: Aperture,
    centre: DVec3,
    /// Least cosine of the angle to the centre.
    cos_reach: f64,
}

impl ApertureWindows {
    /// Windows for light that travels towards the azimuth `forward`, radians.
    pub(crate) fn new(spec: &TallySpec, forward: f64) -> Self {
        let (sin_phi, cos_phi) = sin_cos(forward);
        let along = DVec3::new(cos_phi, sin_phi, 0.0);
        let across = DVec3::new(-sin_phi, cos_phi, 0.0);
        let window = |aperture: Aperture| {
            let (sin_theta, cos_theta) = sin_cos(aperture.theta);
            Window {
                aperture,
                centre: sin_theta * along + cos_theta * DVec3::Z,
                cos_reach: match aperture.shape {
                    _ if !spec.records(aperture.side) => f64::INFINITY,
                    // Every direction, whatever its length is rounded to
                    ApertureShape::Cone { half_angle } if half_angle >= std::f64::consts::PI => {
                        f64::NEG_INFINITY
                    }
                    ApertureShape::Cone { half_angle } => cos(half_angle),
                    shape @ ApertureShape::Receptor { .. } => cos(shape.reach() + MARGIN),
                },
            }
        };
        Self {
            each: spec.apertures().iter().map(window).collect(),
            along,
            across,
        }
    }

    /// All windows, and the horizontal directions along and across the plane of incidence.
    pub(crate) fn table(&self) -> (Vec<ApertureWindow>, [[f64; 3]; 2]) {
        let window = |window: &Window| ApertureWindow {
            side: window.aperture.side,
            centre: window.centre.to_array(),
            cos_reach: window.cos_reach,
            theta: window.aperture.theta,
            receptor: match window.aperture.shape {
                ApertureShape::Cone { .. } => None,
                ApertureShape::Receptor { in_plane, across } => Some([in_plane, across]),
            },
        };
        let axes = [self.along, self.across].map(|axis| axis.to_array());
        (self.each.iter().map(window).collect(), axes)
    }

    /// Finds the windows that many exits may fall into.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns) {
        if self.each.is_empty() {
            return;
        }
        let n = exits.len();
        exits.windows.resize(n, 0);
        let [x, y, z] = exits.wo.each_ref().map(|column| &column[..n]);
        let sides = &exits.side[..n];
        for (number, window) in self.each.iter().enumerate() {
            for (i, windows) in exits.windows[..n].iter_mut().enumerate() {
                let may_enter = window.may_take(sides[i], x[i], y[i], z[i]);
                *windows |= u8::from(may_enter) << number;
            }
        }
    }

    /// Windows that one exit may fall into: a bit for each.
    pub(crate) fn of(&self, side: Side, wo: DVec3) -> u8 {
        let bits = self.each.iter().enumerate();
        bits.map(|(number, window)| u8::from(window.may_take(side, wo.x, wo.y, wo.z)) << number)
            .sum()
    }

    /// Weight of a direction in a window that it may fall into.
    #[inline]
    pub(crate) fn weight(&self, number: usize, wo: DVec3) -> f64 {
        let Aperture { theta, shape, .. } = self.each[number].aperture;
        match shape {
            ApertureShape::Cone { .. } => 1.0,
            ApertureShape::Receptor { in_plane, across } => {
                let polar = atan2(wo.dot(self.along), wo.z);
                let aside = asin(wo.dot(self.across).clamp(-1.0, 1.0));
                part_taken(polar - theta, in_plane) * part_taken(aside, across)
            }
        }
    }
}

impl Window {
    #[inline(always)]
    fn may_take(&self, side: Side, x: f64, y: f64, z: f64) -> bool {
        let cos = x * self.centre.x + y * self.centre.y + z * self.centre.z;
        (cos >= self.cos_reach) & (side == self.aperture.side)
    }
}
