//! Power spectral density of random surfaces, of any kind.

use asperity_numerics::elementary::{exp, sin_cos};
use asperity_numerics::root;
use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::error::{PsdError, positive};
use super::gaussian::GaussianPsd;
use super::plane::PlanePsd;
use super::prepared::PreparedDensity;
use super::radial::RadialPsd;
use super::radial_table::RadialTable;

/// A two-sided power spectral density of surface height over the angular wave vector.
///
/// # Examples
/// ```
/// use asperity_synthesis::Psd;
///
/// // Root mean square height 0.5, correlation length 2: smoothness tau / sigma = 4
/// let psd = Psd::gaussian(0.5, 2.0)?;
/// // Slope variance per axis 2 / s^2
/// assert_eq!(psd.slope_variance(), [0.125, 0.125]);
/// # Ok::<(), asperity_synthesis::PsdError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Psd {
    /// Gaussian, isotropic or anisotropic.
    Gaussian(GaussianPsd),
    /// Exponential, Matern, power law or a radial table, isotropic or anisotropic.
    Radial(RadialPsd),
    /// A table over the plane of wave vectors.
    Plane(PlanePsd),
    /// The sum of several.
    Sum(SumPsd),
}

impl Psd {
    /// The isotropic Gaussian: root mean square height `sigma`, 1/e correlation length `tau`.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless both are positive and finite.
    pub fn gaussian(sigma: f64, tau: f64) -> Result<Self, PsdError> {
        Self::anisotropic_gaussian(sigma, tau, tau, 0.0)
    }

    /// The anisotropic Gaussian; `azimuth` in radians from +x to the axis of `tau_x`.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless the lengths are positive and finite and the azimuth finite.
    pub fn anisotropic_gaussian(
        sigma: f64,
        tau_x: f64,
        tau_y: f64,
        azimuth: f64,
    ) -> Result<Self, PsdError> {
        for (name, value) in [("tau", tau_x), ("tau_y", tau_y), ("sigma", sigma)] {
            positive(name, value)?;
        }
        if !azimuth.is_finite() {
            return Err(PsdError::BadParameter {
                name: "azimuth",
                value: azimuth,
                allowed: "finite",
            });
        }
        Ok(Self::Gaussian(GaussianPsd {
            sigma,
            tau_x,
            tau_y,
            azimuth,
        }))
    }

    /// The exponential autocorrelation `sigma^2 exp(-r / tau)`, without its waves shorter than `cut_off`: a wavelength, at most twice
    /// `tau`.
    ///
    /// Without a cut-off its slopes would have no finite variance. `sigma` is the root mean square height and `tau` the 1/e length of
    /// the surface that is left.
    ///
    /// # Errors
    /// [`PsdError`] for parameters out of range.
    pub fn exponential(sigma: f64, tau: f64, cut_off: f64) -> Result<Self, PsdError> {
        Self::matern(sigma, tau, 0.5, Some(cut_off))
    }

    /// Matern's family: `W` is proportional to `(1 + k^2 l^2)^(-(nu + 1))` for waves longer than `cut_off`, a wavelength.
    ///
    /// `nu` is above 0, up to 100; up to 1 it needs a cut-off, since the variance of slopes would be infinite. `l` is such that the
    /// autocorrelation of the surface, cut off as it is, falls to 1/e at `tau`.
    ///
    /// # Errors
    /// [`PsdError`] for parameters out of range.
    ///
    /// # Source
    /// M. L. Stein, *Interpolation of Spatial Data*, Springer 1999, section 2.10.
    pub fn matern(sigma: f64, tau: f64, nu: f64, cut_off: Option<f64>) -> Result<Self, PsdError> {
        Ok(Self::Radial(RadialPsd::matern(sigma, tau, nu, cut_off)?))
    }

