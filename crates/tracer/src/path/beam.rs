//! Beam: the collimated light that falls on a surface, and the start points of its rays.

use std::f64::consts::PI;

use asperity_optics::Incidence;
use asperity_surface::Border;
use asperity_tally::{Azimuth, ControlVariate, Tally, TallySpec};
use glam::{DVec2, DVec3};

use crate::geometry::Geometry;
use crate::path::illumination::{Illumination, Starts, Window};
use crate::path::state::path_state::turned;
use crate::periodic::Heading;
use crate::ray::HalfSpace;
use crate::settings::Polarisation;

/// Light that falls evenly on a window of one period of a surface.
///
/// Its rays start where they pass the highest point of the surface (the lowest, if they come from
/// below).
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Unit vector towards the light, as the surface lies.
    wi: DVec3,
    incident: HalfSpace,
    /// Corner and size of the window along x and y, tile coordinates.
    corner: [f64; 2],
    size: [f64; 2],
    aspect: f64,
    /// z of all starts.
    z: f64,
    /// Distance along a ray from there to the mean plane.
    to_mean_plane: f64,
}

impl Beam {
    /// The light of `incidence` from the `incident` half space that falls on a window of `surface`.
    #[must_use]
    pub fn new<G: Geometry>(
        surface: &G,
        incident: HalfSpace,
        incidence: Incidence,
        window: Window,
    ) -> Self {
        let wi = incidence.wi() * DVec3::new(1.0, 1.0, incident.sign());
        // A mirrored tile and its images make a period of two tiles along each axis.
        let tiles = match surface.border() {
            Border::Mirrored => 2.0,
            Border::Periodic | Border::Open => 1.0,
        };
        let period = surface.extent().map(|e| e * tiles);
        let [low, high] = surface.z_range();
        let z = match incident {
            HalfSpace::Above => high,
            HalfSpace::Below => low,
        };
        Self {
            wi,
            incident,
            corner: [0, 1].map(|i| window.from[i] * period[i]),
            size: [0, 1].map(|i| (window.to[i] - window.from[i]) * period[i]),
            aspect: surface.aspect(),
            z,
            to_mean_plane: (z - surface.mean_plane()) / wi.z,
        }
    }

