//! Joint scattering: reflects light at several conductors, all that is common to them computed once per arrival.

use std::marker::PhantomData;

use asperity_optics::polarised_conductor;
use asperity_tally::Loss;
use glam::DVec3;

use crate::geometry::Geometry;
use crate::interaction::facet::Incident;
use crate::interaction::polarised::{
    AveragedLight, BothLight, CarriedLight, MuellerLight, Passage, TrackedLight,
};
use crate::path::scatter::facets::handedness;
use crate::path::scatter::roulette::Roulette;
use crate::path::state::batch::Batch;
use crate::path::state::conductors::{Conductors, LANES, MAX_CONDUCTORS};
use crate::path::state::segments::Segments;
use crate::path::state::work::Work;
use crate::path::tracer::Tracer;
use crate::random::{PathStream, Use};
use crate::settings::Polarisation;
use crate::vector::Stage;

/// Reflects all light that has arrived at the conductors, and tallies what they absorb.
struct ScatterJointly<'a, 'c, L, const N: usize> {
    at: &'a mut Segments,
    /// Unit normals, upwards.
    normal: &'a [Vec<f64>; 3],
    /// Sign of the half space of the light, in which +z of its polarisation points.
    incident: f64,
    conductors: &'a mut Conductors<'c>,
    /// Flux below which Russian roulette decides.
    threshold: f64,
    /// Arrivals after which some conductor has less flux than that.
    weak: &'a mut Vec<u32>,
    light: PhantomData<L>,
}

impl<L: CarriedLight<N>, const N: usize> Stage for ScatterJointly<'_, '_, L, N> {
    #[inline(always)]
    fn run(self) {
        let Self {
            at,
            normal,
            incident,
            conductors,
            threshold,
            weak,
            ..
        } = self;
        weak.clear();
        for i in 0..at.len {
            if at.flux[i] == 0.0 {
                continue;
            }
            let is_first = at.order[i] == 0;
            if is_first {
                at.slot[i] = conductors.begin(at.ray[i], at.flux[i], &at.light_state(i));
            } else {
                conductors.spare(at.slot[i], Work::SEARCHED);
            }
            let vector = |[x, y, z]: &[Vec<f64>; 3]| DVec3::new(x[i], y[i], z[i]);
            let arrival = Incident::<0> {
                handedness: handedness(at.mirrored[i], incident),
                ..Incident::averaged(true, -vector(&at.direction), at.side[i] * vector(normal))
            };
            let reflection = Reflection {
                cos_theta_i: arrival.cos_theta_i(),
                passage: arrival.reflection(),
            };
            let mut absorbed = [0.0; MAX_CONDUCTORS];
            if reflection.apply::<L, N>(conductors, at.slot[i], threshold, &mut absorbed) {
                weak.push(i as u32);
            }
            let batch = PathStream::batch_of(at.ray[i]);
            if is_first {
                conductors.tallies.add_first_absorbed(batch, &absorbed);
            } else {
                conductors
                    .tallies
                    .add_loss(batch, Loss::Absorbed, &absorbed);
            }
        }
    }
}

/// What a reflection is for all conductors.
struct Reflection {
    cos_theta_i: f64,
    passage: Passage,
}

