//! A pyramid of height bounds over the cells of a tile.
//!
//! Each node of level `l` covers `2^l` by `2^l` cells and bounds their heights from both sides: a ray
//! above the surface can meet nothing in a node that lies below it, a ray below nothing in one that
//! lies above it. Three searches use the bounds:
//!
//! - `quadtree.rs`, one ray in f64: the clear one, which decides as brute force does;
//! - `scalar.rs`, one ray in f32: it answers only where rounding cannot have changed the answer, and
//!   hands the few other rays to the quadtree;
//! - `wide.rs`, many rays at a time, each lane doing what `scalar.rs` does; on x86-64 only.
//!
//! `load.rs` brings rays into f32, and `instructions.rs` chooses between the last two. Where a ray is met is computed
//! in f64, and which facet of a cell it is wherever rounding in f32 might decide. So all give the facet that brute
//! force gives.

mod bounds;
mod instructions;
mod load;
mod quadtree;
mod rays;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod wide;

use std::cell::Cell;

use self::bounds::Bounds;
use self::load::Load;
use self::rays::{Answer, Rays};
use crate::accelerators::accelerator::{Accelerator, BuildError};
use crate::accelerators::kind::AcceleratorKind;
use crate::geometry::height_field::{Facet, Surface};
use crate::ray::{Hit, Query, RayColumns};
use crate::vector::Instructions;

/// Height bounds over one tile, and the instructions with which they are searched.
pub struct Pyramid {
    bounds: Bounds,
    instructions: Instructions,
}

impl Pyramid {
    /// Builds the bounds over `surface`, to be searched with the best instructions of this machine.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if there are more cells than 30 bits can number.
    pub fn build(surface: &Surface) -> Result<Self, BuildError> {
        Ok(Self {
            bounds: Bounds::new(surface)?,
            instructions: Instructions::best(),
        })
    }

    /// Whether there is one for so many cells, `[columns, rows]`.
    #[must_use]
    pub const fn holds(cells: [usize; 2]) -> bool {
        Bounds::hold(cells)
    }

    /// The same, searched with the given instructions, or portably where the machine lacks them.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        let instructions = if instructions.are_available() {
            instructions
        } else {
            Instructions::Portable
        };
        Self {
            instructions,
            ..self
        }
    }
}

impl Pyramid {
    /// The hit of a ray that is known to meet a facet of a cell. Near an edge, f64 may find that it
    /// passes the cell by after all.
    #[cold]
    fn hit_in_cell(&self, surface: &Surface, cell: [u32; 2], query: &Query) -> Option<Hit<Facet>> {
        let Query { ray, half_space } = query;
        let hit = surface.intersect_cell(cell, ray, *half_space);
        hit.or_else(|| self.closest_hit(surface, query))
    }
}

/// How many answers ahead of their use the heights of a cell are prefetched.
const AHEAD: usize = 16;

/// Prefetches the heights of a cell, where the machine can.
fn fetch(surface: &Surface, [ix, iy]: [u32; 2]) {
    #[cfg(target_arch = "x86_64")]
    {
        let field = surface.field();
        let [_, stride] = field.shape();
        let corner = iy as usize * stride + ix as usize;
        crate::vector::x86::prefetch(field.heights(), corner);
        crate::vector::x86::prefetch(field.heights(), corner + stride);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (surface, ix, iy);
}

thread_local! {
    /// Memory for rays that each thread uses again and again.
    static RAYS: Cell<Rays> = Cell::default();
}

impl Accelerator<Surface> for Pyramid {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Pyramid
    }

    fn bytes(&self) -> usize {
        self.bounds.bytes()
    }

    fn instructions(&self) -> Option<String> {
        Some(self.instructions.to_string())
    }

    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        quadtree::closest_hit(&self.bounds, surface, query)
    }

    fn closest_hits(
        &self,
        surface: &Surface,
        rays: RayColumns<'_>,
        which: &[u32],
        hits: &mut Vec<Option<Hit<Facet>>>,
    ) {
        let mut lanes = RAYS.take();
        self.instructions.run(Load {
            surface,
            rays,
            which,
            into: &mut lanes,
        });
        instructions::search(&self.bounds, &mut lanes, self.instructions);
        hits.clear();
        hits.resize(rays.len(), None);
        let answers = &lanes.answers;
        for i in 0..answers.len() {
            if let Some(cell) = answers.cell(i + AHEAD) {
                fetch(surface, cell);
            }
            let (place, answer) = answers.get(i);
            let query = &rays.query(place);
            match answer {
                Answer::Nothing => {}
                Answer::Inside([ix, iy], triangle) => {
                    let facet = Facet { iy, ix, triangle };
                    let t = surface.crossing(facet, &query.ray);
                    hits[place] = Some(Hit { t, facet });
                }
                Answer::Cell(cell) => hits[place] = self.hit_in_cell(surface, cell, query),
                Answer::Doubtful => hits[place] = self.closest_hit(surface, query),
            }
        }
        RAYS.set(lanes);
    }
}
