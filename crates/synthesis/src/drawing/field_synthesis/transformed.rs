//! Draws surfaces of transformed heights: a rising function of a Gaussian surface.

use rayon::prelude::*;

use super::centred::centred;
use super::curve::Curve;
use super::hermite::HermiteSeries;
use crate::drawing::error::SynthesisError;
use crate::drawing::synthesis::Synthesis;
use crate::gives_up::GivesUp;
use crate::{SlopeMixture, SpectrumMismatch, TransformedHeights};
use asperity_numerics::quadrature::normal_nodes;
use asperity_numerics::transform_plane;
use asperity_surface::HeightField;

/// Normal numbers per unit, and so four in each cell of a curve, over which the derivative of the height is averaged.
const NODES_PER_UNIT: u32 = 256;

/// A generator of surfaces of transformed heights.
#[derive(Clone, Debug)]
pub(super) struct TransformedSynthesis {
    /// Draws normal numbers of variance one.
    waves: Synthesis,
    /// The height by the normal number.
    height: Curve,
    mismatch: SpectrumMismatch,
}

impl TransformedSynthesis {
    /// Finds the spectrum of the normal numbers: the autocorrelation of the heights on the tile, at each lag the correlation of
    /// normal numbers that gives it, and of that the powers of waves, of which no negative ones are drawn.
    pub(super) fn new(
        transformed: &TransformedHeights,
        shape: [usize; 2],
        spacing: [f64; 2],
        fewest: Option<f64>,
    ) -> Result<Self, SynthesisError> {
        let psd = transformed.psd();
        let waves = Synthesis::of_heights(psd.clone(), shape, spacing, fewest)?;
        let function = transformed.heights().standardised();
        let series = HermiteSeries::of(&function);

        let powers = waves.powers();
        let variance: f64 = powers.iter().sum();
        let mut requested = transform_plane(&powers, shape);
        drop(powers);
        requested.iter_mut().for_each(|c| *c /= variance);
        let of_normal: Vec<f64> = requested.par_iter().map(|c| series.inverse(*c)).collect();
        let mut powers = transform_plane(&of_normal, shape);
        drop(of_normal);
        powers.iter_mut().for_each(|power| *power = power.max(0.0));
        powers[0] = 0.0;
        let sum: f64 = powers.iter().sum();
        powers.iter_mut().for_each(|power| *power /= sum);

        let reached = transform_plane(&powers, shape);
        let off = |(rho, requested): (&f64, &f64)| (series.correlation(*rho) - requested).abs();
        let differences = reached.par_iter().zip(&requested).map(off);
        // Slope variance is the fall of the autocorrelation to the next sample
        let fall = |i: usize| {
            let reached = 1.0 - series.correlation(reached[i]);
            reached / (1.0 - requested[i]) - 1.0
        };
        let mismatch = SpectrumMismatch {
            autocorrelation: differences.reduce(|| 0.0, f64::max),
            slope_variance: [fall(1), fall(shape[1])],
        };
        if fewest.is_some() && mismatch.is_refused() {
            return Err(SynthesisError::Unreachable(mismatch));
        }
        let sigma = psd.sigma();
        Ok(Self {
            waves: waves.with_powers(&powers),
            height: Curve::of(|z| sigma * function(z)),
            mismatch,
        })
    }

    pub(super) const fn waves(&self) -> &Synthesis {
        &self.waves
    }

    pub(super) const fn spectrum_mismatch(&self) -> SpectrumMismatch {
        self.mismatch
    }

    /// For a given number the slopes are those of the waves, times the derivative of the height.
    pub(super) fn slope_mixture(&self) -> SlopeMixture {
        let factor = |[z, weight]: [f64; 2]| [self.height.derivative_at(z).powi(2), weight];
        let factors: Vec<[f64; 2]> = normal_nodes(NODES_PER_UNIT, 8).map(factor).collect();
        SlopeMixture::scaled(self.waves.wave_slope_covariance(), &factors)
    }

    /// The amplitudes of the waves are there in addition to the heights.
    pub(super) fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.waves.shape();
        let drawing = self.waves.peak_bytes() + ny * (nx / 2 + 1) * size_of::<f64>();
        drawing.max(Self::planning_bytes([ny, nx]))
    }

    /// Two grids of numbers, and the transform of one with its room.
    pub(super) const fn planning_bytes([ny, nx]: [usize; 2]) -> usize {
        4 * ny.saturating_mul(nx).saturating_mul(size_of::<f64>())
    }

    pub(super) fn draw_into(
        &self,
        seed: u64,
        realisation: u64,
        room: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let field = self.waves.draw_into(seed, realisation, room, gives_up)?;
        let (nx, shape, spacing) = (field.nx(), field.shape(), field.spacing());
        let mut heights = field.into_heights();
        self.height.map(&mut heights, 1.0);
        Ok(HeightField::new(centred(heights, nx), shape, spacing)?)
    }
}
