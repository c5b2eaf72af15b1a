//! What is measured from all directions: one surface, one material.

use asperity_optics::{Bottom, Layer, Material, PhaseFunction};
use asperity_simulate::short;
use asperity_surface::LengthUnit;
use serde::Serialize;

use crate::config::case_text::index_text;
use crate::config::sweep_case::{SweepCase, is_arbitrary};
use asperity_simulate::layer_folder;

/// One combination of surface and material, measured from all directions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Specimen {
    /// `tau / sigma` of random surfaces, by the first principal axis; `None` of a given one.
    pub smoothness: Option<f64>,
    /// What an anisotropic surface has in addition to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grooves: Option<String>,
    /// Unit of lengths.
    #[serde(skip_serializing_if = "is_arbitrary")]
    pub unit: LengthUnit,
    /// The material.
    pub material: Material,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<Layer>,
}

impl Specimen {
    pub(super) fn of_case(case: &SweepCase) -> Self {
        Self {
            smoothness: Some(case.smoothness),
            grooves: case.grooves(),
            unit: case.unit,
            material: case.material,
            layer: case.layer,
        }
    }

    pub(super) const fn of_given(
        material: Material,
        layer: Option<Layer>,
        unit: LengthUnit,
    ) -> Self {
        Self {
            smoothness: None,
            grooves: None,
            unit,
            material,
            layer,
        }
    }

    /// A name for files, as in `n1.5_mfp0.1_albedo0.9`.
    pub(super) fn name(&self) -> String {
        let material = match self.material {
            Material::Dielectric { eta } => format!("n{}", short(eta)),
            Material::Conductor { eta, kappa } => format!("n{}k{}", short(eta), short(kappa)),
            Material::Lambertian { reflectance } => format!("lambertian{}", short(reflectance)),
            _ => "mirror".to_owned(),
        };
        match &self.layer {
            Some(layer) => format!("{material}_{}", layer_folder(layer)),
            None => material,
        }
    }

    /// Its parameters by name, for titles and tables.
    pub(super) fn parameters(&self) -> Vec<(&'static str, String)> {
        let mut parameters = Vec::new();
        if let Some(s) = self.smoothness {
            parameters.push(("s", short(s)));
        }
        if let Some(grooves) = &self.grooves {
            parameters.push(("grooves", grooves.clone()));
        }
        match self.material {
            Material::Dielectric { eta } => parameters.push(("n", index_text(eta))),
            Material::Conductor { eta, kappa } => {
                parameters.push(("n", format!("{} + {}i", short(eta), short(kappa))));
            }
            Material::Lambertian { reflectance } => {
                parameters.push(("reflectance", short(reflectance)));
            }
            _ => parameters.push(("material", "mirror".to_owned())),
        }
        if let Some(layer) = &self.layer {
            parameters.extend(parameters_of(layer, self.unit));
        }
        parameters
    }
}

/// What makes up a layer, by name.
fn parameters_of(layer: &Layer, unit: LengthUnit) -> Vec<(&'static str, String)> {
    let length = |length| format!("{}{}", short(length), unit.suffix());
    let medium = layer.medium();
    let mut parameters = Vec::new();
    if medium.is_clear() {
        parameters.push(("medium", "clear medium".to_owned()));
    } else {
        parameters.push(("mean free path", length(medium.mean_free_path())));
        parameters.push(("albedo", short(medium.albedo())));
        match medium.phase() {
            PhaseFunction::Rayleigh => parameters.push(("phase", "Rayleigh".to_owned())),
            phase => parameters.push(("g", short(phase.mean_cosine()))),
        }
    }
    if let Some(slab) = layer.end() {
        parameters.push(("thickness", length(slab.thickness)));
        parameters.push(("bottom", bottom_in_words(slab.bottom)));
    }
    parameters
}

/// What a layer ends on.
pub(super) fn bottom_in_words(bottom: Bottom) -> String {
    match bottom {
        Bottom::Open => "open below".to_owned(),
        Bottom::Interface { eta } => format!("interface of n = {} below", short(eta)),
        Bottom::Absorbing => "absorbing bottom".to_owned(),
        Bottom::Mirror => "mirror below".to_owned(),
        Bottom::Lambertian { reflectance } => {
            format!("Lambertian bottom of reflectance {}", short(reflectance))
        }
        _ => String::new(),
    }
}

/// How settings are told apart: what all have in common, and what they differ in.
pub(super) struct Distinction {
    /// Common parameters, in words.
    pub(super) common: String,
    /// Names of what differs, in words; empty for one setting.
    pub(super) title: String,
    /// What each setting is called among the others.
    pub(super) labels: Vec<String>,
}

impl Distinction {
    pub(super) fn of(settings: &[Specimen]) -> Self {
        let all: Vec<Vec<(&'static str, String)>> =
            settings.iter().map(Specimen::parameters).collect();
        let value = |of: &[(&'static str, String)], name: &str| {
            of.iter().find(|(n, _)| *n == name).map(|(_, v)| v.clone())
        };
        let mut names: Vec<&'static str> = Vec::new();
        for (name, _) in all.iter().flatten() {
            if !names.contains(name) {
                names.push(name);
            }
        }
        let differs =
            |name: &&&'static str| all.iter().any(|of| value(of, name) != value(&all[0], name));
        let varied: Vec<&'static str> = names.iter().filter(differs).copied().collect();
        let words = |of: &[(&'static str, String)], names: &[&'static str], named: bool| {
            let words = names.iter().filter_map(|name| {
                let value = value(of, name)?;
                // A record's own words need no name before them.
                Some(match *name {
                    "grooves" | "material" | "medium" | "phase" | "bottom" => value,
                    name if named => format!("{name} = {value}"),
                    _ => value,
                })
            });
            words.collect::<Vec<_>>().join(", ")
        };
        let kept: Vec<&'static str> = names
            .iter()
            .filter(|n| !varied.contains(n))
            .copied()
            .collect();
        Self {
            common: all
                .first()
                .map_or_else(String::new, |of| words(of, &kept, true)),
            title: varied.join(", "),
            labels: all
                .iter()
                .map(|of| words(of, &varied, varied.len() > 1))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_heads_the_columns() {
        let glass = |s, eta| Specimen {
            smoothness: Some(s),
            grooves: None,
            unit: LengthUnit::Arbitrary,
            material: Material::Dielectric { eta },
            layer: None,
        };
        let by_eta = Distinction::of(&[glass(3.0, 1.3), glass(3.0, 1.5)]);
        assert_eq!(
            (by_eta.common.as_str(), by_eta.title.as_str()),
            ("s = 3", "n")
        );
        assert_eq!(by_eta.labels, ["1.3", "1.5"]);
        let by_both = Distinction::of(&[glass(3.0, 1.3), glass(1.0, 1.5)]);
        assert_eq!(by_both.labels, ["s = 3, n = 1.3", "s = 1, n = 1.5"]);
        let one = Distinction::of(&[glass(3.0, 1.3)]);
        assert_eq!(
            (one.common.as_str(), one.title.as_str()),
            ("s = 3, n = 1.3", "")
        );
        assert_eq!(one.labels, [""]);
    }
}
