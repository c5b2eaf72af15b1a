//! Expected tally of a flat layer, in the bins of a run.

use std::f64::consts::PI;

use asperity_optics::{Bottom, Incidence, azimuth, from_spherical, polar_angle};
use asperity_tally::{
    Azimuth, Component, Event, EventPath, Exit, MAX_LISTED_ORDER, Side, SideFluxes, Tally,
    TallySpec, TallyValues,
};
use glam::DVec3;
use rayon::prelude::*;

use crate::integrals::expectation::Expectation;
use crate::models::model::Scope;

use super::faces::Inside;
use super::flat_layer::{FlatLayer, LayerPaths};
use super::range::Range;

impl FlatLayer {
    /// [`FlatLayer::tally`] as the expectation of a model; exact.
    #[must_use]
    pub fn expect(&self, incidence: Incidence, spec: &TallySpec, azimuth: Azimuth) -> Expectation {
        let tally = self.tally(incidence, spec, azimuth);
        Expectation::of(*spec, Scope::ScatteredInside, vec![tally], 0)
    }

    /// Expected tally of `spec` for light from `incidence`, as fractions of its flux.
    ///
    /// Unscattered light stands in the bin of its direction, on an edge evenly in the bins on either side, since
    /// on a surface that is hardly rough it spreads to both; or evenly in its ring where the azimuth is free.
    /// Light scattered once is integrated over bins, rings and in-plane profile to about 1e-12.
    ///
    /// Totals, rings and profiles of all orders, and the bins' total, hold both. So do order one and what is
    /// above it. Higher orders, by number and by path, hold unscattered light; and that scattered once by the
    /// paths of Hanrahan and Krueger, which has one order. [`Component::MEDIUM`] is filled where `spec`
    /// keeps it. What is scattered more often, and all that is absorbed, stays zero.
    #[must_use]
    pub fn tally(&self, incidence: Incidence, spec: &TallySpec, azimuth: Azimuth) -> TallyValues {
        let mut expected = self.unscattered_tally(incidence, spec, azimuth);
        for side in spec.sides().filter(|&side| self.sides().includes(side)) {
            let all = self.scattered_once(incidence, spec, side);
            // Where light leaves through no interface, only the face of entry counts.
            let first = if side == Side::Transmitted && self.bottom == Bottom::Open {
                let direct = Self {
                    paths: LayerPaths::HanrahanKrueger,
                    ..*self
                };
                direct.scattered_once(incidence, spec, side)
            } else {
                all.zeros_like()
            };
            let later = all.without(&first);
            for (component, fluxes) in [
                (Component::All, &all),
                (Component::Single, &first),
                (Component::Multiple, &later),
                (Component::ScatteredOnce, &all),
            ] {
                expected.add_component(side, component, fluxes);
            }
            expected[spec.event_path_entry(side, passing(1))] += first.total;
            if self.paths == LayerPaths::HanrahanKrueger {
                // No path is longer.
                expected.add_component(side, Component::Order(2), &later);
                expected[spec.event_path_entry(side, passing(2))] += later.total;
            }
        }
        expected
    }

    /// The unscattered light of a tally.
    fn unscattered_tally(
        &self,
        incidence: Incidence,
        spec: &TallySpec,
        azimuth: Azimuth,
    ) -> TallyValues {
        let mut tally = Tally::new(*spec, azimuth);
        let inside = self.enter(incidence.wi());
        for beam in self.unscattered(incidence.wi()) {
            for (path, flux) in self.by_path(&inside, beam.side, beam.flux) {
                let directions = nearby(beam.wo);
                for &wo in &directions {
                    tally.add_exit(&Exit {
                        side: beam.side,
                        wo,
                        flux: flux / directions.len() as f64,
                        path,
                        scatterings: 0,
                    });
                }
            }
        }
        let mut expected = tally.into_fractions(1);
        // Nothing is traced: there are no rays to count.
        expected.clear_hits();
        expected
    }

