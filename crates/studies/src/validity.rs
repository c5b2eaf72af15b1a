//! Validity of geometric optics: lengths of a surface against the wavelength.
//!
//! Three numbers must be large. The Rayleigh parameter `4 pi sigma cos(theta) / lambda` is the root mean square phase
//! difference of light from high and low points; a fraction `exp(-parameter^2)` of what a Gaussian surface reflects
//! stays coherent (Beckmann and Spizzichino 1963). `tau / lambda` is the correlation length over the wavelength. The
//! radius of curvature over `lambda / cos^3(theta)` tells whether a facet is level enough to act as a plane.

use std::f64::consts::PI;
use std::fmt;

use asperity_optics::Incidence;
use asperity_simulate::short;
use asperity_surface::LengthUnit;
use asperity_synthesis::SurfaceRecipe;
use serde::Serialize;

use crate::surface_lengths::SurfaceLengths;

/// The wavelength unless one is given, in nanometres: the middle of visible light.
pub const DEFAULT_WAVELENGTH_NM: f64 = 550.0;

/// Least value of each number. A Rayleigh parameter of 3 leaves 1.2e-4 of the light coherent.
pub const LARGE: f64 = 3.0;

/// Lengths of a surface against the wavelength, for one direction of the light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Validity {
    /// Wavelength of the light, nanometres.
    pub wavelength_nm: f64,
    /// `true` if it is assumed, none being given.
    pub wavelength_is_assumed: bool,
    /// `4 pi sigma cos(theta) / lambda`.
    pub rayleigh_parameter: f64,
    /// Fraction of the reflected light of a Gaussian surface that stays coherent.
    pub coherent_fraction: f64,
    /// The shorter correlation length over the wavelength; `None` where the surface has none.
    pub tau_over_wavelength: Option<f64>,
    /// `R cos^3(theta) / lambda`, R being one over the root mean square second derivative along the more curved axis;
    /// `None` for a surface without curvature, or where it is not known.
    pub curvature_radius_over_wavelength: Option<f64>,
    /// `true` if all of them are at least [`LARGE`]; `None` where those that are known are, and others are not known.
    pub holds: Option<bool>,
}

impl Validity {
    /// For light from `incidence` on random surfaces.
    pub(crate) fn of_recipe(
        recipe: &SurfaceRecipe,
        unit: LengthUnit,
        incidence: Incidence,
        wavelength_nm: Option<f64>,
    ) -> Option<Self> {
        let lengths = SurfaceLengths::of_recipe(recipe, unit);
        Self::new(&lengths, incidence.theta(), wavelength_nm)
    }

    /// For light at the polar angle `theta`, radians, on a surface of these lengths; `None` if their unit is not
    /// known, or the surface is flat. `wavelength_nm`: [`DEFAULT_WAVELENGTH_NM`] without one.
    #[must_use]
    pub fn new(lengths: &SurfaceLengths, theta: f64, wavelength_nm: Option<f64>) -> Option<Self> {
        let nanometres = wavelength_nm.unwrap_or(DEFAULT_WAVELENGTH_NM);
        let wavelength = LengthUnit::Nanometre.conversion(lengths.unit)?(nanometres);
        if lengths.sigma == 0.0 {
            return None;
        }
        let cos = theta.cos();
        let rayleigh = 4.0 * PI * lengths.sigma * cos / wavelength;
        let tau = lengths.tau.map(|tau| tau / wavelength);
        let curvature = lengths.curvature.filter(|curvature| *curvature > 0.0);
        let radius = curvature.map(|curvature| cos.powi(3) / (curvature * wavelength));
        let known = [Some(rayleigh), tau, radius];
        let is_doubtful = known.into_iter().flatten().any(|number| number < LARGE);
        // A surface without curvature has no radius to fall short.
        let is_complete = tau.is_some() && lengths.curvature.is_some();
        Some(Self {
            wavelength_nm: nanometres,
            wavelength_is_assumed: wavelength_nm.is_none(),
            rayleigh_parameter: rayleigh,
            coherent_fraction: (-rayleigh * rayleigh).exp(),
            tau_over_wavelength: tau,
            curvature_radius_over_wavelength: radius,
            holds: (is_doubtful || is_complete).then_some(!is_doubtful),
        })
    }
}

impl Validity {
    /// The verdict where correlation length or curvature is not known.
    const fn of_known_lengths(&self) -> &'static str {
        match (
            self.tau_over_wavelength,
            self.curvature_radius_over_wavelength,
        ) {
            (None, None) => {
                "the height is large against the wavelength; its height alone is judged, since correlation length and curvature of the surface are not known"
            }
            (None, Some(_)) => {
                "height and radius of curvature are large against the wavelength; the correlation length is not known, so it is not judged"
            }
            (Some(_), _) => {
                "height and correlation length are large against the wavelength; the curvature is not known, so it is not judged"
            }
        }
    }
}