    /// A self-affine surface: `W` is level for waves longer than `roll_off`, falls as `k^(-2 (hurst + 1))` for shorter ones, and is zero
    /// for those shorter than `cut_off`; both are wavelengths. Its correlation length follows.
    ///
    /// # Errors
    /// [`PsdError`] for parameters out of range: `hurst` is above 0, up to 1.
    ///
    /// # Source
    /// T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001.
    pub fn power_law(
        sigma: f64,
        hurst: f64,
        roll_off: f64,
        cut_off: f64,
    ) -> Result<Self, PsdError> {
        Ok(Self::Radial(RadialPsd::power_law(
            sigma, hurst, roll_off, cut_off,
        )?))
    }

    /// An isotropic surface of a measured spectrum. Without `sigma`, the root mean square height is that of the table.
    ///
    /// # Errors
    /// [`PsdError`] if sigma is not positive and finite.
    pub fn of_radial_table(table: RadialTable, sigma: Option<f64>) -> Result<Self, PsdError> {
        Ok(Self::Radial(RadialPsd::table(table, sigma)?))
    }

    /// A surface of a spectrum that was measured over the plane of wave vectors, bilinear between them. `kx`, `ky`: radians per length
    /// unit, ascending; `density`: rows of equal `ky`, length units to the fourth. A table of `ky >= 0` alone stands for all
    /// wave vectors. Without `sigma`, the root mean square height is that of the table.
    ///
    /// # Errors
    /// [`PsdError::Table`] if the table is malformed.
    pub fn of_plane_table(
        kx: Vec<f64>,
        ky: Vec<f64>,
        density: Vec<f64>,
        sigma: Option<f64>,
    ) -> Result<Self, PsdError> {
        Ok(Self::Plane(PlanePsd::new(kx, ky, density, sigma)?))
    }

