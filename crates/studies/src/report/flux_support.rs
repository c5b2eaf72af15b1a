//! Support of fluxes: which are proven, and how many independent samples the others rest on.

use asperity_analysis::ScatteringModel;
use asperity_optics::Material;
use asperity_simulate::{Outcome, SurfaceSource};
use asperity_tally::{Entry, Estimate, Side, TallyResult, TallySpec, TallyStatistics};
use serde::{Deserialize, Serialize};

use crate::output::{Support, Supported};

/// What fluxes rest on whose samples all agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FluxSupport {
    basis: Basis,
    /// Whether something below the surface is left to chance.
    has_medium: bool,
    /// Whether light can be absorbed, and transmitted.
    absorbs: bool,
    transmits: bool,
}

/// Where fluxes come from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Basis {
    /// A bound, without tracing.
    Bound,
    /// Rays on rough surfaces: the number of independent ones.
    Samples(f64),
    /// Rays on a level surface, which all meet the same facet at the same angle: their number.
    LevelSamples(f64),
    /// Quadrature of a model.
    Quadrature,
    /// Single scattering by quadrature, multiple scattering by random paths of the model: their number.
    QuadratureAndRays(f64),
}

impl FluxSupport {
    /// Of a run.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        let case = &outcome.case;
        let basis = match (outcome.deviation_bound, case.surface.is_level()) {
            (Some(_), _) => Basis::Bound,
            (None, false) => Basis::Samples(independent_samples(outcome)),
            (None, true) => Basis::LevelSamples(independent_samples(outcome)),
        };
        let surface = Self::of_surface(basis, case.material);
        match case.layer.is_some() {
            false => surface,
            true => Self {
                has_medium: true,
                absorbs: true,
                transmits: true,
                ..surface
            },
        }
    }

    /// Of the fluxes of a model. `rays`: number of random paths that it followed; zero if all fluxes come from quadrature.
    #[must_use]
    pub fn of_model(model: &dyn ScatteringModel, rays: u64) -> Self {
        let basis = match (rays, model.density()) {
            (0, _) => Basis::Quadrature,
            (rays, Some(_)) => Basis::QuadratureAndRays(rays as f64),
            (rays, None) => Basis::Samples(rays as f64),
        };
        Self::of_surface(basis, model.material())
    }

    fn of_surface(basis: Basis, material: Material) -> Self {
        Self {
            basis,
            has_medium: false,
            absorbs: match material {
                Material::Conductor { .. } => true,
                Material::Lambertian { reflectance } => reflectance < 1.0,
                _ => false,
            },
            transmits: material.transmitting_index().is_some(),
        }
    }

    /// Flux that left on `side`, or a part of it.
    pub(crate) fn flux(&self, side: Side, flux: Estimate) -> Supported {
        let is_possible = side == Side::Reflected || self.transmits;
        self.supported(is_possible, flux)
    }

    /// Flux that was absorbed.
    pub(crate) fn absorbed(&self, flux: Estimate) -> Supported {
        if self.absorbs && self.basis == Basis::Quadrature {
            // Closed forms are of light that leaves.
            return Supported::new(flux, Support::NotComputed);
        }
        self.supported(self.absorbs, flux)
    }

    /// Flux that ended otherwise, as no light does in quadrature.
    pub(crate) fn ended(&self, flux: Estimate) -> Supported {
        self.supported(self.basis != Basis::Quadrature, flux)
    }

    /// An entry of the budget.
    pub(crate) fn of_budget(&self, statistics: &TallyStatistics, entry: Entry) -> Supported {
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

    fn supported(&self, is_possible: bool, flux: Estimate) -> Supported {
        let is_zero = flux.mean == 0.0;
        let support = match self.basis {
            _ if !is_possible => Support::Proven,
            Basis::Bound => Support::Proven,
            // Light that does not scatter below does the same everywhere.
            Basis::LevelSamples(_) if !is_zero || !self.has_medium => Support::Proven,
            Basis::Samples(count) | Basis::LevelSamples(count) => Support::Samples(count),
            Basis::QuadratureAndRays(count) if is_zero => Support::Samples(count),
            Basis::Quadrature | Basis::QuadratureAndRays(_) => Support::Quadrature,
        };
        Supported::new(flux, support)
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
    const GLASS: FluxSupport = FluxSupport {
        basis: Basis::Samples(1e4),
        has_medium: false,
        absorbs: false,
        transmits: true,
    };
    const LEVEL: FluxSupport = FluxSupport {
        basis: Basis::LevelSamples(1e4),
        ..GLASS
    };
    const EXACT: &str = "0 (exact)";
    const UNSEEN: &str = "none seen, below 3.0e-4";

    /// Reflected, transmitted, absorbed and lost.
    fn texts(support: FluxSupport) -> [String; 4] {
        [
            support.flux(Side::Reflected, NONE),
            support.flux(Side::Transmitted, NONE),
            support.absorbed(NONE),
            support.ended(NONE),
        ]
        .map(|flux| flux.text())
    }

    #[test]
    fn what_no_ray_did_is_exact_only_where_none_can() {
        assert_eq!(texts(GLASS), [UNSEEN, UNSEEN, EXACT, UNSEEN]);
        let gold = FluxSupport {
            absorbs: true,
            transmits: false,
            ..GLASS
        };
        assert_eq!(texts(gold), [UNSEEN, EXACT, UNSEEN, UNSEEN]);
        assert_eq!(texts(LEVEL), [EXACT; 4]);
        let over_medium = FluxSupport {
            has_medium: true,
            absorbs: true,
            ..LEVEL
        };
        assert_eq!(texts(over_medium), [UNSEEN; 4]);
        let untraced = FluxSupport {
            basis: Basis::Bound,
            ..GLASS
        };
        assert_eq!(texts(untraced), [EXACT; 4]);
    }

    /// A model may do what its material does, whether it is integrated or followed.
    #[test]
    fn models_prove_what_their_material_cannot_do() {
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
            let integrated = FluxSupport::of_surface(Basis::Quadrature, material);
            let mut of_integral = expected(quadrature, EXACT);
            if absorbed {
                of_integral[2] = "not computed";
            }
            assert_eq!(texts(integrated), of_integral);
            let followed = FluxSupport::of_surface(Basis::QuadratureAndRays(1e4), material);
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
    fn the_budget_rests_on_what_its_sides_rest_on() {
        let spec = TallySpec::new(HemisphereGrid::new(2, 2).unwrap(), 0.1).unwrap();
        let mut tally = TallyValues::zeros(spec);
        tally[TallySpec::BUDGET.reflected] = 0.25;
        let mut statistics = TallyStatistics::new(spec);
        (0..2).for_each(|_| statistics.push(&tally));
        let model = FluxSupport::of_surface(Basis::Quadrature, Material::Mirror);
        let text = |entry| model.of_budget(&statistics, entry).text();
        let budget = TallySpec::BUDGET;
        assert_eq!(text(budget.reflected), "0.25 (quadrature)");
        for entry in [budget.transmitted, budget.absorbed, budget.lost] {
            assert_eq!(text(entry), EXACT);
        }
    }

    #[test]
    fn light_that_a_level_surface_reflects_is_exact_over_a_medium_too() {
        let over_medium = FluxSupport {
            has_medium: true,
            ..LEVEL
        };
        let first_order = Estimate { mean: 0.04, ..NONE };
        let text = |support: FluxSupport| support.flux(Side::Reflected, first_order).text();
        assert_eq!(text(over_medium), "0.04 (exact)");
        assert_eq!(text(GLASS), "0.04 (no scatter)");
    }

    #[test]
    fn patches_are_squares_of_a_correlation_length() {
        assert_eq!(patches([30, 20], [0.5, 2.0], [5.0, 10.0]), 12.0);
        assert_eq!(patches([2, 2], [1.0, 1.0], [8.0, 8.0]), 1.0);
    }
}
