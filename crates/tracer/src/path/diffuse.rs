//! Diffuse reflection: what Lambertian facets do with the light that has arrived, many at a time.
//!
//! A facet reflects the same fraction of all light, in the cosine distribution about its normal, unpolarised. The reference
//! ([`crate::PathIntegrator`]) does the same one path at a time, which tests hold against it.
//!
//! # Source
//! Lambert, Photometria (1760).

use asperity_optics::around;
use glam::DVec3;

use super::arrivals::Arrivals;
use super::light_state::LightState;
use super::scatter::ScatteredLight;
use crate::random::{PathStream, Step, Use};
use crate::vector::Stage;

/// Reflects all arrivals diffusely.
pub(super) struct ScatterDiffusely<'a, F> {
    pub(super) arrivals: &'a Arrivals<F>,
    pub(super) reflectance: f64,
    pub(super) stream: PathStream,
    pub(super) into: &'a mut ScatteredLight,
}

impl<F: Copy> Stage for ScatterDiffusely<'_, F> {
    #[inline(always)]
    fn run(self) {
        let Arrivals { at, normal, .. } = self.arrivals;
        let n = self.arrivals.len();
        self.into.resize(n);
        self.into.transmitted.fill(0.0);
        self.into.reflected.fill(self.reflectance);

        // Sample the direction on the side of the light
        for i in 0..n {
            let step = Step {
                number: at.order[i].wrapping_add(at.scatterings[i]),
                events: at.events[i],
            };
            let numbers = self.stream.pair(at.ray[i], step, Use::Diffuse);
            let m = at.side[i] * DVec3::new(normal[0][i], normal[1][i], normal[2][i]);
            let wo = diffuse_direction(m, numbers);
            for (column, coordinate) in self.into.wo.iter_mut().zip(wo.to_array()) {
                column[i] = coordinate;
            }
        }

        // Depolarise
        let polarisation = at.kept.polarisation;
        let carried = LightState::len(polarisation);
        for light in &mut self.into.light {
            light.resize(carried, Vec::new());
            light.iter_mut().for_each(|column| column.resize(n, 0.0));
        }
        for i in 0..n {
            let light = at.light_state(i).depolarised(polarisation);
            for (column, number) in self.into.light[0].iter_mut().zip(light.0) {
                column[i] = number;
            }
        }
    }
}

/// A direction in the cosine distribution about a unit normal, from two numbers in `[0, 1)`: the squared sine of the angle to
/// the normal is evenly distributed.
#[inline(always)]
pub(super) fn diffuse_direction(m: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    around(m, (1.0 - u).sqrt(), v)
}
