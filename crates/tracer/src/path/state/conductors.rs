//! Conductors: flux and polarisation that the paths in flight have for each of several conductors.
//!
//! Light that conductors reflect takes the same ways whatever their index is: that changes only flux and polarisation. So the paths
//! of a mirror are traced once, and a table keeps the numbers of all conductors: a row per path, which begins with its first interaction.
//! What the table and the tallies hold of a conductor is, bit by bit, what tracing it alone gives.

use asperity_optics::polarised_conductor;
use asperity_tally::{ExitColumns, JointExit, JointTallies, Loss, Tallies};
use glam::DVec3;

use crate::path::state::light_state::LightState;
use crate::path::state::path_state::PathState;
use crate::path::state::work::Work;
use crate::random::PathStream;
use crate::settings::Polarisation;

/// Most conductors that are traced together.
pub const MAX_CONDUCTORS: usize = 32;

/// Conductors whose numbers are computed together.
pub(crate) const LANES: usize = 8;

/// Several conductors, and what their paths in flight carry.
pub(crate) struct Conductors<'c> {
    pub(crate) tallies: JointTallies<'c>,
    /// Real and imaginary parts of their indices, in whole lanes; what is behind the last belongs to no conductor.
    pub(crate) eta: Vec<f64>,
    pub(crate) kappa: Vec<f64>,
    polarisation: Polarisation,
    /// Row by row: the flux of each conductor, then the numbers of [`LightState`], each of all conductors; of light that has left, the
    /// measures of the tally in place of these.
    numbers: Vec<f64>,
    /// By row: the batch of its path, and `true` if the path has ended for a conductor by [`Roulette`](crate::path::scatter::roulette::Roulette).
    batch: Vec<u32>,
    pub(crate) has_ended: Vec<bool>,
    /// Rows without a path, and those whose paths have ended since the exits were last tallied.
    free: Vec<u32>,
    ended: Vec<u32>,
    /// Work on paths that had ended for a conductor, by conductor.
    spared: Vec<Work>,
}

impl<'c> Conductors<'c> {
    /// Conductors of some `[eta, kappa]`, as many as the tallies have materials.
    pub(crate) fn new(
        indices: &[[f64; 2]],
        tallies: JointTallies<'c>,
        polarisation: Polarisation,
    ) -> Self {
        let width = indices.len().next_multiple_of(LANES);
        let column = |part: usize| {
            let mut column: Vec<f64> = indices.iter().map(|index| index[part]).collect();
            column.resize(width, 1.0);
            column
        };
        Self {
            tallies,
            eta: column(0),
            kappa: column(1),
            polarisation,
            numbers: Vec::new(),
            batch: Vec::new(),
            has_ended: Vec::new(),
            free: Vec::new(),
            ended: Vec::new(),
            spared: vec![Work::default(); indices.len()],
        }
    }

    /// Numbers of a row.
    fn stride(&self) -> usize {
        let measures = self.polarisation.polarimetry().len();
        self.eta.len() * (1 + LightState::len(self.polarisation).max(measures))
    }

    /// The numbers of a row.
    #[inline(always)]
    pub(crate) fn row(&mut self, slot: u32) -> &mut [f64] {
        let stride = self.stride();
        &mut self.numbers[slot as usize * stride..][..stride]
    }

    /// The fluxes of a row.
    pub(crate) fn fluxes(&mut self, slot: u32) -> &mut [f64] {
        let conductors = self.tallies.materials();
        &mut self.row(slot)[..conductors]
    }

