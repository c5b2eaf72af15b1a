//! One case of a verification, and its names.

use std::fmt;
use std::ops::Range;

use asperity_optics::{Incidence, Layer, Material};
use asperity_surface::Psd;
use serde::Serialize;

use crate::medium::{layer_folder, layer_name};

/// One combination of smoothness, material and direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// `tau / sigma`, by the first principal axis.
    pub smoothness: f64,
    /// The power spectral density.
    pub psd: Psd,
    /// The material.
    pub material: Material,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<Layer>,
    /// The direction towards the light.
    #[serde(serialize_with = "in_degrees")]
    pub incidence: Incidence,
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

impl fmt::Display for Case {
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
            _ => write!(f, "mirror, ")?,
        }
        write!(f, "theta = {} deg", short(self.incidence.theta_deg()))?;
        match &self.layer {
            Some(layer) => write!(f, ", {}", layer_name(layer)),
            None => Ok(()),
        }
    }
}

impl Case {
    /// What an anisotropic surface has beside the smoothness along its first axis: that along the second, and
    /// the angle from +x to the first.
    pub(crate) fn grooves(&self) -> Option<String> {
        self.psd.anisotropy().map(|[ratio, azimuth]| {
            let (s_y, azimuth) = (ratio * self.smoothness, azimuth.to_degrees());
            format!("s_y = {}, first axis at {} deg", short(s_y), short(azimuth))
        })
    }

    /// A folder name for the case, as in `s3_n1.4_theta30`.
    #[must_use]
    pub fn folder(&self) -> String {
        let material = match self.material {
            Material::Dielectric { eta } => format!("n{}", short(eta)),
            Material::Conductor { eta, kappa } => format!("n{}k{}", short(eta), short(kappa)),
            _ => "mirror".to_owned(),
        };
        let theta = short(self.incidence.theta_deg());
        let layer = self
            .layer
            .map_or(String::new(), |layer| format!("_{}", layer_folder(&layer)));
        format!("s{}_{material}_theta{theta}{layer}", short(self.smoothness))
    }
}

/// At least six significant digits, without trailing zeros; with an exponent, as in `1.5e-150`, where zeros would
/// make it long.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !PLAIN.contains(&value.abs()) {
        let text = format!("{value:.5e}");
        return match text.split_once('e') {
            Some((mantissa, exponent)) => format!("{}e{exponent}", without_zeros(mantissa)),
            None => text,
        };
    }
    let digits = (5 - value.abs().log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.digits$}")).to_owned()
}

/// Magnitudes written without an exponent.
const PLAIN: Range<f64> = 1e-12..1e15;

/// A number without zeros at the end of its fraction.
fn without_zeros(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn numbers_are_shortened_for_people() {
        assert_eq!(short(1.0 / 1.4), "0.714286");
        assert_eq!(short(2.522), "2.522");
        assert_eq!(short(30.0), "30");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(1e-9), "0.000000001");
    }

    #[test]
    fn extreme_numbers_stay_short_and_different() {
        for (value, text) in [
            (1e200, "1e200"),
            (-1.5e200, "-1.5e200"),
            (1e-150, "1e-150"),
            (1.234_567_8e-150, "1.23457e-150"),
            (f64::MAX, "1.79769e308"),
            (5e-324, "4.94066e-324"),
            (1e15, "1e15"),
            (9e14, "900000000000000"),
            (1e-12, "0.000000000001"),
            (9.9e-13, "9.9e-13"),
            (1.5e-12, "0.0000000000015"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
        // From one to the next tenth of a decade, over all that a number can be.
        let all: Vec<String> = (-3070..3080)
            .map(|i| short(10_f64.powf(f64::from(i) / 10.0)))
            .collect();
        assert!(all.iter().all(|text| text.len() <= 20), "{all:?}");
        assert!(all.iter().collect::<HashSet<_>>().len() == all.len());
    }

    #[test]
    fn folders_of_extreme_cases_are_short_and_different() {
        let folder = |smoothness: f64, eta: f64| {
            let case = Case {
                smoothness,
                psd: Psd::gaussian(1.0, 1.0).unwrap(),
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
