//! Interaction: scatters light at the interfaces at which it has arrived, and decides which branches continue.

use asperity_optics::Material;
use asperity_tally::Loss;

use crate::geometry::Geometry;
use crate::interaction::stack::Interface;
use crate::path::absorbed_cells::AbsorbedCells;
use crate::path::scatter::branch::{PickBranches, SplitBranches};
use crate::path::scatter::facets::Scatter;
use crate::path::scatter::roulette::Roulette;
use crate::path::state::arrivals::{Arrivals, Move};
use crate::path::state::batch::{Batch, Interactions};
use crate::path::state::path_state::{Arrival, PathState, Region};
use crate::path::state::random_numbers::DrawPairs;
use crate::path::state::segments::{Gather, Segments};
use crate::path::state::work::Work;
use crate::path::tracer::Tracer;
use crate::random::{PathStream, Use};
use crate::ray::HalfSpace;
use crate::settings::Branching;

impl<G: Geometry> Tracer<'_, G> {
    /// Lets all paths interact that have arrived at the upper surface; `batch.segments` then holds the segments that leave it.
    pub(crate) fn interact_at_surface(&self, batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(Move {
            geometry: self.geometry,
            arrivals: &mut batch.arrivals,
        });
        if batch.traces_shadows {
            self.trace_behind_first_facets(batch);
        }
        let mut at = std::mem::take(&mut batch.arrivals.at);
        let normal = std::mem::take(&mut batch.arrivals.normal);
        self.interact(Interface::TOP, &mut at, &normal, batch);
        batch.arrivals.normal = normal;
        batch.arrivals.at = std::mem::replace(&mut batch.segments, at);
        batch.arrivals.clear();
        if !self.stack.layers().is_empty() {
            self.enter_layer(batch);
        }
    }

    /// Lets segments interact with an interface at points of the given upward unit normals; `at` then holds the segments that
    /// leave it.
    pub(crate) fn interact(
        &self,
        interface: Interface,
        at: &mut Segments,
        normal: &[Vec<f64>; 3],
        batch: &mut Batch<'_, G::Facet>,
    ) {
        self.truncate_at_highest_order(at, batch);

        // Scatter at the facets
        let (material, outer) = self.material_of(interface);
        let Interactions {
            scattered,
            which,
            pairs,
            ..
        } = &mut batch.interactions;
        pairs.clear();
        if material.is_diffuse() {
            which.clear();
            which.extend(0..at.len as u32);
            batch.instructions.run(DrawPairs {
                stream: batch.stream,
                segments: at,
                which,
                of: Use::Diffuse,
                pairs,
            });
        }
        Scatter {
            at,
            normal,
            material,
            outer: outer.sign(),
            incident: self.incident.sign(),
            numbers: pairs,
            into: scattered,
        }
        .run(batch.instructions);

        // Make the branches that survive
        let divides = material.transmitting_index().is_some();
        let picks = divides && self.settings.branching == Branching::Pick;
        if batch.conductors.is_some() {
            self.scatter_jointly(at, normal, batch);
        } else if !divides || material.absorbs() {
            absorb(at, batch);
            if let (Some(cells), Interface::TOP) = (self.absorbed, interface) {
                self.record_absorbed(at, batch, cells);
            }
            if picks {
                renormalise(at, batch);
            }
        }
        if picks {
            self.pick_branches(at, batch);
        } else {
            self.split_branches(at, batch);
        }
    }

    /// The material of an interface, and the half space to whose medium its indices are relative.
    fn material_of(&self, interface: Interface) -> (Material, HalfSpace) {
        match self.stack.bottom(interface) {
            None => (self.material, self.incident),
            Some(bottom) => (bottom.material(), HalfSpace::Above),
        }
    }

    /// Ends paths that have reached the highest order.
    fn truncate_at_highest_order(&self, at: &mut Segments, batch: &mut Batch<'_, G::Facet>) {
        for i in 0..at.len {
            if at.order[i] >= self.settings.max_order {
                let state = at.state(i);
                batch.add_loss(&state, Loss::Truncated, state.flux);
                batch.end_path(&state, Work::SEARCHED);
                at.flux[i] = 0.0;
            }
        }
    }

    /// Continues along one branch of each interaction, which is picked by its fraction and carries all flux.
    fn pick_branches(&self, at: &mut Segments, batch: &mut Batch<'_, G::Facet>) {
        let roulette = self.roulette(batch);
        let Interactions {
            scattered,
            which,
            pairs,
            ..
        } = &mut batch.interactions;
        which.clear();
        which.extend(0..at.len as u32);
        batch.instructions.run(DrawPairs {
            stream: batch.stream,
            segments: at,
            which,
            of: Use::Interaction,
            pairs,
        });
        batch.instructions.run(PickBranches {
            at,
            scattered,
            pairs,
        });
        for (i, [_, u]) in pairs.iter().enumerate() {
            if roulette.decides(at.flux[i], at.order[i] == 1) {
                let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
                at.flux[i] = roulette.play(at.flux[i], *u, tally);
            }
        }
    }

    /// Continues along both branches of each interaction.
    fn split_branches(&self, at: &mut Segments, batch: &mut Batch<'_, G::Facet>) {
        let roulette = self.roulette(batch);
        let Interactions {
            scattered,
            which,
            pairs,
            transmitting,
        } = &mut batch.interactions;
        let n = at.len;
        let [transmitted, reflected] = [
            &mut scattered.transmitted.flux,
            &mut scattered.reflected.flux,
        ];
        for branch in [&mut *transmitted, &mut *reflected] {
            for (fraction, flux) in branch.iter_mut().zip(&at.flux[..n]) {
                *fraction *= flux;
            }
        }

        // Decide by Russian roulette over branches of little flux
        which.clear();
        which.extend((0..n as u32).filter(|&i| {
            let i = i as usize;
            let is_first = at.order[i] == 0;
            [transmitted[i], reflected[i]]
                .into_iter()
                .any(|flux| roulette.decides(flux, is_first))
        }));
        batch.instructions.run(DrawPairs {
            stream: batch.stream,
            segments: at,
            which,
            of: Use::Interaction,
            pairs,
        });
        for (&i, pair) in which.iter().zip(&*pairs) {
            let i = i as usize;
            let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
            let fluxes = [&mut transmitted[i], &mut reflected[i]];
            for (flux, u) in fluxes.into_iter().zip(pair) {
                if roulette.decides(*flux, at.order[i] == 0) {
                    *flux = roulette.play(*flux, *u, tally);
                }
            }
        }

        transmitting.resize(n, 0);
        let mut count = 0;
        for (i, flux) in transmitted.iter().enumerate() {
            transmitting[count] = i as u32;
            count += usize::from(*flux > 0.0);
        }
        at.make_room(n + count);
        batch.instructions.run(SplitBranches {
            at,
            scattered,
            transmitted: &transmitting[..count],
        });
    }

    /// Adds the light that facets of the upper surface absorb to their cells.
    fn record_absorbed(&self, at: &Segments, batch: &Batch<'_, G::Facet>, cells: &AbsorbedCells) {
        let scattered = &batch.interactions.scattered;
        let (reflected, transmitted) = (&scattered.reflected.flux, &scattered.transmitted.flux);
        for (i, facet) in batch.arrivals.facets.iter().enumerate() {
            if let Some(cell) = self.geometry.cell_number(*facet) {
                cells.add(cell, at.flux[i] * (1.0 - reflected[i] - transmitted[i]));
            }
        }
    }

    /// Takes what has entered the uppermost layer out of the segments.
    fn enter_layer(&self, batch: &mut Batch<'_, G::Facet>) {
        let segments = &mut batch.segments;
        let (side, flux) = (&segments.side, &segments.flux);
        batch.met.clear();
        let inside = (0..segments.len as u32).filter(|&i| {
            let i = i as usize;
            side[i] < 0.0 && flux[i] > 0.0
        });
        batch.met.extend(inside);
        batch.instructions.run(Gather {
            from: segments,
            which: &batch.met,
            into: &mut batch.layers[0].entering,
        });
        for &i in &batch.met {
            segments.flux[i as usize] = 0.0;
        }
    }

    /// Russian roulette over the flux of segments; none over that of several conductors, over which [`Tracer::scatter_jointly`] decides.
    fn roulette(&self, batch: &Batch<'_, G::Facet>) -> Roulette {
        Roulette {
            threshold: match batch.conductors {
                Some(_) => 0.0,
                None => self.settings.roulette_below,
            },
            spares_first: batch.tallies.control_variate().is_some(),
        }
    }

    /// The arrival number `i` of the round at the upper surface.
    pub(crate) fn arrival(
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

/// Tallies the light that an interface absorbs: all that it neither reflects nor transmits.
fn absorb<F: Copy>(at: &Segments, batch: &mut Batch<'_, F>) {
    let scattered = &batch.interactions.scattered;
    let fractions = scattered
        .reflected
        .flux
        .iter()
        .zip(&scattered.transmitted.flux);
    for (i, (reflected, transmitted)) in fractions.enumerate() {
        let absorbed = at.flux[i] * (1.0 - reflected - transmitted);
        let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
        if at.order[i] == 0 {
            tally.add_first_absorbed(absorbed);
        } else {
            tally.add_loss(Loss::Absorbed, absorbed);
        }
    }
}

/// Takes absorbed light out of the flux of the segments, and makes the fractions of their branches add to one.
fn renormalise<F: Copy>(at: &mut Segments, batch: &mut Batch<'_, F>) {
    let scattered = &mut batch.interactions.scattered;
    let branches = [
        &mut scattered.reflected.flux,
        &mut scattered.transmitted.flux,
    ];
    let [reflected, transmitted] = branches;
    for (i, (reflected, transmitted)) in reflected.iter_mut().zip(transmitted).enumerate() {
        let kept = *reflected + *transmitted;
        at.flux[i] *= kept;
        if kept > 0.0 {
            *reflected /= kept;
            *transmitted /= kept;
        }
    }
}
