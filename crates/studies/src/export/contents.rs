//! Contents of a file, with the light that it has next to that which was measured.

use asperity_simulate::{Case, Light};
use asperity_tally::{Estimate, Side};
use asperity_tracer::HalfSpace;
use serde_json::json;

use crate::output::{Column, Table, incidence_columns};

/// Relative difference of the light of a table that is noted.
const COARSE: f64 = 0.05;

/// Contents of a file.
pub(super) struct Contents {
    pub(super) bytes: Vec<u8>,
    /// Flux in the file and measured flux.
    pub(super) agreement: Vec<Agreement>,
    /// Sentences on what the format cannot hold, or what was done with it.
    pub(super) notes: Vec<String>,
}

/// Light of one direction that left on one side.
#[derive(Clone, Debug)]
pub(super) struct Agreement {
    light: Light,
    side: Side,
    /// Flux that was measured.
    measured: Estimate,
    /// Integral over the values of the file.
    exported: f64,
}

impl Agreement {
    pub(super) fn of(case: &Case, side: Side, measured: Estimate, exported: f64) -> Self {
        Self {
            light: case.light,
            side,
            measured,
            exported,
        }
    }

    pub(super) fn is_from_above(&self) -> bool {
        self.light.from == HalfSpace::Above
    }

    fn difference(&self) -> f64 {
        (self.exported - self.measured.mean).abs()
    }
}

/// The directions in which the file differs most from what was measured, one of each side.
pub(super) fn farthest(all: &[Agreement]) -> impl Iterator<Item = &Agreement> {
    Side::BOTH.into_iter().filter_map(|side| {
        let of_side = all.iter().filter(move |one| one.side == side);
        of_side.max_by(|a, b| a.difference().total_cmp(&b.difference()))
    })
}

/// Note on a table of values at points that does not have the light that was measured, if it is far off.
pub(super) fn coarse_note(all: &[Agreement]) -> Option<String> {
    let is_off = |one: &&Agreement| one.difference() > COARSE * one.measured.mean;
    let off = all.iter().filter(is_off).count();
    (off > 0).then(|| {
        format!(
            "in {off} directions the light of the table is off by more than 5 %: lobes are narrower than its steps, or noisy; measure with more rays, or with wider bins, such as --bins 45x90"
        )
    })
}

/// Columns of the comparison; without the half space of the light if `is_from_above`.
pub(super) fn table<'a>(is_from_above: bool) -> Table<'a, Agreement> {
    let from = |row: &Agreement| {
        json!(row.light.from)
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    let side = |row: &Agreement| row.side.to_string();
    let from = Column::new("from", "half space that the light comes from", from);
    Table::new()
        .columns((!is_from_above).then_some(from))
        .columns(incidence_columns(|row: &Agreement| row.light.incidence))
        .column(Column::new("side", "side on which light leaves", side))
        .column(Column::estimate(
            "measured",
            "flux that was measured",
            |row: &Agreement| Some(row.measured),
        ))
        .column(
            Column::new(
                "in_file",
                "integral over the values of the file",
                |row: &Agreement| row.exported,
            )
            .heading("in the file"),
        )
}
