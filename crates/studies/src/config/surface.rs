//! `[surface]`: the random surfaces, and the cells of any.

use asperity_simulate::Cells;
use asperity_surface::LengthUnit;
use asperity_synthesis::{Psd, UNRESOLVED_SLOPES};
use serde::{Deserialize, Serialize};

use super::structure_memo::StructureMemo;
use super::surface_choices::{HeightsChoice, SpectrumChoice, SpectrumName, SurfaceFiles};
use super::surface_error::SurfaceError;
use crate::config::structure::StructureConfig;
use crate::config::values::{Auto, Count, Number, OneOrMany, OrAuto, PerAxis};

/// Correlation lengths along the side of a tile whose size is not given.
const TILE: f64 = 32.0;

/// Correlation length of the amplitude of GGX slopes over that of the surface, unless given.
const DEFAULT_AMPLITUDE_RATIO: f64 = 8.0;

/// Largest smoothness. Lobes are then a few millionths of a radian wide; quadrature does not resolve narrower ones.
pub(crate) const MAX_SMOOTHNESS: f64 = 1e6;

/// The cells of a surface, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CellsChoice(OrAuto<Cells>);

impl Default for CellsChoice {
    fn default() -> Self {
        Self(OrAuto::Auto(Auto::Auto))
    }
}

impl CellsChoice {
    /// Of random surfaces, whose heights between the samples are known: smooth unless others are named.
    #[must_use]
    pub const fn of_random(self) -> Cells {
        match self.0.named() {
            Some(cells) => cells,
            None => Cells::Smooth,
        }
    }

    /// Of a given surface, about which a spline would assume more than its samples tell: flat unless others are named.
    #[must_use]
    pub const fn of_given(self) -> Cells {
        match self.0.named() {
            Some(cells) => cells,
            None => Cells::Flat,
        }
    }
}

/// A distribution of slopes by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SlopesName {
    /// Slopes of Gaussian heights.
    #[default]
    Gaussian,
    /// Long tails.
    Ggx,
}

impl SlopesName {
    fn is_gaussian(&self) -> bool {
        *self == Self::Gaussian
    }
}

/// `[surface]`: the random surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceConfig {
    /// Power spectral density.
    #[serde(default, skip_serializing_if = "SpectrumChoice::is_gaussian")]
    pub psd: SpectrumChoice,
    /// Distribution of heights, if it is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights: Option<HeightsChoice>,
    /// Contents of files.
    #[serde(
        default,
        skip_deserializing,
        skip_serializing_if = "SurfaceFiles::is_empty"
    )]
    pub files: SurfaceFiles,
    /// Parameter of Matern's family.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nu: Option<Number>,
    /// Hurst exponent of a power law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hurst: Option<Number>,
    /// Wavelength beyond which a power law is level, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roll_off: Option<Number>,
    /// Wavelength of the shortest waves, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut_off: Option<Number>,
    /// Root mean square height of a second scale that is added, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_sigma: Option<Number>,
    /// Correlation length of the second scale, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_tau: Option<Number>,
    /// Skewness of the heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skewness: Option<Number>,
    /// Kurtosis of the heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kurtosis: Option<Number>,
    /// Distribution of slopes.
    #[serde(default, skip_serializing_if = "SlopesName::is_gaussian")]
    pub slopes: SlopesName,
    /// Roughness of GGX slopes, one or several; instead of `smoothness`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ggx_alpha: Option<OneOrMany<Number>>,
    /// Correlation length of the amplitude of GGX slopes over that of the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude_ratio: Option<Number>,
    /// 1/e correlation length, length units; none where it follows from the spectrum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tau: Option<Number>,
    /// Correlation length along the second principal axis, if it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tau_y: Option<Number>,
    /// Angle from +x to the first principal axis, degrees.
    pub azimuth: Number,
    /// Smoothness `tau / sigma`, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothness: Option<OneOrMany<Number>>,
    /// Root mean square height, one or several; instead of `smoothness`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma: Option<OneOrMany<Number>>,
    /// The structure, if there is one; `sigma`, `tau` and `tau_y` are then those of Gaussian roughness on top.
    #[serde(flatten)]
    pub structure: StructureConfig,
    /// Samples along x and y; those of a tile of 32 correlation lengths by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<PerAxis<Count>>,
    /// Length units per sample along x and y; by default as [`SurfaceConfig::spacing`] says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<PerAxis<Number>>,
    /// Unit of lengths.
    #[serde(default)]
    pub unit: LengthUnit,
    /// Cells between the heights of the grid.
    #[serde(default)]
    pub cells: CellsChoice,
    /// Draw surfaces that the grid cannot resolve or hold.
    pub insist: bool,
    /// Measurements of the structure.
    #[serde(skip)]
    pub(super) measured: StructureMemo,
}

