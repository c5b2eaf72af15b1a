//! Control variate: unshadowed single scattering, whose mean is known before any light is traced.

use crate::spec::filters::Half;
use crate::{Side, SideFluxes, TallyResult, TallySpec, TallyValues};

/// Mean fluxes of *unshadowed single scattering*: every facet that faces the light is lit and sends its
/// light away undisturbed, those included that reflect downwards or refract upwards, which are left out.
///
/// Flux fractions, not yet weighted by any fraction; they may add to more than one.
#[derive(Clone, Debug, PartialEq)]
pub struct UnshadowedFluxes {
    /// Flux into the bins of the grid, in its order.
    pub bins: Vec<f64>,
    /// Flux into the rings of each side, from +z.
    pub rings: [Vec<f64>; 2],
    /// Flux into the in-plane bins of each side.
    pub in_plane: [Vec<f64>; 2],
    /// Flux absorbed at the first interaction.
    pub absorbed: f64,
}

impl UnshadowedFluxes {
    /// No light.
    #[must_use]
    pub fn zeros(spec: &TallySpec) -> Self {
        let grid = spec.grid();
        Self {
            bins: vec![0.0; 2 * grid.bins_per_side()],
            rings: Side::BOTH.map(|_| vec![0.0; grid.n_theta()]),
            in_plane: Side::BOTH.map(|side| vec![0.0; spec.in_plane_filter(side).len()]),
            absorbed: 0.0,
        }
    }

    /// Adds `weight` times other fluxes.
    ///
    /// # Panics
    /// If they are of other bins.
    pub fn add(&mut self, weight: f64, other: &Self) {
        let add = |sums: &mut Vec<f64>, terms: &[f64]| {
            assert_eq!(sums.len(), terms.len(), "fluxes of another spec");
            let pairs = sums.iter_mut().zip(terms);
            pairs.for_each(|(sum, term)| *sum += weight * term);
        };
        add(&mut self.bins, &other.bins);
        for side in 0..2 {
            add(&mut self.rings[side], &other.rings[side]);
            add(&mut self.in_plane[side], &other.in_plane[side]);
        }
        self.absorbed += weight * other.absorbed;
    }
}

/// The fractions of unshadowed single scattering that are expected to be visible: the factors with
/// which it is subtracted from what is traced, and with which its mean is added again.
///
/// Any fractions leave the mean of an estimate as it is; the true ones make its variance least.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleFractions {
    /// Fractions that are neither shadowed nor masked, by side and ring of polar angle.
    pub rings: [Vec<f64>; 2],
    /// Fraction that is not shadowed.
    pub absorbed: f64,
}

/// Unshadowed single scattering as a control variate: subtracted ray by ray, added as a mean.
///
/// Each entry of a tally that light of order one can reach has an expectation here, zero elsewhere. An
/// entry lies in one ring, or is a sum of rings, so that one fraction per ring serves all of them and
/// sums stay sums.
#[derive(Clone, Debug)]
pub struct ControlVariate {
    fractions: VisibleFractions,
    expected: TallyValues,
    shadow_probability: f64,
}

