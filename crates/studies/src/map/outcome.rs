//! Outcome of a map: the results of its cells.

use asperity_simulate::{Case, StoppedBy};

use super::cell::CellResults;
use super::config::MapConfig;
use crate::validity::Validity;
use crate::verify::plan::Plan;

/// One cell of a map.
#[derive(Clone, Copy)]
pub struct MapCell<'a> {
    /// The case.
    pub case: &'a Case,
    /// Results; `None` where the run ended before.
    pub results: Option<&'a CellResults>,
}

/// A map, as far as it has come.
pub struct MapOutcome<'a> {
    /// The configuration.
    pub config: &'a MapConfig,
    /// The cases of the cells, by smoothness, material and angle, in that order of nesting.
    pub plan: &'a Plan,
    /// Results of each cell; `None` where the run ended before.
    pub results: Vec<Option<CellResults>>,
    /// Number of cells that a stop cut short: they are of the surfaces that were finished.
    pub cut_short: usize,
    /// Reason why the run ended before all cells were complete.
    pub stopped_by: Option<StoppedBy>,
}

impl MapOutcome<'_> {
    /// The cells.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = MapCell<'_>> {
        let cells = self.plan.cases.iter().zip(&self.results);
        cells.map(|(case, results)| MapCell {
            case,
            results: results.as_ref(),
        })
    }

    /// The cells that were found, with what was found.
    pub(super) fn found(&self) -> impl Iterator<Item = (&Case, &CellResults)> {
        self.cells()
            .filter_map(|cell| Some((cell.case, cell.results?)))
    }

    /// The cells by name with the validity of geometric optics in them, where the unit of the surfaces is known.
    pub(super) fn validities(&self) -> Vec<(String, Validity)> {
        let cases = self.plan.cases.iter();
        let known = cases.filter_map(|case| Some((case.folder(), self.validity(case)?)));
        known.collect()
    }

    /// Validity of geometric optics in the cell of a case.
    pub(super) fn validity(&self, case: &Case) -> Option<Validity> {
        let wavelength = self.config.light.wavelength_nm();
        Validity::of_random(case, &self.plan.settings.tally, wavelength)
    }

    /// Cells that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.results.iter().filter(|one| one.is_none()).count()
    }
}