impl Reflection {
    /// Reflects the light of a row. Returns `true` if a flux has fallen below `threshold`.
    #[inline(always)]
    fn apply<L: CarriedLight<N>, const N: usize>(
        &self,
        conductors: &mut Conductors<'_>,
        slot: u32,
        threshold: f64,
        absorbed: &mut [f64; MAX_CONDUCTORS],
    ) -> bool {
        let width = conductors.eta.len();
        let mut is_weak = false;
        for (first, absorbed) in (0..width)
            .step_by(LANES)
            .zip(absorbed.as_chunks_mut::<LANES>().0)
        {
            // Copied to arrays, so that the compiler sees that nothing overlaps
            let copied = |column: &[f64]| -> [f64; LANES] {
                let mut lanes = [0.0; LANES];
                lanes.copy_from_slice(&column[first..first + LANES]);
                lanes
            };
            let (eta, kappa) = (copied(&conductors.eta), copied(&conductors.kappa));
            let row = conductors.row(slot);
            let mut flux = copied(row);
            let mut light = [[0.0; LANES]; N];
            for (n, lanes) in light.iter_mut().enumerate() {
                *lanes = copied(&row[(1 + n) * width..]);
            }
            let mut are_weak = [false; LANES];
            for j in 0..LANES {
                let mut numbers = [0.0; N];
                for (number, lanes) in numbers.iter_mut().zip(&light) {
                    *number = lanes[j];
                }
                let passage = Passage {
                    facet: polarised_conductor(self.cos_theta_i, eta[j], kappa[j]).reflected,
                    ..self.passage
                };
                let passed = L::after(numbers, &passage);
                absorbed[j] = flux[j] * (1.0 - passed.fraction);
                let reflected = flux[j] * passed.fraction;
                are_weak[j] = (flux[j] > 0.0) & (reflected < threshold);
                flux[j] = reflected;
                for (number, lanes) in passed.light.into_iter().zip(&mut light) {
                    lanes[j] = number;
                }
            }
            is_weak |= are_weak.contains(&true);
            row[first..first + LANES].copy_from_slice(&flux);
            for (n, lanes) in light.iter().enumerate() {
                row[(1 + n) * width + first..][..LANES].copy_from_slice(lanes);
            }
        }
        is_weak
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Reflects all light that has arrived at conductors, and ends it for those for which Russian roulette decides so. Paths that have ended for
    /// all have no flux afterwards; the flux of others is that of a mirror.
    pub(crate) fn scatter_jointly(
        &self,
        at: &mut Segments,
        normal: &[Vec<f64>; 3],
        batch: &mut Batch<'_, G::Facet>,
    ) {
        match self.settings.polarisation() {
            Polarisation::Averaged => self.run_jointly::<AveragedLight, 0>(at, normal, batch),
            Polarisation::Tracked => self.run_jointly::<TrackedLight, 3>(at, normal, batch),
            Polarisation::Both => self.run_jointly::<BothLight, 4>(at, normal, batch),
            Polarisation::Mueller => self.run_jointly::<MuellerLight, 15>(at, normal, batch),
        }
        let roulette = Roulette {
            threshold: self.settings.roulette(),
            spares_first: batch.tallies.control_variate().is_some(),
        };
        let Some(conductors) = &mut batch.conductors else {
            return;
        };
        for &i in &batch.interactions.which {
            let (i, slot) = (i as usize, at.slot[i as usize]);
            let state = at.state(i);
            let [_, u] = batch.stream.pair(state.ray, state.step(), Use::Interaction);
            let number = PathStream::batch_of(state.ray);
            let [mut some_live, mut some_ended] = [false; 2];
            for j in 0..conductors.tallies.materials() {
                let flux = conductors.fluxes(slot)[j];
                if roulette.decides(flux, at.order[i] == 0) {
                    let kept = roulette.kept(flux, u);
                    let tallies = &mut conductors.tallies;
                    tallies.add_loss_of(j, number, Loss::Truncated, flux - kept);
                    conductors.fluxes(slot)[j] = kept;
                }
                let lives = conductors.fluxes(slot)[j] > 0.0;
                some_live |= lives;
                some_ended |= !lives;
            }
            conductors.has_ended[slot as usize] = some_ended;
            if !some_live {
                conductors.end(slot, Work::NONE);
                at.flux[i] = 0.0;
            }
        }
    }

    fn run_jointly<L: CarriedLight<N>, const N: usize>(
        &self,
        at: &mut Segments,
        normal: &[Vec<f64>; 3],
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let Some(conductors) = &mut batch.conductors else {
            return;
        };
        batch.instructions.run(ScatterJointly {
            at,
            normal,
            incident: self.incident.sign(),
            conductors,
            threshold: self.settings.roulette(),
            weak: &mut batch.interactions.which,
            light: PhantomData::<L>,
        });
    }
}