impl ControlVariate {
    /// The control variate of tallies of `spec`: `fluxes`, each weighted with its visible fraction.
    ///
    /// Flux to a side that is not recorded is booked as such, like light that is traced.
    ///
    /// # Panics
    /// If fractions or fluxes are of other bins than the spec.
    #[must_use]
    pub fn new(spec: TallySpec, fractions: VisibleFractions, fluxes: &UnshadowedFluxes) -> Self {
        let grid = spec.grid();
        let n_theta = grid.n_theta();
        let mut expected = TallyValues::zeros(spec);
        expected[TallySpec::BUDGET.absorbed] = fractions.absorbed * fluxes.absorbed;
        for side in Side::BOTH {
            let fractions = &fractions.rings[side.index()];
            let rings = &fluxes.rings[side.index()];
            let in_plane = &fluxes.in_plane[side.index()];
            let filter = spec.in_plane_filter(side);
            assert_eq!(
                [fractions.len(), rings.len(), in_plane.len()],
                [n_theta, n_theta, filter.len()],
                "rings of another spec"
            );
            let of_side: f64 = fractions.iter().zip(rings).map(|(s, flux)| s * flux).sum();
            if !spec.records(side) {
                expected[TallySpec::BUDGET.not_recorded] += of_side;
                expected[TallySpec::BUDGET.truncated] += of_side;
                continue;
            }
            let bins = &fluxes.bins[side.index() * grid.bins_per_side()..][..grid.bins_per_side()];
            let of_bin = |(i, flux): (usize, &f64)| fractions[i / grid.n_phi()] * flux;
            let mut weighted = SideFluxes {
                total: of_side,
                bins: bins.iter().enumerate().map(of_bin).collect(),
                rings: fractions
                    .iter()
                    .zip(rings)
                    .map(|(s, flux)| s * flux)
                    .collect(),
                in_plane: in_plane.clone(),
            };
            for (ring, fraction) in fractions.iter().enumerate() {
                for half in Half::BOTH {
                    weighted.in_plane[filter.number(ring, half)] *= fraction;
                }
            }
            expected.set_single_scattering(side, &weighted);
        }
        Self {
            fractions,
            expected,
            shadow_probability: 1.0,
        }
    }

    /// Multiplies all fractions, and so all that is added, with `factor`.
    #[must_use]
    pub fn weakened(mut self, factor: f64) -> Self {
        let rings = self.fractions.rings.iter_mut().flatten();
        rings
            .chain([&mut self.fractions.absorbed])
            .chain(self.expected.iter_mut())
            .for_each(|value| *value *= factor);
        self
    }

    /// Returns a control variate under which facets in the shadow of the first one are traced with `probability` only, and weighted
    /// by its inverse.
    ///
    /// # Panics
    /// Unless `0 < probability <= 1`.
    #[must_use]
    pub fn with_shadow_probability(self, probability: f64) -> Self {
        assert!(
            probability > 0.0 && probability <= 1.0,
            "{probability} is not a probability above 0"
        );
        Self {
            shadow_probability: probability,
            ..self
        }
    }

    /// The probability with which facets in the shadow of the first one are traced.
    #[must_use]
    pub const fn shadow_probability(&self) -> f64 {
        self.shadow_probability
    }

    /// The fraction of light that leaves on `side` within `ring` of polar angle, counted from +z.
    #[must_use]
    pub fn fraction(&self, side: Side, ring: usize) -> f64 {
        self.fractions.rings[side.index()][ring]
    }

    /// The fraction of light that is absorbed.
    #[must_use]
    pub const fn absorbed_fraction(&self) -> f64 {
        self.fractions.absorbed
    }

    /// The fractions of unshadowed single scattering that are subtracted.
    #[must_use]
    pub const fn fractions(&self) -> &VisibleFractions {
        &self.fractions
    }

    /// Mean change of completed tallies if the traced fluxes are `fluxes` in place of those expected, with the opposite sign: the change of the
    /// control variate, less the part that [`ControlVariate::complete`] spreads so that the budget closes. The parts of the budget add to zero.
    ///
    /// # Panics
    /// If `fluxes` are of other bins than the spec.
    #[must_use]
    pub fn removed(&self, fluxes: &UnshadowedFluxes) -> TallyValues {
        let spec = *self.expected.spec();
        let mut removed = Self::new(spec, self.fractions.clone(), fluxes).expected;
        let known = self.expected.budget().total();
        let scale = if known == 0.0 {
            0.0
        } else {
            removed.budget().total() / known
        };
        removed.update(&self.expected, |value, expected| *value -= scale * expected);
        removed
    }

    /// Expected values, which are added to a tally.
    #[must_use]
    pub const fn expected(&self) -> &TallyValues {
        &self.expected
    }

