//! What a configuration stands for: settings, their directions, and how each is measured.

use asperity_optics::Incidence;
use asperity_simulate::{
    CaseBins, CoreSlopes, Light, Lobe, Settings, check_memory, check_results, short,
};
use asperity_tally::{Polarimetry, TallySpec};
use serde_json::{Value, json};

use super::config::GonioConfig;
use super::sample::Sample;
use super::specimen::Specimen;
use crate::config::cases::{check_light, check_sides};
use crate::config::error::ConfigError;
use crate::config::lobes::BinnedLobe;
use crate::config::sweep::{Sweep, SweptCase};
use crate::config::sweep_case::SweepCase;
use crate::config::{LightConfig, VerifyConfig};
use crate::validity::Validity;
use crate::verify::error::VerifyError;
use asperity_simulate::BottomSurface;

/// What is measured.
#[derive(Clone, Debug, Default)]
pub(super) struct Plans {
    pub(super) settings: Vec<Specimen>,
    /// The directions of each setting in the order of their files: settings, polar angles, azimuths, in that
    /// order of nesting.
    pub(super) directions: Vec<Plan>,
}

/// One direction of one setting, and how it is measured.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Number of the setting.
    pub(super) setting: usize,
    pub(super) incidence: Incidence,
    /// Name of its files.
    pub(super) name: String,
    /// All that its results depend on.
    pub(super) identity: Value,
    pub(super) work: Work,
    /// Bins of its own, if it has any.
    pub(super) bins: Option<CaseBins>,
    /// What is recorded.
    pub(super) spec: TallySpec,
    /// Lobes of single scattering, next to the bins.
    pub(super) lobes: Vec<BinnedLobe>,
    /// Lengths of the surface against the wavelength, where its unit is known.
    pub(super) validity: Option<Validity>,
}

/// How a direction is measured.
#[derive(Clone, Debug)]
pub(super) enum Work {
    /// On random surfaces.
    Random(Box<VerifyConfig>),
    /// On the given one.
    Given(Settings),
}

