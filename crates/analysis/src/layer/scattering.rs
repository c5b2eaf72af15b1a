//! BSDF of flat layers: light scattered once inside, and the beams of unscattered light.

use std::ops::Range;

use asperity_optics::{azimuth, polar_angle};
use asperity_tally::Side;
use glam::DVec3;

use super::flat_layers::FlatLayers;
use super::passage::Passage;

/// Unscattered light: it leaves along one direction, as a delta in the BSDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnscatteredBeam {
    /// Side on which it leaves.
    pub side: Side,
    /// Direction.
    pub wo: DVec3,
    /// Fraction of the incident flux.
    pub flux: f64,
}

impl UnscatteredBeam {
    /// Polar angle from +z and azimuth, degrees, rounded to a billionth.
    #[must_use]
    pub fn angles_deg(&self) -> [f64; 2] {
        [polar_angle(self.wo), azimuth(self.wo)]
            .map(|angle| (angle.to_degrees() * 1e9).round() / 1e9)
    }
}

impl FlatLayers {
    /// The BSDF of light scattered once inside, 1/sr, for directions outside the layers. Unscattered light is a
    /// delta: see [`FlatLayers::unscattered`].
    ///
    /// Unit vectors, `wo.z > 0` reflected, `wo.z < 0` transmitted; zero unless `wi.z > 0`. Stable for equal
    /// cosines, at grazing, at and beyond critical angles, and from `tau = 0` to infinity.
    #[must_use]
    pub fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z == 0.0 {
            return 0.0;
        }
        let side = if wo.z > 0.0 {
            Side::Reflected
        } else {
            Side::Transmitted
        };
        let incident = Passage::of_incident(self, wi);
        let leaving = self.leave(&incident, self.all(), side, wo.z.abs());
        leaving.bsdf(-wi.truncate().dot(wo.truncate()))
    }

    /// Unscattered light: reflected by the layers, and transmitted through the lowest face.
    #[must_use]
    pub fn unscattered(&self, wi: DVec3) -> Vec<UnscatteredBeam> {
        if wi.z <= 0.0 {
            return Vec::new();
        }
        let incident = Passage::of_incident(self, wi);
        let mut beams = vec![UnscatteredBeam {
            side: Side::Reflected,
            wo: DVec3::new(-wi.x, -wi.y, wi.z),
            flux: incident.reflected,
        }];
        if let (Some(index), Some(mu)) = (self.index_beyond(), incident.mu_beyond) {
            beams.push(UnscatteredBeam {
                side: Side::Transmitted,
                wo: (-wi.truncate() / index).extend(-mu).normalize(),
                flux: incident.transmitted,
            });
        }
        beams
    }

    /// Numbers of all layers.
    pub(super) fn all(&self) -> Range<usize> {
        0..self.media.len()
    }
}