impl fmt::Display for Validity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let assumed = match self.wavelength_is_assumed {
            true => ", assumed without --wavelength",
            false => "",
        };
        let verdict = match self.holds {
            Some(true) => "lengths are large against the wavelength",
            None => self.of_known_lengths(),
            Some(false) => {
                "geometric optics is doubtful, since not all lengths are large against the wavelength"
            }
        };
        write!(
            f,
            "{verdict} ({} nm{assumed}): 4 pi sigma cos(theta) / lambda = {}",
            short(self.wavelength_nm),
            short(self.rayleigh_parameter)
        )?;
        if self.coherent_fraction > 1e-4 {
            let percent = 100.0 * self.coherent_fraction;
            write!(
                f,
                ", which leaves {percent:.2} % of reflected light coherent"
            )?;
        }
        if let Some(tau) = self.tau_over_wavelength {
            write!(f, "; tau / lambda = {}", short(tau))?;
        }
        if let Some(radius) = self.curvature_radius_over_wavelength {
            write!(f, "; R cos^3(theta) / lambda = {}", short(radius))?;
        }
        write!(f, "; each should be above {LARGE}")
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use asperity_surface::HeightField;

    use super::*;

    fn of_field(field: &HeightField, theta: f64, wavelength_nm: Option<f64>) -> Option<Validity> {
        Validity::new(&SurfaceLengths::of_field(field), theta, wavelength_nm)
    }

    /// Waves of amplitude `a` and period 32 along x, spacing 1.
    fn waves(a: f64, unit: LengthUnit) -> HeightField {
        let heights = (0..64 * 64).map(|k| a * (TAU * f64::from(k % 64) / 32.0).sin());
        let field = HeightField::new(heights.collect(), [64, 64], [1.0, 1.0]).unwrap();
        field.with_unit(unit)
    }

    #[test]
    fn numbers_follow_from_lengths_and_angle() {
        let theta = 60_f64.to_radians();
        let found = of_field(&waves(2.0, LengthUnit::Micrometre), theta, Some(500.0));
        let found = found.unwrap();
        // sigma = sqrt 2 um, lambda = 0.5 um
        let rayleigh = 4.0 * PI * 2_f64.sqrt() * 0.5 / 0.5;
        assert!((found.rayleigh_parameter / rayleigh - 1.0).abs() < 1e-12);
        // Second differences of a sine: 2 (1 - cos k) of it
        let curvature = 2_f64.sqrt() * 2.0 * (1.0 - (TAU / 32.0).cos());
        let radius = 0.125 / (curvature * 0.5);
        let ratio = found.curvature_radius_over_wavelength.unwrap() / radius;
        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        assert!(found.holds == Some(true) && !found.wavelength_is_assumed);
        assert!(found.to_string().starts_with("lengths are large"));
    }

    #[test]
    fn unknown_lengths_leave_the_verdict_open_unless_a_known_one_fails() {
        let of_sigma = |sigma| {
            let lengths = SurfaceLengths {
                sigma,
                tau: None,
                curvature: None,
                unit: LengthUnit::Metre,
            };
            Validity::new(&lengths, 0.0, None).unwrap()
        };
        let high = of_sigma(37.365_127_3);
        assert_eq!(high.holds, None);
        let text = high.to_string();
        assert!(text.contains("its height alone is judged"), "{text}");
        assert!(text.contains("lambda = 8537"), "{text}");
        assert!(!text.contains("lengths are large"), "{text}");
        let shallow = of_sigma(1e-9);
        assert_eq!(shallow.holds, Some(false));
        assert!(shallow.to_string().contains("doubtful"));
    }

    #[test]
    fn shallow_surfaces_are_doubtful_and_unknown_units_are_not_judged() {
        let shallow = of_field(&waves(0.02, LengthUnit::Micrometre), 0.0, None).unwrap();
        assert!(shallow.holds == Some(false) && shallow.wavelength_is_assumed);
        assert!((shallow.coherent_fraction - (-shallow.rayleigh_parameter.powi(2)).exp()) == 0.0);
        let text = shallow.to_string();
        assert!(
            text.contains("doubtful") && text.contains("550 nm, assumed"),
            "{text}"
        );
        assert!(text.contains("% of reflected light coherent"), "{text}");
        assert_eq!(
            of_field(&waves(1.0, LengthUnit::Arbitrary), 0.0, None),
            None
        );
        assert_eq!(of_field(&waves(0.0, LengthUnit::Metre), 0.0, None), None);
        // The same lengths in another unit
        let metres = HeightField::new(
            waves(0.02, LengthUnit::Metre)
                .heights()
                .iter()
                .map(|h| h * 1e-6)
                .collect(),
            [64, 64],
            [1e-6, 1e-6],
        );
        let metres = metres.unwrap().with_unit(LengthUnit::Metre);
        let same = of_field(&metres, 0.0, None).unwrap();
        assert!((same.rayleigh_parameter / shallow.rayleigh_parameter - 1.0).abs() < 1e-12);
    }
}
