//! Levels: numbers that are whole multiples of a step, up to an offset, such as differences of heights that an instrument has rounded.
//!
//! Bins that are no multiple of the step hold now more, now fewer levels: the histogram beats. A number that is known to one step is taken
//! for spread evenly over that step, which keeps every bin in proportion.

use super::bins::Bins;

/// Fewest levels of which a step can be told; a surface of few facets has few slopes.
const MIN_LEVELS: usize = 16;

/// Least number of values per level: without a step nearly every value is a level of its own.
const MIN_VALUES_PER_LEVEL: usize = 4;

/// Distance of a gap from a whole number of steps.
const TOLERANCE: f64 = 0.05;

/// Most steps per bin for which bins beat by more than a few per cent.
const MAX_STEPS_PER_BIN: f64 = 50.0;

/// The levels `offset + k step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Levels {
    pub(super) step: f64,
    offset: f64,
}

impl Levels {
    /// The levels of values, if they have some that bins of `width` notice.
    pub(super) fn of(mut values: Vec<f64>, width: f64) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let range = values.last()? - values.first()?;
        // Numbers that were rounded twice lie in groups of a finer step
        let finest = 1e-9 * range;
        let apart = [between_groups(&values, finest).unwrap_or(finest), finest];
        apart
            .into_iter()
            .find_map(|apart| Self::of_groups(&values, apart, width))
    }

    /// The levels of groups, which lie farther than `apart` from each other.
    fn of_groups(values: &[f64], apart: f64, width: f64) -> Option<Self> {
        let groups = values.chunk_by(|a, b| b - a <= apart);
        let middle = |group: &[f64]| 0.5 * (group[0] + group[group.len() - 1]);
        let levels: Vec<f64> = groups.map(middle).collect();
        if levels.len() < MIN_LEVELS || levels.len() * MIN_VALUES_PER_LEVEL > values.len() {
            return None;
        }
        let gaps = || levels.windows(2).map(|pair| pair[1] - pair[0]);
        let least = gaps().fold(f64::INFINITY, f64::min);
        let steps = gaps().map(|gap| (gap / least).round()).sum::<f64>();
        let step = (levels[levels.len() - 1] - levels[0]) / steps;
        let is_whole = |gap: f64| (gap / step - (gap / step).round()).abs() < TOLERANCE;
        (gaps().all(is_whole) && width / step < MAX_STEPS_PER_BIN).then_some(Self {
            step,
            offset: levels[0],
        })
    }

    /// Bins of one level each, over as many as reach into `range`.
    pub(super) fn bins(&self, [from, to]: [f64; 2]) -> Option<Bins> {
        let edge = |k: f64| self.offset + (k - 0.5) * self.step;
        let number = |edge: f64| (edge - self.offset) / self.step + 0.5;
        let [first, last] = [number(from).floor(), number(to).ceil()];
        Bins::new([edge(first), edge(last)], (last - first) as usize)
    }
}

/// Limit between gaps within groups and gaps between them: the middle of the widest interval of the logarithms of those above `finest`.
fn between_groups(values: &[f64], finest: f64) -> Option<f64> {
    let mut gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.retain(|gap| *gap > finest);
    gaps.sort_by(f64::total_cmp);
    let ratio = |pair: &[f64]| pair[1] / pair[0];
    let widest = gaps
        .windows(2)
        .max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
    Some(widest[0].sqrt() * widest[1].sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_told_where_there_are_some() {
        let wave = |i: i32| 40.0 * (f64::from(i) * 0.37).sin();
        let rounded: Vec<f64> = (0..4000).map(|i| 0.3 + 0.7 * wave(i).round()).collect();
        let levels = Levels::of(rounded.clone(), 1.0).unwrap();
        assert!((levels.step - 0.7).abs() < 1e-12);
        // Rounded once more, to a hundredth
        let twice = (0..4000)
            .map(|i| 100.0 / 3.0 * (0.021 * wave(i).round() + 0.000_21 * f64::from(i % 3)));
        let levels = Levels::of(twice.collect(), 1.0).unwrap();
        assert!((levels.step - 0.7).abs() < 1e-3);
        // As many steps in a bin that none is seen
        assert_eq!(Levels::of(rounded, 36.0), None);
        assert_eq!(Levels::of((0..4000).map(wave).collect(), 1.0), None);
        // Two slopes, as of grooves
        let two = (0..4000).map(|i| f64::from(i % 2));
        assert_eq!(Levels::of(two.collect(), 0.1), None);
    }
}
