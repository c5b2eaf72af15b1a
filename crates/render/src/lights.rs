//! Lights of a picture: a sky, a sun, and light from below.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{acos, cos, sin};
use asperity_optics::{Incidence, around};
use asperity_tracer::{Geometry, Sunlight};
use glam::{DVec2, DVec3};

/// Light from all sides. Radiance is relative to a unit of the user's choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lights {
    sky: f64,
    /// Radiance of the sky at the horizon over that at the zenith.
    horizon: f64,
    below: f64,
    sun: Option<Sun>,
}

/// A disc of uniform radiance, infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    towards: DVec3,
    /// Radiance of a white matt plane that faces it.
    strength: f64,
    sin_radius: f64,
    cos_radius: f64,
    patch: Option<Patch>,
}

/// A rectangle of the mean plane, length units of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    low: DVec2,
    high: DVec2,
}

/// Error of invalid lights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightsError {
    /// A radiance is out of range.
    #[error("the radiance of {0} is {1:?}; it must be from 0 to 1e30")]
    BadRadiance(&'static str, f64),
    /// The sun is a point, or half the sky.
    #[error(
        "the angular radius of the sun is {0} deg; it must be from 0.01 to 60 deg, since no path finds a point"
    )]
    BadRadius(f64),
    /// The horizon is brighter than the zenith, or dark beyond nothing.
    #[error("the horizon has {0} times the radiance of the zenith; the factor must be from 0 to 1")]
    BadHorizon(f64),
    /// The rectangle has no area.
    #[error("the patch is {0:?} to {1:?}; the first two must lie below the other two")]
    BadPatch([f64; 2], [f64; 2]),
}

impl Lights {
    /// A uniform sky above, uniform light below, and a sun.
    ///
    /// `sky`: radiance from all directions, seen in the medium above. `below`: radiance of what lies below, seen as through a
    /// flat interface that reflects nothing: that in the medium below over the square of its index relative
    /// to the medium above.
    ///
    /// # Errors
    /// [`LightsError::BadRadiance`] unless both are from 0 to 1e30.
    pub fn new(sky: f64, below: f64, sun: Option<Sun>) -> Result<Self, LightsError> {
        for (name, radiance) in [("the sky", sky), ("what lies below", below)] {
            check(name, radiance)?;
        }
        Ok(Self {
            sky,
            horizon: 1.0,
            below,
            sun,
        })
    }

    /// These lights with a sky that falls in proportion to the cosine of the polar angle, from `sky` at the zenith to
    /// `fraction` of it at the horizon. Only under a sky that is not uniform do rough mirrors look different from flat
    /// ones.
    ///
    /// # Errors
    /// [`LightsError::BadHorizon`] unless `fraction` is from 0 to 1.
    pub fn with_horizon(self, fraction: f64) -> Result<Self, LightsError> {
        match (0.0..=1.0).contains(&fraction) {
            true => Ok(Self {
                horizon: fraction,
                ..self
            }),
            false => Err(LightsError::BadHorizon(fraction)),
        }
    }

    /// The sun, if there is one.
    pub(crate) const fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref()
    }

    /// Radiance of the sky in the direction `towards`.
    pub(crate) fn sky(&self, towards: DVec3) -> f64 {
        self.sky * (self.horizon + (1.0 - self.horizon) * towards.z.max(0.0))
    }

    /// Radiance that comes from the direction `towards`, on a line that meets the mean plane at `place`.
    pub(crate) fn above(&self, towards: DVec3, place: impl FnOnce() -> DVec2) -> f64 {
        let sun = self.sun.as_ref().filter(|sun| sun.shines(towards, place));
        self.sky(towards) + sun.map_or(0.0, Sun::radiance)
    }

    /// Radiance that comes from below.
    pub(crate) const fn below(&self) -> f64 {
        self.below
    }
}

