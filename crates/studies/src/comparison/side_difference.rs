//! Energy and peak of one side, against a model.

use std::ops::Range;

use asperity_analysis::Expectation;
use asperity_tally::{
    BatchStatistics, Component, Estimate, Side, TallyResult, TallySpec, TallyValues,
};

use crate::comparison::peak::{PeakDifference, ProfileBins, Span, peak_difference};

/// Flux fraction below which a side has too little light for a peak that matters.
const LEAST_FLUX: f64 = 1e-3;

/// One side of explicit surfaces against a model.
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
    /// Peak of the light in the plane of incidence; `None` where explicit surfaces or the
    /// model send less than 0.1 % of the light to this side.
    pub peak: Option<PeakDifference>,
}

/// Compares the sides that are recorded. `component`: any that in-plane bins keep.
///
/// `tallies`: one per surface. `free_azimuth`: whether light is spread evenly over azimuth.
pub(crate) fn side_differences(
    spec: &TallySpec,
    component: Component,
    tallies: &[TallyValues],
    expectation: &Expectation,
    free_azimuth: bool,
) -> Vec<SideDifference> {
    spec.sides()
        .map(|side| {
            let entry = spec.flux_entry(side, component);
            let expected = expectation.tallies();
            let paired = expected.len() == tallies.len() && !expectation.is_exact();
            let mean_of_model = expectation.statistics().means();
            let residuals: Vec<f64> = tallies
                .iter()
                .enumerate()
                .map(|(r, tally)| {
                    let model = if paired { &expected[r] } else { mean_of_model };
                    tally[entry] - model[entry]
                })
                .collect();
            let mut scatter = BatchStatistics::new(1);
            residuals.iter().for_each(|&r| scatter.push(&[r]));
            let difference = scatter.estimate(0);
            let model = mean_of_model[entry];
            let explicit = model + difference.mean;
            let profiles = |tallies: &[TallyValues]| -> Vec<Vec<f64>> {
                let of = |tally| intensities(tally, side, component, free_azimuth);
                tallies.iter().map(of).collect()
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
                    profiles(std::slice::from_ref(mean_of_model))
                };
                let filter = spec.in_plane_filter(side);
                let edges = bins_shown(filter.len(), free_azimuth).map(|i| filter.theta_deg(i));
                let bins = ProfileBins::new(span, edges);
                peak_difference(&bins, &profiles(tallies), &of_model)
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

/// Numbers of the in-plane bins of a profile, of `all`.
fn bins_shown(all: usize, forward_alone: bool) -> Range<usize> {
    if forward_alone { all / 2..all } else { 0..all }
}

/// In-plane intensities, 1/sr.
fn intensities(
    tally: &TallyValues,
    side: Side,
    component: Component,
    forward_alone: bool,
) -> Vec<f64> {
    let view = tally.in_plane(side, component);
    bins_shown(view.len(), forward_alone)
        .map(|i| view.get(i) / view.filter().solid_angle(i))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_analysis::{SamplingEffort, SlopeCovariance, create_model, expect};
    use asperity_optics::{Incidence, Material};
    use asperity_tally::{Azimuth, HemisphereGrid};

    /// Surfaces that deviate by 0, 1, 2 and 3 hundredths from the batch of a sampled model that each stands
    /// beside. However the batches scatter, the mean is 0.015, and the squares of its distances to the four
    /// sum up to 5e-4, so that the error is `sqrt(5e-4 / (4 * 3))`.
    #[test]
    fn every_surface_is_compared_with_a_batch_of_its_own() {
        let grid = HemisphereGrid::new(4, 6).unwrap();
        let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH).unwrap();
        let slopes = SlopeCovariance::isotropic(0.5).unwrap();
        let model = create_model("heitz", slopes, Material::dielectric(1.5).unwrap()).unwrap();
        let expectation = expect(
            model.as_ref(),
            Incidence::from_degrees(50.0, 0.0).unwrap(),
            &spec,
            Azimuth::From(std::f64::consts::PI),
            SamplingEffort {
                rays: 400,
                batches: 4,
                seed: 7,
            },
        );
        let mut tallies = expectation.tallies().to_vec();
        let scatter = expectation.statistics().budget().reflected;
        println!("batches {scatter:?}");
        assert!(scatter.se.unwrap() > 1e-4);
        for (r, tally) in tallies.iter_mut().enumerate() {
            tally.iter_mut().for_each(|x| *x += 0.01 * r as f64);
        }
        let of = |tallies: &[TallyValues]| {
            side_differences(&spec, Component::All, tallies, &expectation, false)
        };
        for side in of(&tallies) {
            let Estimate { mean, se } = side.difference;
            let expected = (5e-4_f64 / 12.0).sqrt();
            println!("{:?} {mean} {se:?} of {expected}", side.side);
            assert!((mean - 0.015).abs() < 1e-14);
            assert!((se.unwrap() / expected - 1.0).abs() < 1e-12);
            let model = expectation
                .statistics()
                .means()
                .flux(side.side, Component::All);
            assert_eq!(side.model, model);
            assert!((side.explicit - model - 0.015).abs() < 1e-14);
        }
        // Three surfaces have no batches of their own and are compared with the mean of all.
        let mean = expectation.statistics().means().budget().reflected;
        let three = of(&tallies[..3])[0].difference;
        let expected = tallies[..3]
            .iter()
            .map(|r| r.budget().reflected - mean)
            .sum::<f64>()
            / 3.0;
        assert!((three.mean - expected).abs() < 1e-14);
        assert_eq!(of(&tallies[..1])[0].difference.se, None);
    }
}
