//! Laws: formulas of the BSDF with few parameters, as programs without tables take them.

use std::f64::consts::PI;

use asperity_analysis::{BsdfModel, Ggx, Masking, SlopeCovariance, Smith};
use asperity_numerics::elementary::{exp, ln, pow};
use asperity_optics::Material;
use asperity_simulate::Outcome;
use asperity_surface::LengthUnit;
use asperity_tally::Side;

use super::points::{Point, Ray};

/// A formula with values for its parameters.
pub(super) type Formula = Box<dyn Fn(&Ray) -> f64>;

/// Constructor of a formula from the fitted logarithms; `None` if these describe no lobe.
type FormulaOf = Box<dyn Fn(&[f64]) -> Option<Formula>>;

/// Name of a parameter, and its value by the fitted logarithm.
type Parameter = (&'static str, fn(f64) -> f64);

/// A law, whose parameters are fitted by their logarithms.
pub(super) struct Law {
    pub(super) name: &'static str,
    /// Formula in words of the file.
    pub(super) formula: &'static str,
    /// Sentence on what the law neglects.
    pub(super) neglects: &'static str,
    pub(super) parameters: &'static [Parameter],
    /// Logarithms from which the fit begins; the best minimum counts.
    pub(super) starts: Vec<Vec<f64>>,
    /// `true` if bins count by the light that they hold.
    pub(super) by_flux: bool,
    /// `false` if the fitted logarithms give no finite peak or flux.
    pub(super) is_lobe: fn(&[f64]) -> bool,
    pub(super) of: FormulaOf,
}

/// A law that is not fitted, and why.
pub(super) struct Skipped {
    pub(super) name: &'static str,
    pub(super) reason: &'static str,
}

/// Material, wavelength and unit of the outcomes to which laws are fitted.
pub(super) struct Fitted<'a> {
    pub(super) outcomes: &'a [&'a Outcome],
    pub(super) points: &'a [Point],
    pub(super) side: Side,
}

const SAME_AT_ALL_ANGLES: &str = "Fresnel's equations, shadowing and lobes off the specular direction: the lobe is the same at all angles of incidence";

const POSITIVE: fn(f64) -> f64 = exp;

/// Slope at which the laws of three parameters end: steeper ones are Gaussian, and do not determine slope and width.
const STEEPEST: f64 = 50.0;

/// Width of the narrowest lobes, in projected directions.
const NARROWEST: f64 = 1e-6;

/// A slope by its logarithm.
const SLOPE: fn(f64) -> f64 = |log| exp(log).min(STEEPEST);

