//! Values by entry: a number, or anything else, for each entry of a spec.

pub(crate) mod numbers;
pub(crate) mod side_fluxes;
pub(crate) mod views;

use std::ops::{AddAssign, Index, IndexMut};

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Component, Entries, Entry, Event, EventPath, Score, Side, TallySpec};
use numbers::Numbers;
use side_fluxes::SideFluxes;
use views::TallyResult;

/// One `T` for each entry of a spec.
#[derive(Clone, Debug, PartialEq)]
pub struct ByEntry<T> {
    spec: TallySpec,
    values: Vec<T>,
}

/// Values in their written form, perhaps of another spec.
#[derive(Serialize, Deserialize)]
struct SavedValues<V> {
    spec: TallySpec,
    values: V,
}

impl<T> ByEntry<T> {
    fn read<E: Error>(spec: TallySpec, values: Vec<T>) -> Result<Self, E> {
        match values.len() == spec.len() {
            true => Ok(Self { spec, values }),
            false => {
                let (found, expected) = (values.len(), spec.len());
                Err(E::custom(format!(
                    "{found} values of a tally of {expected}"
                )))
            }
        }
    }
}

impl Serialize for TallyValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let saved = SavedValues {
            spec: self.spec,
            values: Numbers(self.values.as_slice().into()),
        };
        saved.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for TallyValues {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let SavedValues { spec, values } = SavedValues::<Numbers<'_>>::deserialize(source)?;
        Self::read(spec, values.0.into_owned())
    }
}

impl Serialize for ByEntry<Option<f64>> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let saved = SavedValues {
            spec: self.spec,
            values: &self.values,
        };
        saved.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for ByEntry<Option<f64>> {
    fn deserialize<D: Deserializer<'de>>(source: D) -> Result<Self, D::Error> {
        let SavedValues { spec, values } = SavedValues::deserialize(source)?;
        Self::read(spec, values)
    }
}

/// Flux fractions by entry: of one batch or one surface, of a model, or errors.
///
/// Flux fractions are relative to the flux that falls on the mean plane, so that they add up.
pub type TallyValues = ByEntry<f64>;

impl<T> ByEntry<T> {
    /// The value of each entry by a function.
    #[must_use]
    pub fn from_fn(spec: TallySpec, f: impl FnMut(Entry) -> T) -> Self {
        Self {
            spec,
            values: spec.entries().map(f).collect(),
        }
    }

    pub(crate) fn from_vec(spec: TallySpec, values: Vec<T>) -> Self {
        assert_eq!(values.len(), spec.len(), "values of another spec");
        Self { spec, values }
    }

    /// The spec.
    #[must_use]
    pub const fn spec(&self) -> &TallySpec {
        &self.spec
    }

    /// All values in the order of their entries.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }

    /// All values in the order of their entries, to be changed.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.values.iter_mut()
    }

    /// Applies a function to every value.
    #[must_use]
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> ByEntry<U> {
        ByEntry {
            spec: self.spec,
            values: self.values.iter().map(f).collect(),
        }
    }

    /// Applies a function to the values of each entry in two tallies.
    ///
    /// # Panics
    /// If they are of different specs.
    #[must_use]
    pub fn zip_map<U, V>(&self, other: &ByEntry<U>, mut f: impl FnMut(&T, &U) -> V) -> ByEntry<V> {
        assert_eq!(
            self.values.len(),
            other.values.len(),
            "tallies of different specs"
        );
        let pairs = self.values.iter().zip(&other.values);
        ByEntry {
            spec: self.spec,
            values: pairs.map(|(a, b)| f(a, b)).collect(),
        }
    }

    /// Changes each value by that of another tally.
    ///
    /// # Panics
    /// If they are of different specs.
    pub fn update<U>(&mut self, other: &ByEntry<U>, mut f: impl FnMut(&mut T, &U)) {
        assert_eq!(
            self.values.len(),
            other.values.len(),
            "tallies of different specs"
        );
        let pairs = self.values.iter_mut().zip(&other.values);
        pairs.for_each(|(a, b)| f(a, b));
    }

    pub(crate) fn as_slice(&self) -> &[T] {
        &self.values
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.values
    }
}

impl<T: Clone> ByEntry<T> {
    /// One value in all entries.
    #[must_use]
    pub fn filled(spec: TallySpec, value: T) -> Self {
        Self {
            spec,
            values: vec![value; spec.len()],
        }
    }
}

impl<T: Copy> TallyResult for ByEntry<T> {
    type Value = T;

    fn spec(&self) -> &TallySpec {
        &self.spec
    }

    fn at(&self, entry: Entry) -> T {
        self.values[entry.0]
    }
}

impl<'a, T> IntoIterator for &'a ByEntry<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<T> Index<Entry> for ByEntry<T> {
    type Output = T;

    fn index(&self, entry: Entry) -> &T {
        &self.values[entry.0]
    }
}

impl<T> IndexMut<Entry> for ByEntry<T> {
    fn index_mut(&mut self, entry: Entry) -> &mut T {
        &mut self.values[entry.0]
    }
}

impl<T> Index<Entries> for ByEntry<T> {
    type Output = [T];

    fn index(&self, entries: Entries) -> &[T] {
        &self.values[entries.range()]
    }
}

impl<T> IndexMut<Entries> for ByEntry<T> {
    fn index_mut(&mut self, entries: Entries) -> &mut [T] {
        &mut self.values[entries.range()]
    }
}

/// Adds another tally entry by entry.
impl AddAssign<&Self> for TallyValues {
    fn add_assign(&mut self, other: &Self) {
        self.update(other, |a, b| *a += b);
    }
}

