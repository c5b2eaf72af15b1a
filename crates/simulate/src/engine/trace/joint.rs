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

/// Returns `true` if two cases on the same given surface may come to be traced together, whatever their methods are.
pub(crate) fn may_join(a: &Case, b: &Case) -> bool {
    let is_conductor =
        |case: &Case| matches!(case.material, Material::Conductor { .. }) && case.layers.is_empty();
    (a.light, a.bins) == (b.light, b.bins) && is_conductor(a) && is_conductor(b)
}

impl CaseRun {
    /// Returns `true` if both have the same paths on the same surface: they differ in the index of a conductor alone, and are estimated alike.
    fn has_paths_of(&self, other: &Self) -> bool {
        let meshes = self.methods.len().max(other.methods.len());
        let method = |run: &Self, mesh| {
            let method = run.method_on(mesh);
            let control = method.control_variate();
            let shadows = control.map(ControlVariate::shadow_probability);
            (method.starts, method.paths, shadows)
        };
        may_join(&self.case, &other.case)
            && (0..meshes).all(|mesh| method(self, mesh) == method(other, mesh))
    }
}