impl SurfaceConfig {
    /// Returns `true` if the surfaces have no direction, or their spectrum cannot be made, which is refused elsewhere.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        let spectrum = self.unit_psd().and_then(|psd| self.turned(psd));
        let spectrum = spectrum.map_or(true, |psd| psd.is_isotropic());
        match self.structure.structure(self.azimuth.0.to_radians()) {
            Some(structure) => structure.is_isotropic() && (spectrum || self.sigma.is_none()),
            None => spectrum,
        }
    }

    /// Cells between heights. Unless named they are smooth, but flat where a structure has edges.
    #[must_use]
    pub fn cells(&self) -> Cells {
        let is_structured = self.structure.structure.is_some();
        if is_structured && self.cells == CellsChoice::default() {
            let synthesis = self.structure_synthesis();
            return match synthesis.is_ok_and(|synthesis| synthesis.suits_smooth_cells()) {
                true => Cells::Smooth,
                false => Cells::Flat,
            };
        }
        self.cells.of_random()
    }

    /// `[dx, dy]`, length units: as given, or a quarter of the correlation length, the shorter of the two, where cells are smooth,
    /// and a sixteenth where they are flat; less where that would not resolve the waves that hold the slopes.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        if let Some(spacing) = self.spacing {
            return spacing.xy().map(|d| d.0);
        }
        if self.structure.structure.is_some() {
            return [self.structure.spacing(); 2];
        }
        if let Some(spacing) = self.files.psd.as_ref().and_then(Psd::sampled) {
            return spacing;
        }
        let (per_length, per_wave) = match self.cells() {
            Cells::Smooth => (4.0, 5.0),
            Cells::Flat => (16.0, 16.0),
        };
        let [shorter, _] = self.correlation_lengths();
        let [wave_x, wave_y] = self.wavelengths();
        [(shorter / per_length).min(wave_x.min(wave_y) / per_wave); 2]
    }

    /// Samples along x and y: as given, or an even number that spans at least 32 correlation lengths, the longer of the
    /// two, or 16 of the amplitude of GGX slopes.
    #[must_use]
    pub fn size(&self) -> [u64; 2] {
        let [_, longer] = self.correlation_lengths();
        let lengths = match self.slopes {
            SlopesName::Gaussian => TILE,
            SlopesName::Ggx => 0.5 * TILE * self.amplitude_ratio(),
        };
        let tile = match self.structure.structure {
            Some(_) => self.structure.tile(),
            None => lengths * longer,
        };
        let spans = |d: f64| 2 * (0.5 * tile / d).ceil() as u64;
        let given = self.size.map(|size| size.xy().map(|n| n.0));
        given.unwrap_or_else(|| self.spacing().map(spans))
    }

    /// Correlation length of the amplitude of GGX slopes over that of the surface.
    pub(super) fn amplitude_ratio(&self) -> f64 {
        self.amplitude_ratio
            .map_or(DEFAULT_AMPLITUDE_RATIO, |ratio| ratio.0)
    }

    /// Samples `[ny, nx]` of each surface.
    ///
    /// # Errors
    /// [`SurfaceError::TooManySamples`].
    pub fn shape(&self) -> Result<[usize; 2], SurfaceError> {
        let [x, y] = self.size();
        let samples =
            |count: u64| usize::try_from(count).map_err(|_| SurfaceError::TooManySamples(count));
        Ok([samples(y)?, samples(x)?])
    }

    /// Deficit of the slope variance of facets of this spacing against the continuous surface, as a fraction:
    /// `1 - (1 - exp(-x^2)) / x^2` of a Gaussian spectrum, `x` being the spacing over the correlation length, the larger of both axes.
    #[must_use]
    pub fn facet_slope_deficit(&self, spacing: [f64; 2]) -> f64 {
        let [shorter, _] = self.correlation_lengths();
        let [dx, dy] = spacing;
        if self.psd != SpectrumName::Gaussian
            && let Ok(psd) = self.unit_psd().and_then(|psd| self.turned(psd))
        {
            let [along_x, along_y] = psd.slope_variance();
            let deficit = |x: f64, y: f64, variance: f64| {
                let drop = psd.autocorrelation(0.0, 0.0) - psd.autocorrelation(x, y);
                1.0 - 2.0 * drop / ((x * x + y * y) * variance)
            };
            return deficit(dx, 0.0, along_x).max(deficit(0.0, dy, along_y));
        }
        let x2 = (dx.max(dy) / shorter).powi(2);
        1.0 + (-x2).exp_m1() / x2
    }

    /// The shorter and the longer of the two correlation lengths; 1 where they make no sense, which is refused elsewhere.
    fn correlation_lengths(&self) -> [f64; 2] {
        let given = self.tau.filter(|_| self.psd == SpectrumName::Gaussian);
        let tau = match given {
            Some(tau) => tau.0,
            None => self
                .unit_psd()
                .map_or(1.0, |psd| psd.correlation_lengths()[0]),
        };
        let tau_y = self.tau_y.map_or(tau, |t| t.0);
        let [shorter, longer] = [tau.min(tau_y), tau.max(tau_y)];
        match self.second_tau {
            Some(second) => [shorter.min(second.0), longer.max(second.0)],
            None => [shorter, longer],
        }
    }

    /// Wavelengths that the grid has to resolve in addition to the correlation length.
    fn wavelengths(&self) -> [f64; 2] {
        if self.psd == SpectrumName::Gaussian {
            return [f64::INFINITY; 2];
        }
        let psd = self.unit_psd().and_then(|psd| self.turned(psd)).ok();
        let waves = psd.and_then(|psd| psd.wavelengths_holding(UNRESOLVED_SLOPES));
        waves.unwrap_or([f64::INFINITY; 2])
    }
}

#[cfg(test)]
mod tests {
    use crate::config::VerifyConfig;

    fn grid(text: &str) -> ([u64; 2], [f64; 2]) {
        let surface = VerifyConfig::from_toml(&format!("[surface]\n{text}"));
        let surface = surface.unwrap().surface;
        (surface.size(), surface.spacing())
    }

    #[test]
    fn the_grid_follows_from_correlation_length_and_cells() {
        assert_eq!(grid(""), ([128; 2], [4.0; 2]));
        assert_eq!(grid("tau = 2"), ([128; 2], [0.5; 2]));
        assert_eq!(grid("cells = \"flat\""), ([512; 2], [1.0; 2]));
        assert_eq!(grid("tau = 2\ntau_y = 8"), ([512; 2], [0.5; 2]));
        assert_eq!(grid("spacing = 3"), ([172; 2], [3.0; 2]));
        assert_eq!(grid("size = [64, 32]"), ([64, 32], [4.0; 2]));
        assert_eq!(grid("size = 64\nspacing = [2, 3]"), ([64; 2], [2.0, 3.0]));
    }
}
