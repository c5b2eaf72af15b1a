//! Flat layer BSDF: light scattered once inside, and the beams of unscattered light.

use asperity_optics::{azimuth, polar_angle};
use asperity_tally::Side;
use glam::DVec3;

use super::faces::Inside;
use super::flat_layer::FlatLayer;

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

impl FlatLayer {
    /// The BSDF of light scattered once inside, 1/sr, for directions outside the layer. Unscattered light is a
    /// delta: see [`FlatLayer::unscattered`].
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
        let inside = self.enter(wi);
        self.leave(&inside, side, wo.z.abs())
            .map_or(0.0, |exit| self.scattered(&inside, &exit, wo.truncate()))
    }

    /// Unscattered light: reflected by the layer, and transmitted through the bottom.
    #[must_use]
    pub fn unscattered(&self, wi: DVec3) -> Vec<UnscatteredBeam> {
        if wi.z <= 0.0 {
            return Vec::new();
        }
        let inside = self.enter(wi);
        let through_top = inside.up * inside.attenuation() * inside.top.transmitted;
        let mut beams = vec![UnscatteredBeam {
            side: Side::Reflected,
            wo: DVec3::new(-wi.x, -wi.y, wi.z),
            flux: inside.top.reflected + through_top,
        }];
        if let Some(wo) = self.straight_on(wi, &inside) {
            beams.push(UnscatteredBeam {
                side: Side::Transmitted,
                wo,
                flux: inside.down * inside.attenuation() * self.bottom_face(inside.mu).transmitted,
            });
        }
        beams
    }

    /// Direction of light that passes both faces, if it can.
    fn straight_on(&self, wi: DVec3, inside: &Inside) -> Option<DVec3> {
        let index = self.bottom.index_beyond()?;
        let face = self.bottom_face(inside.mu);
        let passes = inside.top.transmitted > 0.0 && face.transmitted > 0.0;
        passes.then(|| {
            let across = -wi.truncate() / (self.eta * index);
            across.extend(-face.cos_theta_t).normalize()
        })
    }
}
