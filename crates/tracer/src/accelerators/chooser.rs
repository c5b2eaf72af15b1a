//! Chooser: builds the accelerator of a given kind over a geometry.

use super::accelerator::{Accelerator, BuildError, MAX_HEIGHT_RANGE};
use super::brute_force::BruteForce;
use super::flat::Flat;
use super::kind::AcceleratorKind;
use super::mesh_bvh::MeshBvh;
use super::pyramid::Pyramid;
use crate::geometry::Geometry;
use crate::geometry::height_field::Surface;
use crate::geometry::mesh::MeshSurface;
use crate::geometry::smooth::SmoothSurface;

/// Geometry over which accelerators can be built by their kind.
pub trait BuildAccelerator: Geometry {
    /// The accelerator that `kind` stands for on this geometry: [`AcceleratorKind::Auto`] becomes the best one.
    #[must_use]
    fn resolve(&self, kind: AcceleratorKind) -> AcceleratorKind;

    /// Builds an accelerator over the facets of the tile.
    ///
    /// # Errors
    /// [`BuildError`] if there is none of this kind for this geometry.
    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError>;
}

impl BuildAccelerator for Surface {
    fn resolve(&self, kind: AcceleratorKind) -> AcceleratorKind {
        kind.on_height_field(self.is_flat())
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        check_height_range(self)?;
        Ok(match self.resolve(kind) {
            AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::Flat => Box::new(Flat::build(self)?),
            AcceleratorKind::Auto | AcceleratorKind::Pyramid => Box::new(Pyramid::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
        })
    }
}

impl BuildAccelerator for SmoothSurface {
    fn resolve(&self, kind: AcceleratorKind) -> AcceleratorKind {
        match kind {
            AcceleratorKind::Auto => AcceleratorKind::Pyramid,
            chosen => chosen,
        }
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        check_height_range(self)?;
        Ok(match self.resolve(kind) {
            AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::Flat => return Err(BuildError::NotFlat),
            AcceleratorKind::Auto | AcceleratorKind::Pyramid => Box::new(Pyramid::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
        })
    }
}

impl BuildAccelerator for MeshSurface {
    fn resolve(&self, kind: AcceleratorKind) -> AcceleratorKind {
        match kind {
            AcceleratorKind::Auto => AcceleratorKind::Mesh,
            chosen => chosen,
        }
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        Ok(match self.resolve(kind) {
            AcceleratorKind::Auto | AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
            kind => return Err(BuildError::NeedsHeightField { kind }),
        })
    }
}

/// Refuses heights out of proportion to the spacing.
fn check_height_range<G: Geometry>(geometry: &G) -> Result<(), BuildError> {
    let [low, high] = geometry.z_range();
    let columns = high - low;
    if columns.is_nan() || columns > MAX_HEIGHT_RANGE {
        return Err(BuildError::TooTall { columns });
    }
    Ok(())
}
