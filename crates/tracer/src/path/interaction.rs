//! Interaction: what happens to light at the facets at which it has arrived, from scattering to Russian roulette.

use asperity_optics::Material;
use asperity_tally::{Loss, Tallies};

use super::Tracer;
use super::arrivals::{Arrivals, Move};
use super::batch::{Batch, Interactions};
use super::branch::{PickBranches, SplitBranches};
use super::diffuse::ScatterDiffusely;
use super::random_pairs::DrawPairs;
use super::roulette::Roulette;
use super::scatter::Scatter;
use super::scatter_polarised::ScatterPolarised;
use super::segments::Segments;
use super::state::{Arrival, PathState, Region};
use crate::geometry::Geometry;
use crate::interaction::facet::{Scattered, scatter};
use crate::interaction::layer::Interface;
use crate::interaction::polarised::{BothLight, MuellerLight, TrackedLight};
use crate::random::PathStream;
use crate::ray::HalfSpace;
use crate::settings::{Branching, Polarisation};
use crate::vector::Stage;

/// Adds segments to those that begin inside the layer, by their numbers.
struct Enter<'a> {
    segments: &'a Segments,
    which: &'a [u32],
    entering: &'a mut Segments,
}

impl Stage for Enter<'_> {
    #[inline(always)]
    fn run(self) {
        self.entering.gather(self.segments, self.which);
    }
}

impl<'a, G: Geometry> Tracer<'a, G> {
    /// Lets a path interact with the facet at which it has arrived: at the upper surface with all others of the round.
    pub(super) fn interact(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        match at.region.interface {
            Interface::Top => batch.arrivals.push(at, state),
            Interface::Bottom => self.interact_at_bottom(at, state, batch),
        }
    }

    /// Lets all paths interact that have arrived at the upper surface; `batch.segments` then holds what leaves it.
    pub(super) fn interact_at_surface(&self, batch: &mut Batch<'_, G::Facet>) {
        self.truncate_at_highest_order(batch);

        // Scatter at the facets
        batch.instructions.run(Move {
            geometry: self.geometry,
            arrivals: &mut batch.arrivals,
        });
        self.scatter_arrivals(batch);
        let divides = self.material.transmitting_index().is_some();
        if !divides {
            self.absorb(batch);
        }

        // Look for shadowed facets behind the first one
        if batch.traces_shadows {
            self.trace_behind_first_facets(batch);
        }

        // Make the branches that survive
        let picks = divides && self.settings.branching == Branching::Pick;
        if picks {
            self.pick_branches(batch);
        } else {
            self.split_branches(batch);
        }
        std::mem::swap(&mut batch.segments, &mut batch.arrivals.at);
        batch.arrivals.clear();
        if self.layer.is_some() {
            self.enter_layer(batch);
        }
    }

    /// Computes what becomes of all arrivals: diffuse facets depolarise, others go by what is known of the polarisation.
    fn scatter_arrivals(&self, batch: &mut Batch<'_, G::Facet>) {
        let arrivals = &batch.arrivals;
        let incident = self.incident.sign();
        let material = self.material;
        let into = &mut batch.interactions.scattered;
        let instructions = batch.instructions;
        if let Material::Lambertian { reflectance } = material {
            instructions.run(ScatterDiffusely {
                arrivals,
                reflectance,
                stream: batch.stream,
                into,
            });
            return;
        }
        match self.settings.polarisation {
            Polarisation::Averaged => instructions.run(Scatter {
                arrivals,
                incident,
                material,
                into,
            }),
            Polarisation::Tracked => {
                ScatterPolarised::<_, TrackedLight, 3>::new(arrivals, incident, into)
                    .run(material, instructions);
            }
            Polarisation::Both => {
                ScatterPolarised::<_, BothLight, 4>::new(arrivals, incident, into)
                    .run(material, instructions);
            }
            Polarisation::Mueller => {
                ScatterPolarised::<_, MuellerLight, 15>::new(arrivals, incident, into)
                    .run(material, instructions);
            }
        }
    }

    /// Ends paths that have reached the highest order.
    fn truncate_at_highest_order(&self, batch: &mut Batch<'_, G::Facet>) {
        let at = &mut batch.arrivals.at;
        for i in 0..at.len {
            if at.order[i] >= self.settings.max_order {
                let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
                tally.add_loss(Loss::Truncated, at.flux[i]);
                at.flux[i] = 0.0;
            }
        }
    }

    /// Tallies what an opaque material absorbs.
    fn absorb(&self, batch: &mut Batch<'_, G::Facet>) {
        let Arrivals { at, .. } = &batch.arrivals;
        for i in 0..at.len {
            let absorbed = at.flux[i] * (1.0 - batch.interactions.scattered.reflected[i]);
            let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
            if at.order[i] == 0 {
                tally.add_first_absorbed(absorbed);
            } else {
                tally.add_loss(Loss::Absorbed, absorbed);
            }
        }
    }

