//! Share: the part of a run that one of several machines traces.
//!
//! The work of a run is laid out in a row: cases, the surfaces of each, the blocks of rays on a given one, as long as they are expected to
//! take. A share is a part of that row; a surface or a block belongs to the share that its middle lies in. All shares of a run have the
//! same division without communication: nothing is traced twice or left out. Cases that are small beside a share are not divided, so that each is finished by one
//! machine, and shares are as equal as that allows.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// The part of a run that one of several machines traces: `2/7` is the second of seven.
///
/// # Examples
/// ```
/// use asperity_simulate::Share;
///
/// let share: Share = "2/4".parse()?;
/// // Cases that take 3, 1, 4 seconds, with 8 surfaces each
/// let surfaces: Vec<_> = share.slices(&[3.0, 1.0, 4.0]).iter().map(|one| one.units(8)).collect();
/// assert_eq!(surfaces, [5..8, 0..8, 0..0]);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    begin: u64,
    end: u64,
    of: u64,
}

/// The share of a run that is traced, and the times that shares are balanced by.
#[derive(Clone, Debug, PartialEq)]
pub struct Division {
    /// The share.
    pub share: Share,
    /// Times of all cases in seconds, as an earlier run has planned them; empty for expected ones.
    pub seconds: Vec<f64>,
}

impl Division {
    /// All of a run.
    pub const WHOLE: Self = Self {
        share: Share::WHOLE,
        seconds: Vec::new(),
    };
}

/// A part of the surfaces of a case, or of the blocks of rays on a given one, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    begin: f64,
    end: f64,
}

/// Largest time of a case that is not divided, as a part of that of a share.
pub(crate) const MAX_UNDIVIDED: f64 = 0.5;

/// Distance from either end of a case at which a division of it is rounding alone.
const ROUNDING: f64 = 1e-9;

impl Share {
    /// All of a run.
    pub const WHOLE: Self = Self {
        begin: 0,
        end: 1,
        of: 1,
    };

    /// Empty share: no surface or block is traced.
    pub const NOTHING: Self = Self {
        begin: 0,
        end: 0,
        of: 1,
    };

    /// Most shares of a run.
    pub const MAX: u64 = 1_000_000;

    /// Share `number`, from 1, of `of`; `None` if there is no such share.
    #[must_use]
    pub fn new(number: u64, of: u64) -> Option<Self> {
        let is_share = (1..=of).contains(&number) && of <= Self::MAX;
        is_share.then_some(Self {
            begin: number.saturating_sub(1),
            end: number,
            of,
        })
    }

    /// Returns `true` if it is all of a run.
    #[must_use]
    pub fn is_whole(self) -> bool {
        self == Self::WHOLE
    }

    /// Returns `true` if there is nothing to trace.
    #[must_use]
    pub fn is_nothing(self) -> bool {
        self == Self::NOTHING
    }

    /// Number of the share, from 1.
    #[must_use]
    pub const fn number(self) -> u64 {
        self.end
    }

    /// Number of shares.
    #[must_use]
    pub const fn of(self) -> u64 {
        self.of
    }

    /// The slices of pieces of work that take these times, in any unit.
    #[must_use]
    pub fn slices(self, costs: &[f64]) -> Vec<Slice> {
        // Added in the same order as below, so that the last piece ends where the row does
        let all = costs.iter().fold(0.0, |sum, cost| sum + cost);
        let bound = |shares: u64| shares as f64 / self.of as f64 * all;
        let fair = all / self.of as f64;
        let mut before = 0.0;
        let slice = |cost: &f64| {
            let place = |shares: u64| {
                // Cases of zero cost are not divided.
                let place =
                    ((bound(shares) - before) / cost.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                let is_divided = *cost > MAX_UNDIVIDED * fair;
                match (is_divided, (place - place.round()).abs() < ROUNDING) {
                    (true, false) => place,
                    (true, true) => place.round(),
                    (false, _) => f64::from(place > 0.5),
                }
            };
            let slice = Slice {
                begin: place(self.begin),
                end: place(self.end),
            };
            before += cost;
            slice
        };
        costs.iter().map(slice).collect()
    }
}

impl Slice {
    /// All of it.
    pub const WHOLE: Self = Self {
        begin: 0.0,
        end: 1.0,
    };

