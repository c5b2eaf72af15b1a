//! Joint tallies: those of several materials, whose light leaves along the same paths with fluxes of its own.
//!
//! The sums of all materials in one entry of one batch stand side by side, so that the bins of an exit are found once, and its fluxes are
//! added in one loop. Each material gets the sums that a [`Tally`] of its own would have, bit by bit.

use super::{Direction, Tallies, Tally, Units, is_away, units};
use crate::binning::exit_columns::ExitColumns;
use crate::{ControlVariate, Exit, Loss, Side};

/// Tallies of several materials and batches, all of the same spec, azimuth and largest weight.
#[derive(Clone, Debug)]
pub struct JointTallies<'c> {
    /// Its batches are pairs of a batch and a material, the material fastest; behind the last material stands what all have in common.
    pairs: Tally<'c>,
    batches: usize,
    /// By material.
    controls: Vec<Option<&'c ControlVariate>>,
    /// Fractions of the control variates by side, ring and material; empty without them.
    fractions: Vec<f64>,
    /// Fractions that they absorb, by material.
    absorbed: Vec<f64>,
    /// Fluxes by material as they count, and units of flux and rays, about to be added.
    weighted: Vec<f64>,
    units: Vec<i128>,
    hits: Vec<i128>,
}

/// Light of several materials that leaves along one path.
#[derive(Clone, Copy, Debug)]
pub struct JointExit<'a> {
    /// Number of the batch.
    pub batch: u32,
    /// Flux of each material; what follows those is ignored.
    pub fluxes: &'a [f64],
    /// Measures over the flux: for each of [`crate::Polarimetry`] as many numbers as there are fluxes.
    pub measures: &'a [f64],
}

impl<'c> JointTallies<'c> {
    /// Empty tallies like `empty`, for several batches, of a material per control variate: all have one, or none has.
    ///
    /// # Panics
    /// If there is no material, or some have a control variate and others have none.
    #[must_use]
    pub fn new(
        empty: Tally<'c>,
        batches: usize,
        controls: Vec<Option<&'c ControlVariate>>,
    ) -> Self {
        let grid = empty.spec.grid();
        let all: Vec<&ControlVariate> = controls.iter().copied().flatten().collect();
        assert!(
            !controls.is_empty() && (all.is_empty() || all.len() == controls.len()),
            "control variates for all materials or for none"
        );
        let directions = Side::BOTH
            .into_iter()
            .flat_map(|side| (0..grid.n_theta()).map(move |ring| (side, ring)));
        let fractions =
            directions.flat_map(|(side, ring)| all.iter().map(move |one| one.fraction(side, ring)));
        let absorbed = |control: &Option<&ControlVariate>| {
            control.map_or(0.0, ControlVariate::absorbed_fraction)
        };
        let Tallies(pairs) = Tallies::new(empty, batches * (controls.len() + 1));
        Self {
            batches,
            fractions: fractions.collect(),
            absorbed: controls.iter().map(absorbed).collect(),
            weighted: vec![0.0; controls.len()],
            units: vec![0; controls.len()],
            hits: vec![0; controls.len()],
            controls,
            pairs,
        }
    }

    /// Number of materials.
    #[must_use]
    pub const fn materials(&self) -> usize {
        self.controls.len()
    }

