//! Planned work: surfaces, rays and time of each case, before the result is traced.

use serde::Serialize;

use super::cost::case_seconds;
use crate::engine::prepare::group::Group;
use crate::store::Stage;

/// Work that is planned for a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlannedWork {
    /// Number of the case.
    pub case: usize,
    /// Surfaces.
    pub surfaces: u64,
    /// Rays on all of them.
    pub rays: u64,
    /// Expected time of one thread, seconds. Surfaces that cases share are divided among them.
    pub seconds: f64,
}

impl Group {
    /// Work that is planned for its cases, by the pilot run where there was one; none for those that need no rays.
    pub(in crate::engine) fn planned_work(&self) -> Vec<PlannedWork> {
        let expected = case_seconds(&self.source, &self.cases, self.plan);
        let surfaces = self.plan.surfaces as f64 / self.cases.len() as f64;
        let traced = self
            .cases
            .iter()
            .zip(expected)
            .map(|(run, expected)| PlannedWork {
                case: run.number,
                surfaces: self.plan.surfaces,
                rays: self.rays_of_case(Stage::Result),
                seconds: run.pilot.map_or(expected, |pilot| {
                    let of_rays = pilot.cost_of_ray_ns * self.plan.rays as f64;
                    1e-9 * (pilot.cost_of_surface_ns * surfaces + of_rays)
                }),
            });
        let without_rays = self.analytic.iter().map(|one| PlannedWork {
            case: one.run.number,
            surfaces: 0,
            rays: 0,
            seconds: 0.0,
        });
        traced.chain(without_rays).collect()
    }
}
