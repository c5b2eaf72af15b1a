//! `[surface]`: the random surfaces, and the cells of any.

use asperity_numerics::elementary::exp_m1;
use asperity_simulate::Cells;
use asperity_surface::LengthUnit;
use asperity_synthesis::{
    ErodedSurface, Erosion, MeasuredStructure, Psd, StructureSynthesis, SurfaceRecipe,
    UNRESOLVED_SLOPES,
};
use serde::{Deserialize, Serialize};

use super::erosion::ErosionConfig;
use super::memo::Memo;
use super::surface_choices::{HeightsChoice, Roughness, SecondScale, Spectrum, SurfaceFiles};
use crate::config::structure::StructureConfig;
use crate::config::values::{Auto, Count, Number, OrAuto, PerAxis};

/// Correlation lengths along the side of a tile whose size is not given.
const TILE: f64 = 32.0;

/// Correlation length of the amplitude of GGX slopes over that of the surface, unless given.
const DEFAULT_AMPLITUDE_RATIO: f64 = 8.0;

/// Largest smoothness. Lobes are then a few millionths of a radian wide; quadrature does not resolve narrower ones.
pub(crate) const MAX_SMOOTHNESS: f64 = 1e6;

/// Least smoothness: no steeper surface is of use.
pub(crate) const MIN_SMOOTHNESS: f64 = 1e-6;

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
    /// Cells of random surfaces, whose heights between the samples are known: smooth unless others are named.
    #[must_use]
    pub const fn of_random(self) -> Cells {
        match self.0.named() {
            Some(cells) => cells,
            None => Cells::Smooth,
        }
    }

    /// Cells of a given surface, about which a spline would assume more than its samples tell: flat unless others are named.
    #[must_use]
    pub const fn of_given(self) -> Cells {
        match self.0.named() {
            Some(cells) => cells,
            None => Cells::Flat,
        }
    }
}

/// Random surfaces before erosion with their grid, and the processes of erosion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Uneroded {
    pub(super) recipe: SurfaceRecipe,
    pub(super) shape: [usize; 2],
    pub(super) spacing: [f64; 2],
    pub(super) erosion: Vec<Erosion>,
}

/// `[surface]`: the random surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceConfig {
    /// Power spectral density.
    #[serde(flatten)]
    pub spectrum: Spectrum,
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
    /// The second scale, if there is one.
    #[serde(flatten)]
    pub second: Option<SecondScale>,
    /// Skewness of the heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skewness: Option<Number>,
    /// Kurtosis of the heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kurtosis: Option<Number>,
    /// Roughness; none where it follows from the file of the spectrum, and of a structure alone.
    #[serde(flatten)]
    pub roughness: Option<Roughness>,
    /// Correlation length along the second principal axis, if it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tau_y: Option<Number>,
    /// Angle from +x to the first principal axis, degrees.
    pub azimuth: Number,
    /// The structure, if there is one; spectrum and roughness are then those of Gaussian roughness on top.
    #[serde(flatten)]
    pub structure: Option<StructureConfig>,
    /// Erosion of what is drawn.
    #[serde(flatten)]
    pub erosion: ErosionConfig,
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
    pub(super) measured: Memo<StructureSynthesis, MeasuredStructure>,
    /// Measurements of the surfaces after erosion.
    #[serde(skip)]
    pub(super) eroded: Memo<Uneroded, ErodedSurface>,
}

impl SurfaceConfig {
    /// Returns `true` if heights and slopes follow from no formula, and are measured on surfaces that are drawn to plan a run.
    pub(crate) fn is_measured(&self) -> bool {
        self.erosion.is_some() || self.structure.is_some()
    }

