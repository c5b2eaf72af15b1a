//! Basis of fluxes: which are proven, and how many independent samples the others have.

use asperity_analysis::ScatteringModel;
use asperity_optics::Material;
use asperity_simulate::{Outcome, SurfaceSource};
use asperity_tally::{Entry, Estimate, Side, TallyResult, TallySpec, TallyStatistics};

use crate::output::{Basis, EstimateWithLimit};

/// Basis of the fluxes of a result, which gives them their limits where all samples agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxBasis {
    /// Basis of fluxes that are zero.
    zero: Basis,
    /// Basis of all others.
    nonzero: Basis,
    /// `true` if light can be absorbed.
    absorbs: bool,
    /// `true` if light can be transmitted.
    transmits: bool,
}

impl FluxBasis {
    /// Basis of the fluxes of a run: a bound, without tracing; or rays. All rays on a level surface meet the same facet at the same angle, and
    /// do the same unless light is scattered below it.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        let case = &outcome.case;
        let samples = Basis::Samples(independent_samples(outcome));
        let has_medium = !case.layers.is_empty();
        let bases = match outcome.deviation_bound {
            Some(_) => [Basis::Proven; 2],
            None if !case.surface.is_level() => [samples; 2],
            None if has_medium => [samples, Basis::Proven],
            None => [Basis::Proven; 2],
        };
        let surface = Self::of_surface(bases, case.material);
        Self {
            absorbs: surface.absorbs || has_medium,
            transmits: surface.transmits || has_medium,
            ..surface
        }
    }

    /// Basis of the fluxes of a model. `rays`: number of random paths that it followed, of multiple scattering alone if it has a density;
    /// zero if all fluxes come from quadrature.
    #[must_use]
    pub fn of_model(model: &dyn ScatteringModel, rays: u64) -> Self {
        let samples = Basis::Samples(rays as f64);
        let bases = match (rays, model.density()) {
            (0, _) => [Basis::Quadrature; 2],
            (_, Some(_)) => [samples, Basis::Quadrature],
            (_, None) => [samples; 2],
        };
        Self::of_surface(bases, model.material())
    }

    fn of_surface([zero, nonzero]: [Basis; 2], material: Material) -> Self {
        Self {
            zero,
            nonzero,
            absorbs: material.absorbs(),
            transmits: material.transmitting_index().is_some(),
        }
    }

    /// Flux that left on `side`, or a part of it.
    pub(crate) fn flux(&self, side: Side, flux: Estimate) -> EstimateWithLimit {
        let is_possible = side == Side::Reflected || self.transmits;
        self.with_limit(is_possible, flux)
    }

    /// Part of the light of a side, which is a flux of `whole`.
    pub(crate) fn part(&self, side: Side, whole: f64, part: Estimate) -> EstimateWithLimit {
        let of_part = |basis: Basis| match basis {
            Basis::Samples(count) => Basis::Samples(count * whole),
            other => other,
        };
        let basis = Self {
            zero: of_part(self.zero),
            nonzero: of_part(self.nonzero),
            ..*self
        };
        basis.flux(side, part)
    }

    /// Flux that was absorbed.
    pub(crate) fn absorbed(&self, flux: Estimate) -> EstimateWithLimit {
        if self.absorbs && self.zero == Basis::Quadrature {
            // Closed forms are of light that leaves.
            return EstimateWithLimit::new(flux, Basis::NotComputed);
        }
        self.with_limit(self.absorbs, flux)
    }

    /// Flux that ended otherwise, as no light does in quadrature.
    pub(crate) fn ended(&self, flux: Estimate) -> EstimateWithLimit {
        self.with_limit(self.zero != Basis::Quadrature, flux)
    }

    /// An entry of the budget.
    pub(crate) fn of_budget(
        &self,
        statistics: &TallyStatistics,
        entry: Entry,
    ) -> EstimateWithLimit {
        let flux = statistics.at(entry);
        let budget = TallySpec::BUDGET;
        if entry == budget.absorbed {
            self.absorbed(flux)
        } else if entry == budget.reflected {
            self.flux(Side::Reflected, flux)
        } else if entry == budget.transmitted {
            self.flux(Side::Transmitted, flux)
        } else {
            self.ended(flux)
        }
    }

    fn with_limit(&self, is_possible: bool, flux: Estimate) -> EstimateWithLimit {
        let basis = match flux.mean == 0.0 {
            _ if !is_possible => Basis::Proven,
            true => self.zero,
            false => self.nonzero,
        };
        EstimateWithLimit::new(flux, basis)
    }
}

/// Rays, but no more than there are patches of a correlation length on random surfaces: rays that fall on one patch
/// meet with the same.
fn independent_samples(outcome: &Outcome) -> f64 {
    let rays = outcome.work.rays as f64;
    let SurfaceSource::Random(surfaces) = &outcome.case.surface else {
        return rays;
    };
    let lengths = surfaces.recipe().axis_correlation_lengths();
    let patches = patches(surfaces.shape(), surfaces.spacing(), lengths);
    rays.min(outcome.work.realisations as f64 * patches)
}

