//! Rows of the report: the work done and the errors found, one per scene.

use rayon::prelude::*;

use crate::scenes::{self, Scene};
use crate::stressed::Stressed;

/// Numbers of one scene; everything but the first three must be zero or within its bound.
#[derive(Clone, Default)]
pub(super) struct Row {
    pub(super) name: String,
    /// Rays asked, times accelerators; segments of paths.
    pub(super) segments: u64,
    /// Rays compared with the textbook, and those of them that differ in the band.
    pub(super) compared: u64,
    pub(super) band: u64,
    /// Rays that differ from the textbook outside the band.
    pub(super) textbook: u64,
    /// Answers that differ from those of brute force: another facet, or another bit of `t`.
    pub(super) unlike_brute_force: u64,
    /// Batches whose results differ from those of brute force by a bit.
    pub(super) unlike_batches: u64,
    pub(super) lost: u64,
    pub(super) wrong_sides: u64,
    /// Largest `|sum - 1|`, and the largest in units of its bound.
    pub(super) residual: f64,
    pub(super) residual_in_bounds: f64,
    pub(super) first_fault: Option<String>,
}

impl Row {
    pub(super) fn add(&mut self, other: &Self) {
        self.segments += other.segments;
        self.compared += other.compared;
        self.band += other.band;
        self.textbook += other.textbook;
        self.unlike_brute_force += other.unlike_brute_force;
        self.unlike_batches += other.unlike_batches;
        self.lost += other.lost;
        self.wrong_sides += other.wrong_sides;
        self.residual = self.residual.max(other.residual);
        self.residual_in_bounds = self.residual_in_bounds.max(other.residual_in_bounds);
        if self.first_fault.is_none() {
            self.first_fault.clone_from(&other.first_fault);
        }
    }

    pub(super) fn fault(&mut self, what: impl FnOnce() -> String) {
        self.first_fault.get_or_insert_with(what);
    }

    /// `residual` of a budget into which `segments` segments of light went.
    ///
    /// A segment's flux is that of the segment before times a fraction; the fractions of an interaction add to one
    /// exactly but for half an eps each, and each product and each addition to a sum of at most the
    /// whole rounds by half an eps. So each segment adds at most 2 eps of the whole.
    pub(super) fn book(&mut self, residual: f64, segments: u64) {
        let bound = 2.0 * f64::EPSILON * (segments + 1) as f64;
        self.residual = self.residual.max(residual);
        self.residual_in_bounds = self.residual_in_bounds.max(residual / bound);
    }

    pub(super) fn is_clean(&self) -> bool {
        self.textbook == 0
            && self.unlike_brute_force == 0
            && self.unlike_batches == 0
            && self.lost == 0
            && self.wrong_sides == 0
            && self.residual_in_bounds <= 1.0
            && self.first_fault.is_none()
    }

    pub(super) const HEADINGS: &str = "scene                          segments  compared    band  textbook  \
                            facets  batches  lost  sides  residual (of its bound)";

    pub(super) fn print(&self) {
        println!(
            "{:<28} {:>10} {:>9} {:>7} {:>9} {:>7} {:>8} {:>5} {:>6}  {:.1e} ({:.3})",
            self.name,
            self.segments,
            self.compared,
            self.band,
            self.textbook,
            self.unlike_brute_force,
            self.unlike_batches,
            self.lost,
            self.wrong_sides,
            self.residual,
            self.residual_in_bounds,
        );
        if let Some(fault) = &self.first_fault {
            println!("    {fault}");
        }
    }
}

/// Prints the rows of surfaces of `cells` and their sum, which it returns.
pub(super) fn report(cells: &str, rows: &[Row]) -> Row {
    println!("\n{cells}\n{}", Row::HEADINGS);
    let mut all = Row {
        name: "all".into(),
        ..Row::default()
    };
    for row in rows {
        row.print();
        all.add(row);
    }
    all.print();
    all
}

/// Fails with what went wrong first, if anything did.
pub(super) fn assert_clean(all: &Row) {
    assert!(all.is_clean(), "{:?}", all.first_fault);
}

/// Does `work` for every scene, as facets or as smooth cells.
pub(super) fn over_scenes<G: Stressed>(work: impl Fn(usize, &Scene<G>) -> Row + Sync) -> Vec<Row> {
    scenes::all::<G>()
        .par_iter()
        .enumerate()
        .map(|(i, scene)| Row {
            name: scene.name.clone(),
            ..work(i, scene)
        })
        .collect()
}

/// Runs scenes, reports them, and asserts that they are clean.
pub(super) fn assert_scenes_are_clean<G: Stressed>(
    work: impl Fn(usize, &Scene<G>) -> Row + Sync,
) -> Row {
    let all = report(G::CELLS, &over_scenes(work));
    assert_clean(&all);
    all
}
