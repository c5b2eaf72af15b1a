//! What was found for one direction.

use asperity_tally::{BatchStatistics, Estimate, History, Layout, OrderClass, Share, Side};
use serde::{Deserialize, Serialize};

/// Means with their standard errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Means {
    /// The means.
    pub mean: Vec<f64>,
    /// Their standard errors; `None` if there are none to be had.
    pub se: Option<Vec<f64>>,
}

impl Means {
    fn of(statistics: &BatchStatistics, entries: impl IntoIterator<Item = usize>) -> Self {
        let entries = entries.into_iter();
        Self::collect(entries.map(|entry| statistics.estimate(entry)).collect())
    }

    fn collect(estimates: Vec<Estimate>) -> Self {
        Self {
            mean: estimates.iter().map(|e| e.mean).collect(),
            se: estimates.iter().map(|e| e.se).collect(),
        }
    }

    /// Mean and error of quantity `i`.
    #[must_use]
    pub fn estimate(&self, i: usize) -> Estimate {
        Estimate {
            mean: self.mean[i],
            se: self.se.as_ref().map(|se| se[i]),
        }
    }

    fn is_sound(&self, len: usize) -> bool {
        let errors = self.se.iter().flatten();
        self.mean.len() == len
            && self.mean.iter().all(|v| v.abs() <= 2.0)
            && self.se.as_ref().is_none_or(|se| se.len() == len)
            && errors.into_iter().all(|e| (0.0..=2.0).contains(e))
    }
}

/// Flux fractions of one part of the light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredPart {
    /// `all`; `unscattered`, `once` or `more` with a medium; `single` or `multiple` without.
    pub name: String,
    /// By side, of those asked for.
    pub sides: Means,
    /// By bin of the grid, of the sides asked for.
    pub bins: Means,
    /// By side asked for and bin of the in-plane profile.
    pub in_plane: Means,
}

/// All that was found for a direction: what its file holds. Fluxes are fractions of what falls on the mean plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DirectionResults {
    /// Surfaces.
    pub surfaces: u64,
    /// Rays over all of them.
    pub rays: u64,
    /// What the errors come from: `surfaces`, `ray blocks`, or a `deviation bound` where nothing was traced.
    pub errors_from: String,
    /// What was absorbed, truncated and lost.
    pub budget: Means,
    /// All light, then its parts, which add up to it.
    pub parts: Vec<MeasuredPart>,
    /// What a reader should know.
    pub warnings: Vec<String>,
}

/// What the light of a part has in common.
#[derive(Clone, Copy)]
enum Whose {
    All,
    /// It met the surface once.
    Single,
    /// It met the surface more often.
    Multiple,
    /// It was scattered inside so often.
    History(History),
}

/// The parts of the light: by how often it was scattered inside a medium where there is one, and otherwise
/// by whether it met the surface once or more often.
fn parts_of(layout: &Layout) -> Vec<(&'static str, Whose)> {
    let mut parts = vec![("all", Whose::All)];
    if layout.has_histories() {
        parts.extend(History::ALL.map(|h| (h.name(), Whose::History(h))));
    } else {
        parts.extend([("single", Whose::Single), ("multiple", Whose::Multiple)]);
    }
    parts
}

/// Names of the parts that results of a layout have.
pub(super) fn part_names(layout: &Layout) -> Vec<&'static str> {
    parts_of(layout).into_iter().map(|(name, _)| name).collect()
}

impl Whose {
    fn side(self, layout: &Layout, side: Side) -> usize {
        match self {
            Self::All => [Layout::REFLECTED, Layout::TRANSMITTED][side.index()],
            Self::Single => layout.order(side, 1),
            Self::Multiple => layout.multiple(side),
            Self::History(history) => layout.history(side, history),
        }
    }