    /// Adds exits to the bins that [`Tallies::locate`] has found, and removes them: as [`Tallies::add_located`] for each material. `light`
    /// returns the light of an exit by what stands for the number of its batch.
    #[inline(always)]
    pub fn add_located<'a>(
        &mut self,
        exits: &mut ExitColumns,
        light: impl Fn(u32) -> JointExit<'a>,
    ) {
        for i in 0..exits.len() {
            self.add_exit(exits, i, light(exits.batch[i]));
        }
        exits.clear();
    }

    /// Adds exit number `i`.
    #[inline(always)]
    fn add_exit(&mut self, exits: &ExitColumns, i: usize, light: JointExit<'_>) {
        let JointExit {
            batch,
            fluxes,
            measures,
        } = light;
        let materials = self.materials();
        let (exit, at) = (exits.exit(i), Direction::located(exits, i));
        let is_masked = exits.is_masked[i];
        self.select(batch);
        self.book_apertures(exits.windows_of(i), &exit, fluxes);
        let rings = self.pairs.spec.grid().n_theta();
        let first = (exit.side.index() * rings + at.ring) * materials;
        let fractions = self.fractions.get(first..first + materials);
        for (j, (weighted, flux)) in self.weighted.iter_mut().zip(fluxes).enumerate() {
            *weighted = weight(fractions, j, &exit, is_masked) * flux;
        }
        find_units(&self.weighted, self.pairs.scale, &mut self.units);
        let (flux, hit) = (&self.units[..], self.pairs.hit);
        if self.weighted.contains(&0.0) {
            // Not every material has a ray there.
            for (hits, flux) in self.hits.iter_mut().zip(&self.weighted) {
                *hits = if *flux == 0.0 { 0 } else { hit };
            }
            self.pairs.book_units(&exit, flux, &self.hits[..], &at);
        } else {
            let all = Common {
                place: materials,
                units: hit,
            };
            self.pairs.book_units(&exit, flux, all, &at);
        }
        if exits.measures.is_empty() || is_masked {
            return;
        }
        let entries = self.pairs.measure_entries(&exit, &at);
        for (number, ratios) in measures.chunks_exact(fluxes.len()).enumerate() {
            for (weighted, (ratio, flux)) in self.weighted.iter_mut().zip(ratios.iter().zip(fluxes))
            {
                *weighted = ratio * flux;
            }
            find_units(&self.weighted, self.pairs.scale, &mut self.units);
            for entry in entries.into_iter().flatten() {
                self.pairs.add(entry + number, &self.units[..]);
            }
        }
    }

    /// Adds light of each material to the apertures it falls into: as [`Tally::book_apertures`].
    #[inline(always)]
    fn book_apertures(&mut self, mut windows: u8, exit: &Exit, fluxes: &[f64]) {
        while windows != 0 {
            let number = windows.trailing_zeros() as usize;
            windows &= windows - 1;
            let weight = self.pairs.windows.weight(number, exit.wo);
            for (weighted, flux) in self.weighted.iter_mut().zip(fluxes) {
                *weighted = weight * flux;
            }
            find_units(&self.weighted, self.pairs.scale, &mut self.units);
            let entry = self.pairs.spec.offsets().apertures_start() + number;
            self.pairs.add(entry, &self.units[..]);
        }
    }

    /// Adds flux of each material that ended without an exit: as [`Tally::add_loss`].
    #[inline(always)]
    pub fn add_loss(&mut self, batch: u32, loss: Loss, fluxes: &[f64]) {
        self.select(batch);
        find_units(fluxes, self.pairs.scale, &mut self.units);
        self.pairs.add_units_of_loss(loss, &self.units[..]);
    }

    /// Adds flux of one material that ended without an exit.
    pub fn add_loss_of(&mut self, material: usize, batch: u32, loss: Loss, flux: f64) {
        self.select(batch);
        self.pairs.batch += material;
        self.pairs.add_loss(loss, flux);
    }

    /// Adds flux of each material that was absorbed at the first interaction: as [`Tally::add_first_absorbed`].
    #[inline(always)]
    pub fn add_first_absorbed(&mut self, batch: u32, fluxes: &[f64]) {
        self.add_absorbed(batch, fluxes, |fraction| 1.0 - fraction);
    }

    /// Subtracts flux that a shadowed facet would absorb if it were lit: as [`Tally::add_shadowed_absorbed`].
    pub fn add_shadowed_absorbed(&mut self, batch: u32, fluxes: &[f64]) {
        self.add_absorbed(batch, fluxes, |fraction| -fraction);
    }

    #[inline(always)]
    fn add_absorbed(&mut self, batch: u32, fluxes: &[f64], weight: impl Fn(f64) -> f64) {
        self.select(batch);
        let pairs = self.weighted.iter_mut().zip(&self.absorbed).zip(fluxes);
        for ((weighted, fraction), flux) in pairs {
            *weighted = weight(*fraction) * flux;
        }
        find_units(&self.weighted, self.pairs.scale, &mut self.units);
        self.pairs
            .add_units_of_loss(Loss::Absorbed, &self.units[..]);
    }

    /// Adds what follows to a batch.
    #[inline(always)]
    fn select(&mut self, batch: u32) {
        let batch = batch as usize;
        assert!(batch < self.batches, "no tallies of batch {batch}");
        self.pairs.batch = batch * (self.materials() + 1);
    }

    /// The tallies of each material.
    #[must_use]
    pub fn into_each(self) -> Vec<Tallies<'c>> {
        let materials = self.materials();
        let of_material = |(number, control)| {
            let mut own = self.pairs.clone_empty();
            own.batches = self.batches;
            own.control_variate = control;
            let sums = self.pairs.sums.chunks_exact(materials + 1);
            own.sums = sums.map(|sums| sums[number] + sums[materials]).collect();
            Tallies(own)
        };
        let controls = self.controls.iter().copied().enumerate();
        controls.map(of_material).collect()
    }
}

