//! Sweep case: one combination of the values of a sweep over random surfaces, and its names.

use std::fmt;

use asperity_optics::{Incidence, Layer, Material};
use asperity_surface::{LengthUnit, SurfaceRecipe};
use serde::Serialize;

use asperity_simulate::{layer_folder, layer_name, short, slopes};

use crate::config::case_model::ModelledSurface;

/// One combination of smoothness, material, layer and direction of light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepCase {
    /// `tau / sigma`, by the first principal axis.
    pub smoothness: f64,
    /// What the surfaces are drawn by.
    #[serde(rename = "psd")]
    pub recipe: SurfaceRecipe,
    /// Unit of lengths.
    #[serde(skip_serializing_if = "is_arbitrary")]
    pub unit: LengthUnit,
    /// The material.
    pub material: Material,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<Layer>,
    /// The direction towards the light.
    #[serde(serialize_with = "in_degrees")]
    pub incidence: Incidence,
}

/// Whether lengths have no physical unit; results are silent about it then.
pub(crate) fn is_arbitrary(unit: &LengthUnit) -> bool {
    *unit == LengthUnit::Arbitrary
}

fn in_degrees<S: serde::Serializer>(
    incidence: &Incidence,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    use serde::ser::SerializeStruct;
    let mut out = serializer.serialize_struct("Incidence", 2)?;
    out.serialize_field("theta_deg", &incidence.theta_deg())?;
    out.serialize_field("phi_deg", &incidence.phi_deg())?;
    out.end()
}

impl fmt::Display for SweepCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "s = {}, ", short(self.smoothness))?;
        if let Some(grooves) = self.grooves() {
            write!(f, "{grooves}, ")?;
        }
        match self.material {
            Material::Dielectric { eta } => write!(f, "n = {}, ", short(eta))?,
            Material::Conductor { eta, kappa } => {
                write!(f, "n = {} + {}i, ", short(eta), short(kappa))?;
            }
            Material::Lambertian { reflectance } => {
                write!(f, "Lambertian {}, ", short(reflectance))?;
            }
            _ => write!(f, "mirror, ")?,
        }
        write!(f, "theta = {} deg", short(self.incidence.theta_deg()))?;
        match &self.layer {
            Some(layer) => write!(f, ", {}", layer_name(layer, self.unit)),
            None => Ok(()),
        }
    }
}

impl SweepCase {
    /// What an anisotropic surface has in addition to the smoothness along its first axis: that along the second, and
    /// the angle from +x to the first.
    #[must_use]
    pub fn grooves(&self) -> Option<String> {
        self.recipe.anisotropy().map(|[ratio, azimuth]| {
            let (s_y, azimuth) = (ratio * self.smoothness, azimuth.to_degrees());
            format!(
                "s = {} along the second axis, first axis at {} deg",
                short(s_y),
                short(azimuth)
            )
        })
    }

    /// What models of the case are made for.
    pub(crate) fn modelled(&self) -> ModelledSurface {
        ModelledSurface {
            slopes: slopes(&self.recipe).map(Into::into),
            is_nearly_isotropic: false,
            material: self.material,
            layer: self.layer,
        }
    }

    /// A folder name for the case, as in `s3_n1.4_theta30`.
    #[must_use]
    pub fn folder(&self) -> String {
        let material = match self.material {
            Material::Dielectric { eta } => format!("n{}", short(eta)),
            Material::Conductor { eta, kappa } => format!("n{}k{}", short(eta), short(kappa)),
            Material::Lambertian { reflectance } => format!("lambertian{}", short(reflectance)),
            _ => "mirror".to_owned(),
        };
        let theta = short(self.incidence.theta_deg());
        let layer = self
            .layer
            .map_or(String::new(), |layer| format!("_{}", layer_folder(&layer)));
        format!("s{}_{material}_theta{theta}{layer}", short(self.smoothness))
    }
}

#[cfg(test)]
mod tests {
    use asperity_surface::Psd;

    use super::*;

    #[test]
    fn folders_of_extreme_cases_are_short_and_different() {
        let folder = |smoothness: f64, eta: f64| {
            let case = SweepCase {
                smoothness,
                recipe: Psd::gaussian(1.0, 1.0).unwrap().into(),
                unit: LengthUnit::Arbitrary,
                material: Material::Dielectric { eta },
                layer: None,
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
            };
            case.folder()
        };
        assert_eq!(folder(1e200, 1.5), "s1e200_n1.5_theta30");
        assert_eq!(folder(1e-150, 1e-150), "s1e-150_n1e-150_theta30");
        assert_ne!(folder(1e-150, 1.5), folder(1e-151, 1.5));
        assert_ne!(folder(1.5e-12, 1.5), folder(2e-12, 1.5));
    }
}
