//! Sweep: expands the lists of a configuration into cases, each with one value.
//!
//! [`DIMENSIONS`] names the lists in their order of nesting: the last one changes fastest. A further dimension is a
//! further row there.

use asperity_optics::Incidence;
use asperity_simulate::{Case, Coordinates, Light, SurfaceSource};
use serde_json::{Value, json};

use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;
use crate::config::values::{Number, OneOrMany};
use crate::config::{Incident, LightConfig, MaterialConfig, VerifyConfig};

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

/// Sample of a configuration, and the light that falls on it.
pub(crate) struct LitSample<'c> {
    pub(crate) material: &'c mut MaterialConfig,
    pub(crate) medium: Option<&'c MediumConfig>,
    pub(crate) light: &'c mut LightConfig,
}

/// The configurations of [`expanded`] for each side that light comes from, one side after the other. A sample that is lit from both, without
/// layers, has the reciprocal index from below.
///
/// # Errors
/// [`ConfigError`] as of [`expanded`], or if named media have no indices.
pub(crate) fn expanded_by_side<C: Clone>(
    config: &C,
    sample: fn(&mut C) -> LitSample<'_>,
    dimensions: &[(&'static str, Dimension<C>)],
) -> Result<Vec<C>, ConfigError> {
    let mut config = config.clone();
    let lit = sample(&mut config);
    lit.material
        .prepare(lit.light.wavelength.as_ref(), lit.medium)?;
    let from = lit.light.from;
    let mut singles = Vec::new();
    for side in from.sides() {
        let mut config = config.clone();
        let lit = sample(&mut config);
        lit.light.from = *side;
        if from == Incident::Both && *side == Incident::Below && lit.medium.is_none() {
            *lit.material = lit.material.other_side();
        }
        singles.extend(expanded(&config, dimensions)?);
    }
    Ok(singles)
}

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

fn lit_sample(config: &mut VerifyConfig) -> LitSample<'_> {
    LitSample {
        material: &mut config.material,
        medium: config.medium.as_ref(),
        light: &mut config.light,
    }
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
        let mut singles = expanded_by_side(self, lit_sample, &DIMENSIONS)?;
        if let Some(pairs) = &self.light.pairs {
            let pairs = pairs
                .iter()
                .map(|pair| pair.map(|angle| Some(Number(angle))));
            let pairs: Vec<[Option<Number>; 2]> = pairs.collect();
            singles.retain(|single| {
                pairs.contains(&[single.light.theta.first(), single.light.phi.first()])
            });
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
