//! The array of all tables: albedo.npy.

use asperity_tally::Side;

use super::outcome::{AlbedoOutcome, AlbedoPoint};

/// Quantities of a point, in the order of the last axis of albedo.npy.
pub(super) const CHANNELS: [&str; 8] = [
    "E_R", "E_R_se", "E_T", "E_T_se", "single_R", "single_T", "ratio_R", "ratio_T",
];

/// The quantities of a point; NaN where they are unknown.
pub(super) fn channels(point: &AlbedoPoint<'_>) -> [f64; 8] {
    let of = |side| {
        let flux = point.flux(side);
        let se = flux.and_then(|flux| flux.se);
        [flux.map(|flux| flux.mean), se, point.ratio(side)].map(|value| value.unwrap_or(f64::NAN))
    };
    let [[r, r_se, r_ratio], [t, t_se, t_ratio]] = Side::BOTH.map(of);
    let [single_r, single_t] = Side::BOTH.map(|side| point.single(side));
    [r, r_se, t, t_se, single_r, single_t, r_ratio, t_ratio]
}

/// Shape `[material, alpha, cos, channel]` and values of the array.
pub(super) fn array(outcome: &AlbedoOutcome<'_>) -> ([usize; 4], Vec<f64>) {
    let axes = outcome.axes;
    let shape = [
        outcome.materials(),
        axes.alphas.len(),
        axes.cosines.len(),
        CHANNELS.len(),
    ];
    let values = outcome.points().flat_map(|point| channels(&point));
    (shape, values.collect())
}
