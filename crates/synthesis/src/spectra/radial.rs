//! Radial spectra: those that depend on the wave number alone once both axes are measured in correlation lengths.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::error::{PsdError, positive};
use super::matern::Matern;
use super::power_law::PowerLaw;
use super::profile::Profile;
use super::radial_table::RadialTable;
use asperity_numerics::elementary::exp;
use asperity_numerics::root;

/// A spectrum `W = sigma^2 tau_x tau_y f(kappa)` with `kappa^2 = (tau_x k_u)^2 + (tau_y k_v)^2`, in axes turned by an azimuth, where
/// the integral of `f` over the plane is 1. Made by [`Psd::matern`](super::psd::Psd::matern) and its fellows, which check its parameters.
///
/// The autocorrelation is a function of `(u / tau_x)^2 + (v / tau_y)^2`, and 1/e where that is 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialPsd {
    /// Root mean square height, length units.
    sigma: f64,
    /// 1/e correlation lengths and their axes.
    #[serde(flatten)]
    axes: Axes,
    /// Profile by which the density falls.
    profile: Profile,
}

impl RadialPsd {
    /// Matern's family, isotropic: `cut_off` is a wavelength.
    pub(super) fn matern(
        sigma: f64,
        tau: f64,
        nu: f64,
        cut_off: Option<f64>,
    ) -> Result<Self, PsdError> {
        positive("sigma", sigma)?;
        positive("tau", tau)?;
        if let Some(cut_off) = cut_off {
            positive("cut_off", cut_off)?;
            if cut_off > MAX_CUT_OFF * tau {
                return Err(PsdError::LongCutOff { cut_off, tau });
            }
        }
        let largest = cut_off.map(|wavelength| TAU * tau / wavelength);
        let with = |scale: f64| Matern::new(nu, scale, largest);
        with(1.0)?;
        // The scale whose autocorrelation is 1/e at one correlation length
        let above = |logarithm: f64| {
            let at_one = |matern| Profile::Matern(matern).autocorrelation(1.0);
            with(exp(logarithm)).map_or(f64::NAN, at_one) - exp(-1.0_f64)
        };
        let scale = exp(root(above, -6.0, 4.0));
        Ok(Self {
            sigma,
            axes: Axes::isotropic(tau),
            profile: Profile::Matern(with(scale)?),
        })
    }

    /// A power law, isotropic: `roll_off` and `cut_off` are wavelengths.
    pub(super) fn power_law(
        sigma: f64,
        hurst: f64,
        roll_off: f64,
        cut_off: f64,
    ) -> Result<Self, PsdError> {
        positive("sigma", sigma)?;
        positive("roll_off", roll_off)?;
        positive("cut_off", cut_off)?;
        if cut_off >= roll_off {
            return Err(PsdError::CutOffBeyondRollOff { cut_off, roll_off });
        }
        let law = PowerLaw::new(hurst, TAU / roll_off, TAU / cut_off)?;
        Ok(Self::of_profile(sigma, Profile::PowerLaw(law)))
    }

    /// A measured table, whose root mean square height is its own unless another is given.
    pub(super) fn table(table: RadialTable, sigma: Option<f64>) -> Result<Self, PsdError> {
        let own = table.moment(0, f64::INFINITY).sqrt();
        let sigma = sigma.unwrap_or(own);
        positive("sigma", sigma)?;
        Ok(Self::of_profile(sigma, Profile::Table(table)))
    }

    /// An isotropic spectrum of a profile in wave numbers of the length unit.
    fn of_profile(sigma: f64, profile: Profile) -> Self {
        let tau = profile.one_over_e_lag();
        Self {
            sigma,
            axes: Axes::isotropic(tau),
            profile: profile.scaled(tau),
        }
    }

    pub(super) fn with_sigma(self, sigma: f64) -> Self {
        Self { sigma, ..self }
    }

    pub(super) fn sigma(&self) -> f64 {
        self.sigma
    }

    pub(super) const fn axes(&self) -> &Axes {
        &self.axes
    }

