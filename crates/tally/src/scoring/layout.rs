//! Layout: positions of entries and edges of bins, for an engine that sums light elsewhere, such as on a GPU.

use super::Tallies;
use crate::binning::aperture_windows::ApertureWindow;
use crate::spec::edges::BinStarts;
use crate::spec::offsets::BinOffsets;
use crate::{Component, Score, Side, TallySpec};

/// Positions of the entries that an exit counts for, the edges that choose them, and the unit of sums. An entry is given where the first of its kind
/// stands: that of reflected light, and of its single scattering where there are several components.
///
/// An engine that adds exits by it, and sums by [`Tallies::add_sums`], has the bits of [`Tallies::add_located`].
#[derive(Clone, Debug, PartialEq)]
pub struct TallyLayout {
    /// Rings of a side.
    pub n_theta: usize,
    /// Sectors of a ring.
    pub n_phi: usize,
    /// Limits of the bins of both sides, unless all are of equal angles.
    pub edges: Option<[BinStarts; 2]>,
    /// Azimuth and half width of the in-plane slice, radians; `None` where azimuths are free, and exits have neither sector nor slice.
    pub slice: Option<[f64; 2]>,
    /// Sides that are recorded.
    pub records: [bool; 2],
    /// Apertures, in the order of their entries.
    pub apertures: Vec<ApertureWindow>,
    /// Horizontal unit vectors along and across the plane of incidence.
    pub axes: [[f64; 3]; 2],
    /// Orders of scattering.
    pub orders: usize,
    /// Event paths.
    pub paths: usize,
    /// Rings.
    pub rings: usize,
    /// In-plane bins.
    pub in_plane: usize,
    /// Bins.
    pub bins: usize,
    /// Rays in bins.
    pub hits: usize,
    /// Measures of polarised light, all of one flux entry side by side: of the flux of orders of both sides, then of rings and in-plane bins, then
    /// of bins of all light.
    pub measures: usize,
    /// Apertures.
    pub of_apertures: usize,
    /// Absorbed flux.
    pub absorbed: usize,
    /// Flux on paths that were ended.
    pub truncated: usize,
    /// Flux on paths that failed.
    pub lost: usize,
    /// Flux of sides that are not recorded, a part of what was truncated.
    pub not_recorded: usize,
    /// Flux on paths that left an open patch, a part of what was truncated.
    pub left_patch: usize,
    /// High parts in a flux of one, of `2^62` units each.
    pub scale: f64,
}

impl Tallies<'_> {
    /// The layout of these tallies; `None` with components of a medium, which exits count for in other ways.
    /// Weights under a control variate are those of [`Tallies::control_variate`].
    #[must_use]
    pub fn layout(&self) -> Option<TallyLayout> {
        let (tally, spec) = (&self.0, self.0.spec);
        if !spec.components().is_empty() {
            return None;
        }
        let (grid, offsets, budget) = (spec.grid(), spec.offsets(), TallySpec::BUDGET);
        let first = |score| {
            let of_single = offsets.find(score, Side::Reflected, Component::Single);
            of_single.map(|entries| entries.start)
        };
        let (apertures, axes) = tally.windows.table();
        Some(TallyLayout {
            apertures,
            axes,
            of_apertures: offsets.apertures_start(),
            n_theta: grid.n_theta(),
            n_phi: grid.n_phi(),
            edges: grid.bin_starts(),
            slice: tally.slice.map(|slice| slice.angles()),
            records: Side::BOTH.map(|side| spec.records(side)),
            orders: BinOffsets::orders(Side::Reflected).start,
            paths: BinOffsets::paths(Side::Reflected).start,
            rings: first(Score::RingFlux)?,
            in_plane: first(Score::InPlaneFlux)?,
            bins: first(Score::BinFlux)?,
            hits: first(Score::BinHits)?,
            measures: offsets.measures_start(),
            absorbed: budget.absorbed.0,
            truncated: budget.truncated.0,
            lost: budget.lost.0,
            not_recorded: budget.not_recorded.0,
            left_patch: budget.left_patch.0,
            scale: tally.scale,
        })
    }

    /// The exact sums, in units of `2^-62 / scale` of the incident flux ([`TallyLayout::scale`]): of each entry those of all batches side by side.
    #[must_use]
    pub fn sums(&self) -> &[i128] {
        &self.0.sums
    }

    /// Adds sums of other rays of the same batches, in the order of [`Tallies::sums`].
    ///
    /// # Panics
    /// If there are not as many.
    pub fn add_sums(&mut self, sums: impl ExactSizeIterator<Item = i128>) {
        assert_eq!(sums.len(), self.0.sums.len(), "sums of other tallies");
        self.0
            .sums
            .iter_mut()
            .zip(sums)
            .for_each(|(sum, other)| *sum += other);
    }
}
