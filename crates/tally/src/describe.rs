//! Descriptions of entries: the filters behind a place in memory.

use crate::component::MAX_LISTED_ORDER;
use crate::entry::{Entries, Entry, EntryDescription, Score};
use crate::places::{PATH_ENTRIES, PATHS_START};
use crate::{Component, Measure, Side, TallySpec};

impl TallySpec {
    /// What an entry counts.
    ///
    /// # Panics
    /// If the entry is of a larger spec.
    #[must_use]
    pub fn describe(&self, entry: Entry) -> EntryDescription {
        if let Some((flux, measure)) = self.measured_by(entry) {
            return EntryDescription {
                measure: Some(measure),
                ..self.describe(flux)
            };
        }
        let found = self
            .sections()
            .into_iter()
            .find(|section| section.entries.range().contains(&entry.0));
        match found {
            Some(Section { entries, first }) => EntryDescription {
                index: first.index + entry.0 - entries.start,
                ..first
            },
            None => panic!("entry {} of a spec of {}", entry.0, self.len()),
        }
    }

    /// The flux entry and the measure of an entry that is kept besides the flux.
    fn measured_by(&self, entry: Entry) -> Option<(Entry, Measure)> {
        let number = entry.0.checked_sub(self.places().measures_start())?;
        let measures = self.polarimetry().len();
        let flux = self.places().flux_of_places();
        let flux = flux.get(number.checked_div(measures)?)?;
        let measure = self.polarimetry().measure(number % measures);
        Some((Entry(*flux), measure))
    }

    /// Entries that are alike.
    fn sections(&self) -> Vec<Section> {
        let mut sections = Self::budget_sections();
        for component in self.described_components() {
            for side in Side::BOTH {
                sections.extend(self.component_sections(side, component));
            }
        }
        sections.extend(Side::BOTH.map(Self::path_section));
        sections
    }

    fn budget_sections() -> Vec<Section> {
        let budget = Self::BUDGET;
        [
            (budget.absorbed, Score::Absorbed),
            (budget.truncated, Score::Truncated),
            (budget.lost, Score::Lost),
            (budget.left_patch, Score::LeftPatch),
            (budget.not_recorded, Score::NotRecorded),
        ]
        .map(|(entry, score)| Section::new(Entries::new(entry.0, 1), score, None, Component::All))
        .into()
    }

    /// All components that entries may be of, each once.
    fn described_components(&self) -> Vec<Component> {
        let surface = [Component::All, Component::Multiple].into_iter();
        let orders = (1..MAX_LISTED_ORDER as u8).map(Component::Order);
        let last = Component::OrderAndAbove(MAX_LISTED_ORDER as u8);
        let components = surface.chain(orders).chain([last, Component::Single]);
        let components = components
            .chain(Component::ORDERS)
            .chain(self.components().iter().copied());
        let mut listed: Vec<Component> = Vec::new();
        for component in components {
            if !listed.contains(&component) {
                listed.push(component);
            }
        }
        listed
    }

    /// The entries of a component on a side, as far as there are any.
    fn component_sections(
        &self,
        side: Side,
        component: Component,
    ) -> impl Iterator<Item = Section> {
        let (places, grid) = (self.places(), self.grid());
        let (bins, rings) = (grid.bins_per_side(), grid.n_theta());
        [
            (places.find_flux(side, component), 1, Score::Flux),
            (places.find_bins(side, component), bins, Score::BinFlux),
            (places.find_hits(side, component), bins, Score::BinHits),
            (places.find_rings(side, component), rings, Score::RingFlux),
            (
                places.find_in_plane(side, component),
                2 * rings,
                Score::InPlaneFlux,
            ),
        ]
        .into_iter()
        .filter_map(move |(start, len, score)| {
            let entries = Entries::new(start?, len);
            Some(Section::new(entries, score, Some(side), component))
        })
    }

    fn path_section(side: Side) -> Section {
        let start = PATHS_START + side.index() * PATH_ENTRIES;
        let entries = Entries::new(start, PATH_ENTRIES);
        Section::new(entries, Score::EventPathFlux, Some(side), Component::All)
    }
}

/// Entries that are alike.
struct Section {
    entries: Entries,
    /// Description of the first of them.
    first: EntryDescription,
}

impl Section {
    const fn new(entries: Entries, score: Score, side: Option<Side>, component: Component) -> Self {
        let first = EntryDescription {
            score,
            side,
            component,
            measure: None,
            index: 0,
        };
        Self { entries, first }
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
            for section in spec.sections() {
                section.entries.iter().for_each(|entry| seen[entry.0] += 1);
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
                measure,
                index,
            } = spec.describe(entry);
            assert_eq!(measure, None);
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