    /// Returns `true` if it is neither all nor nothing.
    #[must_use]
    pub fn is_part(self) -> bool {
        !self.is_empty() && self != Self::WHOLE
    }

    /// Length of the slice, from 0 to 1.
    #[must_use]
    pub fn part(self) -> f64 {
        self.end - self.begin
    }

    /// Returns `true` if it has no unit, however many there are.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.begin >= self.end
    }

    /// Numbers of its units among `count` of equal size.
    #[must_use]
    pub fn units(self, count: u64) -> Range<u64> {
        let first_after = |place: f64| (place * count as f64 - 0.5).ceil() as u64;
        first_after(self.begin)..first_after(self.end)
    }
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parsed = text
            .split_once('/')
            .and_then(|(number, of)| Self::new(number.parse().ok()?, of.parse().ok()?));
        let is_plain = |share: &Self| share.to_string() == text;
        parsed.filter(is_plain).ok_or_else(|| {
            format!(
                "K/N with K from 1 to N and N at most {}, as in 2/7",
                Self::MAX
            )
        })
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.end, self.of)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Each surface of each case belongs to one share, and shares take nearly equal times.
    #[test]
    fn shares_cover_a_run_once_and_are_balanced() {
        for seed in 0..200 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let cases = random.random_range(1..20);
            let costs: Vec<f64> = (0..cases)
                .map(|_| 10.0_f64.powf(random.random_range(-2.0..2.0)))
                .collect();
            let surfaces: Vec<u64> = (0..cases).map(|_| random.random_range(1..40)).collect();
            let of = random.random_range(1..70);
            let mut next = vec![0; cases];
            let largest = costs
                .iter()
                .zip(&surfaces)
                .map(|(cost, n)| cost / *n as f64);
            let largest = largest.fold(0.0, f64::max);
            let fair = costs.iter().sum::<f64>() / f64::from(of);
            for number in 1..=of {
                let share: Share = format!("{number}/{of}").parse().unwrap();
                let mut time = 0.0;
                for (case, slice) in share.slices(&costs).iter().enumerate() {
                    let units = slice.units(surfaces[case]);
                    time += costs[case] / surfaces[case] as f64 * (units.end - units.start) as f64;
                    if !units.is_empty() {
                        assert_eq!(units.start, next[case], "seed {seed}, share {share}");
                        next[case] = units.end;
                    }
                }
                let most = 1.001 * largest.max(MAX_UNDIVIDED * fair);
                assert!((time - fair).abs() <= most, "{seed}: {time} of {fair}");
            }
            assert_eq!(next, surfaces, "seed {seed}");
        }
    }

    #[test]
    fn the_whole_has_all_and_nothing_has_none() {
        let costs = [0.1, 0.7, 1e-9, 3e5];
        assert!(
            Share::WHOLE
                .slices(&costs)
                .iter()
                .all(|one| one.units(1_000_003) == (0..1_000_003))
        );
        assert!(
            Share::NOTHING
                .slices(&costs)
                .iter()
                .all(|one| one.is_empty())
        );
    }

    #[test]
    fn shares_are_read_as_they_are_written() {
        for text in ["1/1", "2/7", "1000000/1000000"] {
            assert_eq!(text.parse::<Share>().unwrap().to_string(), text);
        }
        for text in [
            "0/7",
            "8/7",
            "1/0",
            "3",
            "-1/2",
            "1/2/3",
            "1/1000001",
            "a/b",
            "",
            "+1/2",
            "01/2",
        ] {
            assert!(text.parse::<Share>().unwrap_err().contains("2/7"), "{text}");
        }
    }
}
