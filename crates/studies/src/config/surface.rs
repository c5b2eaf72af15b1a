//! `[surface]`: the random surfaces, and the cells of any.

use asperity_simulate::Cells;
use asperity_surface::{LengthUnit, Psd, SurfaceRecipe};
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::values::{Auto, Count, Number, OneOrMany, OrAuto, PerAxis};

/// Correlation lengths along the side of a tile whose size is not given.
const TILE: f64 = 32.0;

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

/// `[surface]`: the random surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceConfig {
    /// 1/e correlation length, length units.
    pub tau: Number,
    /// The same along the second principal axis, if it differs.
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
    /// Samples along x and y; those of a tile of 32 correlation lengths by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<PerAxis<Count>>,
    /// Length units per sample along x and y; by default as [`SurfaceConfig::spacing`] says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<PerAxis<Number>>,
    /// Unit of lengths.
    #[serde(default)]
    pub unit: LengthUnit,
    /// What lies between the heights of the grid.
    #[serde(default)]
    pub cells: CellsChoice,
    /// Draw surfaces that the grid cannot resolve or hold.
    pub insist: bool,
}

impl SurfaceConfig {
    /// The smoothness and what surfaces are drawn by, of a configuration without lists.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is missing or out of range.
    pub fn recipe(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let tau = self.tau.0;
        let (smoothness, sigma) = match (&self.smoothness, &self.sigma) {
            (Some(smoothness), None) => {
                let smoothness = smoothness.one("smoothness")?.0;
                (smoothness, tau / smoothness)
            }
            (None, Some(sigma)) => {
                let sigma = sigma.one("sigma")?.0;
                (tau / sigma, sigma)
            }
            _ => {
                return Err(ConfigError::Contradiction(
                    "give either smoothness or sigma: smoothness = tau / sigma".into(),
                ));
            }
        };
        let ratio = self.tau_y.map_or(1.0, |tau_y| tau_y.0 / tau);
        let smoother = smoothness * ratio.max(1.0);
        if smoother > MAX_SMOOTHNESS {
            return Err(ConfigError::TooSmooth(smoother));
        }
        if !(smoothness.is_finite() && smoothness > 0.0) {
            return Err(ConfigError::Contradiction(format!(
                "smoothness is {smoothness}; tau / sigma must be positive and finite"
            )));
        }
        let tau_y = self.tau_y.map_or(tau, |t| t.0);
        let azimuth = self.azimuth.0.to_radians();
        Ok((
            smoothness,
            Psd::anisotropic_gaussian(sigma, tau, tau_y, azimuth)?.into(),
        ))
    }

    /// What lies between heights: smooth cells unless others are named.
    #[must_use]
    pub const fn cells(&self) -> Cells {
        self.cells.of_random()
    }

    /// `[dx, dy]`, length units: as given, or a quarter of the correlation length, the shorter of the two, where cells are smooth,
    /// and a sixteenth where they are flat.
    #[must_use]
    pub fn spacing(&self) -> [f64; 2] {
        let per_length = match self.cells() {
            Cells::Smooth => 4.0,
            Cells::Flat => 16.0,
        };
        let [shorter, _] = self.correlation_lengths();
        let given = self.spacing.map(|spacing| spacing.xy().map(|d| d.0));
        given.unwrap_or([shorter / per_length; 2])
    }

    /// Samples along x and y: as given, or an even number that spans at least 32 correlation lengths, the longer of the
    /// two.
    #[must_use]
    pub fn size(&self) -> [u64; 2] {
        let [_, longer] = self.correlation_lengths();
        let spans = |d: f64| 2 * (0.5 * TILE * longer / d).ceil() as u64;
        let given = self.size.map(|size| size.xy().map(|n| n.0));
        given.unwrap_or_else(|| self.spacing().map(spans))
    }

    /// Samples `[ny, nx]` of each surface.
    ///
    /// # Errors
    /// [`ConfigError::Contradiction`] if a number does not fit into memory.
    pub fn shape(&self) -> Result<[usize; 2], ConfigError> {
        let [x, y] = self.size();
        let samples = |count: u64| {
            usize::try_from(count).map_err(|_| {
                ConfigError::Contradiction(format!("{count} samples do not fit into memory"))
            })
        };
        Ok([samples(y)?, samples(x)?])
    }

    /// How far the slope variance of facets of this spacing lies below that of the continuous surface, as a fraction:
    /// `1 - (1 - exp(-x^2)) / x^2`, `x` being the spacing over the correlation length, the larger of both axes.
    #[must_use]
    pub fn facet_slope_deficit(&self, spacing: [f64; 2]) -> f64 {
        let [shorter, _] = self.correlation_lengths();
        let [dx, dy] = spacing;
        let x2 = (dx.max(dy) / shorter).powi(2);
        1.0 + (-x2).exp_m1() / x2
    }

    /// The shorter and the longer of the two correlation lengths.
    fn correlation_lengths(&self) -> [f64; 2] {
        let tau = self.tau.0;
        let tau_y = self.tau_y.map_or(tau, |t| t.0);
        [tau.min(tau_y), tau.max(tau_y)]
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