    fn bins(self, layout: &Layout) -> usize {
        match self {
            Self::All => layout.bins(Share::Total).start,
            Self::Single => layout.bins(Share::Single).start,
            Self::Multiple => layout.bins(Share::Multiple).start,
            Self::History(history) => layout.history_bins(history).start,
        }
    }

    /// The entries of a profile that add up to it.
    fn in_plane(self, layout: &Layout, side: Side) -> Vec<usize> {
        let of = |class| layout.in_plane(side, class).start;
        match self {
            Self::All => vec![of(OrderClass::All)],
            Self::Single => vec![of(OrderClass::First)],
            Self::Multiple => OrderClass::ALL[1..4]
                .iter()
                .map(|&class| of(class))
                .collect(),
            Self::History(history) => vec![layout.history_in_plane(side, history).start],
        }
    }
}

impl MeasuredPart {
    fn of(name: &str, whose: Whose, layout: &Layout, statistics: &BatchStatistics) -> Self {
        let start = whose.bins(layout);
        let in_plane = layout.sides().flat_map(|side| {
            let starts = whose.in_plane(layout, side);
            (0..layout.in_plane_len()).map(move |i| {
                let sums = starts.iter().map(|start| statistics.estimate(start + i));
                // Errors of a sum add up at most.
                sums.reduce(|a, b| Estimate {
                    mean: a.mean + b.mean,
                    se: a.se.zip(b.se).map(|(a, b)| a + b),
                })
            })
        });
        let in_plane: Vec<Estimate> = in_plane.flatten().collect();
        Self {
            name: name.to_owned(),
            sides: Means::of(
                statistics,
                layout.sides().map(|side| whose.side(layout, side)),
            ),
            bins: Means::of(statistics, layout.asked_bins().map(|bin| start + bin)),
            in_plane: Means::collect(in_plane),
        }
    }

    /// Flux that left on `side`; `None` if it was not asked for.
    #[must_use]
    pub fn side(&self, layout: &Layout, side: Side) -> Option<Estimate> {
        let place = layout.sides().position(|s| s == side)?;
        Some(self.sides.estimate(place))
    }

    /// Flux into bin `bin` of the grid; `None` if its side was not asked for.
    #[must_use]
    pub fn bin(&self, layout: &Layout, bin: usize) -> Option<Estimate> {
        let asked = layout.asked_bins();
        asked
            .contains(&bin)
            .then(|| self.bins.estimate(bin - asked.start))
    }

    /// Flux into in-plane bin `i` of `side`; `None` if it was not asked for.
    #[must_use]
    pub fn in_plane(&self, layout: &Layout, side: Side, i: usize) -> Option<Estimate> {
        let place = layout.sides().position(|s| s == side)?;
        Some(self.in_plane.estimate(place * layout.in_plane_len() + i))
    }
}

/// What light fluxes may miss each other by where they add up: rounding, of sums over all bins.
const ROUNDING: f64 = 1e-9;

impl DirectionResults {
    /// Takes from the statistics of a run what a measurement keeps.
    pub(super) fn of(
        layout: &Layout,
        statistics: &BatchStatistics,
        (surfaces, rays): (u64, u64),
        errors_from: &str,
        warnings: Vec<String>,
    ) -> Self {
        let budget = [Layout::ABSORBED, Layout::TRUNCATED, Layout::LOST];
        Self {
            surfaces,
            rays,
            errors_from: errors_from.to_owned(),
            budget: Means::of(statistics, budget),
            parts: parts_of(layout)
                .into_iter()
                .map(|(name, whose)| MeasuredPart::of(name, whose, layout, statistics))
                .collect(),
            warnings,
        }
    }