    /// Goes on along one branch of each interaction, which is picked by its share and carries all flux.
    fn pick_branches(&self, batch: &mut Batch<'_, G::Facet>) {
        let Interactions {
            scattered,
            which,
            pairs,
            ..
        } = &mut batch.interactions;
        let at = &mut batch.arrivals.at;
        which.clear();
        which.extend(0..at.len as u32);
        batch.instructions.run(DrawPairs {
            stream: batch.stream,
            segments: at,
            which,
            pairs,
        });
        batch.instructions.run(PickBranches {
            at,
            scattered,
            pairs,
        });
        let roulette = self.roulette(&batch.tallies);
        for (i, [_, u]) in pairs.iter().enumerate() {
            if roulette.decides(at.flux[i], at.order[i] == 1) {
                let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
                at.flux[i] = roulette.play(at.flux[i], *u, tally);
            }
        }
    }

    /// Goes on along both branches of each interaction.
    fn split_branches(&self, batch: &mut Batch<'_, G::Facet>) {
        let Interactions {
            scattered,
            which,
            pairs,
            transmitting,
        } = &mut batch.interactions;
        let at = &mut batch.arrivals.at;
        let n = at.len;
        let fluxes = at.flux[..n].iter();
        let shares = scattered
            .transmitted
            .iter_mut()
            .zip(&mut scattered.reflected);
        fluxes
            .zip(shares)
            .for_each(|(flux, (transmitted, reflected))| {
                *transmitted *= flux;
                *reflected *= flux;
            });

        // Decide by Russian roulette over branches of little flux
        let roulette = self.roulette(&batch.tallies);
        which.clear();
        which.extend((0..n as u32).filter(|&i| {
            let i = i as usize;
            let is_first = at.order[i] == 0;
            let fluxes = [scattered.transmitted[i], scattered.reflected[i]];
            fluxes
                .into_iter()
                .any(|flux| roulette.decides(flux, is_first))
        }));
        batch.instructions.run(DrawPairs {
            stream: batch.stream,
            segments: at,
            which,
            pairs,
        });
        for (&i, pair) in which.iter().zip(&*pairs) {
            let i = i as usize;
            let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
            let fluxes = [&mut scattered.transmitted[i], &mut scattered.reflected[i]];
            for (flux, u) in fluxes.into_iter().zip(pair) {
                if roulette.decides(*flux, at.order[i] == 0) {
                    *flux = roulette.play(*flux, *u, tally);
                }
            }
        }

        transmitting.resize(n, 0);
        let mut count = 0;
        for i in 0..n {
            transmitting[count] = i as u32;
            count += usize::from(scattered.transmitted[i] > 0.0);
        }
        at.make_room(n + count);
        batch.instructions.run(SplitBranches {
            at,
            scattered,
            transmitted: &transmitting[..count],
        });
    }

    /// Takes what has entered the layer out of the segments.
    fn enter_layer(&self, batch: &mut Batch<'_, G::Facet>) {
        let segments = &mut batch.segments;
        let (side, flux) = (&segments.side, &segments.flux);
        batch.met.clear();
        let inside = (0..segments.len as u32).filter(|&i| {
            let i = i as usize;
            side[i] < 0.0 && flux[i] > 0.0
        });
        batch.met.extend(inside);
        batch
            .entering
            .make_room(batch.entering.len + batch.met.len());
        batch.instructions.run(Enter {
            segments,
            which: &batch.met,
            entering: &mut batch.entering,
        });
        for &i in &batch.met {
            segments.flux[i as usize] = 0.0;
        }
    }

    /// Russian roulette of this tracer.
    fn roulette(&self, tallies: &Tallies<'_>) -> Roulette {
        let roulette = Roulette::below(self.settings.roulette_below);
        match tallies.control_variate() {
            Some(_) => roulette.sparing_first(),
            None => roulette,
        }
    }

    /// What a facet of the surface does with light that has arrived at it.
    pub(super) fn scattered(&self, at: &Arrival<G::Facet>) -> Scattered {
        let half_space = at.region.half_space;
        let m = half_space.sign() * self.geometry.normal_at(at.facet, at.heading.origin);
        let wi = -at.heading.direction;
        scatter(self.material, half_space == self.incident, wi, m)
    }

    /// The arrival number `i` of the round at the upper surface.
    pub(super) fn arrival(
        &self,
        i: usize,
        batch: &Batch<'_, G::Facet>,
    ) -> (Arrival<G::Facet>, PathState) {
        let Arrivals { at, facets, .. } = &batch.arrivals;
        let arrival = Arrival {
            region: Region::top(HalfSpace::from_sign(at.side[i])),
            heading: at.heading(i),
            facet: facets[i],
        };
        (arrival, at.state(i))
    }
}
