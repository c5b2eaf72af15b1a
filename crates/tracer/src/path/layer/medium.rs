//! Medium: absorption and scattering at the ends of flights inside the layer, many at a time.

use std::ops::Range;

use asperity_optics::PhaseFunction;
use asperity_tally::Loss;
use glam::DVec3;

use crate::geometry::Geometry;
use crate::interaction::rayleigh::scatter_rayleigh;
use crate::interaction::stack::TracedLayer;
use crate::path::layer::flight::BeginFlights;
use crate::path::scatter::roulette::Roulette;
use crate::path::state::batch::Batch;
use crate::path::state::flights::Flights;
use crate::path::state::light_state::LightState;
use crate::path::state::random_numbers::{DrawNumbers, Numbers};
use crate::path::state::segments::{Segments, rows_of_mut};
use crate::path::tracer::Tracer;
use crate::random::{PathStream, Use};
use crate::settings::Polarisation;
use crate::vector::Stage;

/// Threshold of Russian roulette inside the layer, over the threshold elsewhere.
///
/// A scattered path continues for long with little flux. At an albedo of 0.9 over glass, 0.3 of an incident
/// ray's flux instead of 0.01 takes a third of the scatterings, and half the time for the same error of bins.
const ROULETTE_FACTOR: f64 = 30.0;

/// Turns flights into the directions in which the medium scatters them, whatever their polarisation.
struct Turn<'a> {
    phase: PhaseFunction,
    numbers: &'a Numbers,
    segments: &'a mut Segments,
    rows: Range<usize>,
}

impl Stage for Turn<'_> {
    #[inline(always)]
    fn run(self) {
        // A loop for each phase function
        match self.phase {
            PhaseFunction::HenyeyGreenstein { g } => {
                self.turn(|d, numbers| PhaseFunction::HenyeyGreenstein { g }.sample(d, numbers));
            }
            PhaseFunction::Isotropic => {
                self.turn(|d, numbers| PhaseFunction::Isotropic.sample(d, numbers));
            }
            phase => self.turn(|d, numbers| phase.sample(d, numbers)),
        }
    }
}

impl Turn<'_> {
    #[inline(always)]
    fn turn(self, scattered: impl Fn(DVec3, [f64; 2]) -> DVec3) {
        let n = self.rows.len();
        let [_, u, v, ..] = self.numbers;
        let (u, v) = (&u[..n], &v[..n]);
        let [x, y, z] = rows_of_mut(&mut self.segments.direction, self.rows.clone());
        for i in 0..n {
            let w = scattered(DVec3::new(x[i], y[i], z[i]), [u[i], v[i]]);
            (x[i], y[i], z[i]) = (w.x, w.y, w.z);
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Absorbs and scatters the flights of the batch from number `first` on, at whose beginnings they interact with the medium.
    pub(crate) fn scatter_in_medium(
        &self,
        layer: &TracedLayer<'_, G>,
        first: usize,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let polarisation = self.settings.polarisation;
        let chooses_plane =
            polarisation != Polarisation::Averaged && layer.phase() == PhaseFunction::Rayleigh;
        let number = layer.number();
        let rows = first..batch.layers[number].flights.at.len;
        let mut numbers = std::mem::take(&mut batch.numbers);
        batch.instructions.run(DrawNumbers {
            stream: batch.stream,
            segments: &batch.layers[number].flights.at,
            rows: rows.clone(),
            pairs: if chooses_plane { 3 } else { 2 },
            of: Use::Medium,
            into: &mut numbers,
        });
        self.collide(layer, first, &numbers[0], batch);
        let of_flight = if chooses_plane {
            self.scatter_rayleigh(rows.clone(), &numbers, &mut batch.layers[number].flights.at);
            &numbers[4]
        } else {
            batch.instructions.run(Turn {
                phase: layer.phase(),
                numbers: &numbers,
                segments: &mut batch.layers[number].flights.at,
                rows: rows.clone(),
            });
            depolarise(
                polarisation,
                rows.clone(),
                &mut batch.layers[number].flights.at,
            );
            &numbers[3]
        };
        batch.instructions.run(BeginFlights {
            layer,
            numbers: of_flight,
            length: &mut batch.layers[number].flights.length[rows],
        });
        batch.numbers = numbers;
    }

    /// Absorbs the fraction of each interaction with the medium that does not scatter, and ends paths at random.
    fn collide(
        &self,
        layer: &TracedLayer<'_, G>,
        first: usize,
        numbers: &[f64],
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let threshold = (ROULETTE_FACTOR * self.settings.roulette_below).min(1.0);
        let roulette = Roulette {
            threshold,
            spares_first: false,
        };
        let (albedo, most) = (layer.albedo(), layer.max_scatterings());
        let Flights { at, .. } = &mut batch.layers[layer.number()].flights;
        for (i, u) in (first..at.len).zip(numbers) {
            let flux = at.flux[i];
            if flux == 0.0 {
                continue;
            }
            let tally = batch.tallies.of(PathStream::batch_of(at.ray[i]));
            let kept = flux * albedo;
            tally.add_loss(Loss::Absorbed, flux - kept);
            if kept > 0.0 && at.scatterings[i] == most {
                tally.add_loss(Loss::Truncated, kept);
                at.flux[i] = 0.0;
                continue;
            }
            at.flux[i] = roulette.play(kept, *u, tally);
            if kept > 0.0 {
                at.scatterings[i] += 1;
                batch.work.scatterings += 1;
                batch.work.max_scatterings = batch.work.max_scatterings.max(at.scatterings[i]);
            }
        }
    }

    /// Scatters polarised light by particles far smaller than the wavelength.
    fn scatter_rayleigh(&self, rows: Range<usize>, numbers: &Numbers, at: &mut Segments) {
        let [_, u, azimuth, choice, ..] = numbers;
        for (k, i) in rows.enumerate() {
            let mut heading = at.heading(i);
            let light = at.light_state(i);
            // Images that are mirrored along both axes are turned, not mirrored.
            let [x, y] = heading.mirrored;
            let incident = self.incident.sign();
            let handedness = if x == y { incident } else { -incident };
            let numbers = [u[k], azimuth[k], choice[k]];
            let scattered =
                scatter_rayleigh(heading.direction, light.stokes(), handedness, numbers);
            heading.direction = scattered.direction;
            at.set_heading(i, &heading);
            // The direction was chosen by the flux that goes there.
            let (light, _) = light.after(self.settings.polarisation, &scattered.passage);
            at.set_light_state(i, &light);
        }
    }
}

/// Takes the polarisation off some segments, as all but Rayleigh scattering does.
fn depolarise(polarisation: Polarisation, rows: Range<usize>, at: &mut Segments) {
    match polarisation {
        Polarisation::Averaged => {}
        Polarisation::Tracked => {
            for column in &mut at.light {
                column[rows.clone()].fill(0.0);
            }
        }
        Polarisation::Both | Polarisation::Mueller => {
            for i in rows {
                let light: LightState = at.light_state(i).depolarised(polarisation);
                at.set_light_state(i, &light);
            }
        }
    }
}
