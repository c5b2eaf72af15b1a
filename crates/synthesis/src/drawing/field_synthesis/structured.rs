//! Draws structured surfaces: a structure plus Gaussian roughness.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::centred::centred;
use crate::drawing::error::SynthesisError;
use crate::drawing::synthesis::Synthesis;
use crate::gives_up::GivesUp;
use crate::{StructureSynthesis, StructuredSurface};
use asperity_surface::HeightField;

/// A generator of structured surfaces.
#[derive(Clone, Debug)]
pub(super) struct StructuredSynthesis {
    structure: StructureSynthesis,
    roughness: Option<Synthesis>,
    is_exact: OnceLock<bool>,
}

impl StructuredSynthesis {
    /// `fewest`: spacings that a correlation length of the roughness must span; if none, nothing that the grid cannot resolve is
    /// refused.
    pub(super) fn new(
        surface: &StructuredSurface,
        shape: [usize; 2],
        spacing: [f64; 2],
        fewest: Option<f64>,
    ) -> Result<Self, SynthesisError> {
        let insist = fewest.is_none();
        let structure = StructureSynthesis::new(*surface.structure(), shape, spacing, insist)?;
        let roughness = surface
            .roughness()
            .map(|psd| Synthesis::of_heights(psd.clone(), shape, spacing, fewest));
        Ok(Self {
            structure,
            roughness: roughness.transpose()?,
            is_exact: OnceLock::new(),
        })
    }

    pub(super) const fn structure(&self) -> &StructureSynthesis {
        &self.structure
    }

    /// Exactness of facets: `true` if they are the surface itself; `None` with roughness on top. Found on the first surface of the first
    /// `seed`: facets cut all realisations of what is random.
    pub(super) fn is_exact(&self, seed: u64) -> Result<Option<bool>, SynthesisError> {
        if self.roughness.is_some() {
            return Ok(None);
        }
        if let Some(known) = self.is_exact.get() {
            return Ok(Some(*known));
        }
        let found = self.structure.is_exact(seed, 0)?;
        Ok(Some(*self.is_exact.get_or_init(|| found)))
    }

    pub(super) fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.structure.shape();
        // The middles of cells are no longer there when roughness is drawn
        let middles = ny * nx * size_of::<f64>();
        let roughness = self.roughness.as_ref().map_or(0, Synthesis::peak_bytes);
        self.structure.peak_bytes() - middles + roughness.max(middles)
    }

    pub(super) fn draw(
        &self,
        seed: u64,
        realisation: u64,
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let (shape, spacing) = (self.structure.shape(), self.structure.spacing());
        let (mut heights, turned_cells) =
            self.structure.heights_and_turned_cells(seed, realisation)?;
        if gives_up() {
            return Err(SynthesisError::GivenUp);
        }
        let [_, nx] = shape;
        if let Some(roughness) = &self.roughness {
            let added = roughness.draw_into(seed, realisation, Vec::new(), gives_up)?;
            heights
                .par_chunks_mut(nx)
                .zip(added.heights().par_chunks(nx))
                .for_each(|(heights, added)| {
                    for (h, more) in heights.iter_mut().zip(added) {
                        *h += more;
                    }
                });
        }
        let field = HeightField::new(centred(heights, nx), shape, spacing)?;
        Ok(field.with_turned_cells(Some(Arc::new(turned_cells))))
    }
}