    /// The spectrum of the sum of two independent surfaces, none of which is such a sum.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self::Sum(SumPsd::new(self, other))
    }

    /// Returns the spectrum with another root mean square height.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless it is positive and finite.
    pub fn with_sigma(self, sigma: f64) -> Result<Self, PsdError> {
        positive("sigma", sigma)?;
        Ok(match self {
            Self::Gaussian(gaussian) => Self::Gaussian(GaussianPsd { sigma, ..gaussian }),
            Self::Radial(radial) => Self::Radial(radial.with_sigma(sigma)),
            Self::Plane(plane) => Self::Plane(plane.with_sigma(sigma)),
            Self::Sum(sum) => Self::Sum(sum.with_sigma(sigma)?),
        })
    }

    /// Returns the spectrum stretched along a second axis, so that the correlation length along it is `tau_y`, and turned: `azimuth` in radians
    /// from +x to the first axis. Tables over the plane and sums stay as they are.
    ///
    /// # Errors
    /// [`PsdError::BadParameter`] unless the length is positive and finite and the azimuth finite.
    pub fn stretched(self, tau_y: f64, azimuth: f64) -> Result<Self, PsdError> {
        let [tau_x, _] = self.correlation_lengths();
        let checked = Self::anisotropic_gaussian(self.sigma(), tau_x, tau_y, azimuth)?;
        Ok(match self {
            Self::Gaussian(_) => checked,
            Self::Radial(radial) => {
                Self::Radial(radial.with_axes(Axes::new(tau_x, tau_y, azimuth)))
            }
            other => other,
        })
    }

    /// A number that tells spectra of measured tables from each other; `None` of others. It is the same in all units, and for any root
    /// mean square height.
    pub(crate) fn mark(&self) -> Option<u32> {
        match self {
            Self::Gaussian(_) => None,
            Self::Radial(radial) => radial.mark(),
            Self::Plane(plane) => Some(plane.mark()),
            Self::Sum(sum) => sum.mark(),
        }
    }

    /// `W(kx, ky)` in length units to the fourth; `kx`, `ky` in radians per length unit.
    #[must_use]
    pub fn density(&self, kx: f64, ky: f64) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.density(kx, ky),
            Self::Radial(radial) => radial.prepared().at(kx, ky),
            Self::Plane(plane) => plane.density(kx, ky),
            Self::Sum(sum) => sum.parts().iter().map(|part| part.density(kx, ky)).sum(),
        }
    }

    /// The density, with everything precomputed that does not depend on the wave vector.
    pub(crate) fn prepared(&self) -> PreparedDensity {
        match self {
            Self::Gaussian(gaussian) => PreparedDensity::Gaussian(gaussian.prepared()),
            Self::Radial(radial) => PreparedDensity::Radial(radial.prepared()),
            Self::Plane(plane) => PreparedDensity::Plane(plane.clone()),
            Self::Sum(sum) => {
                PreparedDensity::Sum(sum.parts().iter().map(Self::prepared).collect())
            }
        }
    }

    /// Largest `[|kx|, |ky|]` at which the density is `fraction` of its peak, radians per length unit, or its cut-off; infinite without
    /// either.
    pub(crate) fn reach(&self, fraction: f64) -> [f64; 2] {
        match self {
            Self::Gaussian(gaussian) => gaussian.reach(fraction),
            Self::Radial(radial) => radial.reach(),
            Self::Plane(plane) => plane.reach(),
            Self::Sum(sum) => sum.largest(|part| part.reach(fraction)),
        }
    }

    /// Root mean square height.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.sigma(),
            Self::Radial(radial) => radial.sigma(),
            Self::Plane(plane) => plane.sigma(),
            Self::Sum(sum) => sum.root_sum(Self::sigma),
        }
    }

    /// The principal axes.
    fn axes(&self) -> Axes {
        match self {
            Self::Gaussian(gaussian) => gaussian.axes(),
            Self::Radial(radial) => *radial.axes(),
            Self::Plane(plane) => *plane.axes(),
            Self::Sum(sum) => *sum.axes(),
        }
    }

    /// 1/e correlation lengths along the two principal axes.
    #[must_use]
    pub fn correlation_lengths(&self) -> [f64; 2] {
        self.axes().lengths()
    }

    /// The correlation length along the second principal axis over that along the first, and the angle from +x
    /// to the first, radians; `None` if it [is isotropic](Self::is_isotropic).
    #[must_use]
    pub fn anisotropy(&self) -> Option<[f64; 2]> {
        self.axes().anisotropy()
    }

    /// Returns `true` if the statistics do not depend on azimuth.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Plane(_) => false,
            other => other.axes().is_isotropic(),
        }
    }

    /// Lags along x and along y at which the autocorrelation is 1/e of its peak, length units:
    /// `[tau_x, tau_y]` if the azimuth is zero.
    #[must_use]
    pub fn axis_correlation_lengths(&self) -> [f64; 2] {
        match self {
            Self::Gaussian(_) | Self::Radial(_) => self.axes().axis_lengths(),
            Self::Plane(plane) => plane.axis_lengths(),
            Self::Sum(sum) => sum.axis_lengths(),
        }
    }

    /// Farthest reach along x and along y of the contour on which the autocorrelation is 1/e of its
    /// peak, length units: `[tau_x, tau_y]` if the azimuth is zero. Of sums, the largest of their parts.
    #[must_use]
    pub fn correlation_extents(&self) -> [f64; 2] {
        match self {
            Self::Sum(sum) => sum.largest(Self::correlation_extents),
            other => other.axes().extents(),
        }
    }

    /// Returns `true` if the statistics are the same on either side of the x axis, and so of the y axis.
    #[must_use]
    pub fn is_mirror_symmetric(&self) -> bool {
        match self {
            Self::Plane(_) => false,
            Self::Sum(sum) => sum.parts().iter().all(Self::is_mirror_symmetric),
            other => other.axes().is_mirror_symmetric(),
        }
    }

    /// Largest root mean square second derivative along a line, per length unit: `sqrt(12) sigma / tau^2` of a
    /// Gaussian, `tau` being the shorter correlation length; infinite where the spectrum falls too slowly.
    #[must_use]
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.curvature(),
            Self::Radial(radial) => radial.curvature(),
            Self::Plane(plane) => plane.curvature(),
            Self::Sum(sum) => sum.root_sum(Self::curvature),
        }
    }

    /// Spectra that a grid has to resolve each: the parts of a sum, or this one.
    pub(crate) fn parts(&self) -> &[Self] {
        match self {
            Self::Sum(sum) => sum.parts(),
            other => std::slice::from_ref(other),
        }
    }

    /// Wavelengths along x and y below which waves hold `fraction` of the slope variance; `None` of a Gaussian, which is resolved
    /// where its correlation length is, and of a sum.
    #[must_use]
    pub fn wavelengths_holding(&self, fraction: f64) -> Option<[f64; 2]> {
        match self {
            Self::Gaussian(_) | Self::Sum(_) => None,
            Self::Radial(radial) => Some(radial.wavelengths_holding(fraction)),
            Self::Plane(plane) => Some(plane.wavelengths_holding(fraction)),
        }
    }

    /// Spacing along x and y of the surface that it was measured on; `None` of all others.
    #[must_use]
    pub const fn sampled(&self) -> Option<[f64; 2]> {
        match self {
            Self::Plane(plane) => plane.sampled(),
            _ => None,
        }
    }

    /// `8 pi^2` times the integral of `W^2`, over `sigma^4`, length units squared: the variance of the mean square height of a tile,
    /// relative to its square, is this over the area of the tile. `pi tau_x tau_y` of a Gaussian; `None` where it is not known.
    #[must_use]
    pub fn correlation_area(&self) -> Option<f64> {
        match self {
            Self::Gaussian(gaussian) => {
                Some(std::f64::consts::PI * gaussian.tau_x * gaussian.tau_y)
            }
            Self::Radial(radial) => Some(radial.correlation_area()),
            Self::Plane(plane) => Some(plane.correlation_area()),
            Self::Sum(_) => None,
        }
    }

    /// Returns the spectrum with all lengths converted.
    pub(crate) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        match self {
            Self::Gaussian(gaussian) => Self::Gaussian(gaussian.converted(convert)),
            Self::Radial(radial) => Self::Radial(radial.converted(convert)),
            Self::Plane(plane) => Self::Plane(plane.converted(convert)),
            Self::Sum(sum) => Self::Sum(sum.converted(convert)),
        }
    }

    /// Returns `true` if all numbers are in range, for what was read from a file.
    pub(crate) fn is_valid(&self) -> bool {
        match self {
            Self::Gaussian(gaussian) => {
                self.axes().is_valid() && positive("sigma", gaussian.sigma).is_ok()
            }
            Self::Radial(radial) => radial.is_valid(),
            Self::Plane(plane) => plane.is_valid(),
            Self::Sum(sum) => sum.is_valid(),
        }
    }

    /// Autocorrelation `C(x, y)` at the lag `(x, y)`, length units squared: closed of a Gaussian, by quadrature of others.
    #[must_use]
    pub fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.autocorrelation(x, y),
            Self::Radial(radial) => radial.autocorrelation(x, y),
            Self::Plane(plane) => plane.autocorrelation(x, y),
            Self::Sum(sum) => sum.autocorrelation(x, y),
        }
    }

    /// Slope variances along x and y, `[-C_xx(0), -C_yy(0)]`, of the continuous surface.
    #[must_use]
    pub fn slope_variance(&self) -> [f64; 2] {
        let [xx, _, yy] = self.slope_covariance();
        [xx, yy]
    }

    /// Covariance `[xx, xy, yy]` of the slopes of the continuous surface, dimensionless:
    /// `[-C_xx(0), -C_xy(0), -C_yy(0)]`. Along a principal axis of correlation length `tau` it is
    /// `2 sigma^2 / tau^2` of a Gaussian.
    ///
    /// The covariance of the facets of a mesh is
    /// [`Synthesis::facet_slope_covariance`](crate::Synthesis::facet_slope_covariance).
    #[must_use]
    pub fn slope_covariance(&self) -> [f64; 3] {
        match self {
            Self::Gaussian(gaussian) => gaussian.slope_covariance(),
            Self::Radial(radial) => radial.slope_covariance(),
            Self::Plane(plane) => plane.slope_covariance(),
            Self::Sum(sum) => sum.slope_covariance(),
        }
    }
}