    /// Adds its mean to a tally from which the control variate has been subtracted ray by ray.
    ///
    /// The five parts of the budget add to one on average, not in every tally. What is missing, or too
    /// much, is zero on average, and is spread over all entries as the control variate itself is, so
    /// that the budget closes and parts still add to their sums.
    ///
    /// # Panics
    /// If the tally is of another spec.
    pub fn complete(&self, tally: &mut TallyValues) {
        let known = self.expected.budget().total();
        if known == 0.0 {
            return;
        }
        let missing = 1.0 - (tally.budget().total() + known);
        let scale = 1.0 + missing / known;
        tally.update(&self.expected, |value, expected| *value += scale * expected);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Component, HemisphereGrid, Sides};

    fn spec() -> TallySpec {
        TallySpec::new(HemisphereGrid::new(2, 3).unwrap(), 0.2).unwrap()
    }

    /// A tenth of the light is reflected, half is transmitted, a fifth absorbed, before fractions.
    fn control_variate(spec: TallySpec) -> ControlVariate {
        let fluxes = UnshadowedFluxes {
            bins: [vec![0.1 / 6.0; 6], vec![0.5 / 6.0; 6]].concat(),
            rings: [vec![0.05; 2], vec![0.25; 2]],
            in_plane: [vec![0.001; 4], vec![0.005; 4]],
            absorbed: 0.2,
        };
        let fractions = VisibleFractions {
            rings: [vec![0.5, 0.0], vec![1.0, 0.8]],
            absorbed: 0.9,
        };
        ControlVariate::new(spec, fractions, &fluxes)
    }

    #[test]
    fn expectations_are_weighted_and_add_up() {
        let control_variate = control_variate(spec());
        let expected = control_variate.expected();
        let near = |found: f64, value: f64| (found - value).abs() < 1e-15;
        let budget = expected.budget();
        assert!(near(budget.reflected, 0.025));
        assert!(near(budget.transmitted, 0.45));
        assert!(near(budget.absorbed, 0.18));
        for side in Side::BOTH {
            let of_side = expected.flux(side, Component::All);
            for component in [Component::Single, Component::All] {
                let rings = expected.rings(side, component).iter().sum::<f64>();
                assert!(near(rings, of_side));
            }
            assert!(near(expected.order(side, 1), of_side));
            assert!(near(expected.order(side, 2), 0.0));
            assert!(near(expected.flux(side, Component::Multiple), 0.0));
            let mut multiple = expected.bins(side, Component::Multiple).iter();
            assert!(multiple.all(|flux| flux == 0.0));
        }
        // In-plane bins count from the side's own normal, rings from +z.
        let in_plane = expected.in_plane(Side::Transmitted, Component::All).iter();
        assert!(in_plane.eq([0.005, 0.004, 0.004, 0.005]));
    }

    #[test]
    fn a_side_that_is_not_recorded_is_booked_as_such() {
        let one = control_variate(spec().with_sides(Sides::Reflected));
        let budget = one.expected().budget();
        assert!((budget.not_recorded - 0.45).abs() < 1e-15);
        assert!((budget.truncated - 0.45).abs() < 1e-15);
        assert_eq!(budget.transmitted, 0.0);
    }

    #[test]
    fn a_completed_tally_closes_its_budget_and_keeps_its_sums() {
        let control_variate = control_variate(spec());
        let mut tally = TallyValues::zeros(spec());
        // Of what is subtracted ray by ray, this is left.
        for component in [Component::Single, Component::All] {
            tally[spec().flux_entry(Side::Reflected, component)] = 0.07;
        }
        control_variate.complete(&mut tally);
        let budget = tally.budget();
        assert!((budget.total() - 1.0).abs() < 1e-15);
        let rings = tally.rings(Side::Transmitted, Component::Single);
        let sum = rings.iter().sum::<f64>();
        assert!((sum - budget.transmitted).abs() < 1e-15);
        assert_eq!(budget.reflected, tally.order(Side::Reflected, 1));
    }

    #[test]
    fn a_weaker_control_variate_expects_less_of_everything() {
        let full = control_variate(spec());
        let half = control_variate(spec()).weakened(0.5);
        for (a, b) in full.expected().iter().zip(half.expected().iter()) {
            assert_eq!(0.5 * a, *b);
        }
        assert_eq!(half.fraction(Side::Transmitted, 0), 0.5);
        assert_eq!(half.absorbed_fraction(), 0.45);
    }
}
