//! Given rays: follows rays of any origin and direction, such as those of a camera, and hands over what leaves of each.

use asperity_surface::Border;
use asperity_tally::{Azimuth, EventPath, Exit, Tallies, Tally, TallyResult, TallySpec};
use glam::DVec2;

use crate::geometry::Geometry;
use crate::path::state::batch::{Batch, MAX_IN_FLIGHT};
use crate::path::state::light_state::LightState;
use crate::path::state::path_state::{PathRay, PathState, RayKind, Region};
use crate::path::state::segments::Kept;
use crate::path::tracer::Tracer;
use crate::periodic::{Heading, approach};
use crate::random::PathStream;
use crate::ray::HalfSpace;
use crate::settings::Polarisation;

/// Ends of given rays, other than exits.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenRays {
    /// `true` for each ray that met the surface.
    pub met: Vec<bool>,
    /// Flux that reached the highest order, sum over all rays. Flux that Russian roulette removed or added is not part of it.
    pub truncated: f64,
    /// Flux that left an open patch sideways after it had met the surface, sum over all rays.
    pub left_patch: f64,
    /// Flux that failed numerically, sum over all rays.
    pub lost: f64,
}

impl<G: Geometry> Tracer<'_, G> {
    /// Traces rays from above, each of flux one, and hands each exit over with the number of its ray, in an order that depends
    /// on the rays alone. An exit of order zero is a ray that has missed the surface.
    ///
    /// Origins are in tile coordinates, above the surface, possibly over another tile; directions are unit vectors in the world. The
    /// rays are the paths of `stream` from its first on.
    ///
    /// # Panics
    /// If light comes from below, or carries polarisation, if there are layers, several conductors, or
    /// [`PathStream::MAX_PATHS_OF_BATCH`] rays or more.
    pub fn given_rays(
        &self,
        rays: &[Heading],
        stream: PathStream,
        mut leave: impl FnMut(u32, &Exit),
    ) -> GivenRays {
        let polarisation = self.settings.polarisation;
        assert!(
            self.incident == HalfSpace::Above && polarisation == Polarisation::Averaged,
            "given rays come from above, without polarisation"
        );
        assert!(
            self.stack.layers().is_empty() && self.conductors.is_empty(),
            "given rays see one surface of one material"
        );
        assert!(
            (rays.len() as u64) < PathStream::MAX_PATHS_OF_BATCH,
            "{} given rays",
            rays.len()
        );
        let kept = Kept {
            slot: true,
            ..Kept::NOTHING
        };
        // One tally, of losses alone
        let tallies = Tallies::new(Tally::new(TallySpec::default(), Azimuth::Free), 1);
        let mut batch = Batch::new(tallies, stream, self.instructions, kept, 0);
        let mut waiting = (0..).zip(rays);
        let mut found = GivenRays {
            met: vec![false; rays.len()],
            truncated: 0.0,
            left_patch: 0.0,
            lost: 0.0,
        };
        let mut missed = rays.len();
        loop {
            let free = MAX_IN_FLIGHT.saturating_sub(batch.in_flight());
            for (number, heading) in waiting.by_ref().take(free) {
                self.begin_given(number, *heading, &mut batch);
            }
            let is_finished = batch.is_finished();
            if !is_finished {
                self.search(&mut batch);
                let at = &batch.arrivals.at;
                for i in 0..at.len {
                    if at.order[i] == 0 {
                        found.met[at.slot[i] as usize] = true;
                        missed -= 1;
                    } else if at.order[i] >= self.settings.max_order {
                        found.truncated += at.flux[i];
                    }
                }
                self.interact_at_surface(&mut batch);
                self.escape(&mut batch);
            }
            batch.exits.drain(|number, exit| {
                missed -= usize::from(exit.path.order() == 0);
                leave(number, exit);
            });
            if is_finished {
                break;
            }
        }
        let budget = batch.tallies.into_fractions(1).swap_remove(0).budget();
        // Rays that miss an open patch do not count as lost
        let beside = match self.geometry.border() {
            Border::Open => missed as f64,
            Border::Periodic | Border::Mirrored => 0.0,
        };
        found.left_patch = budget.left_patch - beside;
        found.lost = budget.lost;
        found
    }

    /// Begins ray number `number`, where it comes between lowest and highest point.
    fn begin_given(&self, number: u32, mut heading: Heading, batch: &mut Batch<'_, G::Facet>) {
        let above = HalfSpace::Above;
        approach(self.geometry, &mut heading, above, f64::INFINITY);
        let ray = PathRay {
            region: Region::top(above),
            heading,
            state: PathState {
                flux: 1.0,
                events: EventPath::default(),
                scatterings: 0,
                ray: number,
                slot: number,
                turn: DVec2::X,
                light: LightState::NONE,
            },
        };
        self.trace(ray, RayKind::Path, batch);
    }
}
