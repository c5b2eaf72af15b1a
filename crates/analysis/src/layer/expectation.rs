//! Expected tally of flat layers, in the bins of a run.

use asperity_optics::{Incidence, azimuth, from_spherical, polar_angle};
use asperity_tally::{
    Azimuth, Component, Event, EventPath, Exit, MAX_LISTED_ORDER, Side, SideFluxes, Tally,
    TallySpec, TallyValues,
};
use glam::DVec3;

use crate::integrals::expectation::Expectation;
use crate::models::model::Scope;

use super::directions::Directions;
use super::flat_layers::{FlatLayers, LayerPaths};
use super::passage::Passage;

impl FlatLayers {
    /// [`FlatLayers::tally`] as the expectation of a model; exact.
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
    /// paths of Hanrahan and Krueger, of which each layer has one on either side. [`Component::MEDIUM`] is filled
    /// where `spec` keeps it. What is scattered more often, and all that is absorbed, stays zero.
    #[must_use]
    pub fn tally(&self, incidence: Incidence, spec: &TallySpec, azimuth: Azimuth) -> TallyValues {
        let mut expected = self.unscattered_tally(incidence, spec, azimuth);
        for side in spec.sides().filter(|&side| self.sides().includes(side)) {
            for Once { order, fluxes } in self.scattered_once(incidence, spec, side) {
                let multiple = match order {
                    Some(1) => Component::Single,
                    _ => Component::Multiple,
                };
                for component in [Component::All, multiple, Component::ScatteredOnce] {
                    expected.add_component(side, component, &fluxes);
                }
                let Some(order) = order else { continue };
                let path = (0..order).fold(EventPath::default(), |path, _| {
                    path.then(Event::Transmission)
                });
                expected[spec.event_path_entry(side, path)] += fluxes.total;
                match order {
                    1 => {}
                    2 | 3 => expected.add_component(side, Component::Order(order as u8), &fluxes),
                    _ => {
                        let [.., and_above] = Component::ORDERS;
                        expected.add_component(side, and_above, &fluxes);
                        expected[spec.order_entry(side, order as usize)] += fluxes.total;
                    }
                }
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
        let incident = Passage::of_incident(self, incidence.wi());
        let parts = self.event_paths(&incident);
        for beam in self.unscattered(incidence.wi()) {
            let parts = parts.iter().filter(|part| part.side == beam.side);
            let listed: f64 = parts.clone().map(|part| part.flux).sum();
            // Higher orders share an entry.
            let rest = EventPath::from_code(MAX_LISTED_ORDER as u32, 1);
            let rest = Some((rest, beam.flux - listed)).filter(|rest| rest.1 > 1e-15 * beam.flux);
            for (path, flux) in parts.map(|part| (part.path, part.flux)).chain(rest) {
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

/// Light scattered once that leaves on one side.
struct Once {
    /// Interactions with faces, if all of it had as many.
    order: Option<u32>,
    fluxes: SideFluxes,
}

impl FlatLayers {
    /// Light scattered once that leaves on one side, by its interactions as far as they are known.
    fn scattered_once(&self, incidence: Incidence, spec: &TallySpec, side: Side) -> Vec<Once> {
        let n = self.media.len();
        let through = n + usize::from(!self.is_open);
        let once = |order, numbers| Once {
            order,
            fluxes: Directions::new(self, numbers, incidence, side).fluxes(spec),
        };
        match (self.paths, side) {
            (LayerPaths::HanrahanKrueger, Side::Reflected) => (0..n)
                .filter(|&number| self.media[number].albedo > 0.0)
                .map(|number| once(Some(2 * (number as u32 + 1)), number..number + 1))
                .collect(),
            (LayerPaths::HanrahanKrueger, Side::Transmitted) => {
                vec![once(Some(through as u32), self.all())]
            }
            // Through the top alone
            (LayerPaths::All, Side::Transmitted) if through == 1 => {
                let direct = Self {
                    paths: LayerPaths::HanrahanKrueger,
                    ..self.clone()
                };
                let mut parts = direct.scattered_once(incidence, spec, side);
                let later = parts.iter().fold(once(None, self.all()), |all, part| Once {
                    fluxes: all.fluxes.without(&part.fluxes),
                    ..all
                });
                parts.push(later);
                parts
            }
            (LayerPaths::All, _) => vec![once(None, self.all())],
        }
    }
}
