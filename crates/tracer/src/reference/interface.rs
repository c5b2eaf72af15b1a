//! Interface: moves a path to an interface, and says what the interface does with its light.

use asperity_optics::{Bottom, Material, around};
use asperity_tally::Event;
use glam::DVec3;
use rand::{Rng, RngExt};

use super::PathIntegrator;
use super::amplitudes::Amplitudes;
use super::division::Division;
use super::next_event::InterfaceHit;
use super::result::PathEnd;
use super::state::{PathState, Space};
use crate::geometry::Geometry;
use crate::interaction::facet::{Branch, Scattered, scatter};
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
            (Interface::Bottom, Some((bottom, _))) => bottom,
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

    /// What an interface does with the light of a path that has come to it, at a place of normal `m`.
    pub(super) fn divided<R: Rng>(
        &self,
        interface: Interface,
        path: &PathState,
        m: DVec3,
        rng: &mut R,
    ) -> Division {
        let wi = -path.heading.direction;
        let material = self.material(interface, path.space);
        let scattered = match material {
            Some(material) => scatter(material, true, wi, m),
            None => self.scattered_at_bottom(m, rng),
        };
        let division = Division::averaged(&scattered);
        match (path.fields, material) {
            (None, _) => division,
            (Some(fields), Some(material)) => {
                let amplitudes = Amplitudes::of(material, wi.dot(m).clamp(0.0, 1.0));
                division.polarised(&path.heading, &fields, m, &amplitudes)
            }
            (Some(_), None) => division.depolarised(&path.heading),
        }
    }

    /// The material of an interface for light that comes through `space`; `None` for a bottom that reflects
    /// diffusely, or not at all.
    fn material(&self, interface: Interface, space: Space) -> Option<Material> {
        let bottom = self.layer.as_ref().and_then(TracedLayer::bottom);
        let (material, incident) = match (interface, bottom) {
            (Interface::Top, _) | (_, None) => (self.material, Space::Above),
            (_, Some(Bottom::Interface { eta })) => (Material::Dielectric { eta }, Space::Inside),
            (_, Some(Bottom::Mirror)) => (Material::Mirror, Space::Inside),
            _ => return None,
        };
        Some(if space == incident {
            material
        } else {
            material.reversed()
        })
    }

    /// What a bottom does that is no interface, at a place of normal `m`.
    fn scattered_at_bottom<R: Rng>(&self, m: DVec3, rng: &mut R) -> Scattered {
        let (reflectance, wo) = match self.layer.as_ref().and_then(TracedLayer::bottom) {
            // Lambert: the squared cosine to the normal is evenly distributed.
            Some(Bottom::Lambertian { reflectance }) => {
                let cos_theta_o = rng.random::<f64>().sqrt();
                (reflectance, around(m, cos_theta_o, rng.random()))
            }
            _ => (0.0, DVec3::ZERO),
        };
        let branch = |event, fraction, direction| Branch {
            event,
            direction,
            fraction,
        };
        Scattered {
            branches: [
                branch(Event::Transmission, 0.0, DVec3::ZERO),
                branch(Event::Reflection, reflectance, wo),
            ],
            absorbed: 1.0 - reflectance,
        }
    }
}
