//! Interaction: one bounce of a path at a facet, from scattering to Russian roulette.

use asperity_optics::Bottom;
use asperity_tally::Loss;
use rand::{Rng, RngExt};

use super::Tracer;
use super::batch::Batch;
use super::flight::scatter_at_bottom;
use super::state::{Arrival, Departure, PathRay, PathState, RayKind, Region};
use crate::geometry::Geometry;
use crate::interaction::facet::{Branch, Scattered, scatter};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::settings::Branching;

impl<'a, G: Geometry> Tracer<'a, G> {
    /// Lets a path interact with the facet at which it has arrived, and traces what leaves the facet.
    #[inline]
    pub(super) fn interact<R: Rng>(
        &self,
        at: Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        // End the path at the highest order
        if state.events.order() >= self.settings.max_order {
            batch.tally.add_loss(Loss::Truncated, state.flux);
            return;
        }

        // Scatter at the facet
        match at.region.interface {
            Interface::Top => self.interact_at_surface(&at, state, batch),
            Interface::Bottom => self.interact_at_bottom(&at, state, batch),
        }

        // Look for shadowed facets behind the first one
        if batch.tally.control_variate().is_some() {
            self.trace_behind_first_facet(at, state, batch);
        }
    }

    /// Reflects, transmits or absorbs light at a facet of the surface.
    #[inline]
    pub(super) fn interact_at_surface<R: Rng>(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        // Scatter by the Fresnel equations
        let scattered = self.scattered(at);
        let absorbed = state.flux * scattered.absorbed;
        if state.events.order() == 0 {
            batch.tally.add_first_absorbed(absorbed);
        } else {
            batch.tally.add_loss(Loss::Absorbed, absorbed);
        }

        // Trace the branches that survive
        let divides = self.material.transmitting_index().is_some();
        for (branch, fraction) in self.followed(&scattered, divides, batch.rng) {
            let mut ray = at.leave(&branch, fraction, state);
            if self.survives_roulette(&mut ray.state, batch) {
                self.trace_if_recorded(ray, batch);
            }
        }
    }

    /// Reflects, transmits or absorbs light at a facet of the layer's bottom.
    fn interact_at_bottom<R: Rng>(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let (Some(bottom), Some(geometry)) = (
            self.layer.as_ref().and_then(TracedLayer::bottom),
            self.geometry_of(Interface::Bottom),
        ) else {
            return;
        };
        let half_space = at.region.half_space;
        let m = half_space.sign() * geometry.normal(at.facet);
        let wi = -at.heading.direction;
        let scattered = scatter_at_bottom(bottom, half_space, wi, m, batch.rng);
        batch
            .tally
            .add_loss(Loss::Absorbed, state.flux * scattered.absorbed);
        let divides = matches!(bottom, Bottom::Interface { .. });
        for (branch, fraction) in self.followed(&scattered, divides, batch.rng) {
            let mut ray = at.leave(&branch, fraction, state);
            if self.survives_roulette(&mut ray.state, batch) {
                self.trace(ray, RayKind::Path, batch);
            }
        }
    }

    /// What a facet of the surface does with light that has arrived at it.
    #[inline(always)]
    pub(super) fn scattered(&self, at: &Arrival<G::Facet>) -> Scattered {
        let half_space = at.region.half_space;
        let m = half_space.sign() * self.geometry.normal(at.facet);
        let wi = -at.heading.direction;
        scatter(self.material, half_space == self.incident, wi, m)
    }

    /// The branches that are traced, each with the fraction of the flux that it takes: both, or one picked at
    /// random where an interface `divides` light.
    #[inline(always)]
    pub(super) fn followed<R: Rng>(
        &self,
        scattered: &Scattered,
        divides: bool,
        rng: &mut R,
    ) -> impl Iterator<Item = (Branch, f64)> + use<'_, 'a, R, G> {
        let [transmitted, reflected] = scattered.branches;
        let fractions = if divides && self.settings.branching == Branching::Pick {
            if rng.random::<f64>() < reflected.fraction {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        } else {
            [transmitted.fraction, reflected.fraction]
        };
        [transmitted, reflected]
            .into_iter()
            .zip(fractions)
            .filter(|(_, fraction)| *fraction > 0.0)
    }

    /// Russian roulette: a path of little flux continues with a probability proportional to its flux, and then
    /// carries the threshold; false if it ends. Flux that roulette removes or adds is tallied as truncated, zero
    /// on average.
    ///
    /// Under a control variate the first branches are all traced: what cancels must not be left to chance.
    #[inline(always)]
    pub(super) fn survives_roulette<R: Rng>(
        &self,
        state: &mut PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) -> bool {
        self.survives_roulette_below(self.settings.roulette_below, state, batch)
    }

    /// The same with another threshold.
    #[inline(always)]
    pub(super) fn survives_roulette_below<R: Rng>(
        &self,
        threshold: f64,
        state: &mut PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) -> bool {
        let cancels = state.events.order() == 1 && batch.tally.control_variate().is_some();
        if state.flux < threshold && !cancels {
            let survives = batch.rng.random::<f64>() * threshold < state.flux;
            let kept = if survives { threshold } else { 0.0 };
            batch.tally.add_loss(Loss::Truncated, state.flux - kept);
            state.flux = kept;
        }
        state.flux > 0.0
    }

    /// Traces a ray from the surface, unless it can end only on a side that is not recorded.
    ///
    /// A path that has reached the highest order has no interaction left: it escapes on the side of its half
    /// space, or is truncated. If that side is not recorded, its flux is tallied as such at once. A path of lower
    /// order is always traced, since it may come back. This is decided after all random numbers of a branch are
    /// drawn, and one of the highest order draws no more, so the tally of a side does not depend on whether the
    /// other is recorded.
    #[inline(always)]
    fn trace_if_recorded<R: Rng>(&self, ray: PathRay, batch: &mut Batch<'_, G::Facet, R>) {
        // Inside the layer it may yet be absorbed, or leave elsewhere.
        let is_inside = self.layer.is_some() && ray.region == Region::inside(Interface::Top);
        let is_last = ray.state.events.order() >= self.settings.max_order && !is_inside;
        if is_last && !batch.tally.records(self.side_of(ray.region)) {
            batch.tally.add_loss(Loss::NotRecorded, ray.state.flux);
            let departure = Departure {
                region: ray.region,
                direction: ray.heading.world_direction(),
                state: ray.state,
            };
            self.tally_masked(&departure, batch);
            batch.work.branches_not_recorded += 1;
        } else {
            self.trace(ray, RayKind::Path, batch);
        }
    }
}