    /// Returns `true` if the surfaces have no direction, or their spectrum cannot be made, which is refused elsewhere.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        let spectrum = self.unit_psd().and_then(|psd| self.turned(psd));
        let spectrum = spectrum.map_or(true, |psd| psd.is_isotropic());
        match &self.structure {
            Some(structure) => {
                let structure = structure.structure(self.azimuth.0.to_radians());
                structure.is_isotropic() && (spectrum || self.roughness.is_none())
            }
            None => spectrum,
        }
    }

    /// Cells between heights. Unless named they are smooth, but flat where a structure or erosion has edges.
    #[must_use]
    pub fn cells(&self) -> Cells {
        if self.cells == CellsChoice::default() && self.erosion.is_some() {
            return Cells::Flat;
        }
        if let Some(structure) = &self.structure
            && self.cells == CellsChoice::default()
        {
            let synthesis = self.structure_synthesis(structure);
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
        if let Some(structure) = &self.structure {
            return [structure.spacing(); 2];
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
        let tile = match &self.structure {
            Some(structure) => structure.tile(),
            None => {
                let ratio = self.amplitude_ratio();
                let lengths = ratio.map_or(TILE, |ratio| 0.5 * TILE * ratio);
                let [_, longer] = self.correlation_lengths();
                lengths * longer
            }
        };
        let spans = |d: f64| 2 * (0.5 * tile / d).ceil() as u64;
        let given = self.size.map(|size| size.xy().map(|n| n.0));
        given.unwrap_or_else(|| self.spacing().map(spans))
    }

    /// Correlation length of the amplitude of GGX slopes over that of the surface; `None` of other slopes.
    pub(super) fn amplitude_ratio(&self) -> Option<f64> {
        match &self.roughness {
            Some(Roughness::Ggx {
                amplitude_ratio, ..
            }) => Some(amplitude_ratio.map_or(DEFAULT_AMPLITUDE_RATIO, |ratio| ratio.0)),
            _ => None,
        }
    }

    /// Returns `true` if slopes are GGX, which erosion changes.
    pub(super) fn has_ggx_slopes(&self) -> bool {
        self.amplitude_ratio().is_some() && !self.erosion.is_some()
    }

    /// Samples `[ny, nx]` of each surface.
    #[must_use]
    pub fn shape(&self) -> [usize; 2] {
        let [x, y] = self.size();
        // More than can be counted do not fit into memory, which is refused elsewhere
        [y, x].map(|count| usize::try_from(count).unwrap_or(usize::MAX))
    }

    const fn has_gaussian_spectrum(&self) -> bool {
        matches!(self.spectrum, Spectrum::Gaussian { .. })
    }

    /// Deficit of the slope variance of facets of this spacing against the continuous surface, as a fraction:
    /// `1 - (1 - exp(-x^2)) / x^2` of a Gaussian spectrum, `x` being the spacing over the correlation length, the larger of both axes.
    #[must_use]
    pub fn facet_slope_deficit(&self, spacing: [f64; 2]) -> f64 {
        let [shorter, _] = self.correlation_lengths();
        let [dx, dy] = spacing;
        if !self.has_gaussian_spectrum()
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
        1.0 + exp_m1(-x2) / x2
    }

    /// The shorter and the longer of the two correlation lengths; 1 where they make no sense, which is refused elsewhere.
    fn correlation_lengths(&self) -> [f64; 2] {
        let psd = self.unit_psd();
        let tau = psd.map_or(1.0, |psd| psd.correlation_lengths()[0]);
        let tau_y = self.tau_y.map_or(tau, |t| t.0);
        let [shorter, longer] = [tau.min(tau_y), tau.max(tau_y)];
        match self.second {
            Some(second) => [shorter.min(second.tau.0), longer.max(second.tau.0)],
            None => [shorter, longer],
        }
    }

    /// Wavelengths that the grid has to resolve in addition to the correlation length.
    fn wavelengths(&self) -> [f64; 2] {
        if self.has_gaussian_spectrum() {
            return [f64::INFINITY; 2];
        }
        let psd = self.unit_psd().and_then(|psd| self.turned(psd)).ok();
        let waves = psd.and_then(|psd| psd.wavelengths_holding(UNRESOLVED_SLOPES));
        waves.unwrap_or([f64::INFINITY; 2])
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::json;

    use crate::config::VerifyConfig;

    fn grid(text: &str) -> ([u64; 2], [f64; 2]) {
        let surface = VerifyConfig::from_toml(&format!("[surface]\n{text}"));
        let surface = surface.unwrap().surface;
        (surface.size(), surface.spacing())
    }

    /// Results hold configurations, and resume by them.
    #[test]
    fn a_configuration_has_the_keys_that_were_given() {
        let always = ["azimuth", "cells", "insist", "unit"];
        for text in [
            "tau = 8\nsmoothness = 3\ntau_y = 4\nskewness = 0.1",
            "tau = 8\nsigma = 3\nsecond_sigma = 1\nsecond_tau = 2\nheights = \"h.csv\"",
            "tau = 8\nslopes = \"ggx\"\nggx_alpha = [0.1, 0.2]\namplitude_ratio = 4",
            "psd = \"matern\"\nnu = 2\ntau = 8\nsmoothness = 3",
            "psd = \"exponential\"\ncut_off = 2\ntau = 8\nsigma = [1, 2]",
            "psd = \"power-law\"\nhurst = 0.5\nroll_off = 9\ncut_off = 1\nsmoothness = 3",
            "psd = \"like:map.exr\"",
            "structure = \"pits\"\ndepth = [1, 2]\nwidth = 9\narrangement = \"lattice\"",
            "structure = \"scratches\"\nspread = 1\nscratch_length = 99\nedge_radius = 0",
            "structure = \"sine-grooves\"\nrandomness = 0.1\nsigma = 1\ntau = 8",
        ] {
            let given: toml::Table = text.parse().unwrap();
            let given: BTreeSet<&str> = given.keys().map(String::as_str).chain(always).collect();
            let config = VerifyConfig::from_toml(&format!("[surface]\n{text}")).unwrap();
            let kept = json!(config.surface);
            let kept: BTreeSet<&str> = kept
                .as_object()
                .unwrap()
                .keys()
                .map(String::as_str)
                .collect();
            assert_eq!(kept, given, "{text}");
        }
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