impl TallyValues {
    /// Zero in all entries.
    #[must_use]
    pub fn zeros(spec: TallySpec) -> Self {
        Self::filled(spec, 0.0)
    }

    /// Rays per incident ray that reached bin `i` of `side`; for all light the sum of
    /// [`Component::SURFACE`].
    #[must_use]
    pub fn hits(&self, side: Side, component: Component, i: usize) -> f64 {
        let of = |component| self[self.spec.hit_entries(side, component).get(i)];
        match component {
            Component::All => Component::SURFACE.map(of).iter().sum(),
            component => of(component),
        }
    }

    /// Rays per incident ray that reached a bin, by its number among those of both sides.
    #[must_use]
    pub fn grid_hits(&self, component: Component, bin: usize) -> f64 {
        let of_a_side = self.spec.grid().bins_per_side();
        self.hits(Side::BOTH[bin / of_a_side], component, bin % of_a_side)
    }

    /// Sets the rays in all bins to zero, for values that were not traced.
    pub fn clear_hits(&mut self) {
        let components = self.spec.components().iter().copied();
        for component in Component::SURFACE.into_iter().chain(components) {
            for side in Side::BOTH {
                let entries = self.spec.hit_entries(side, component);
                self[entries].fill(0.0);
            }
        }
    }

    /// Sets all entries that hold light of order one of `side` and no other, and those of all light:
    /// the expectation of a model of single scattering.
    ///
    /// # Panics
    /// If `fluxes` are of other bins than the spec.
    pub fn set_single_scattering(&mut self, side: Side, fluxes: &SideFluxes) {
        let spec = self.spec;
        for component in [Component::Single, Component::All] {
            for (score, fluxes) in fluxes.by_score() {
                self[spec.component_entries(score, side, component)].copy_from_slice(fluxes);
            }
        }
        self[spec.event_path_entry(side, single_path(side))] = fluxes.total;
    }

    /// Takes light of order one from `single`, and changes all light by the difference.
    ///
    /// # Panics
    /// If the two are of different specs.
    pub fn replace_single_scattering(&mut self, single: &Self) {
        let spec = self.spec;
        for side in Side::BOTH {
            for score in Score::FLUXES {
                let [firsts, all] = [Component::Single, Component::All]
                    .map(|component| spec.component_entries(score, side, component));
                for (first, all) in firsts.iter().zip(all) {
                    self[all] += single[first] - self[first];
                    self[first] = single[first];
                }
            }
            let path = spec.event_path_entry(side, single_path(side));
            self[path] = single[path];
        }
    }

    /// Adds the fluxes of a component of `side` where the tally keeps it.
    ///
    /// # Panics
    /// If `fluxes` are of other bins than the spec.
    pub fn add_component(&mut self, side: Side, component: Component, fluxes: &SideFluxes) {
        let offsets = self.spec.offsets();
        for (score, fluxes) in fluxes.by_score() {
            if let Some(entries) = offsets.find(score, side, component) {
                assert_eq!(entries.len(), fluxes.len(), "fluxes of other bins");
                let pairs = self[entries].iter_mut().zip(fluxes);
                pairs.for_each(|(sum, flux)| *sum += flux);
            }
        }
    }
}

/// The path of light that left on `side` after one interaction.
pub(crate) const fn single_path(side: Side) -> EventPath {
    let event = match side {
        Side::Reflected => Event::Reflection,
        Side::Transmitted => Event::Transmission,
    };
    EventPath::from_code(0, 0).then(event)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HemisphereGrid;

    fn spec() -> TallySpec {
        TallySpec::new(HemisphereGrid::new(2, 3).unwrap(), 0.2).unwrap()
    }

    fn fluxes(flux: f64) -> SideFluxes {
        let bins = spec().bin_filter(Side::Reflected);
        SideFluxes::from_bins(&bins, vec![flux; bins.len()], vec![0.5 * flux; 4])
    }

    #[test]
    fn replaced_single_scattering_changes_all_light_alike() {
        let (mut sampled, mut exact) = (TallyValues::zeros(spec()), TallyValues::zeros(spec()));
        sampled.set_single_scattering(Side::Reflected, &fluxes(0.01));
        sampled.add_component(Side::Reflected, Component::All, &fluxes(0.02));
        exact.set_single_scattering(Side::Reflected, &fluxes(0.015));
        sampled.replace_single_scattering(&exact);
        for view in [
            sampled.bins(Side::Reflected, Component::All),
            sampled.bins(Side::Reflected, Component::Single),
        ] {
            let expected = if view.component() == Component::All {
                0.035
            } else {
                0.015
            };
            assert!(view.iter().all(|flux| (flux - expected).abs() < 1e-15));
        }
        let total = sampled.flux(Side::Reflected, Component::All);
        assert!((total - 6.0 * 0.035).abs() < 1e-15);
        assert_eq!(sampled.flux(Side::Transmitted, Component::All), 0.0);
    }

    #[test]
    fn a_component_that_is_not_kept_is_left_out() {
        let mut values = TallyValues::zeros(spec());
        values.add_component(Side::Reflected, Component::ScatteredOnce, &fluxes(0.01));
        assert!(values.iter().all(|&value| value == 0.0));
        let mut values = TallyValues::zeros(spec().with_medium());
        values.add_component(Side::Reflected, Component::ScatteredOnce, &fluxes(0.01));
        assert_eq!(
            values
                .rings(Side::Reflected, Component::ScatteredOnce)
                .get(0),
            0.03
        );
    }
}