impl GonioConfig {
    /// Checks everything that can be known before a ray is traced; `sample` is the given surface, if there
    /// is one.
    ///
    /// # Errors
    /// [`VerifyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn check(&self, sample: Option<&Sample>) -> Result<(), VerifyError> {
        if self.run.polarisation.polarimetry() != Polarimetry::Nothing {
            return Err(ConfigError::Contradiction(format!(
                "--polarisation {}: gonio keeps fluxes alone; take tracked or averaged, or trace or verify for one direction",
                self.run.polarisation
            ))
            .into());
        }
        let plans = self.plans(sample)?;
        let rays = self.ray_settings()?;
        for plan in &plans.directions {
            check_results(&plan.spec, self.run.realisations.0, 1, rays.refine)?;
        }
        let specs = plans.directions.iter().map(|plan| plan.spec.len());
        let values = 2.0 * specs.sum::<usize>() as f64;
        check_memory("the table of all directions", (8.0 * values) as usize)?;
        for plan in &plans.directions {
            if let Work::Random(config) = &plan.work {
                config.check_surfaces()?;
            }
        }
        for setting in plans.settings {
            check_sides(self.run.side, setting.material, setting.layer.as_ref())?;
        }
        Ok(())
    }

    /// What is measured.
    pub(super) fn plans(&self, sample: Option<&Sample>) -> Result<Plans, ConfigError> {
        self.measured.check()?;
        match sample {
            None if self.measured.is_given() => Err(ConfigError::Contradiction(
                "the measured surface was not read".into(),
            )),
            None => self.random(),
            Some(sample) => self.given(sample),
        }
    }

    fn random(&self) -> Result<Plans, ConfigError> {
        let wavelength = self.light.wavelength_nm();
        let mut plans = Plans::default();
        for SweptCase { case, config } in self.as_verification()?.sweep()?.cases {
            let setting = plans.number_of(Specimen::of_case(&case));
            let Binned { bins, spec, lobes } =
                self.binned(&case, CoreSlopes::of_recipe(&case.recipe))?;
            plans.directions.push(Plan {
                bins,
                spec,
                lobes,
                setting,
                validity: Validity::of_recipe(&case.recipe, case.unit, case.incidence, wavelength),
                incidence: case.incidence,
                name: format!("{}_{}", case.folder(), phi_name(case.incidence)),
                identity: json!(config),
                work: Work::Random(Box::new(config)),
            });
        }
        Ok(plans)
    }

    fn given(&self, sample: &Sample) -> Result<Plans, ConfigError> {
        let contradiction = |text: &str| Err(ConfigError::Contradiction(text.to_owned()));
        let run = self.ray_settings()?;
        let medium = self.medium.as_ref();
        if medium.is_some_and(|medium| medium.bottom_surface.named() == BottomSurface::Independent)
        {
            return contradiction(
                "an independent bottom cannot be drawn for a measured surface; take bottom_surface flat or same",
            );
        }
        if self.medium.is_some() {
            check_light(self.light.from.into(), self.run.estimator)?;
        }
        let slopes = CoreSlopes::of_shape(&sample.shape);
        let mut plans = Plans::default();
        for SweptCase { case, config } in Sweep::of(&self.as_verification()?)?.cases {
            let setting = Specimen::of_given(case.material, case.layer, sample.about.unit);
            let name = format!(
                "{}_theta{}_{}",
                setting.name(),
                short(case.incidence.theta_deg()),
                phi_name(case.incidence)
            );
            if plans.directions.iter().any(|plan| plan.name == name) {
                let text = format!(
                    "two directions would share the same file {name}; give each value once, and values that differ in six digits"
                );
                return Err(ConfigError::Contradiction(text));
            }
            let setting = plans.number_of(setting);
            let Binned { bins, spec, lobes } = self.binned(&case, slopes)?;
            plans.directions.push(Plan {
                bins,
                spec,
                lobes,
                setting,
                validity: Validity::new(
                    &sample.about.lengths,
                    case.incidence.theta(),
                    self.light.wavelength_nm(),
                ),
                incidence: case.incidence,
                identity: self.identity(sample, &case, &config.light),
                work: Work::Given(run),
                name,
            });
        }
        Ok(plans)
    }

    /// The bins of a case on a surface of these slopes.
    fn binned(&self, case: &SweepCase, slopes: CoreSlopes) -> Result<Binned, ConfigError> {
        let light = Light {
            from: self.light.from.into(),
            random_azimuth: self.any_azimuth(),
            ..Light::from_above(case.incidence)
        };
        let [reflected, transmitted] = Lobe::of(&light, &case.material, slopes);
        let lobes = [reflected, transmitted.filter(|_| case.layer.is_none())];
        let bins = self.run.bins_around(lobes);
        let tally = self.ray_settings()?.tally;
        let spec = bins.map_or(tally, |own| {
            tally.with_bins(own.grid, own.in_plane_half_width)
        });
        Ok(Binned {
            bins,
            lobes: BinnedLobe::of_lobes(lobes, &spec),
            spec,
        })
    }

    /// All that the results of a direction on a given surface depend on; `light` is that of this direction.
    fn identity(&self, sample: &Sample, case: &SweepCase, light: &LightConfig) -> Value {
        let medium = self.medium.as_ref();
        json!({
            "measured": sample.about.description,
            "cells": self.surface.cells.of_given(),
            "material": case.material,
            "layer": case.layer,
            "medium": medium.map(|medium| json!([medium.bottom_surface, medium.max_scatterings])),
            "light": {
                "theta": light.theta,
                "phi": light.phi,
                "any_azimuth": self.any_azimuth(),
                "from": self.light.from,
            },
            "run": self.piece_run(),
        })
    }
}

/// Bins of a direction.
struct Binned {
    bins: Option<CaseBins>,
    spec: TallySpec,
    lobes: Vec<BinnedLobe>,
}

impl Plans {
    /// The number of a setting, which is added unless it is the last one: directions change faster than settings.
    fn number_of(&mut self, setting: Specimen) -> usize {
        if self.settings.last() != Some(&setting) {
            self.settings.push(setting);
        }
        self.settings.len() - 1
    }
}

fn phi_name(incidence: Incidence) -> String {
    format!("phi{}", short(incidence.phi_deg()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_multiply_and_a_grid_holds_the_centres_of_its_bins() {
        let config = GonioConfig::from_toml(
            "[material]\neta = [1.3, 1.5]\n[light]\ntheta = [0, 40]\nphi = [0, 90, 180]\nazimuth = \"fixed\"",
        )
        .unwrap();
        let Plans {
            settings,
            directions: plans,
        } = config.plans(None).unwrap();
        assert_eq!((settings.len(), plans.len()), (2, 12));
        assert_eq!(plans[0].name, "s3_n1.3_theta0_phi0");
        assert_eq!(plans[4].name, "s3_n1.3_theta40_phi90");
        assert_eq!(plans[11].name, "s3_n1.5_theta40_phi180");
        assert_eq!(plans[11].setting, 1);
        let grid = GonioConfig::from_toml("[light]\ndirections = \"3x2\"").unwrap();
        assert_eq!(
            grid.light.angles().unwrap(),
            [vec![15.0, 45.0, 75.0], vec![90.0, 270.0]]
        );
    }
}
