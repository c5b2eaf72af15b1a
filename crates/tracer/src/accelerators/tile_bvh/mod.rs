//! A bounding volume hierarchy over square blocks of cells, by obvhs.
//!
//! The heights of the surface are all the geometry there is in memory. The hierarchy proposes
//! blocks, in f32; within a block a ray goes from square to square and from cell to cell in f64, past
//! what it stays above (below). Where rounding may decide which comes next, `Walk::through` looks at
//! all cells that may; what is met in one is decided by [`Surface::intersect_cell`], as brute force
//! decides it.
//!
//! For a new surface the hierarchy is built anew. Over 512 x 512 blocks (ms on one core), a hierarchy
//! is built in 184: 75 for the binary tree, the rest for making it wide. To refit the binary tree takes
//! 16, but the rest is still to do, 118, and the tree has to be kept, three times as large as the wide
//! one and shaped after another surface: saving a quarter (the boxes, 60, are needed either way) of
//! what is a thousandth of the time of tracing is not worth it.

mod axis;
mod block;
mod walk;

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;

use super::mesh_bvh::held_by;
use super::obvhs_ray::Handover;
use crate::accelerators::accelerator::{Accelerator, AcceleratorKind, BuildError, Query};
use crate::geometry::height_field::{Facet, Surface};
use crate::ray::Hit;
use block::{BLOCK, Block, BlockBox};
use walk::Walk;

/// Cells along an axis, at most, since boxes are in f32.
const MOST_CELLS: usize = 1 << 24;

/// One block a leaf: a box around several would propose blocks that the ray passes by.
const PARAMETERS: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 1,
    ..BvhBuildParams::medium_build()
};

/// Eight-wide compressed hierarchy over blocks of cells.
pub struct TileBvh {
    bvh: CwBvh,
    handover: Handover,
    /// Blocks in a row of blocks.
    columns: usize,
    /// Row by row.
    blocks: Vec<Block>,
}

impl TileBvh {
    /// Builds the hierarchy over the blocks of `surface`.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if an axis has more cells than 24 bits can number.
    pub fn build(surface: &Surface) -> Result<Self, BuildError> {
        let [cx, cy] = surface.cells();
        if cx.max(cy) > MOST_CELLS {
            return Err(BuildError::TooManyFacets {
                facets: 2 * cx * cy,
                most: 2 * MOST_CELLS,
            });
        }
        let handover = Handover::new(surface);
        let margin = handover.margin();
        let blocks = block::blocks(surface, margin);
        let columns = cx.div_ceil(BLOCK);
        let boxes: Vec<BlockBox> = blocks
            .iter()
            .enumerate()
            .map(|(i, block)| {
                let cells = block::cells_of([i % columns, i / columns], [cx, cy]);
                block.around(&cells, margin)
            })
            .collect();
        Ok(Self {
            bvh: build_cwbvh(&boxes, PARAMETERS, &mut Duration::default()),
            handover,
            columns,
            blocks,
        })
    }
}

impl Accelerator<Surface> for TileBvh {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Tiles
    }

    fn bytes(&self) -> usize {
        held_by(&self.bvh) + self.blocks.capacity() * size_of::<Block>()
    }

    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        let single = self.handover.single_precision(&query.ray)?;
        let mut walk = Walk::new(surface, query);
        self.bvh
            .ray_traverse(single.ray, &mut RayHit::none(), |_, id| {
                let block = self.bvh.primitive_indices[id] as usize;
                let place = [block % self.columns, block / self.columns];
                match walk.block(place, &self.blocks[block]) {
                    Some(t) => single.beyond(t),
                    None => f32::INFINITY,
                }
            });
        walk.closest
    }
}
