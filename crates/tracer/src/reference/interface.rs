//! Interface: moves a path to an interface, and divides its light there.

use asperity_optics::{Bottom, Material};
use glam::DVec3;
use rand::Rng;

use super::PathIntegrator;
use super::amplitudes::Amplitudes;
use super::event::InterfaceHit;
use super::facet::Scattered;
use super::result::PathEnd;
use super::state::{PathState, Space};
use crate::geometry::Geometry;
use crate::interaction::stack::Interface;
use crate::periodic::Heading;
use crate::ray::HalfSpace;

impl<G: Geometry> PathIntegrator<'_, G> {
    /// Moves a path to the interface that it meets, or ends it there if nothing can scatter it.
    pub(super) fn move_to_interface(
        &self,
        path: &mut PathState,
        hit: &InterfaceHit<G::Facet>,
    ) -> Option<PathEnd> {
        if let Some((_, heading)) = hit.at {
            self.advance(path, hit.t);
            path.heading = heading;
            path.flight = hit.t;
            return None;
        }
        let layer = self.layer_of(path.space)?;
        if !self.move_inside(path, hit.t) {
            return Some(PathEnd::LeftPatch);
        }
        let Heading {
            origin, direction, ..
        } = &mut path.heading;
        layer.put_onto_plane(origin, direction.z);
        (self.stack.bottom(hit.interface) == Some(Bottom::Open)).then_some(PathEnd::Below)
    }

    /// Normal of the interface where a path meets it, on the side of the path.
    pub(super) fn normal(&self, hit: &InterfaceHit<G::Facet>, space: Space) -> DVec3 {
        let side = space.side_of(hit.interface).sign();
        let surface = self.stack.surface(hit.interface);
        let geometry = surface.map_or(self.geometry, |surface| surface.geometry);
        let normal = hit.at.map_or(DVec3::Z, |(facet, heading)| {
            geometry.normal_at(facet, heading.origin)
        });
        side * normal
    }

    /// Divides the light of a path that has come to an interface, at a point of normal `m`.
    pub(super) fn scattered<R: Rng>(
        &self,
        interface: Interface,
        path: &PathState,
        m: DVec3,
        rng: &mut R,
    ) -> Scattered {
        let wi = -path.heading.direction;
        let face = self.face(interface, path.space);
        let scattered = match face {
            Face::Smooth(material) => Scattered::smoothly(material, wi, m),
            Face::Lambertian(reflectance) => Scattered::diffusely(reflectance, m, rng),
        };
        match (path.fields, face) {
            (None, _) => scattered,
            (Some(fields), Face::Smooth(material)) => {
                let amplitudes = Amplitudes::of(material, wi.dot(m).clamp(0.0, 1.0));
                scattered.polarised(&path.heading, &fields, m, &amplitudes)
            }
            (Some(_), Face::Lambertian(_)) => scattered.depolarised(&path.heading),
        }
    }

    /// Kind of an interface for light that comes through `space`.
    fn face(&self, interface: Interface, space: Space) -> Face {
        let bottom = self.stack.bottom(interface);
        match bottom.map_or(self.material, |bottom| bottom.material()) {
            Material::Lambertian { reflectance } => Face::Lambertian(reflectance),
            material if space.side_of(interface) == HalfSpace::Above => Face::Smooth(material),
            material => Face::Smooth(material.reversed()),
        }
    }
}

/// Kind of an interface that a path has come to.
#[derive(Clone, Copy)]
#[expect(
    clippy::large_enum_variant,
    reason = "one exists at a time, and is not stored"
)]
enum Face {
    /// A facet that reflects and refracts, of that material for the light that comes.
    Smooth(Material),
    /// A facet that reflects that fraction diffusely, and absorbs the rest.
    Lambertian(f64),
}
