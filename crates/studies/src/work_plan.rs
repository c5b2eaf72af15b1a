//! Work plan: surfaces, rays and time of each case of a study, and of each shard, before anything is traced.

use asperity_results::Container;
use asperity_simulate::{Observer, Share, StoppedBy, counted, short};
use serde::Serialize;
use serde_json::{Value, json};

use crate::error::StudyError;
use crate::output::{Cell, Column, Table};
use crate::report::views::Views;
use crate::settings::Document;
use crate::shards::{PLAN_FILE, share_of};
use crate::study::{Findings, PlannedRow, Study};

/// Cases that the text shows; files have all.
const SHOWN: usize = 20;

/// Work that a study plans.
#[derive(Clone, Debug)]
pub struct WorkPlan {
    rows: Vec<PlannedRow>,
    /// Shards among which it is divided.
    shards: u64,
}

impl WorkPlan {
    /// Plans the work that `found` lacks, divided among as many shards as the document names.
    ///
    /// # Errors
    /// [`StudyError`] if a case cannot be planned, or `observer` stops a pilot run.
    pub fn of<S: Study>(
        study: &S,
        document: &Document,
        found: &mut Container<'_, S::Kept>,
        observer: &dyn Observer,
    ) -> Result<Self, StudyError> {
        let rows = study.plan_work(found, observer)?;
        found.close()?;
        let shards = share_of(document).map_or(1, Share::of);
        Ok(Self { rows, shards })
    }

    /// Names of its files.
    pub fn views<'a>() -> Views<'a, Self> {
        let mut views: Views<'a, Self> = Views::new();
        views.csv("plan.csv", |plan: &Self| {
            Some(plan.table().with_rows(plan.rows.clone()))
        });
        views.json(PLAN_FILE, |plan: &Self| Some(plan.times()));
        views
    }

    /// Returns `true` if the column of this number tells cases apart.
    fn differs(&self, column: usize) -> bool {
        let mut values = self.rows.iter().map(|row| &row.columns[column].value);
        let first = values.next();
        values.any(|value| Some(value) != first)
    }

    fn table<'a>(&self) -> Table<'a, PlannedRow> {
        self.table_of(|_| true)
    }

    /// The table with those of the columns of cases that are `shown`, by their number.
    fn table_of<'a>(&self, shown: impl Fn(usize) -> bool) -> Table<'a, PlannedRow> {
        let columns = self.rows.first().map_or(&[][..], |row| &row.columns);
        let columns = columns.iter().enumerate().filter(|(i, _)| shown(*i));
        let columns = columns.map(|(i, column)| {
            let value = move |row: &PlannedRow| match &row.columns[i].value {
                Value::Null => Cell::Empty,
                Value::String(text) => Cell::Text(text.clone().into()),
                value => value.as_f64().map_or(Cell::Empty, Cell::Number),
            };
            Column::new(column.name.clone(), column.about.clone(), value).unit(column.unit.clone())
        });
        Table::new()
            .columns(columns)
            .column(Column::new("surfaces", "surfaces", |row: &PlannedRow| {
                row.work.surfaces
            }))
            .column(Column::new(
                "rays",
                "rays on all surfaces",
                |row: &PlannedRow| row.work.rays,
            ))
            .column(
                Column::new(
                    "seconds",
                    "expected time of one thread",
                    |row: &PlannedRow| row.work.seconds,
                )
                .unit("s"),
            )
    }

    /// Expected time of each case.
    fn seconds(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.work.seconds).collect()
    }

    /// Expected time of each shard.
    fn seconds_of_shards(&self) -> Vec<f64> {
        let costs = self.seconds();
        let of_share = |share: Share| {
            let slices = share.slices(&costs);
            let parts = slices.iter().zip(&self.rows).map(|(slice, row)| {
                // A surface is not divided, but for the rays on a given one.
                let part = match row.work.surfaces {
                    0 | 1 => slice.part(),
                    surfaces => slice.units(surfaces).count() as f64 / surfaces as f64,
                };
                part * row.work.seconds
            });
            parts.sum()
        };
        let shares = (1..=self.shards).filter_map(|number| Share::new(number, self.shards));
        shares.map(of_share).collect()
    }

    /// Times of each case and of each shard, in seconds.
    fn times(&self) -> Value {
        json!({
            "seconds": self.seconds(),
            "shards": self.seconds_of_shards(),
        })
    }
}

impl Findings for WorkPlan {
    fn summary(&self) -> impl Serialize {
        let mut times = self.times();
        times["cases"] = self.table().json(&self.rows);
        times
    }

    fn headline(&self) -> Vec<String> {
        let seconds: f64 = self.seconds().iter().sum();
        let cases = counted(self.rows.len() as u64, "row");
        let mut lines = vec![format!(
            "{cases}, {} s of one thread expected",
            short_seconds(seconds)
        )];
        if self.shards > 1 {
            let of_shards = self.seconds_of_shards();
            let [least, most] = [f64::min, f64::max].map(|of| of_shards.iter().copied().reduce(of));
            let [least, most] = [least, most].map(|s| short_seconds(s.unwrap_or(0.0)));
            lines.push(format!("{} shards of {least} to {most} s", self.shards));
        }
        lines
    }

    fn tables(&self) -> String {
        let shown = &self.rows[..self.rows.len().min(SHOWN)];
        let mut text = self.table_of(|column| self.differs(column)).text(shown);
        if self.rows.len() > SHOWN {
            text += &format!("... and {} more\n", self.rows.len() - SHOWN);
        }
        text
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        None
    }
}

fn short_seconds(seconds: f64) -> String {
    short(format!("{seconds:.2e}").parse().unwrap_or(seconds))
}