    /// Empty tally of the paths of this light over facets of slopes up to `steepest`.
    ///
    /// Exits have no azimuth where vertical light may come from any. No path adds more flux to an entry at a time than that with which it
    /// starts, which branches share and Russian roulette raises to one at the most. Shadowed facets that are traced count for those
    /// that are not.
    #[must_use]
    pub fn tally<'c>(
        &self,
        illumination: &Illumination,
        polarisation: Polarisation,
        steepest: f64,
        spec: TallySpec,
        control: Option<&'c ControlVariate>,
    ) -> Tally<'c> {
        let azimuth = if illumination.any_azimuth && !illumination.turns(polarisation) {
            Azimuth::Free
        } else {
            Azimuth::From(illumination.incidence.phi() + PI)
        };
        let start = match illumination.starts {
            Starts::FromAbove => 1.0,
            Starts::OnSurface => self.largest_flux_on(steepest),
        };
        let largest = start / control.map_or(1.0, ControlVariate::shadow_probability);
        Tally::new(spec, azimuth)
            .with_control_variate(control)
            .with_largest_weight(largest)
    }

    /// This beam from another direction of the same half space; `wi` has `z > 0`.
    pub(crate) fn towards(&self, wi: DVec3) -> Self {
        let wi = wi * DVec3::new(1.0, 1.0, self.incident.sign());
        Self {
            to_mean_plane: self.to_mean_plane * (self.wi.z / wi.z),
            wi,
            ..*self
        }
    }

    /// Corner and size of the window along x and y, tile coordinates.
    #[must_use]
    pub const fn window(&self) -> [[f64; 2]; 2] {
        [self.corner, self.size]
    }

    /// z of all starts, and the distance along a ray from there to the mean plane.
    #[must_use]
    pub const fn heights(&self) -> [f64; 2] {
        [self.z, self.to_mean_plane]
    }

    /// Unit vector towards the light, before it is turned by the azimuth of a start.
    #[must_use]
    pub const fn wi(&self) -> DVec3 {
        self.wi
    }

    /// Returns `true` if its rays are vertical.
    pub(crate) fn is_vertical(&self) -> bool {
        self.wi.truncate() == DVec2::ZERO
    }

    /// The ray that would meet the mean plane at `[u, v]` of the window, from light whose azimuth is turned by the angle of
    /// which `turn` holds cosine and sine.
    pub(crate) fn ray(&self, position: [f64; 2], turn: DVec2) -> Heading {
        let direction = turned(-self.wi, turn);
        Heading {
            origin: self.origin(position, [direction.x, direction.y]),
            direction,
            mirrored: [false; 2],
        }
    }

    /// Start point of the ray at that position whose direction has the components `[dx, dy]`.
    #[inline(always)]
    pub(crate) fn origin(&self, position: [f64; 2], [dx, dy]: [f64; 2]) -> DVec3 {
        let [x, y] = self.position(position);
        DVec3::new(
            x - self.to_mean_plane * dx,
            y - self.to_mean_plane * dy * self.aspect,
            self.z,
        )
    }

    /// Point `[u, v]` of the window, tile coordinates.
    #[inline(always)]
    pub(crate) fn position(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let ([x, y], [width, depth]) = (self.corner, self.size);
        [x + u * width, y + v * depth]
    }

    /// Upper bound of the flux that falls on facets up to a slope: `1 + slope tan theta_i`, since `m / cos theta_m` is
    /// `(-gradient, 1)`.
    #[must_use]
    pub(crate) fn largest_flux_on(&self, slope: f64) -> f64 {
        1.0 + slope * self.wi.truncate().length() / self.wi.z.abs()
    }

    /// The flux that falls on a facet with the upward normal `m` from light in the direction `wi`, as a fraction of that of a ray:
    /// `max(0, wi . m) / (cos theta_m cos theta_i)`.
    ///
    /// # Source
    /// Xu and Sun 2008, the weight of Eq. 26.
    #[inline(always)]
    pub(crate) fn flux_on(&self, wi: DVec3, m: DVec3) -> f64 {
        let m = self.incident.sign() * m;
        let facing = wi.dot(m);
        let flux = facing / (m.z * self.wi.z);
        if facing > 0.0 { flux } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use asperity_surface::HeightField;
    use asperity_tally::{Tallies, UnshadowedFluxes, VisibleFractions};

    use super::*;
    use crate::geometry::height_field::Surface;

    #[test]
    fn tallies_bound_the_weight_of_starts_and_have_azimuths_unless_all_are_alike() {
        let field = HeightField::new(vec![0.0; 9], [3, 3], [1.0; 2]).unwrap();
        let surface = Surface::new(field);
        let spec = TallySpec::default();
        let fractions = VisibleFractions {
            rings: [0, 1].map(|_| vec![1.0; spec.grid().n_theta()]),
            absorbed: 1.0,
        };
        let control = ControlVariate::new(spec, fractions, &UnshadowedFluxes::zeros(&spec))
            .with_shadow_probability(0.4);
        let layout = |light: &Illumination, polarisation, control| {
            let beam = Beam::new(&surface, HalfSpace::Above, light.incidence, light.window);
            let tally = beam.tally(light, polarisation, 3.0, spec, control);
            Tallies::new(tally, 1).layout().unwrap()
        };

        // A flux of one is 2^13 high parts, less the digits of the largest weight: 1, 1 / 0.4, and 1 + 3 tan 60 degrees
        let from_above = Illumination::new(Incidence::from_degrees(60.0, 0.0).unwrap(), true);
        let on_surface = Illumination {
            starts: Starts::OnSurface,
            ..from_above
        };
        let averaged = Polarisation::Averaged;
        for (light, control, scale) in [
            (from_above, None, 8192.0),
            (from_above, Some(&control), 2048.0),
            (on_surface, None, 1024.0),
            (on_surface, Some(&control), 512.0),
        ] {
            assert_eq!(layout(&light, averaged, control).scale, scale);
        }

        // Of vertical light from any azimuth only that of its axes is left
        let vertical = Illumination::new(Incidence::from_degrees(0.0, 0.0).unwrap(), true);
        let polarised = Illumination {
            stokes: [0.5, 0.0, 0.0],
            ..vertical
        };
        for (light, has_azimuths) in [(from_above, true), (vertical, false), (polarised, true)] {
            let slice = layout(&light, averaged, None).slice;
            assert_eq!(slice.is_some(), has_azimuths);
        }
    }
}