/// The sum of spectra: the surface is the sum of independent ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SumPsd {
    parts: Vec<Psd>,
    /// 1/e correlation lengths along the axes of the first anisotropic part.
    axes: Axes,
    /// 1/e correlation lengths along x and y.
    along: [f64; 2],
}

impl SumPsd {
    /// The sum of at least one spectrum.
    fn new(first: Psd, second: Psd) -> Self {
        let parts = vec![first, second];
        let anisotropic = parts.iter().find_map(Psd::anisotropy);
        let azimuth = anisotropic.map_or(0.0, |[_, azimuth]| azimuth);
        let mut sum = Self {
            parts,
            axes: Axes::isotropic(1.0),
            along: [1.0; 2],
        };
        let (sin, cos) = sin_cos(azimuth);
        let first = sum.lag_along(cos, sin);
        sum.axes = match anisotropic {
            None => Axes::isotropic(first),
            Some(_) => Axes::new(first, sum.lag_along(-sin, cos), azimuth),
        };
        sum.along = match anisotropic {
            None => [first; 2],
            Some(_) => [sum.lag_along(1.0, 0.0), sum.lag_along(0.0, 1.0)],
        };
        sum
    }

    /// All parts scaled alike.
    fn with_sigma(self, sigma: f64) -> Result<Self, PsdError> {
        let scale = sigma / self.root_sum(Psd::sigma);
        let parts = self.parts.into_iter().map(|part| {
            let own = part.sigma();
            part.with_sigma(scale * own)
        });
        Ok(Self {
            parts: parts.collect::<Result<_, _>>()?,
            ..self
        })
    }