impl Fitted<'_> {
    /// All laws, in the order of the file.
    pub(super) fn laws(&self) -> Vec<Result<Law, Skipped>> {
        vec![
            Ok(self.abg()),
            Ok(self.harvey_shack()),
            self.k_correlation(),
            self.microfacets("ggx", |slopes, material| {
                Smith::of_ggx(Ggx::new(slopes), material, Masking::HeightCorrelated).ok()
            }),
            self.microfacets("beckmann", |slopes, material| {
                Smith::new(slopes, material, Masking::HeightCorrelated).ok()
            }),
        ]
    }

    pub(super) fn abg(&self) -> Law {
        let (peak, width) = self.peak_and_width();
        Law {
            name: "abg",
            formula: "A / (B + |beta - beta0|^g), in 1/sr",
            neglects: SAME_AT_ALL_ANGLES,
            parameters: &[("A", POSITIVE), ("B", POSITIVE), ("g", SLOPE)],
            starts: [1.5_f64, 3.0]
                .map(|g| vec![ln(peak * pow(width, g)), g * ln(width), ln(g)])
                .to_vec(),
            by_flux: false,
            is_lobe: |logs| logs[1] > SLOPE(logs[2]) * ln(NARROWEST),
            of: Box::new(|logs| {
                let [a, b, g] = [exp(logs[0]), exp(logs[1]), SLOPE(logs[2])];
                Some(Box::new(move |ray| a / (b + pow(ray.distance, g))))
            }),
        }
    }

    pub(super) fn harvey_shack(&self) -> Law {
        let (peak, width) = self.peak_and_width();
        Law {
            name: "harvey-shack",
            formula: "b0 (1 + (|beta - beta0| / L)^2)^(s / 2), in 1/sr",
            neglects: SAME_AT_ALL_ANGLES,
            parameters: &[("b0", POSITIVE), ("L", POSITIVE), ("s", |log| -SLOPE(log))],
            starts: [1.5_f64, 4.0]
                .map(|slope| vec![ln(peak), ln(width), ln(slope)])
                .to_vec(),
            by_flux: false,
            is_lobe: |logs| logs[1] > ln(NARROWEST),
            of: Box::new(|logs| {
                let [b0, l, slope] = [exp(logs[0]), exp(logs[1]), SLOPE(logs[2])];
                let shape = move |x: f64| pow(1.0 + (x / l).powi(2), -0.5 * slope);
                Some(Box::new(move |ray| b0 * shape(ray.distance)))
            }),
        }
    }

    /// Scatter of smooth surfaces, by Rayleigh and Rice, with the K-correlation (ABC) power spectrum.
    ///
    /// # Source
    /// Church and Takacs 1991; Dittman 2006, K-correlation power spectral density and surface scatter model.
    fn k_correlation(&self) -> Result<Law, Skipped> {
        let skipped = |reason| {
            let name = "k-correlation";
            Err(Skipped { name, reason })
        };
        let case = &self.outcomes[0].case;
        if self.side == Side::Transmitted {
            return skipped("fitted to reflected light alone");
        }
        let Some(wavelength) = case.at.wavelength_nm() else {
            return skipped("needs a wavelength: measure with --wavelength and a material by name");
        };
        if case.at.unit.conversion(LengthUnit::Metre).is_none() {
            return skipped("needs lengths of the surface with a unit");
        }
        let wavelength = wavelength / case.at.index_above.unwrap_or(1.0);
        let material = case.material;
        let (peak, width) = self.peak_and_width();
        let scale = 16.0 * PI * PI / wavelength.powi(4);
        // B by the width of the lobe, sigma by its peak, with all light reflected
        let b = wavelength / width;
        let starts = [1.0_f64, 4.0].map(|excess| {
            let sigma = (peak * 2.0 * PI / (scale * b * b * excess)).sqrt();
            vec![ln(sigma), ln(b), ln(excess)]
        });
        Ok(Law {
            name: "k-correlation",
            formula: "16 pi^2 / lambda^4 cos(theta_i) cos(theta_o) F(theta_i) PSD(f), f = |beta - beta0| / lambda, PSD = sigma^2 B^2 (s - 2) / (2 pi) / (1 + (B f)^2)^(s / 2); the correlation length is B / (2 pi)",
            neglects: "everything that is not the first order of a smooth surface: where 4 pi sigma cos(theta_i) / lambda is not well below 1, sigma and B describe the lobe, not the surface",
            parameters: &[
                ("sigma_nm", POSITIVE),
                ("B_nm", POSITIVE),
                ("s", |log| 2.0 + SLOPE(log)),
            ],
            starts: starts.to_vec(),
            by_flux: false,
            // With a slope of 2 the roughness is not finite
            is_lobe: |logs| SLOPE(logs[2]) > 1e-3,
            of: Box::new(move |logs| {
                let [sigma, b, excess] = [exp(logs[0]), exp(logs[1]), SLOPE(logs[2])];
                let psd = move |f: f64| {
                    let shape = pow(1.0 + (b * f).powi(2), -1.0 - 0.5 * excess);
                    (sigma * b).powi(2) * excess / (2.0 * PI) * shape
                };
                Some(Box::new(move |ray| {
                    let fresnel = material.fresnel(ray.wi.z).reflected;
                    scale * ray.wi.z * ray.wo.z * fresnel * psd(ray.distance / wavelength)
                }))
            }),
        })
    }

    /// Microfacets: `alpha` of all azimuths, or one along each axis where light comes from several azimuths.
    fn microfacets(
        &self,
        name: &'static str,
        model: fn(SlopeCovariance, Material) -> Option<Smith>,
    ) -> Result<Law, Skipped> {
        let skipped = |reason| Err(Skipped { name, reason });
        let case = &self.outcomes[0].case;
        let material = case.material;
        if !case.layers.is_empty() {
            return skipped("describes one surface, without layers below it");
        }
        let slopes = |logs: &[f64]| {
            let half = |log: f64| 0.5 * exp(2.0 * log);
            SlopeCovariance::new(half(logs[0]), half(*logs.last()?), 0.0).ok()
        };
        if slopes(&[0.0])
            .and_then(|slopes| model(slopes, material))
            .is_none()
        {
            return skipped("describes facets that reflect as mirrors or refract");
        }
        let mut azimuths: Vec<f64> = self
            .outcomes
            .iter()
            .map(|outcome| outcome.case.light.incidence.phi_deg())
            .collect();
        azimuths.dedup();
        let has_axes = azimuths.len() > 1;
        let starts = [0.05_f64, 0.3, 1.0].map(|alpha| match has_axes {
            true => vec![ln(alpha); 2],
            false => vec![ln(alpha)],
        });
        Ok(Law {
            name,
            formula: "F D G2 / (4 cos(theta_i) cos(theta_o)) of reflection, and its counterpart of refraction (Walter et al. 2007), with height-correlated Smith masking and the index of the material",
            neglects: "light that meets the surface more than once, and every slope distribution but its own",
            parameters: match has_axes {
                true => &[("alpha_x", POSITIVE), ("alpha_y", POSITIVE)],
                false => &[("alpha", POSITIVE)],
            },
            starts: starts.to_vec(),
            by_flux: true,
            is_lobe: |_| true,
            of: Box::new(move |logs| {
                let model = model(slopes(logs)?, material)?;
                Some(Box::new(move |ray| model.bsdf(ray.wi, ray.wo)))
            }),
        })
    }

    /// Largest value, 1/sr, and the distance from the specular direction within which half of the light lies.
    fn peak_and_width(&self) -> (f64, f64) {
        let fitted = || self.points.iter().filter(|point| point.is_fitted());
        let peak = fitted().map(|point| point.mean).fold(0.0, f64::max);
        let light = |point: &Point| (point.rays[0].distance, point.mean * point.projected);
        let mut light: Vec<(f64, f64)> = fitted().map(light).collect();
        light.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = light.iter().map(|(_, flux)| flux).sum();
        let mut sum = 0.0;
        let half = light.iter().find(|(_, flux)| {
            sum += flux;
            sum >= 0.5 * all
        });
        (peak, half.map_or(1.0, |(distance, _)| distance.max(1e-6)))
    }
}