impl Sun {
    /// A sun about the direction `towards`, of angular radius `radius` in radians.
    ///
    /// `strength`: the radiance of a white matt plane that faces it, its irradiance over pi, so that a sun
    /// of one is about as bright as a sky of one. With a `patch` it shines only along those straight lines
    /// that meet the mean plane in there.
    ///
    /// # Errors
    /// [`LightsError`] unless `strength` is from 0 to 1e30 and the radius from 0.01 to 60 degrees.
    pub fn new(
        towards: Incidence,
        strength: f64,
        radius: f64,
        patch: Option<Patch>,
    ) -> Result<Self, LightsError> {
        check("the sun", strength)?;
        let degrees = radius.to_degrees();
        if !(0.01 - 1e-12..=60.0 + 1e-12).contains(&degrees) {
            return Err(LightsError::BadRadius(degrees));
        }
        Ok(Self {
            towards: towards.wi(),
            strength,
            sin_radius: sin(radius),
            cos_radius: cos(radius),
            patch,
        })
    }

    /// Returns `true` if it shines on a rectangle alone.
    pub(crate) const fn is_limited(&self) -> bool {
        self.patch.is_some()
    }

    /// Polar angle of the middle of the disc, radians.
    pub(crate) fn theta(&self) -> f64 {
        acos(self.towards.z.clamp(-1.0, 1.0))
    }

    /// Radiance of the disc: its irradiance `pi strength` over its projected solid angle `pi sin^2`.
    fn radiance(&self) -> f64 {
        self.strength / (self.sin_radius * self.sin_radius)
    }

    /// The direction of a point of the disc, by two uniform numbers that spread evenly over its solid angle.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        around(self.towards, 1.0 - u * (1.0 - self.cos_radius), v)
    }

    /// The disc, as paths are connected to it.
    pub(crate) const fn sunlight<'a, G: Geometry>(&self) -> Sunlight<'a, G> {
        Sunlight::new(self.towards, self.cos_radius)
    }

    /// Radiance times solid angle, which light from one direction stands for on a line that meets the mean
    /// plane at `place`.
    pub(crate) fn collimated(&self, place: DVec2) -> f64 {
        let lit = self.patch.is_none_or(|patch| patch.contains(place));
        if lit {
            TAU * (1.0 - self.cos_radius) * self.radiance()
        } else {
            0.0
        }
    }

    fn shines(&self, towards: DVec3, place: impl FnOnce() -> DVec2) -> bool {
        towards.dot(self.towards) > self.cos_radius
            && self.patch.is_none_or(|patch| patch.contains(place()))
    }
}

impl Patch {
    /// The rectangle from the corner `low` to the corner `high`.
    ///
    /// # Errors
    /// [`LightsError::BadPatch`] if it has no area.
    pub fn new(low: [f64; 2], high: [f64; 2]) -> Result<Self, LightsError> {
        if !(low[0] < high[0] && low[1] < high[1]) {
            return Err(LightsError::BadPatch(low, high));
        }
        let [low, high] = [low, high].map(DVec2::from_array);
        Ok(Self { low, high })
    }

    fn contains(&self, place: DVec2) -> bool {
        place.cmpge(self.low).all() && place.cmplt(self.high).all()
    }
}

