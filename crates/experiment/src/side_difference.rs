//! What leaves on one side in all, and where it is brightest, beside a model.

use asperity_analysis::Expectation;
use asperity_tally::{Estimate, Layout, OrderClass, Share, Side};

use crate::peak::{PeakDifference, Span, peak_difference};

/// Flux fraction below which a side has too little light for a peak that matters.
const LEAST_FLUX: f64 = 1e-3;

/// One side of explicit surfaces beside a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideDifference {
    /// The side.
    pub side: Side,
    /// Flux fraction on explicit surfaces.
    pub explicit: f64,
    /// Flux fraction by the model.
    pub model: f64,
    /// The first less the second; its error is that of the difference, surface by surface.
    pub difference: Estimate,
    /// Where the light is brightest in the plane of incidence; `None` where explicit surfaces or the
    /// model send less than 0.1 % of the light to this side.
    pub peak: Option<PeakDifference>,
}

/// Compares the sides that are asked for. `share`: light scattered once, or all.
///
/// `records`: one a surface, by `layout`. `free_azimuth`: whether light is spread evenly over azimuth.
pub(crate) fn side_differences(
    layout: &Layout,
    share: Share,
    records: &[Vec<f64>],
    expectation: &Expectation,
    free_azimuth: bool,
) -> Vec<SideDifference> {
    layout
        .sides()
        .map(|side| {
            let (entry, class) = match share {
                Share::Single => (layout.order(side, 1), OrderClass::First),
                _ => (side.index(), OrderClass::All),
            };
            let expected = expectation.records();
            let paired = expected.len() == records.len() && !expectation.is_exact();
            let mean_of_model = expectation.statistics().means();
            let residuals: Vec<f64> = records
                .iter()
                .enumerate()
                .map(|(r, record)| {
                    let model = if paired { &expected[r] } else { mean_of_model };
                    record[entry] - model[entry]
                })
                .collect();
            let difference = mean_and_error(&residuals);
            let model = mean_of_model[entry];
            let explicit = model + difference.mean;
            let profiles = |records: &[Vec<f64>]| -> Vec<Vec<f64>> {
                let profile =
                    |record: &Vec<f64>| intensities(layout, side, class, record, free_azimuth);
                records.iter().map(profile).collect()
            };
            let span = if free_azimuth {
                Span::Forward
            } else {
                Span::Both
            };
            let bright = explicit.min(model) >= LEAST_FLUX;
            let peak = bright.then(|| {
                let of_model = if paired {
                    profiles(expected)
                } else {
                    profiles(&[mean_of_model.to_vec()])
                };
                peak_difference(span, &profiles(records), &of_model)
            });
            SideDifference {
                side,
                explicit,
                model,
                difference,
                peak: peak.flatten(),
            }
        })
        .collect()
}

/// In-plane intensities, 1/sr.
fn intensities(
    layout: &Layout,
    side: Side,
    class: OrderClass,
    record: &[f64],
    forward_alone: bool,
) -> Vec<f64> {
    let first = if forward_alone {
        layout.in_plane_len() / 2
    } else {
        0
    };
    let start = layout.in_plane(side, class).start;
    (first..layout.in_plane_len())
        .map(|i| record[start + i] / layout.in_plane_solid_angle(i))
        .collect()
}

fn mean_and_error(values: &[f64]) -> Estimate {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let se = (values.len() > 1).then(|| {
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        (squares / (count * (count - 1.0))).sqrt()
    });
    Estimate { mean, se }
}
