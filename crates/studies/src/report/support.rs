//! Support of fluxes: which are proven, and how many independent samples the others rest on.

use asperity_optics::Material;
use asperity_simulate::{Outcome, SurfaceSource};
use asperity_tally::{Entry, Estimate, Side, TallyResult, TallySpec, TallyStatistics};
use serde::{Deserialize, Serialize};

use crate::output::{Support, Supported};

/// What the fluxes of a run rest on whose samples all agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FluxSupport {
    /// Independent samples; `None` where nothing was traced.
    samples: Option<f64>,
    /// Whether every ray meets the same facet, at the same angle.
    is_level: bool,
    /// Whether something below the surface is left to chance.
    has_medium: bool,
    /// Whether light can be absorbed, and transmitted.
    absorbs: bool,
    transmits: bool,
}

impl FluxSupport {
    /// Of a run.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        let case = &outcome.case;
        let is_traced = outcome.deviation_bound.is_none();
        let has_medium = case.layer.is_some();
        Self {
            samples: is_traced.then(|| independent_samples(outcome)),
            is_level: case.surface.is_level(),
            has_medium,
            absorbs: has_medium || matches!(case.material, Material::Conductor { .. }),
            transmits: has_medium || case.material.transmitting_index().is_some(),
        }
    }

    /// Of a model, of which `rays` were drawn where it has no closed form.
    #[must_use]
    pub const fn of_model(rays: u64) -> Self {
        Self {
            samples: match rays {
                0 => None,
                rays => Some(rays as f64),
            },
            // What does not scatter comes from closed forms.
            is_level: true,
            has_medium: true,
            absorbs: false,
            transmits: true,
        }
    }

    /// Flux that left on `side`, or a part of it.
    pub(crate) fn flux(&self, side: Side, flux: Estimate) -> Supported {
        let is_possible = side == Side::Reflected || self.transmits;
        self.supported(is_possible, flux)
    }

    /// Flux that was absorbed.
    pub(crate) fn absorbed(&self, flux: Estimate) -> Supported {
        self.supported(self.absorbs, flux)
    }

    /// Flux that ended otherwise.
    pub(crate) fn ended(&self, flux: Estimate) -> Supported {
        self.supported(true, flux)
    }

    /// An entry of the budget.
    pub(crate) fn of_budget(&self, statistics: &TallyStatistics, entry: Entry) -> Supported {
        let flux = statistics.at(entry);
        let budget = TallySpec::BUDGET;
        if entry == budget.absorbed {
            self.absorbed(flux)
        } else if entry == budget.transmitted {
            self.flux(Side::Transmitted, flux)
        } else {
            self.ended(flux)
        }
    }

    fn supported(&self, is_possible: bool, flux: Estimate) -> Supported {
        // On a level surface light that does not scatter below does the same everywhere.
        let is_same_everywhere = self.is_level && (flux.mean != 0.0 || !self.has_medium);
        let support = match self.samples {
            Some(count) if is_possible && !is_same_everywhere => Support::Samples(count),
            _ => Support::Proven,
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
    let [ny, nx] = surfaces.shape();
    let [dx, dy] = surfaces.spacing();
    let [tau_x, tau_y] = surfaces.psd().axis_correlation_lengths();
    let patches = (nx as f64 * dx / tau_x) * (ny as f64 * dy / tau_y);
    rays.min(outcome.work.realisations as f64 * patches.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Estimate = Estimate {
        mean: 0.0,
        se: Some(0.0),
    };
    const GLASS: FluxSupport = FluxSupport {
        samples: Some(1e4),
        is_level: false,
        has_medium: false,
        absorbs: false,
        transmits: true,
    };

    #[test]
    fn what_no_ray_did_is_exact_only_where_none_can() {
        let texts = |support: FluxSupport| {
            [
                support.flux(Side::Reflected, NONE),
                support.flux(Side::Transmitted, NONE),
                support.absorbed(NONE),
                support.ended(NONE),
            ]
            .map(|flux| flux.text())
        };
        let (exact, unseen) = ("0 (exact)", "none seen, below 3.0e-4");
        assert_eq!(texts(GLASS), [unseen, unseen, exact, unseen]);
        let gold = FluxSupport {
            absorbs: true,
            transmits: false,
            ..GLASS
        };
        assert_eq!(texts(gold), [unseen, exact, unseen, unseen]);
        let level = FluxSupport {
            is_level: true,
            ..GLASS
        };
        assert_eq!(texts(level), [exact; 4]);
        let over_medium = FluxSupport {
            has_medium: true,
            absorbs: true,
            ..level
        };
        assert_eq!(texts(over_medium), [unseen; 4]);
        let untraced = FluxSupport {
            samples: None,
            ..GLASS
        };
        assert_eq!(texts(untraced), [exact; 4]);
    }

    #[test]
    fn light_that_a_level_surface_reflects_is_exact_over_a_medium_too() {
        let over_medium = FluxSupport {
            is_level: true,
            has_medium: true,
            ..GLASS
        };
        let first_order = Estimate { mean: 0.04, ..NONE };
        let text = |support: FluxSupport| support.flux(Side::Reflected, first_order).text();
        assert_eq!(text(over_medium), "0.04 (exact)");
        assert_eq!(text(GLASS), "0.04 (no scatter)");
    }
}