    /// Returns the spectrum along other axes.
    pub(super) fn with_axes(&self, axes: Axes) -> Self {
        Self {
            axes,
            ..self.clone()
        }
    }

    /// Mark of [`Psd::mark`](super::psd::Psd): the mean square of kappa.
    pub(super) fn mark(&self) -> Option<u32> {
        match &self.profile {
            Profile::Table(_) => {
                let square = self.profile.total(2) / self.profile.total(0);
                Some((square as f32).to_bits())
            }
            Profile::Matern(_) | Profile::PowerLaw(_) => None,
        }
    }

    pub(super) fn prepared(&self) -> PreparedRadial {
        let [tau_x, tau_y] = self.axes.lengths();
        PreparedRadial {
            peak: self.sigma * self.sigma * tau_x * tau_y / self.profile.total(0),
            form: self.axes.square_form(),
            cut_off: self.profile.cut_off(),
            profile: self.profile.clone(),
        }
    }

    pub(super) fn reach(&self) -> [f64; 2] {
        self.axes
            .axis_lengths()
            .map(|length| self.profile.cut_off() / length)
    }

    pub(super) fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        self.sigma * self.sigma * self.profile.autocorrelation(self.axes.distance(x, y))
    }

    pub(super) fn slope_covariance(&self) -> [f64; 3] {
        // Half the mean square of kappa along each axis
        let along = 0.5 * self.profile.total(2) / self.profile.total(0);
        self.axes.covariance(self.sigma * self.sigma * along)
    }

    /// Three eighths of the mean fourth power of kappa along an axis.
    pub(super) fn curvature(&self) -> f64 {
        let [tau_x, tau_y] = self.axes.lengths();
        let mean = self.profile.total(4) / self.profile.total(0);
        self.sigma * (0.375 * mean).sqrt() / tau_x.min(tau_y).powi(2)
    }

    /// Wavelengths along x and y below which waves hold `fraction` of the slope variance.
    pub(super) fn wavelengths_holding(&self, fraction: f64) -> [f64; 2] {
        let kappa = self.profile.holding(fraction);
        self.axes.axis_lengths().map(|length| TAU * length / kappa)
    }

    /// `8 pi^2` times the integral of `W^2`, over `sigma^4`: an area, whose ratio to that of a tile is the variance of the mean
    /// square height of one, relative to its square.
    pub(super) fn correlation_area(&self) -> f64 {
        let [tau_x, tau_y] = self.axes.lengths();
        let all = self.profile.total(0);
        8.0 * PI * PI * tau_x * tau_y * self.profile.square_integral() / (all * all)
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            sigma: convert(self.sigma),
            axes: self.axes.converted(convert),
            profile: self.profile.clone(),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        positive("sigma", self.sigma).is_ok() && self.axes.is_valid() && self.profile.is_valid()
    }
}

/// Longest cut-off in correlation lengths: with waves that are longer alone the autocorrelation does not fall to 1/e in time.
const MAX_CUT_OFF: f64 = 2.0;

/// `W(k) = peak f(kappa)`, with everything precomputed that does not depend on the wave vector.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRadial {
    peak: f64,
    /// `kappa^2 = form . [kx kx, kx ky, ky ky]`
    form: [f64; 3],
    cut_off: f64,
    profile: Profile,
}

impl PreparedRadial {
    pub(super) fn at(&self, kx: f64, ky: f64) -> f64 {
        let [xx, xy, yy] = self.form;
        let square = xx * kx * kx + xy * kx * ky + yy * ky * ky;
        self.peak * self.profile.at_square(square)
    }

    /// Largest `|ky|` within the cut-off for this `kx`.
    pub(super) fn reach_along_y(&self, kx: f64) -> Option<f64> {
        if self.cut_off.is_infinite() {
            return Some(f64::INFINITY);
        }
        let [xx, xy, yy] = self.form;
        let b = (xy * kx).abs();
        let discriminant = b * b - 4.0 * yy * (xx * kx * kx - self.cut_off * self.cut_off);
        (discriminant >= 0.0).then(|| (b + discriminant.sqrt()) / (2.0 * yy))
    }
}