fn check(name: &'static str, radiance: f64) -> Result<(), LightsError> {
    if (0.0..=1e30).contains(&radiance) {
        Ok(())
    } else {
        Err(LightsError::BadRadiance(name, radiance))
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::from_spherical;

    use super::*;

    #[test]
    fn a_plane_that_faces_the_sun_gets_its_irradiance_whatever_the_radius() {
        for radius in [0.001_f64, 0.1, 0.8] {
            let towards = Incidence::from_degrees(0.0, 0.0).unwrap();
            let sun = Sun::new(towards, 0.7, radius, None).unwrap();
            let lights = Lights::new(0.0, 0.0, Some(sun)).unwrap();
            // Integral of radiance over projected solid angle, 2 pi sin cos dtheta, by the midpoint rule:
            // the step at the rim is off by half a step at most.
            let n = 100_000;
            let step = 2.0 * radius / f64::from(n);
            let irradiance: f64 = (0..n)
                .map(|i| {
                    let theta = (f64::from(i) + 0.5) * step;
                    let radiance = lights.above(from_spherical(theta, 1.0), || DVec2::ZERO);
                    TAU * radiance * theta.sin() * theta.cos() * step
                })
                .sum();
            let expected = 0.7 * std::f64::consts::PI;
            assert!((irradiance / expected - 1.0).abs() < 1e-4, "{radius}");
        }
    }

    /// Evenly over the solid angle: of `1 - cos` to the middle the mean is half and the mean square a third of
    /// that of the rim, and both sides are alike.
    #[test]
    fn points_spread_evenly_over_the_disc() {
        let towards = Incidence::from_degrees(40.0, 70.0).unwrap();
        let radius = 0.3_f64;
        let sun = Sun::new(towards, 1.0, radius, None).unwrap();
        let n = 200;
        let (mut sums, mut middle) = ([0.0; 2], DVec3::ZERO);
        for i in 0..n * n {
            let [u, v] = [i / n, i % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let point = sun.point([u, v]);
            let inside = (1.0 - point.dot(towards.wi())) / (1.0 - radius.cos());
            sums[0] += inside / f64::from(n * n);
            sums[1] += inside * inside / f64::from(n * n);
            middle += point / f64::from(n * n);
        }
        // The midpoint rule is off by a twelfth of a step squared.
        assert!(
            (sums[0] - 0.5).abs() < 1e-5 && (sums[1] - 1.0 / 3.0).abs() < 1e-5,
            "{sums:?}"
        );
        let expected = 0.5 * (1.0 + radius.cos()) * towards.wi();
        assert!((middle - expected).length() < 1e-9, "{middle}");
    }

    #[test]
    fn a_patch_limits_the_sun_and_not_the_sky() {
        let towards = Incidence::from_degrees(30.0, 0.0).unwrap();
        let patch = Patch::new([0.0, 0.0], [2.0, 1.0]).unwrap();
        let sun = Sun::new(towards, 1.0, 0.1, Some(patch)).unwrap();
        let lights = Lights::new(0.25, 0.0, Some(sun)).unwrap();
        let at = |x, y| lights.above(towards.wi(), || DVec2::new(x, y));
        assert!(at(1.0, 0.5) > 1.0);
        assert_eq!([at(-0.1, 0.5), at(1.0, 1.1)], [0.25; 2]);
    }

    #[test]
    fn the_sky_falls_towards_the_horizon() {
        let lights = Lights::new(0.8, 0.0, None).unwrap();
        let at = |lights: &Lights, theta: f64| {
            let towards = Incidence::from_degrees(theta, 20.0).unwrap();
            lights.above(towards.wi(), || DVec2::ZERO)
        };
        assert_eq!([at(&lights, 0.0), at(&lights, 80.0)], [0.8; 2]);
        let falling = lights.with_horizon(0.25).unwrap();
        for (theta, expected) in [(0.0, 0.8), (60.0, 0.8 * (0.25 + 0.75 * 0.5))] {
            assert!((at(&falling, theta) - expected).abs() < 1e-12, "{theta}");
        }
        assert!(lights.with_horizon(1.1).is_err());
    }

    #[test]
    fn impossible_lights_are_refused() {
        let towards = Incidence::from_degrees(30.0, 0.0).unwrap();
        for radius in [0.0, 2.0, f64::NAN] {
            assert!(Sun::new(towards, 1.0, radius, None).is_err());
        }
        assert!(Sun::new(towards, -1.0, 0.1, None).is_err());
        assert!(Lights::new(f64::NAN, 0.0, None).is_err());
        assert!(Lights::new(1.0, -1.0, None).is_err());
        assert!(Patch::new([0.0, 0.0], [0.0, 1.0]).is_err());
    }
}
