//! Sample groups: entries among which light is divided, and the error that a few samples leave.
//!
//! A sample is a ray, or all rays of one surface. The scatter of few samples says little of how far they may be off, and that of none
//! nothing at all. An entry of few samples therefore has an error of at least one more of the root mean square that samples of its group
//! add, times the root of the number that is expected in it where that is below one. In an entry without any, that number follows from
//! those with a single one: the next sample falls into an empty entry as often as samples have been the only ones of theirs (Good and
//! Turing).

use crate::{Component, Entry, Score, Side, TallySpec, TallyValues};

/// Rays, or surfaces, from which on their own scatter is taken for the error.
pub const FEW_RAYS: f64 = 20.0;

/// Numbers of samples that are expected in entries of these `samples`, at most one each; zero in those of `few` or more.
pub(crate) fn expected_samples(samples: &[f64], few: f64) -> Vec<f64> {
    let is_few = |n: f64| n > 0.0 && n < few;
    let count = |of: &dyn Fn(f64) -> bool| samples.iter().filter(|&&n| of(n)).count() as f64;
    let alone = count(&|n| is_few(n) && n < 2.0);
    let at_least = count(&is_few).min(1.0);
    let unseen = alone.max(at_least) / count(&|n| n == 0.0);
    let expected = |&n: &f64| if n == 0.0 { unseen } else { n };
    let of = |n: &f64| if *n < few { expected(n).min(1.0) } else { 0.0 };
    samples.iter().map(of).collect()
}

/// Raises squares of errors in `entries` of fewer than `few` samples to that of one more. `squares`: of the errors by the scatter of
/// samples, of which those of fewer than `pooled` tell the mean square of one.
pub(crate) fn raise(
    least: &mut TallyValues,
    squares: &TallyValues,
    entries: &[Entry],
    samples: &[f64],
    [few, pooled]: [f64; 2],
) {
    let pool = || entries.iter().zip(samples).filter(|(_, n)| **n < pooled);
    let count: f64 = pool().map(|(_, n)| n).sum();
    let sum: f64 = pool().map(|(&entry, _)| squares[entry]).sum();
    if count == 0.0 {
        return;
    }
    for (&entry, expected) in entries.iter().zip(expected_samples(samples, few)) {
        least[entry] = least[entry].max(expected * sum / count);
    }
}

/// Raises squares of errors of orders without any sample in rings and in-plane bins, where few samples carry the order below: one more sample
/// may scatter once more than any did, with what those of the order below add, into any of the entries.
pub(crate) fn raise_unseen(
    least: &mut TallyValues,
    squares: &TallyValues,
    samples: impl Fn(Entry) -> f64,
    few: f64,
) {
    let spec = *squares.spec();
    for (side, score) in spec
        .sides()
        .flat_map(|side| [Score::RingFlux, Score::InPlaneFlux].map(|score| (side, score)))
    {
        for orders in Component::ORDERS.windows(2) {
            let [below, above] = [0, 1].map(|i| entries_of(&spec, score, side, orders[i]));
            let found = || below.iter().map(|&entry| samples(entry));
            let is_unseen = above.iter().all(|&entry| samples(entry) == 0.0);
            let count: f64 = found().sum();
            if is_unseen && count > 0.0 && found().all(|n| n < few) {
                let sum: f64 = below.iter().map(|&entry| squares[entry]).sum();
                let square = sum / count / above.len() as f64;
                above
                    .iter()
                    .for_each(|&entry| least[entry] = least[entry].max(square));
            }
        }
    }
}

