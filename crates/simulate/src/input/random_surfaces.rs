//! Random surfaces: the recipe that draws them, by the cells that they consist of.

use asperity_surface::{
    HeightField, Psd, SlopeMoments, SplineSynthesis, Synthesis, SynthesisError,
};

use super::cells::Cells;

/// Random surfaces, by the cells that they consist of.
#[derive(Clone, Debug)]
pub enum RandomSurfaces {
    /// Heights on a grid, two triangles per cell.
    Flat(Synthesis),
    /// Bicubic B-splines.
    Smooth(SplineSynthesis),
}

impl RandomSurfaces {
    /// Plans surfaces of the power spectral density `psd`; the other parameters are those of [`Synthesis::new`].
    ///
    /// # Errors
    /// As [`Synthesis::new`] or [`SplineSynthesis::new`].
    pub fn new(
        cells: Cells,
        psd: Psd,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        Ok(match cells {
            Cells::Flat => Self::Flat(Synthesis::new(psd, shape, spacing, insist)?),
            Cells::Smooth => Self::Smooth(SplineSynthesis::new(psd, shape, spacing, insist)?),
        })
    }

    /// What their cells are.
    #[must_use]
    pub const fn cells(&self) -> Cells {
        match self {
            Self::Flat(_) => Cells::Flat,
            Self::Smooth(_) => Cells::Smooth,
        }
    }

    /// The requested power spectral density.
    #[must_use]
    pub const fn psd(&self) -> &Psd {
        match self {
            Self::Flat(synthesis) => synthesis.psd(),
            Self::Smooth(synthesis) => synthesis.psd(),
        }
    }

    /// Cells `[rows, columns]`; as many as samples, since the surfaces are periodic.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        match self {
            Self::Flat(synthesis) => synthesis.shape(),
            Self::Smooth(synthesis) => synthesis.shape(),
        }
    }

    /// `[dx, dy]`, length units per cell.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        match self {
            Self::Flat(synthesis) => synthesis.spacing(),
            Self::Smooth(synthesis) => synthesis.spacing(),
        }
    }

    /// Moments that the slopes of its surfaces have on average.
    #[must_use]
    pub(crate) fn expected_slope_moments(&self) -> SlopeMoments {
        match self {
            Self::Flat(synthesis) => synthesis.expected_slope_moments(),
            Self::Smooth(synthesis) => synthesis.expected_slope_moments(),
        }
    }

    /// The same surfaces of the same tile with about `scale` times the spacing, as whole cells allow; `None` if the grid
    /// cannot be. `insist`: even if it resolves them no more.
    #[must_use]
    pub(crate) fn respaced(&self, scale: f64, insist: bool) -> Option<Self> {
        let (shape, spacing) = (self.shape(), self.spacing());
        let cells = shape.map(|n| (n as f64 / scale).round().max(2.0) as usize);
        // Spacing is that of columns, then of rows; shape the number of rows, then of columns.
        let spacing = [0, 1].map(|i| spacing[i] * shape[1 - i] as f64 / cells[1 - i] as f64);
        Self::new(self.cells(), *self.psd(), cells, spacing, insist).ok()
    }

    /// Bytes that a program holds at the peak of drawing one of them.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        match self {
            Self::Flat(synthesis) => synthesis.peak_bytes(),
            Self::Smooth(synthesis) => synthesis.peak_bytes(),
        }
    }

    /// Heights of one surface, for a picture: those of its grid, or of one up to four times as fine where cells are smooth, of at
    /// most 512 samples per side.
    ///
    /// # Errors
    /// As [`Synthesis::draw`].
    pub fn heights(&self, seed: u64, realisation: u64) -> Result<HeightField, SynthesisError> {
        match self {
            Self::Flat(synthesis) => synthesis.draw(seed, realisation),
            Self::Smooth(synthesis) => {
                let [ny, nx] = synthesis.shape();
                let per_cell = (512 / nx.max(ny)).clamp(1, 4);
                Ok(synthesis.draw(seed, realisation)?.tessellated(per_cell)?)
            }
        }
    }
}

/// Two recipes are equal if they draw the same surfaces.
impl PartialEq for RandomSurfaces {
    fn eq(&self, other: &Self) -> bool {
        self.cells() == other.cells()
            && self.psd() == other.psd()
            && self.shape() == other.shape()
            && self.spacing() == other.spacing()
    }
}

impl From<Synthesis> for RandomSurfaces {
    fn from(synthesis: Synthesis) -> Self {
        Self::Flat(synthesis)
    }
}

impl From<SplineSynthesis> for RandomSurfaces {
    fn from(synthesis: SplineSynthesis) -> Self {
        Self::Smooth(synthesis)
    }
}
