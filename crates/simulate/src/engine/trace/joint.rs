//! Joint cases: cases that are traced together, since they differ in the index of a conductor alone.

use asperity_optics::Material;
use asperity_tally::ControlVariate;
use asperity_tracer::MAX_CONDUCTORS;

use crate::engine::prepare::case_run::CaseRun;
use crate::input::case::Case;

/// Sets of numbers of cases that are traced together, each in the place of its first. `can_join` returns `true` if two cases on the same
/// paths, by their numbers, may share a trace.
pub(crate) fn joint_sets(
    cases: &[CaseRun],
    can_join: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let set = sets.iter_mut().find(|set| {
            let first = set[0];
            set.len() < MAX_CONDUCTORS
                && case.has_paths_of(&cases[first])
                && can_join(first, number)
        });
        match set {
            Some(set) => set.push(number),
            None => sets.push(vec![number]),
        }
    }
    sets
}

impl CaseRun {
    /// Returns `true` if both have the same paths on the same surface: they differ in the index of a conductor alone, and are estimated alike.
    fn has_paths_of(&self, other: &Self) -> bool {
        let of = |case: &Case| (case.light, case.bins);
        let are_conductors = [self, other].iter().all(|run| {
            matches!(run.case.material, Material::Conductor { .. }) && run.case.layers.is_empty()
        });
        let meshes = self.methods.len().max(other.methods.len());
        let method = |run: &Self, mesh| {
            let method = run.method_on(mesh);
            let control = method.control_variate();
            let shadows = control.map(ControlVariate::shadow_probability);
            (method.starts, method.paths, shadows)
        };
        are_conductors
            && of(&self.case) == of(&other.case)
            && (0..meshes).all(|mesh| method(self, mesh) == method(other, mesh))
    }
}
