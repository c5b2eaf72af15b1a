//! Event paths of unscattered light in flat layers: what happened to it at the faces, interaction by interaction.

use asperity_tally::{Event, EventPath, MAX_LISTED_ORDER, MAX_LISTED_PATH, Side};

use super::flat_layers::{FlatLayers, LayerPaths};
use super::passage::Passage;

/// Unscattered light that has left.
pub(super) struct Left {
    pub(super) side: Side,
    pub(super) path: EventPath,
    pub(super) flux: f64,
}

/// Unscattered light at a face.
struct Ray {
    /// Number of the face, from above.
    face: usize,
    is_down: bool,
    path: EventPath,
    flux: f64,
}

impl FlatLayers {
    /// Unscattered light that leaves after fewer than [`MAX_LISTED_ORDER`] interactions, by its path. Paths that have no entry of
    /// their own in a tally are followed together.
    pub(super) fn event_paths(&self, incident: &Passage) -> Vec<Left> {
        let mut left = Vec::new();
        let mut rays = vec![Ray {
            face: 0,
            is_down: true,
            path: EventPath::default(),
            flux: 1.0,
        }];
        for order in 1..MAX_LISTED_ORDER {
            let branches = rays.iter().flat_map(|ray| self.branches(ray, incident));
            let mut next: Vec<Ray> = Vec::new();
            for branch in branches.filter(|branch| branch.flux > 0.0) {
                let ray = match self.next_face(branch, incident) {
                    Ok(ray) => ray,
                    Err(exit) => {
                        left.push(exit);
                        continue;
                    }
                };
                let is_alike = |other: &&mut Ray| {
                    order > MAX_LISTED_PATH
                        && (other.face, other.is_down) == (ray.face, ray.is_down)
                };
                match next.iter_mut().find(is_alike) {
                    Some(other) => other.flux += ray.flux,
                    None => next.push(ray),
                }
            }
            rays = next;
        }
        left
    }

    /// Light that a face reflects and transmits of a ray.
    fn branches(&self, ray: &Ray, incident: &Passage) -> [Ray; 2] {
        let face = incident.faces[ray.face];
        let fractions = if ray.is_down { face.near } else { face.far };
        let is_inside = ray.path.order() > 0;
        let reflected = match self.paths {
            LayerPaths::HanrahanKrueger if is_inside => 0.0,
            _ => fractions.reflected,
        };
        let is_face = !(self.is_open && ray.face == self.media.len());
        let branch = |event, is_down, fraction| Ray {
            path: if is_face {
                ray.path.then(event)
            } else {
                ray.path
            },
            flux: ray.flux * fraction,
            is_down,
            face: ray.face,
        };
        [
            branch(Event::Reflection, !ray.is_down, reflected),
            branch(Event::Transmission, ray.is_down, fractions.transmitted),
        ]
    }

    /// Light from one face when it meets the next, or when it leaves the stack.
    fn next_face(&self, ray: Ray, incident: &Passage) -> Result<Ray, Left> {
        let Ray { path, flux, .. } = ray;
        let (layer, side) = match ray.is_down {
            true => (Some(ray.face), Side::Transmitted),
            false => (ray.face.checked_sub(1), Side::Reflected),
        };
        let layer = layer.filter(|&layer| layer < self.media.len());
        let layer = layer.ok_or(Left { side, path, flux })?;
        let attenuation = incident.layers[layer].attenuation(self.media[layer].tau);
        Ok(Ray {
            face: layer + usize::from(ray.is_down),
            flux: flux * attenuation,
            ..ray
        })
    }
}
