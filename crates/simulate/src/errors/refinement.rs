//! Refinement: what meshes of several spacings show of one another.

use asperity_numerics::elementary::log2;
use asperity_tally::{Entry, Estimate, TallyResult, TallySpec, TallyStatistics, TallyValues};
use serde::{Deserialize, Serialize};

use super::convergence::Convergence;

/// Standard errors that a difference between meshes must exceed before an order is read off it.
const RESOLVED: f64 = 3.0;

/// Orders that count as second.
const SECOND_ORDER: std::ops::RangeInclusive<f64> = 1.5..=2.5;

/// Statistics of what differs between the finer, the given, and perhaps the coarser mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshShifts {
    /// The given mesh less the finer one.
    given_less_finer: TallyStatistics,
    /// Richardson's values, `finer + (finer - given) / 3`.
    extrapolated: TallyStatistics,
    /// The coarser mesh less the given one.
    coarser_less_given: Option<TallyStatistics>,
}

impl MeshShifts {
    pub(crate) fn new(spec: TallySpec, has_coarser: bool) -> Self {
        Self {
            given_less_finer: TallyStatistics::new(spec),
            extrapolated: TallyStatistics::new(spec),
            coarser_less_given: has_coarser.then(|| TallyStatistics::new(spec)),
        }
    }

    /// Shifts of one block of rays: a tally of each mesh, the finest first.
    pub(crate) fn of_block(tallies: &[TallyValues]) -> Self {
        let (finer, given) = (&tallies[0], &tallies[1]);
        let shift = given.zip_map(finer, |g, f| g - f);
        let coarser = tallies.get(2);
        let coarser = coarser.map(|coarser| coarser.zip_map(given, |c, g| c - g));
        Self {
            extrapolated: TallyStatistics::of_one(finer.zip_map(&shift, |f, s| f - s / 3.0)),
            given_less_finer: TallyStatistics::of_one(shift),
            coarser_less_given: coarser.map(TallyStatistics::of_one),
        }
    }

    /// Adds the blocks of `other`.
    pub(crate) fn append(&mut self, other: &Self) {
        self.given_less_finer.append(&other.given_less_finer);
        self.extrapolated.append(&other.extrapolated);
        if let (Some(own), Some(others)) = (&mut self.coarser_less_given, &other.coarser_less_given)
        {
            own.append(others);
        }
    }

    /// Tally spec.
    pub(crate) const fn spec(&self) -> &TallySpec {
        self.given_less_finer.spec()
    }

    /// Adds one surface: the means of its own batches.
    fn push_means(&mut self, surface: &Self) {
        self.given_less_finer.push(surface.given_less_finer.means());
        self.extrapolated.push(surface.extrapolated.means());
        if let (Some(statistics), Some(of_surface)) =
            (&mut self.coarser_less_given, &surface.coarser_less_given)
        {
            statistics.push(of_surface.means());
        }
    }
}

/// Differences between meshes of several spacings.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Refinement {
    /// Spacing of the given mesh, length units along x and y.
    pub(crate) given: [f64; 2],
    convergence: Convergence,
    /// A batch is a surface, or a ray block where there is one surface.
    shifts: MeshShifts,
}

impl Refinement {
    /// Refinement of a given mesh of that spacing.
    pub(crate) const fn new(given: [f64; 2], convergence: Convergence, shifts: MeshShifts) -> Self {
        Self {
            given,
            convergence,
            shifts,
        }
    }

    /// From what each of several surfaces showed, or from the ray blocks of one.
    pub(crate) fn of_surfaces(
        given: [f64; 2],
        convergence: Convergence,
        surfaces: &[MeshShifts],
    ) -> Option<Self> {
        let (first, others) = surfaces.split_first()?;
        let shifts = if others.is_empty() {
            first.clone()
        } else {
            let spec = *first.extrapolated.spec();
            let mut shifts = MeshShifts::new(spec, first.coarser_less_given.is_some());
            surfaces.iter().for_each(|one| shifts.push_means(one));
            shifts
        };
        Some(Self::new(given, convergence, shifts))
    }

    /// Tally spec.
    pub(crate) const fn spec(&self) -> &TallySpec {
        self.shifts.spec()
    }

    /// Returns `true` if there was a mesh of twice the given spacing.
    #[must_use]
    pub const fn has_coarser(&self) -> bool {
        self.shifts.coarser_less_given.is_some()
    }

    /// The given mesh less the finer one.
    #[must_use]
    pub fn shift(&self, entry: Entry) -> Estimate {
        self.shifts.given_less_finer.at(entry)
    }

    /// Mesh error that is left in the finer mesh: a third of the shift for facets of second order, a fifteenth for smooth
    /// cells, and all of it for facets too large to show an order.
    #[must_use]
    pub fn remaining(&self, entry: Entry) -> Estimate {
        let Estimate { mean, se } = self.shift(entry);
        let part = self.convergence.remaining();
        Estimate {
            mean: part * mean,
            se: se.map(|se| part * se),
        }
    }

    /// Convergence of the error with the spacing.
    pub(crate) const fn convergence(&self) -> Convergence {
        self.convergence
    }

    /// The coarser mesh less the given one.
    #[must_use]
    pub fn coarser_shift(&self, entry: Entry) -> Option<Estimate> {
        let shifts = self.shifts.coarser_less_given.as_ref()?;
        Some(shifts.at(entry))
    }

    /// The order with which an entry converges.
    ///
    /// # Errors
    /// The reason why no order is seen.
    pub fn order(&self, entry: Entry) -> Result<f64, String> {
        let Some(coarser) = self.coarser_shift(entry) else {
            return Err("there is no coarser mesh, of twice the spacing".into());
        };
        let shift = self.shift(entry);
        let seen = |shift: Estimate| {
            shift
                .se
                .is_some_and(|se| shift.mean != 0.0 && shift.mean.abs() > RESOLVED * se)
        };
        if !seen(shift) || !seen(coarser) {
            return Err(format!(
                "the differences between meshes are not both beyond {RESOLVED} of their standard errors"
            ));
        }
        let ratio = coarser.mean / shift.mean;
        if ratio <= 0.0 {
            return Err("the differences between meshes have opposite signs".into());
        }
        Ok(log2(ratio))
    }

    /// Richardson's value for a spacing of zero.
    ///
    /// # Errors
    /// The reason why it is not to be trusted.
    pub fn extrapolated(&self, entry: Entry) -> Result<Estimate, String> {
        if self.convergence != Convergence::Second {
            return Err("the value is that of facets of second order".into());
        }
        let order = self.order(entry)?;
        if SECOND_ORDER.contains(&order) {
            return Ok(self.shifts.extrapolated.at(entry));
        }
        Err(format!(
            "the order seen is {order:.2}, and the value holds for second order, seen from {} to {}",
            SECOND_ORDER.start(),
            SECOND_ORDER.end()
        ))
    }
}