/// Units that all materials have in common, and the place behind these where they are added.
#[derive(Clone, Copy)]
struct Common {
    place: usize,
    units: i128,
}

impl Units for Common {
    #[inline(always)]
    fn add_to(self, sums: &mut [i128]) {
        sums[self.place] += self.units;
    }
}

/// Parts into which the low part of a flux in units is divided: whole numbers of 32 bits.
const HALF: f64 = (1_u64 << HALF_DIGITS) as f64;
const HALF_DIGITS: u32 = super::LOW_DIGITS / 2;

/// Finds the [`units`] of as many fluxes as there are places for, by conversions to 32 bits, which vector instructions have.
#[inline(always)]
fn find_units(fluxes: &[f64], scale: f64, into: &mut [i128]) {
    let fluxes = &fluxes[..into.len()];
    let are_small = fluxes
        .iter()
        .fold(true, |all, flux| all & ((flux * scale).abs() < HALF));
    if !are_small {
        for (into, flux) in into.iter_mut().zip(fluxes) {
            *into = units(*flux, scale);
        }
        return;
    }
    for (into, fluxes) in into.chunks_mut(LANES).zip(fluxes.chunks(LANES)) {
        let mut scaled = [0.0; LANES];
        scaled[..fluxes.len()].copy_from_slice(fluxes);
        let mut parts = [[0_i32; LANES]; 3];
        for j in 0..LANES {
            let scaled = scaled[j] * scale;
            parts[0][j] = scaled as i32;
            let rest = (scaled - f64::from(parts[0][j])) * HALF;
            parts[1][j] = rest as i32;
            parts[2][j] = ((rest - f64::from(parts[1][j])) * HALF) as i32;
        }
        for (j, into) in into.iter_mut().enumerate() {
            let [high, middle, low] = [0, 1, 2].map(|part| i64::from(parts[part][j]));
            let low = (middle << HALF_DIGITS) + low;
            *into = (i128::from(high) << super::LOW_DIGITS) + i128::from(low);
        }
    }
}

/// Fluxes that are converted together.
const LANES: usize = 8;

/// The factor with which light of material `j` counts: as of [`Tally::weight`] and [`Tally::masked_weight`]. `fractions`: those of its ring,
/// by material.
#[inline(always)]
fn weight(fractions: Option<&[f64]>, j: usize, exit: &Exit, is_masked: bool) -> f64 {
    match fractions {
        Some(fractions) if is_masked && is_away(exit) => -fractions[j],
        _ if is_masked => 0.0,
        Some(fractions) if exit.path.order() == 1 => 1.0 - fractions[j],
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scoring::HIGH;

    #[test]
    fn units_of_many_fluxes_are_those_of_each() {
        let scale = HIGH / 4.0;
        let fluxes: Vec<f64> = (0..3000)
            .map(|i| (0.37 * f64::from(i)).sin() * 0.93_f64.powi(i % 700))
            .chain([0.0, -0.0, 1.0, -1.0, 4.0, 1e-300, 0.1, 1.0 / 3.0])
            .collect();
        for (large, len) in [(1.0, 3008), (1.0, 5), (1e9, 3008)] {
            let fluxes: Vec<f64> = fluxes.iter().map(|flux| large * flux).collect();
            let mut found = vec![0; len];
            find_units(&fluxes, scale, &mut found);
            for (found, flux) in found.into_iter().zip(&fluxes) {
                assert_eq!(found, units(*flux, scale), "{flux:e}");
            }
        }
    }
}