/// Groups of entries among which the light of one component of a side is divided: orders, event paths, apertures, and the bins, rings or
/// in-plane bins of `scores`.
pub(crate) fn flux_groups<const N: usize>(
    spec: &TallySpec,
    scores: [Score; N],
) -> impl Iterator<Item = Vec<Entry>> + '_ {
    spec.sides().flat_map(move |side| {
        let paths = spec.listed_paths();
        let paths = paths.map(move |path| spec.event_path_entry(side, path));
        let paths = paths.chain([spec.longer_paths_entry(side)]).collect();
        let orders = spec.order_entries(side).iter().collect();
        let apertures = spec.aperture_entries().iter().zip(spec.apertures().iter());
        let apertures = apertures.filter(|(_, aperture)| aperture.side == side);
        let apertures = apertures.map(|(entry, _)| entry).collect();
        let split = scores.into_iter().flat_map(move |score| {
            let listed: &[Component] = match score {
                Score::BinFlux => &Component::BINS,
                _ => &Component::RINGS,
            };
            let all = listed.iter().chain(spec.components());
            all.map(move |&component| entries_of(spec, score, side, component))
        });
        [paths, orders, apertures].into_iter().chain(split)
    })
}

/// Groups of flux entries that measures of polarised light are kept beside.
pub(crate) fn measured_groups(
    spec: &TallySpec,
) -> impl Iterator<Item = (Side, Score, Component)> + '_ {
    let scores = [Score::Flux, Score::RingFlux, Score::InPlaneFlux];
    spec.sides().flat_map(move |side| {
        let of_score = move |score| Component::RINGS.map(move |component| (side, score, component));
        let groups = scores.into_iter().flat_map(of_score);
        groups.chain([(side, Score::BinFlux, Component::All)])
    })
}

/// All entries of a score.
pub(crate) fn entries_of(
    spec: &TallySpec,
    score: Score,
    side: Side,
    component: Component,
) -> Vec<Entry> {
    let entries = spec.component_entries(score, side, component);
    entries.iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HemisphereGrid;

    #[test]
    fn empty_entries_share_as_many_samples_as_were_found_alone() {
        let expected = |samples: &[f64]| expected_samples(samples, FEW_RAYS);
        // Two entries of one sample, four empty ones
        let found = expected(&[90.0, 7.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(found, [0.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5]);
        // At least one where any entry has few; none where all light is in places of many.
        assert_eq!(expected(&[90.0, 7.0, 0.0, 0.0]), [0.0, 1.0, 0.5, 0.5]);
        assert_eq!(expected(&[90.0, 0.0, 0.0]), [0.0; 3]);
        assert_eq!(expected(&[1.0, 1.0, 1.0, 0.0]), [1.0; 4]);
        assert_eq!(expected(&[0.25, 30.0]), [0.25, 0.0]);
    }

    /// Two samples of order three in one of six rings and none of higher orders; order two is carried by many.
    #[test]
    fn an_order_without_samples_may_have_one_of_the_order_below() {
        let spec = TallySpec::new(HemisphereGrid::new(6, 4).unwrap(), 0.2).unwrap();
        let rings = |order: usize| spec.ring_entries(Side::Reflected, Component::ORDERS[order - 1]);
        let (mut squares, mut samples) = (TallyValues::zeros(spec), TallyValues::zeros(spec));
        (squares[rings(3).get(2)], samples[rings(3).get(2)]) = (0.12, 2.0);
        for ring in 0..6 {
            (squares[rings(2).get(ring)], samples[rings(2).get(ring)]) = (0.5, 30.0);
        }
        let raised = |samples: &TallyValues| {
            let mut least = TallyValues::zeros(spec);
            raise_unseen(&mut least, &squares, |entry| samples[entry], FEW_RAYS);
            least
        };
        let least = raised(&samples);
        for ring in 0..6 {
            assert!((least[rings(4).get(ring)] - 0.01).abs() < 1e-15);
        }
        assert_eq!(least.iter().filter(|&&square| square > 0.0).count(), 6);
        // What one sample carries has the error of its group
        samples[rings(4).get(0)] = 1.0;
        assert!(raised(&samples).iter().all(|&square| square == 0.0));
        // Many samples of an order and none of the next one: there is no light of the next order
        samples[rings(4).get(0)] = 0.0;
        samples[rings(3).get(2)] = 20.0;
        assert!(raised(&samples).iter().all(|&square| square == 0.0));
    }
}
