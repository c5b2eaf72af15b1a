//! Light that each cell of a given surface absorbs: absorbed.exr, absorbed.npy, absorbed_se.npy, and their figure.

use asperity_io::{Picture, write_array, write_picture_exr};
use asperity_plot::{CellMapFigure, Figure, PlotError};
use asperity_results::{CaseResult, Stored};
use asperity_simulate::{AbsorbedMap, Observer, SimulateError};
use serde_json::{Value, json};

use super::outcome::{TraceOutcome, TraceOutcomes};
use super::plan::PlannedTrace;
use crate::output::Place;
use crate::report::error::ReportError;
use crate::report::views::Views;

const EXR: &str = "absorbed.exr";
const MEANS: &str = "absorbed.npy";
const ERRORS: &str = "absorbed_se.npy";

/// Value of a cell, for people.
const ABOUT: &str =
    "flux that the facets of a cell absorb, over the flux that falls on the mean area of a cell";
const ABOUT_ERROR: &str = "its standard error, by the scatter between blocks of rays";

impl PlannedTrace {
    /// The light that each cell absorbs, if it is requested and the run was not cut short.
    pub(super) fn absorbed_map(
        &self,
        whole: &CaseResult,
        observer: &dyn Observer,
    ) -> Result<Option<AbsorbedMap>, SimulateError> {
        if !self.config.output.absorbed_map || whole.is_cut_short() {
            return Ok(None);
        }
        AbsorbedMap::of(&self.case, &self.settings, &whole.outcome, observer)
    }
}

impl TraceOutcome<'_> {
    /// Returns `true` if a stop came before the map of absorbed light that was requested.
    pub(super) const fn lacks_absorbed_map(&self) -> bool {
        self.absorbed.is_none() && self.study.config.output.absorbed_map
    }

    /// Says that the map of absorbed light is missing.
    pub(super) fn absorbed_map_warning(&self) -> Option<String> {
        let text = "the run was ended before the map of absorbed light was traced; the same command with more time traces it";
        self.lacks_absorbed_map().then(|| text.to_owned())
    }
}

/// Adds the files of the map of a case by its number, and its figure, within its folder.
pub(super) fn add_absorbed_map<'a>(
    views: &mut Views<'a, TraceOutcomes<'a>>,
    folder: &str,
    number: usize,
    plots: bool,
) {
    let names = [EXR, MEANS, ERRORS].map(|name| format!("{folder}{name}"));
    let within = folder.to_owned();
    views.other(names.to_vec(), move |found, place, _| {
        if let Some(map) = found.case(number).and_then(|one| one.absorbed.as_ref()) {
            write(map, &place.join(&within))?;
        }
        Ok(0)
    });
    if plots {
        views.figure(format!("{folder}absorbed"), move |found| {
            let drawn = found.case(number).and_then(|one| {
                let map = one.absorbed.as_ref()?;
                Some(figure(map, one))
            });
            Ok(drawn.transpose()?.flatten())
        });
    }
}

/// Describes the values of the files as those of tables are.
pub(super) fn describe_absorbed_map(columns: &mut Value) {
    let value =
        |name: &str, about: &str| json!({ "name": name, "unit": null, "description": about });
    columns[EXR] = json!([value("Y", ABOUT), value("error", ABOUT_ERROR)]);
    columns[MEANS] = json!([value("absorbed", ABOUT)]);
    columns[ERRORS] = json!([value("absorbed_se", ABOUT_ERROR)]);
}

fn write(map: &AbsorbedMap, place: &Place<'_>) -> Result<(), ReportError> {
    let [rows, columns] = map.shape;
    let picture = Picture {
        size: [columns, rows],
        radiance: map.means.clone(),
        error: map.errors.clone(),
        coverage: vec![1.0; map.means.len()],
        colour: None,
    };
    let comment = format!("Y: {ABOUT}; error: {ABOUT_ERROR}, NaN where unknown; A: 1");
    write_picture_exr(place.claim(EXR)?, &picture, &comment)?;
    write_array(place.claim(MEANS)?, &map.shape, &map.means)?;
    write_array(place.claim(ERRORS)?, &map.shape, &map.errors)?;
    Ok(())
}

fn figure(map: &AbsorbedMap, outcome: &TraceOutcome<'_>) -> Result<Option<Figure>, PlotError> {
    let case = &outcome.outcome.case;
    let Some(field) = outcome.study.case.surface.heights() else {
        return Ok(None);
    };
    let [dx, dy] = field.spacing();
    let figure = CellMapFigure {
        title: format!("Light that cells of {} absorb", outcome.study.first),
        subtitle: format!("{}; {ABOUT}", case.figure_label()),
        quantity: "absorbed / incident flux".to_owned(),
        values: &map.means,
        shape: map.shape,
        spacing: [dy, dx],
        unit: field.unit().symbol().to_owned(),
        y_up: outcome.study.y_is_north,
        noun: "cells",
        decades: false,
    };
    figure.draw().map(Some)
}