    /// Mark of [`Psd::mark`], of the first part that has one.
    fn mark(&self) -> Option<u32> {
        self.parts.iter().find_map(Psd::mark)
    }

    fn parts(&self) -> &[Psd] {
        &self.parts
    }

    const fn axes(&self) -> &Axes {
        &self.axes
    }

    const fn axis_lengths(&self) -> [f64; 2] {
        self.along
    }

    /// The root of the sum of squares of a number that each part has.
    fn root_sum(&self, of: impl Fn(&Psd) -> f64) -> f64 {
        self.parts
            .iter()
            .map(|part| of(part).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// The larger of what parts have along each axis.
    fn largest(&self, of: impl Fn(&Psd) -> [f64; 2]) -> [f64; 2] {
        let each = self.parts.iter().map(of);
        each.fold([0.0; 2], |[x, y], [a, b]| [x.max(a), y.max(b)])
    }

    fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        self.parts
            .iter()
            .map(|part| part.autocorrelation(x, y))
            .sum()
    }

    fn slope_covariance(&self) -> [f64; 3] {
        let each = self.parts.iter().map(Psd::slope_covariance);
        each.fold([0.0; 3], |sum, term| [0, 1, 2].map(|i| sum[i] + term[i]))
    }

    fn lag_along(&self, cos: f64, sin: f64) -> f64 {
        let variance = self.autocorrelation(0.0, 0.0);
        let below = |r: f64| self.autocorrelation(r * cos, r * sin) / variance - exp(-1.0_f64);
        // Between the shortest and the longest of the parts, whose sum is on either side of 1/e there
        let lags = self.parts.iter().map(|part| {
            let [x, y] = part.axis_correlation_lengths();
            (x.min(y), x.max(y))
        });
        let (low, high) = lags.fold((f64::INFINITY, 0.0_f64), |(low, high), (a, b)| {
            (low.min(0.5 * a), high.max(2.0 * b))
        });
        let mut low = low;
        while below(1.2 * low) > 0.0 && low < high {
            low *= 1.2;
        }
        root(below, low, 1.2 * low)
    }

    fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            parts: self
                .parts
                .iter()
                .map(|part| part.converted(convert))
                .collect(),
            axes: self.axes.converted(convert),
            along: self.along.map(convert),
        }
    }

    /// With one level of parts alone, so that a file cannot nest them without end.
    fn is_valid(&self) -> bool {
        let is_part = |part: &Psd| !matches!(part, Psd::Sum(_)) && part.is_valid();
        self.axes.is_valid()
            && self.along.iter().all(|x| x.is_finite() && *x > 0.0)
            && !self.parts.is_empty()
            && self.parts.iter().all(is_part)
    }
}
