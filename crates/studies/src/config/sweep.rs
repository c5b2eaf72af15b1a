//! Sweep: expands the lists of a configuration into cases, each with one value.
//!
//! [`DIMENSIONS`] names the lists in their order of nesting: the last one changes fastest. A further dimension is a
//! further row there.

use asperity_optics::Incidence;
use asperity_simulate::{Case, Coordinates, Light, SurfaceSource};
use serde_json::{Value, json};

use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};
use crate::config::{Incident, VerifyConfig};

/// Most cases of a sweep.
const MAX_CASES: f64 = 20_000.0;

/// Access to a list of a configuration.
pub(crate) type Dimension<C> = fn(&mut C) -> Option<&mut OneOrMany<Number>>;

/// The lists that are expanded, the last one fastest. Of the two pairs of names for a medium one is missing.
const DIMENSIONS: [(&str, Dimension<VerifyConfig>); 13] = [
    ("roughness", |config| {
        Some(config.surface.roughness.as_mut()?.list_mut())
    }),
    ("depth", |config| {
        config.surface.structure.as_mut()?.depth.as_mut()
    }),
    ("eta", |config| config.material.eta_mut()),
    ("kappa", |config| config.material.kappa_mut()),
    ("mean_free_path", |config| interactions(config)?[0].take()),
    ("albedo", |config| interactions(config)?[1].take()),
    ("absorption", |config| interactions(config)?[2].take()),
    ("scattering", |config| interactions(config)?[3].take()),
    ("g", |config| config.medium.as_mut()?.g.as_mut()),
    ("thickness", |config| {
        config.medium.as_mut()?.thickness.as_mut()
    }),
    ("wavelength", |config| {
        config.light.wavelength_of(&config.material)
    }),
    ("theta", |config| Some(&mut config.light.theta)),
    ("phi", |config| Some(&mut config.light.phi)),
];

/// The configurations of every combination of the lists, each with one value per list, the last list fastest.
///
/// # Errors
/// [`ConfigError`] if a list is empty, or there are more than [`MAX_CASES`] combinations.
pub(crate) fn expanded<C: Clone>(
    config: &C,
    dimensions: &[(&'static str, Dimension<C>)],
) -> Result<Vec<C>, ConfigError> {
    let mut lists = Vec::new();
    let mut copy = config.clone();
    for (name, dimension) in dimensions {
        if let Some(list) = dimension(&mut copy) {
            lists.push((*dimension, list.values(name)?));
        }
    }
    let count: f64 = lists
        .iter()
        .map(|(_, values)| values.len() as f64)
        .product();
    if count > MAX_CASES {
        return Err(ConfigError::unsuitable(
            format!("{count} cases of all lists"),
            format!("must be at most {MAX_CASES}; divide them among several runs"),
        ));
    }
    let with_values = |configs: Vec<C>, (dimension, values): (Dimension<C>, Vec<Number>)| {
        let with = |config: C| {
            let values = values.iter().map(move |value| (config.clone(), *value));
            values.map(|(mut config, value)| {
                if let Some(list) = dimension(&mut config) {
                    *list = OneOrMany::One(value);
                }
                config
            })
        };
        configs.into_iter().flat_map(with).collect()
    };
    Ok(lists.into_iter().fold(vec![config.clone()], with_values))
}

fn interactions(config: &mut VerifyConfig) -> Option<[Option<&mut OneOrMany<Number>>; 4]> {
    Some(config.medium.as_mut()?.interactions.lists())
}

impl VerifyConfig {
    /// The configurations of every combination of the lists, each with one value per list.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty, or there are more than [`MAX_CASES`] combinations.
    pub(crate) fn singles(&self) -> Result<Vec<Self>, ConfigError> {
        let mut config = self.clone();
        let medium = config.medium.as_ref();
        config
            .material
            .prepare(config.light.wavelength.as_ref(), medium)?;
        let mut singles = Vec::new();
        for side in self.light.from.sides() {
            let mut config = config.clone();
            config.light.from = *side;
            if self.light.from == Incident::Both
                && *side == Incident::Below
                && self.medium.is_none()
            {
                config.material = config.material.other_side();
            }
            singles.extend(expanded(&config, &DIMENSIONS)?);
        }
        Ok(singles)
    }

    /// The settings that the results of all cases depend on, without those that are listed: a case has its own. `measured`: the given
    /// surface in place of the random ones.
    pub(crate) fn document_of_cases(&self, measured: Option<&Value>) -> Value {
        let mut settings = self.clone();
        for (_, dimension) in DIMENSIONS {
            if let Some(list) = dimension(&mut settings) {
                *list = OneOrMany::Many(Vec::new());
            }
        }
        let mut document = settings.document();
        // A list that is not given is that of its default.
        document["material"]["eta"] = json!([]);
        document["material"]["kappa"] = json!([]);
        if let Some(measured) = measured {
            document["surface"] = json!({ "cells": self.surface.cells.of_given() });
            document["measured"] = measured.clone();
        }
        document
    }

    /// The settings that the results depend on: neither the time that a run is given, nor plots and coherent light, nor a wavelength that changes nothing that
    /// is traced.
    pub(crate) fn document(&self) -> Value {
        let mut settings = self.clone();
        settings.run.max_time = None;
        settings.light.forget_wavelength(&settings.material);
        settings.output.plots = true;
        settings.output.coherent = None;
        json!(settings)
    }

    /// The case of a configuration without lists, on `surface`, in the bins of the settings.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub(crate) fn case(
        &self,
        surface: SurfaceSource,
        at: Coordinates,
    ) -> Result<Case, ConfigError> {
        let from = self.light.from.into();
        let resolved = self.material.resolved(self.light.wavelength_nm())?;
        let (material, layers) = resolved.over_layers(self.medium.as_ref(), at.unit, from)?;
        let (theta, phi) = (self.light.theta.one("theta")?, self.light.phi.one("phi")?);
        let incidence = Incidence::from_degrees(theta.0, phi.0)?;
        let light = Light {
            incidence,
            from,
            spread: self.light.spread(incidence)?,
            random_azimuth: self.any_azimuth(),
            stokes: self.light.stokes(self.run.polarisation)?,
        };
        Ok(Case {
            layers,
            at: material.coordinates(at),
            ..Case::new(surface, material.material, light)
        })
    }
}