    /// Whether a run with this layout may have found these numbers: they are fluxes and add up.
    pub(super) fn is_sound(&self, layout: &Layout) -> bool {
        let asked = layout.asked_bins().len();
        let sides = layout.sides().count();
        let lengths = |part: &MeasuredPart| {
            part.sides.is_sound(sides)
                && part.bins.is_sound(asked)
                && part.in_plane.is_sound(sides * layout.in_plane_len())
        };
        let names = self.parts.iter().map(|part| part.name.as_str());
        if !(names.eq(part_names(layout))
            && self.budget.is_sound(3)
            && self.parts.iter().all(lengths))
        {
            return false;
        }
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING;
        let (all, parts) = (&self.parts[0], &self.parts[1..]);
        let adds_up = |of: fn(&MeasuredPart) -> &Means| {
            (0..of(all).mean.len())
                .all(|i| near(parts.iter().map(|p| of(p).mean[i]).sum(), of(all).mean[i]))
        };
        let fills_sides = |part: &MeasuredPart| {
            part.bins
                .mean
                .chunks(layout.grid().bins_per_side())
                .zip(&part.sides.mean)
                .all(|(bins, side)| near(sum(bins), *side))
        };
        near(sum(&all.sides.mean) + sum(&self.budget.mean), 1.0)
            && adds_up(|part| &part.sides)
            && adds_up(|part| &part.bins)
            && adds_up(|part| &part.in_plane)
            && self.parts.iter().all(fills_sides)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::HemisphereGrid;

    /// Results of a record whose bins, sides and parts hold what adds up.
    fn results(layout: &Layout) -> DirectionResults {
        let grid = layout.grid();
        let mut record = vec![0.0; layout.len()];
        for (history, share) in History::ALL.into_iter().zip([0.5, 0.25, 0.25]) {
            let bin = layout.history_bins(history).start + 1;
            let in_plane = layout.history_in_plane(Side::Reflected, history).start;
            let side = layout.history(Side::Reflected, history);
            (record[bin], record[in_plane], record[side]) =
                (0.75 * share, 0.1 * share, 0.75 * share);
        }
        assert!(grid.len() > 1);
        record[layout.bins(Share::Total).start + 1] = 0.75;
        record[layout.in_plane(Side::Reflected, OrderClass::All).start] = 0.1;
        record[Layout::REFLECTED] = 0.75;
        record[Layout::ABSORBED] = 0.25;
        let mut statistics = BatchStatistics::new(layout.len());
        (0..2).for_each(|_| statistics.push(&record));
        DirectionResults::of(layout, &statistics, (2, 100), "surfaces", Vec::new())
    }

    #[test]
    fn numbers_that_no_run_finds_are_not_believed() {
        let grid = HemisphereGrid::new(2, 3).unwrap();
        let layout = Layout::new(grid, 0.1).unwrap().with_histories();
        assert!(results(&layout).is_sound(&layout));
        // Another grid, other parts.
        let other = HemisphereGrid::new(3, 2).unwrap();
        let other = Layout::new(other, 0.1).unwrap().with_histories();
        assert!(!results(&layout).is_sound(&other));
        assert!(!results(&layout).is_sound(&Layout::new(grid, 0.1).unwrap()));
        type Spoil = fn(&mut DirectionResults);
        let spoilt: [(&str, Spoil); 9] = [
            ("budget", |r| r.budget.mean[0] = 0.3),
            ("side", |r| r.parts[0].sides.mean[0] = 0.7),
            ("bin", |r| r.parts[0].bins.mean[1] = 0.7),
            ("bin of a part", |r| r.parts[2].bins.mean[0] = 0.1),
            ("profile", |r| r.parts[1].in_plane.mean[0] = 0.2),
            ("name", |r| r.parts[1].name = "once".to_owned()),
            ("part", |r| drop(r.parts.pop())),
            ("error below zero", |r| {
                r.parts[0].bins.se = Some(vec![-1.0; 12]);
            }),
            ("errors of other bins", |r| {
                r.parts[0].bins.se = Some(vec![0.0; 3])
            }),
        ];
        for (what, spoil) in spoilt {
            let mut results = results(&layout);
            spoil(&mut results);
            assert!(!results.is_sound(&layout), "{what}");
        }
    }
}