    /// Unscattered light on `side`, `total` in all, by what happened to it at the faces.
    fn by_path(&self, inside: &Inside, side: Side, total: f64) -> Vec<(EventPath, f64)> {
        let (top, bottom) = (inside.top, self.bottom_face(inside.mu));
        let a = inside.attenuation();
        let mut parts = Vec::new();
        let (mut order, mut flux) = match side {
            Side::Reflected => {
                let at_once = EventPath::default().then(Event::Reflection);
                parts.push((at_once, top.reflected));
                let back = match self.paths {
                    LayerPaths::HanrahanKrueger => 0.0,
                    LayerPaths::All => bottom.reflected,
                };
                (3, top.transmitted * a * back * a * top.transmitted)
            }
            Side::Transmitted => (
                self.straight_order(),
                top.transmitted * a * bottom.transmitted,
            ),
        };
        let round_trip = match self.paths {
            LayerPaths::HanrahanKrueger => 0.0,
            LayerPaths::All => top.reflected * a * bottom.reflected * a,
        };
        while flux > 0.0 && order < MAX_LISTED_ORDER as u32 {
            parts.push((passing(order), flux));
            flux *= round_trip;
            order += 2;
        }
        // Higher orders share an entry.
        let rest = total - parts.iter().map(|part| part.1).sum::<f64>();
        if rest > 1e-15 * total {
            parts.push((passing(order.max(MAX_LISTED_ORDER as u32)), rest));
        }
        parts
    }

    /// Interactions of light that passes straight through. An open bottom does not count as one.
    fn straight_order(&self) -> u32 {
        match self.bottom {
            Bottom::Open => 1,
            _ => 2,
        }
    }
}

/// Four directions slightly off `wo`, by more than rounding; `wo` itself if it is vertical or nearly level.
fn nearby(wo: DVec3) -> Vec<DVec3> {
    const OFFSET: f64 = 1e-7;
    let (theta, phi) = (polar_angle(wo), azimuth(wo));
    if wo.truncate().length() < 2.0 * OFFSET || wo.z.abs() < 2.0 * OFFSET {
        return vec![wo];
    }
    [
        (-OFFSET, -OFFSET),
        (-OFFSET, OFFSET),
        (OFFSET, -OFFSET),
        (OFFSET, OFFSET),
    ]
    .map(|(up, around)| from_spherical(theta + up, phi + around))
    .to_vec()
}

/// The path of the given number of interactions, of which the first and the last pass a face and all others are
/// reflections: `T`, `TT`, `TRT` and so on.
fn passing(order: u32) -> EventPath {
    let last = if order <= EventPath::KEPT {
        1 << (order - 1)
    } else {
        0
    };
    EventPath::from_code(order, 1 | last)
}

impl FlatLayer {
    /// Fluxes of light scattered once that leaves on one side.
    fn scattered_once(&self, incidence: Incidence, spec: &TallySpec, side: Side) -> SideFluxes {
        let range = Range::new(self, incidence, side);
        let filter = spec.bin_filter(side);
        let bins = (0..filter.len())
            .into_par_iter()
            .map(|i| {
                let bin = filter.bin(i);
                range.flux(bin.theta, bin.phi)
            })
            .collect();
        let slice = spec.in_plane_filter(side);
        let half_width = slice.half_width();
        let in_plane = (0..slice.len())
            .into_par_iter()
            .map(|i| {
                let [from, to] = slice.theta_deg(i).map(f64::to_radians);
                // Bins do not straddle the normal.
                let (azimuth, near, far) = if to > 0.0 {
                    (incidence.phi() + PI, from, to)
                } else {
                    (incidence.phi(), -to, -from)
                };
                let theta = match side {
                    Side::Reflected => [near, far],
                    Side::Transmitted => [PI - far, PI - near],
                };
                range.flux(theta, [azimuth - half_width, azimuth + half_width])
            })
            .collect();
        SideFluxes::from_bins(&filter, bins, in_plane)
    }
}
