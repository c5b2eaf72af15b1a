//! What is not lit or not seen: looking for it, and taking note of it under a control.

use asperity_tally::Loss;
use glam::DVec3;
use rand::{Rng, RngExt};

use super::leg::{Arrival, Errand, Leg, Light, onward};
use super::{Batch, Tracer};
use crate::geometry::Geometry;
use crate::interaction::layer::Face;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};
use crate::ray::HalfSpace;

impl<G: Geometry> Tracer<'_, G> {
    /// Looks along `towards_light` whether a facet is lit.
    #[inline(never)]
    pub(super) fn look<R: Rng>(
        &self,
        mut towards_light: Heading,
        light: Light,
        at: Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        // Most facets see the light without a search, and need not be kept.
        match begin(self.geometry, &mut towards_light, self.incident) {
            Some(end) => {
                batch.work.count(end);
                self.looked(end, &light, &at, batch);
            }
            None => {
                let way = Traversal::begin(&towards_light);
                let query = towards_light.query(self.geometry, self.incident);
                let leg = Leg {
                    way,
                    light,
                    errand: Errand::Sight(Box::new(at)),
                    flight: f64::INFINITY,
                };
                self.push(Face::Top, leg, query, batch);
            }
        }
    }

    /// What follows where nothing stands between a facet and the light.
    pub(super) fn looked<R: Rng>(
        &self,
        end: TraversalEnd,
        light: &Light,
        at: &Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        match end {
            TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_) => {
                self.interact(at, self.incident, light, batch);
            }
            TraversalEnd::LeftPatch | TraversalEnd::Lost => {
                self.unlit(at, light, batch);
                batch.record.add_loss(Loss::Lost, light.flux);
            }
        }
    }

    /// Goes on behind the first facet that light has met, where that is of interest.
    #[inline(never)]
    pub(super) fn look_into_shadow<R: Rng>(
        &self,
        at: Arrival<G::Facet>,
        behind: HalfSpace,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let Some(control) = batch.record.control_variate() else {
            return;
        };
        let probability = control.shadow_probability();
        if light.path.order() > 0 || probability < 1.0 && batch.rng.random::<f64>() >= probability {
            return;
        }
        let line = Light {
            flux: light.flux / probability,
            ..*light
        };
        self.set_out(Face::Top, at.heading, behind, line, Errand::Shadow, batch);
    }

    /// Takes note that light on its way from its first facet does not get away.
    pub(super) fn unseen<R>(
        &self,
        direction: DVec3,
        half_space: HalfSpace,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if light.path.order() == 1 && batch.record.control_variate().is_some() {
            let exit = self.exit(direction, Face::Top, half_space, light);
            batch.record.add_masked(&exit);
        }
    }

    /// Takes note that a facet that faces the light is not lit.
    #[inline(never)]
    pub(super) fn unlit<R>(
        &self,
        at: &Arrival<G::Facet>,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if batch.record.control_variate().is_none() {
            return;
        }
        let scattered = self.scattered(at, self.incident);
        for branch in scattered.branches {
            if branch.share > 0.0 {
                let (heading, half_space, light) =
                    onward(at, self.incident, light, &branch, branch.share);
                let exit = self.exit(heading.world_direction(), Face::Top, half_space, &light);
                batch.record.add_masked(&exit);
            }
        }
        batch
            .record
            .add_shadowed_absorbed(light.flux * scattered.absorbed);
    }
}