    /// Begins a row for a path that has met no conductor yet.
    #[inline]
    pub(crate) fn begin(&mut self, ray: u32, flux: f64, light: &LightState) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            let slot = self.batch.len();
            self.batch.push(0);
            self.has_ended.push(false);
            let len = self.numbers.len() + self.stride();
            self.numbers.resize(len, 0.0);
            slot as u32
        });
        self.batch[slot as usize] = PathStream::batch_of(ray);
        self.has_ended[slot as usize] = false;
        let (width, conductors) = (self.eta.len(), self.tallies.materials());
        let (fluxes, rest) = self.row(slot).split_at_mut(width);
        fluxes[..conductors].fill(flux);
        fluxes[conductors..].fill(0.0);
        for (column, number) in rest.chunks_exact_mut(width).zip(light.0) {
            column.fill(number);
        }
        slot
    }

    /// Tallies what the conductors of a shadowed facet would absorb, and returns a row of what they would reflect, which ends at once.
    pub(crate) fn begin_shadowed(&mut self, light: &PathState, cos_theta_i: f64) -> u32 {
        let slot = self.begin(light.ray, 0.0, &LightState::NONE);
        let mut absorbed = [0.0; MAX_CONDUCTORS];
        let conductors = self.tallies.materials();
        for (j, absorbed) in absorbed.iter_mut().enumerate().take(conductors) {
            let fraction = polarised_conductor(cos_theta_i, self.eta[j], self.kappa[j])
                .reflected
                .m00;
            *absorbed = light.flux * (1.0 - fraction);
            self.fluxes(slot)[j] = light.flux * fraction;
        }
        let batch = PathStream::batch_of(light.ray);
        self.tallies.add_shadowed_absorbed(batch, &absorbed);
        self.end(slot, Work::NONE);
        slot
    }

    /// Ends a path. Its row is kept until the exits are tallied. `counted`: the work since its last interaction.
    pub(crate) fn end(&mut self, slot: u32, counted: Work) {
        self.spare(slot, counted);
        self.ended.push(slot);
    }

    /// Counts work on a path that those conductors have spared for which it has ended.
    pub(crate) fn spare(&mut self, slot: u32, counted: Work) {
        if !self.has_ended[slot as usize] {
            return;
        }
        for j in 0..self.spared.len() {
            if self.fluxes(slot)[j] == 0.0 {
                self.spared[j] += counted;
            }
        }
    }

    /// Tallies flux of a path that ended without an exit; before its first interaction it is that of `of` for all.
    pub(crate) fn add_loss(&mut self, of: &PathState, loss: Loss) {
        let batch = PathStream::batch_of(of.ray);
        if of.events.order() == 0 {
            self.tallies
                .add_loss(batch, loss, &[of.flux; MAX_CONDUCTORS]);
        } else {
            let first = of.slot as usize * self.stride();
            self.tallies.add_loss(batch, loss, &self.numbers[first..]);
        }
    }

    /// Sets the measures of the tally of a path that leaves along `wo` for good.
    pub(crate) fn set_measures(&mut self, state: &PathState, wo: DVec3) {
        let (width, polarisation) = (self.eta.len(), self.polarisation);
        let measures = polarisation.polarimetry().len();
        if measures == 0 {
            return;
        }
        let (_, numbers) = self.row(state.slot).split_at_mut(width);
        for j in 0..width {
            let mut light = LightState::NONE;
            let column = numbers.iter().skip(j).step_by(width);
            let kept = light.0.iter_mut().take(LightState::len(polarisation));
            kept.zip(column).for_each(|(into, number)| *into = *number);
            let of_conductor = PathState { light, ..*state };
            let light = of_conductor.light_that_leaves(wo, polarisation);
            let column = numbers.iter_mut().skip(j).step_by(width);
            let found = light.measures(polarisation);
            column
                .zip(&found[..measures])
                .for_each(|(into, measure)| *into = *measure);
        }
    }

    /// Tallies exits, whose batches are the rows of their paths, and frees the rows of paths that have ended.
    pub(crate) fn tally(&mut self, exits: &mut ExitColumns) {
        let (width, stride) = (self.eta.len(), self.stride());
        let measures = width * self.polarisation.polarimetry().len();
        let (numbers, batch) = (&self.numbers, &self.batch);
        self.tallies.add_located(exits, |slot| {
            let row = &numbers[slot as usize * stride..][..stride];
            JointExit {
                batch: batch[slot as usize],
                fluxes: &row[..width],
                measures: &row[width..][..measures],
            }
        });
        self.free.append(&mut self.ended);
    }

    /// The tallies of each conductor, and the work done on it, given that on all paths.
    pub(crate) fn into_tallies(self, all: Work) -> Vec<(Tallies<'c>, Work)> {
        let work = self.spared.iter().map(|spared| all.without(spared));
        self.tallies.into_each().into_iter().zip(work).collect()
    }
}
