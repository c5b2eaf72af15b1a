//! What closed forms expect, entry by entry of a record.

use std::f64::consts::PI;

use asperity_analysis::{CLOSED_FORMS, SamplingEffort, bin_fluxes, expect, hemispherical_energy};
use asperity_optics::{Incidence, Material};
use asperity_tally::{Azimuth, HemisphereGrid, Layout, OrderClass, Share, Side, Sides};

use crate::common::closed_form;

const EFFORT: SamplingEffort = SamplingEffort {
    rays: 1,
    batches: 2,
    seed: 1,
};

fn layout() -> Layout {
    Layout::new(HemisphereGrid::new(9, 12).unwrap(), 0.1).unwrap()
}

#[test]
fn every_view_of_a_closed_form_agrees() {
    let light = Incidence::from_degrees(40.0, 20.0).unwrap();
    let azimuth = Azimuth::From(light.phi() + PI);
    for &name in CLOSED_FORMS {
        let model = closed_form(name, 2.0, Material::dielectric(1.5).unwrap());
        let layout = layout();
        let expectation = expect(model.as_ref(), light, &layout, azimuth, EFFORT);
        assert!(expectation.is_exact() && expectation.records().len() == 1);
        assert!(expectation.describes(Share::Single) && !expectation.describes(Share::Multiple));
        let record = expectation.statistics().means();
        let grid = layout.grid();
        let bins = bin_fluxes(model.as_ref(), light.wi(), &grid);
        let energy = hemispherical_energy(model.as_ref(), light.wi());
        assert_eq!(record[layout.bins(Share::Single)], bins);
        assert_eq!(record[layout.bins(Share::Total)], bins);
        for (side, energy) in [
            (Side::Reflected, energy.reflected),
            (Side::Transmitted, energy.transmitted),
        ] {
            assert_eq!(record[side.index()], energy, "{name} {side}");
            assert_eq!(record[layout.order(side, 1)], energy);
            assert_eq!(record[layout.multiple(side)], 0.0);
            for class in [OrderClass::First, OrderClass::All] {
                let rings: f64 = record[layout.rings(side, class)].iter().sum();
                // 108 bins, each to some 1e-12.
                assert!(
                    (rings - energy).abs() < 1e-9,
                    "{name} {side}: {rings} {energy}"
                );
            }
            // A wedge of 0.1 to either side of the plane of incidence holds some of the light, not all.
            let wedge: f64 = record[layout.in_plane(side, OrderClass::All)].iter().sum();
            let some = wedge > 0.02 * energy && wedge < energy;
            assert!(some || wedge == 0.0 && energy == 0.0, "{name} {side}");
        }
        assert_eq!(record[Layout::ABSORBED], 0.0);
        assert!(expectation.statistics().estimate(0).se == Some(0.0));
    }
}

#[test]
fn an_unrecorded_side_stays_empty() {
    let light = Incidence::from_degrees(40.0, 20.0).unwrap();
    let model = closed_form("smith", 2.0, Material::dielectric(1.5).unwrap());
    let layout = layout().with_sides(Sides::Reflected);
    let azimuth = Azimuth::From(light.phi() + PI);
    let expectation = expect(model.as_ref(), light, &layout, azimuth, EFFORT);
    let record = expectation.statistics().means();
    assert!(record[Layout::REFLECTED] > 0.0);
    assert_eq!(record[Layout::TRANSMITTED], 0.0);
    let below = layout.grid().bins_per_side();
    assert!(
        record[layout.bins(Share::Total)][below..]
            .iter()
            .all(|&f| f == 0.0)
    );
}
