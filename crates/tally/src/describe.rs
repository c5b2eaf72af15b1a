//! Descriptions of entries: the filters behind a place in memory.

use crate::component::MAX_LISTED_ORDER;
use crate::entry::{Entries, Entry, EntryDescription, Score};
use crate::places::{PATH_ENTRIES, PATHS_START};
use crate::{Component, Side, TallySpec};

impl TallySpec {
    /// What an entry counts.
    ///
    /// # Panics
    /// If the entry is of a larger spec.
    #[must_use]
    pub fn describe(&self, entry: Entry) -> EntryDescription {
        let found = self
            .sections()
            .into_iter()
            .find(|(entries, _)| entries.range().contains(&entry.0));
        match found {
            Some((entries, first)) => EntryDescription {
                index: first.index + entry.0 - entries.start,
                ..first
            },
            None => panic!("entry {} of a spec of {}", entry.0, self.len()),
        }
    }

    /// Entries that are alike, each with the description of its first.
    fn sections(&self) -> Vec<(Entries, EntryDescription)> {
        let mut sections = Vec::new();
        let mut add = |entries: Entries, score, side, component| {
            let description = EntryDescription {
                score,
                side,
                component,
                index: 0,
            };
            sections.push((entries, description));
        };
        let budget = Self::BUDGET;
        for (entry, score) in [
            (budget.absorbed, Score::Absorbed),
            (budget.truncated, Score::Truncated),
            (budget.lost, Score::Lost),
            (budget.left_patch, Score::LeftPatch),
            (budget.not_recorded, Score::NotRecorded),
        ] {
            add(Entries::new(entry.0, 1), score, None, Component::All);
        }
        let surface = [Component::All, Component::Multiple].into_iter();
        let orders = (1..MAX_LISTED_ORDER as u8).map(Component::Order);
        let last = Component::OrderAndAbove(MAX_LISTED_ORDER as u8);
        let components = surface.chain(orders).chain([last, Component::Single]);
        let components = components
            .chain(Component::ORDERS)
            .chain(self.components().iter().copied());
        let mut listed: Vec<Component> = Vec::new();
        for component in components {
            if listed.contains(&component) {
                continue;
            }
            listed.push(component);
            for side in Side::BOTH {
                let n_theta = self.grid().n_theta();
                for (start, len, score) in [
                    (self.places().find_flux(side, component), 1, Score::Flux),
                    (
                        self.places().find_bins(side, component),
                        self.grid().bins_per_side(),
                        Score::BinFlux,
                    ),
                    (
                        self.places().find_hits(side, component),
                        self.grid().bins_per_side(),
                        Score::BinHits,
                    ),
                    (
                        self.places().find_rings(side, component),
                        n_theta,
                        Score::RingFlux,
                    ),
                    (
                        self.places().find_in_plane(side, component),
                        2 * n_theta,
                        Score::InPlaneFlux,
                    ),
                ] {
                    if let Some(start) = start {
                        add(Entries::new(start, len), score, Some(side), component);
                    }
                }
            }
        }
        for side in Side::BOTH {
            let start = PATHS_START + side.index() * PATH_ENTRIES;
            let paths = Entries::new(start, PATH_ENTRIES);
            add(paths, Score::EventPathFlux, Some(side), Component::All);
        }
        sections
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HemisphereGrid;

    #[test]
    fn every_entry_has_one_description() {
        let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
        for spec in [spec, spec.with_medium()] {
            let mut seen = vec![0_u32; spec.len()];
            for (entries, _) in spec.sections() {
                entries.iter().for_each(|entry| seen[entry.0] += 1);
            }
            assert!(seen.iter().all(|&n| n == 1), "{seen:?}");
        }
    }

    #[test]
    fn descriptions_lead_back_to_their_entries() {
        let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1)
            .unwrap()
            .with_medium();
        for entry in spec.entries() {
            let EntryDescription {
                score,
                side,
                component,
                index,
            } = spec.describe(entry);
            let Some(side) = side else {
                assert!(
                    TallySpec::BUDGET.parts().contains(&entry)
                        || entry.0 < crate::places::MULTIPLE_START
                );
                continue;
            };
            let entries = match score {
                Score::BinFlux => spec.bin_entries(side, component),
                Score::BinHits => spec.hit_entries(side, component),
                Score::RingFlux => spec.ring_entries(side, component),
                Score::InPlaneFlux => spec.in_plane_entries(side, component),
                Score::Flux => Entries::new(spec.flux_entry(side, component).0, 1),
                _ => continue,
            };
            assert_eq!(entries.get(index), entry);
        }
    }
}
