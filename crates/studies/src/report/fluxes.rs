//! The fluxes of one case with their errors, as columns of tables.

use std::borrow::Cow;

use asperity_simulate::{Errors, Outcome};
use asperity_tally::{Component, Entry, Measure, Polarimetry, TallyResult, is_of_few_rays};

use crate::output::Column;

/// Description of a flux, tracked less averaged.
pub(crate) const AVERAGING: &str =
    "flux less what it would be if s and p were averaged at every interface";

/// The fluxes of one case with their errors.
#[derive(Clone, Copy)]
pub(crate) struct Fluxes<'a>(pub(crate) &'a Outcome);

impl<'a> Fluxes<'a> {
    /// A column of an entry of the spec, by row.
    pub(crate) fn column<R: 'a>(
        self,
        name: impl Into<Cow<'a, str>>,
        about: &'static str,
        entry: impl Fn(&R) -> Entry + 'a,
    ) -> Column<'a, R> {
        let estimate = move |row: &R| Some(self.0.statistics.at(entry(row)));
        Column::estimate(name, about, estimate)
    }

    /// Columns of each of `components`.
    pub(crate) fn components<R: 'a>(
        self,
        components: &'static [Component],
        entry: impl Fn(Component, &R) -> Entry + Copy + 'a,
    ) -> impl Iterator<Item = Column<'a, R>> {
        components.iter().map(move |&component| {
            let name = format!("flux_{component}");
            self.column(name, component.description(), move |row| {
                entry(component, row)
            })
        })
    }

    /// A column that names the components, orders included, whose errors are lower bounds.
    pub(crate) fn few_samples<R: 'a>(
        self,
        entry: impl Fn(Component, &R) -> Entry + 'a,
    ) -> Column<'a, R> {
        let spec = self.0.statistics.spec();
        let names = move |row: &R| {
            let all = Component::ORDERS.iter().chain(spec.components());
            let few = std::iter::once(&Component::All)
                .chain(all)
                .filter(|&&component| is_of_few_rays(self.0.statistics.at(entry(component, row))));
            few.map(|component| component.name())
                .collect::<Vec<_>>()
                .join(" ")
        };
        Column::new(
            "few_samples",
            "components with the relative error of fewer than 20 surfaces or rays, or a larger one, which is a lower bound",
            names,
        )
    }

    /// A column of what tracking polarisation changes, if that is kept.
    pub(crate) fn averaging<R: 'a>(
        self,
        entry: impl Fn(&R) -> Entry + 'a,
    ) -> impl Iterator<Item = Column<'a, R>> {
        let spec = self.0.statistics.spec();
        let is_kept = spec.polarimetry() == Polarimetry::Averaging;
        let difference = move |row: &R| {
            let measured = spec.measure_entry(entry(row), Measure::Averaging)?;
            Some(self.0.statistics.at(measured))
        };
        let column = Column::estimate("flux_tracked_less_averaged", AVERAGING, difference);
        is_kept.then_some(column).into_iter()
    }

    /// Columns that tell where the error of `flux` comes from.
    pub(crate) fn errors<R: 'a>(
        self,
        entry: impl Fn(&R) -> Entry + Copy + 'a,
    ) -> [Column<'a, R>; 3] {
        let column = |name, about, of: fn(Errors) -> Option<f64>| {
            let value = move |row: &R| of(self.0.errors.at(entry(row)));
            Column::new(name, about, value)
        };
        [
            column("flux_se_rays", "its error by the number of rays", |e| {
                e.rays
            }),
            column(
                "flux_se_surfaces",
                "its error by the number of surfaces",
                |e| e.surfaces,
            ),
            column(
                "flux_mesh",
                "what the spacing of the mesh adds to it",
                |e| e.mesh,
            ),
        ]
    }
}
