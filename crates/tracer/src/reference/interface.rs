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
use crate::interaction::layer::{Interface, TracedLayer};

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
        let layer = self.layer.as_ref()?;
        if !self.move_inside(path, hit.t) {
            return Some(PathEnd::LeftPatch);
        }
        layer.put_onto_bottom(&mut path.heading.origin);
        (layer.bottom() == Some(Bottom::Open)).then_some(PathEnd::Below)
    }

    /// Normal of the interface where a path meets it, on the side of the path.
    pub(super) fn normal(&self, hit: &InterfaceHit<G::Facet>, space: Space) -> DVec3 {
        let bottom = self.layer.as_ref().and_then(TracedLayer::surface);
        let geometry = match (hit.interface, bottom) {
            (Interface::Bottom, Some(bottom)) => bottom.geometry,
            _ => self.geometry,
        };
        let is_above = match hit.interface {
            Interface::Top => space == Space::Above,
            Interface::Bottom => space == Space::Inside,
        };
        let side = if is_above { 1.0 } else { -1.0 };
        hit.at.map_or(DVec3::Z, |(facet, heading)| {
            side * geometry.normal_at(facet, heading.origin)
        })
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
            Face::Absorbing => Scattered::nowhere(),
        };
        match (path.fields, face) {
            (None, _) => scattered,
            (Some(fields), Face::Smooth(material)) => {
                let amplitudes = Amplitudes::of(material, wi.dot(m).clamp(0.0, 1.0));
                scattered.polarised(&path.heading, &fields, m, &amplitudes)
            }
            (Some(_), Face::Lambertian(_) | Face::Absorbing) => {
                scattered.depolarised(&path.heading)
            }
        }
    }

    /// Kind of an interface for light that comes through `space`.
    fn face(&self, interface: Interface, space: Space) -> Face {
        let bottom = self.layer.as_ref().and_then(TracedLayer::bottom);
        let (material, incident) = match (interface, bottom) {
            (Interface::Top, _) | (_, None) => (self.material, Space::Above),
            (_, Some(Bottom::Interface { eta })) => (Material::Dielectric { eta }, Space::Inside),
            (_, Some(Bottom::Mirror)) => (Material::Mirror, Space::Inside),
            (_, Some(Bottom::Lambertian { reflectance })) => return Face::Lambertian(reflectance),
            _ => return Face::Absorbing,
        };
        match material {
            Material::Lambertian { reflectance } => Face::Lambertian(reflectance),
            material if space == incident => Face::Smooth(material),
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
    /// A facet that absorbs all light.
    Absorbing,
}