/// Returns how many patches of one correlation length by one a surface has, at least one. `shape`: samples `[ny, nx]`;
/// `spacing`, `lengths`: distance between samples and correlation length along x and y.
pub(crate) fn patches(shape: [usize; 2], spacing: [f64; 2], lengths: [f64; 2]) -> f64 {
    let [ny, nx] = shape.map(|samples| samples as f64);
    let ([dx, dy], [tau_x, tau_y]) = (spacing, lengths);
    ((nx * dx / tau_x) * (ny * dy / tau_y)).max(1.0)
}

#[cfg(test)]
mod tests {
    use asperity_tally::{HemisphereGrid, TallyValues};

    use super::*;

    const NONE: Estimate = Estimate {
        mean: 0.0,
        se: Some(0.0),
    };
    const SAMPLES: Basis = Basis::Samples(1e4);
    const GLASS: FluxBasis = FluxBasis {
        zero: SAMPLES,
        nonzero: SAMPLES,
        absorbs: false,
        transmits: true,
    };
    const LEVEL: FluxBasis = FluxBasis {
        zero: Basis::Proven,
        nonzero: Basis::Proven,
        ..GLASS
    };
    const EXACT: &str = "0 (exact)";
    const UNSEEN: &str = "0 (< 3.0e-4, 95 %)";

    /// Reflected, transmitted, absorbed and lost.
    fn texts(support: FluxBasis) -> [String; 4] {
        [
            support.flux(Side::Reflected, NONE),
            support.flux(Side::Transmitted, NONE),
            support.absorbed(NONE),
            support.ended(NONE),
        ]
        .map(|flux| flux.text())
    }

    #[test]
    fn a_flux_of_zero_is_exact_only_where_it_is_impossible() {
        assert_eq!(texts(GLASS), [UNSEEN, UNSEEN, EXACT, UNSEEN]);
        let gold = FluxBasis {
            absorbs: true,
            transmits: false,
            ..GLASS
        };
        assert_eq!(texts(gold), [UNSEEN, EXACT, UNSEEN, UNSEEN]);
        assert_eq!(texts(LEVEL), [EXACT; 4]);
        let over_medium = FluxBasis {
            zero: SAMPLES,
            absorbs: true,
            ..LEVEL
        };
        assert_eq!(texts(over_medium), [UNSEEN; 4]);
    }

    /// A model may do what its material does, whether it is integrated or followed.
    #[test]
    fn fluxes_that_a_material_excludes_are_exact_in_models() {
        let glass = Material::dielectric(1.5).unwrap();
        let gold = Material::conductor(0.2, 3.0).unwrap();
        let quadrature = "0 (quadrature)";
        for (material, transmitted, absorbed) in [
            (glass, true, false),
            (gold, false, true),
            (Material::Mirror, false, false),
        ] {
            let expected = |possible: &'static str, lost| {
                let of = |is_possible| if is_possible { possible } else { EXACT };
                [possible, of(transmitted), of(absorbed), lost]
            };
            let integrated = FluxBasis::of_surface([Basis::Quadrature; 2], material);
            let mut of_integral = expected(quadrature, EXACT);
            if absorbed {
                of_integral[2] = "not computed";
            }
            assert_eq!(texts(integrated), of_integral);
            let followed = FluxBasis::of_surface([SAMPLES, Basis::Quadrature], material);
            assert_eq!(texts(followed), expected(UNSEEN, UNSEEN));
            // Single scattering, which rays do not add to
            let once = Estimate { mean: 0.25, ..NONE };
            for model in [integrated, followed] {
                assert_eq!(
                    model.flux(Side::Reflected, once).text(),
                    "0.25 (quadrature)"
                );
            }
        }
    }

    #[test]
    fn parts_of_the_budget_have_the_basis_of_their_sides() {
        let spec = TallySpec::new(HemisphereGrid::new(2, 2).unwrap(), 0.1).unwrap();
        let mut tally = TallyValues::zeros(spec);
        tally[TallySpec::BUDGET.reflected] = 0.25;
        let mut statistics = TallyStatistics::new(spec);
        (0..2).for_each(|_| statistics.push(&tally));
        let model = FluxBasis::of_surface([Basis::Quadrature; 2], Material::Mirror);
        let text = |entry| model.of_budget(&statistics, entry).text();
        let budget = TallySpec::BUDGET;
        assert_eq!(text(budget.reflected), "0.25 (quadrature)");
        for entry in [budget.transmitted, budget.absorbed, budget.lost] {
            assert_eq!(text(entry), EXACT);
        }
    }

    #[test]
    fn light_that_a_level_surface_reflects_is_exact_over_a_medium_too() {
        let over_medium = FluxBasis {
            zero: SAMPLES,
            ..LEVEL
        };
        let first_order = Estimate { mean: 0.04, ..NONE };
        let text = |support: FluxBasis| support.flux(Side::Reflected, first_order).text();
        assert_eq!(text(over_medium), "0.04 (exact)");
        assert_eq!(text(GLASS), "0.04 (no scatter)");
    }

    #[test]
    fn patches_are_squares_of_a_correlation_length() {
        assert_eq!(patches([30, 20], [0.5, 2.0], [5.0, 10.0]), 12.0);
        assert_eq!(patches([2, 2], [1.0, 1.0], [8.0, 8.0]), 1.0);
    }
}
