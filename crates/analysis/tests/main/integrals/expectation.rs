//! Expectations of closed forms, entry by entry of a tally.

use std::f64::consts::PI;

use asperity_analysis::{CLOSED_FORMS, SamplingEffort, bin_fluxes, expect, hemispherical_energy};
use asperity_optics::{Incidence, Material};
use asperity_tally::{Azimuth, Component, HemisphereGrid, Side, Sides, TallyResult, TallySpec};

use crate::common::closed_form;

const EFFORT: SamplingEffort = SamplingEffort {
    rays: 1,
    batches: 2,
    seed: 1,
};

fn spec() -> TallySpec {
    TallySpec::new(HemisphereGrid::new(9, 12).unwrap(), 0.1).unwrap()
}

#[test]
fn every_view_of_a_closed_form_agrees() {
    let light = Incidence::from_degrees(40.0, 20.0).unwrap();
    let azimuth = Azimuth::From(light.phi() + PI);
    for &name in CLOSED_FORMS {
        let model = closed_form(name, 2.0, Material::dielectric(1.5).unwrap());
        let spec = spec();
        let expectation = expect(model.as_ref(), light, &spec, azimuth, EFFORT);
        assert!(expectation.is_exact() && expectation.tallies().len() == 1);
        assert!(
            expectation.describes(Component::Single) && !expectation.describes(Component::Multiple)
        );
        let tally = expectation.statistics().means();
        let grid = spec.grid();
        let bins = bin_fluxes(model.as_ref(), light.wi(), &grid);
        let energy = hemispherical_energy(model.as_ref(), light.wi());
        assert_eq!(tally[spec.grid_entries(Component::Single)], bins);
        assert_eq!(tally[spec.grid_entries(Component::All)], bins);
        for (side, energy) in [
            (Side::Reflected, energy.reflected),
            (Side::Transmitted, energy.transmitted),
        ] {
            // 108 bins, each to some 1e-12
            let total = tally[spec.flux_entry(side, Component::All)];
            assert!(
                (total - energy).abs() < 1e-10,
                "{name} {side}: {total} {energy}"
            );
            assert_eq!(tally[spec.order_entry(side, 1)], total);
            assert_eq!(tally[spec.flux_entry(side, Component::Multiple)], 0.0);
            for class in [Component::Single, Component::All] {
                let rings: f64 = tally[spec.ring_entries(side, class)].iter().sum();
                assert!(
                    (rings - total).abs() < 1e-15,
                    "{name} {side}: {rings} {total}"
                );
            }
            // A slice of 0.1 to either side of the plane of incidence holds some of the light, not all.
            let slice: f64 = tally[spec.in_plane_entries(side, Component::All)]
                .iter()
                .sum();
            let some = slice > 0.02 * energy && slice < energy;
            assert!(some || slice == 0.0 && energy == 0.0, "{name} {side}");
        }
        assert_eq!(tally.budget().absorbed, 0.0);
        assert!(expectation.statistics().budget().reflected.se == Some(0.0));
    }
}

#[test]
fn an_unrecorded_side_stays_empty() {
    let light = Incidence::from_degrees(40.0, 20.0).unwrap();
    let model = closed_form("smith", 2.0, Material::dielectric(1.5).unwrap());
    let spec = spec().with_sides(Sides::Reflected);
    let azimuth = Azimuth::From(light.phi() + PI);
    let expectation = expect(model.as_ref(), light, &spec, azimuth, EFFORT);
    let tally = expectation.statistics().means();
    assert!(tally.budget().reflected > 0.0);
    assert_eq!(tally.budget().transmitted, 0.0);
    let below = spec.grid().bins_per_side();
    assert!(
        tally[spec.grid_entries(Component::All)][below..]
            .iter()
            .all(|&f| f == 0.0)
    );
}
