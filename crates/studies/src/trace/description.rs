//! The configuration of a traced surface as summary.json holds it.

use asperity_simulate::Case;
use serde_json::{Value, json};

use crate::config::Azimuth;
use crate::config::trace::TraceConfig;
use crate::given::{GivenSurface, GivenSurfaces};

/// The surfaces as summary.json holds them.
pub(super) struct Surfaces {
    surface: Value,
    bottom: Option<Value>,
}

impl Surfaces {
    pub(super) fn of(
        tops: &GivenSurfaces,
        bottom: Option<&GivenSurface>,
        config: &TraceConfig,
    ) -> Self {
        let reading = &config.measured;
        Self {
            surface: tops.described(|one| one.description(reading)),
            bottom: bottom.map(|bottom| bottom.description(reading)),
        }
    }

    /// The configuration that `case` on these surfaces is of.
    pub(super) fn config(self, config: &TraceConfig, case: &Case) -> Value {
        let (run, incidence) = (&config.run, case.light.incidence);
        let mut described = json!({
            "surface": self.surface,
            "cells": config.surface.cells.of_given(),
            "material": case.material,
            "light": {
                "theta_deg": incidence.theta_deg(),
                "phi_deg": incidence.phi_deg(),
                "azimuth": config.light.azimuth.unwrap_or(Azimuth::Fixed),
                "from": config.light.from,
                "stokes": config.light.stokes,
            },
            "rays": run.target_error.is_none().then_some(run.rays),
            "target_error": run.target_error,
            "of": run.of,
            "max_time": run.max_time,
            "bins": run.bins,
            "in_plane_half_width_deg": run.in_plane_half_width,
            "side": run.side,
            "branching": run.branching,
            "polarisation": run.polarisation,
            "roulette": run.roulette,
            "max_order": run.max_order,
            "accelerator": run.accelerator,
            "estimator": run.estimator,
            "sampling": run.sampling,
            "refine": run.refine,
        });
        if let (Some(name), Some(wavelength)) = (&case.at.material, case.at.wavelength_nm()) {
            described["material_name"] = json!(name);
            described["light"]["wavelength_nm"] = json!(wavelength);
        }
        if !config.compare.models.is_empty() {
            described["compare"] = json!(config.compare);
        }
        if let (Some(medium), false) = (&config.medium, case.layers.is_empty()) {
            described["below"] = json!({
                "medium": medium,
                "layers": case.layers,
                "bottom": self.bottom,
            });
        }
        described
    }
}
