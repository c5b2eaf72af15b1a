//! Case views: tables and figures of one case, which verifications and traces share.

use asperity_tally::{Polarimetry, TallySpec, TallyStatistics};
use serde_json::Value;

use crate::output::{Place, figure_files};
use crate::report::error::ReportError;
use crate::report::figures::lobes_and_curves;
use crate::report::flux_tables::{comparison, histogram, in_plane, theta};
use crate::report::polarised::{mueller_bins, mueller_in_plane, mueller_rings};
use crate::report::polarised_figures::{draw_polarised, polarised_figures};
use crate::report::shown_case::ShownCase;
use crate::report::views::{Csv, Views};

/// Makes a table of Mueller matrices.
type MuellerTable = fn(&TallyStatistics) -> Csv<'_>;

/// Draws figures of a case.
type Draw = fn(&Place<'_>, &ShownCase<'_>) -> Result<(), ReportError>;

/// Files that a case has.
#[derive(Clone, Copy)]
pub(crate) struct CaseViews<'a> {
    pub(crate) spec: &'a TallySpec,
    /// `true` if it is compared with models.
    pub(crate) compared: bool,
    /// `true` if figures are drawn.
    pub(crate) figures: bool,
}

impl<'a> CaseViews<'a> {
    /// Without figures, and without models.
    pub(crate) const fn of(spec: &'a TallySpec) -> Self {
        Self {
            spec,
            compared: false,
            figures: false,
        }
    }

    /// The files of the case that `shown` picks from what was found, within the folder `within`, which ends with a slash or is empty.
    pub(crate) fn add<'v, J, F>(self, views: &mut Views<'v, J>, within: &str, shown: F)
    where
        J: Sync + 'v,
        F: for<'j> Fn(&'j J) -> Option<ShownCase<'j>> + Copy + Send + Sync + 'v,
    {
        let named = |name: &str| format!("{within}{name}");
        views.csv(named("histogram.csv"), move |found| {
            Some(histogram(shown(found)?.outcome))
        });
        views.csv(named("theta.csv"), move |found| {
            Some(theta(shown(found)?.outcome))
        });
        views.csv(named("in_plane.csv"), move |found| {
            let case = shown(found)?;
            Some(in_plane(case.outcome, case.models()))
        });
        self.add_polarised(views, within, shown);
        if self.compared {
            views.csv(named("comparison.csv"), move |found| {
                shown(found)?.judgement.map(comparison)
            });
        }
        if self.figures {
            let curves = self.spec.sides().map(|side| format!("in_plane_{side}"));
            let curves = std::iter::once("lobes".to_owned()).chain(curves);
            add_figures(views, within, curves.collect(), lobes_and_curves, shown);
        }
    }

    /// The tables and figures of the Mueller matrices of such a case, if they are kept.
    pub(crate) fn add_polarised<'v, J, F>(self, views: &mut Views<'v, J>, within: &str, shown: F)
    where
        J: Sync + 'v,
        F: for<'j> Fn(&'j J) -> Option<ShownCase<'j>> + Copy + Send + Sync + 'v,
    {
        if self.spec.polarimetry() != Polarimetry::Mueller {
            return;
        }
        let tables: [(&str, MuellerTable); 3] = [
            ("mueller.csv", mueller_bins),
            ("mueller_theta.csv", mueller_rings),
            ("mueller_in_plane.csv", mueller_in_plane),
        ];
        for (name, table) in tables {
            views.csv(format!("{within}{name}"), move |found| {
                Some(table(&shown(found)?.outcome.statistics))
            });
        }
        if self.figures {
            let names = polarised_figures(self.spec);
            add_figures(views, within, names, draw_polarised, shown);
        }
    }

    /// Name, unit and description of each column of the tables of a case, by file.
    pub(crate) fn columns(self, case: ShownCase<'_>) -> Value {
        let mut views = Views::new();
        self.add(&mut views, "", |case: &ShownCase<'_>| Some(*case));
        views.columns(&case)
    }
}

/// Adds figures of a case by their names; they are drawn together.
fn add_figures<'v, J, F>(
    views: &mut Views<'v, J>,
    within: &str,
    names: Vec<String>,
    draw: Draw,
    shown: F,
) where
    J: Sync + 'v,
    F: for<'j> Fn(&'j J) -> Option<ShownCase<'j>> + Copy + Send + Sync + 'v,
{
    let count = names.len();
    let names = names.iter();
    let names = names.flat_map(|name| figure_files(&format!("{within}{name}")));
    let within = within.to_owned();
    views.other(names.collect(), move |found, place, observer| {
        let Some(case) = shown(found) else {
            return Ok(0);
        };
        if observer.gives_up_first() {
            return Ok(count);
        }
        draw(&place.join(&within), &case)?;
        Ok(0)
    });
}
