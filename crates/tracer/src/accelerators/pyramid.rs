//! Pyramid: a hierarchy of height bounds over the cells of a tile.
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
//! `load.rs` brings rays into f32, and `instructions.rs` chooses between the last two. They name the cell that a ray
//! meets; `meet.rs` finds the facet and where, in f64. So all give the hit that brute force gives. Cells are tested by
//! `facet_cells.rs` for triangles and by `spline_cells.rs` for smooth cells.

mod bounds;
mod build;
mod cells;
mod facet_cells;
mod instructions;
#[cfg(target_arch = "x86_64")]
mod lane_state;
mod load;
#[cfg(test)]
mod margin_tests;
mod meet;
mod quadtree;
mod rays;
mod scalar;
mod spline_cells;
#[cfg(target_arch = "x86_64")]
mod wide;

use std::cell::Cell;
use std::marker::PhantomData;

use self::bounds::{Bounds, MAX_LEVELS};
use self::build::build;
use self::cells::SearchedGrid;
use self::load::Load;
use self::meet::Meet;
use self::rays::Rays;
use crate::accelerators::accelerator::{Accelerator, BuildError};
use crate::accelerators::kind::AcceleratorKind;
use crate::geometry::height_field::Surface;
use crate::ray::{Hit, Query, RayColumns};
use crate::vector::Instructions;

/// Height bounds over one tile, and the instructions with which they are searched.
pub struct Pyramid<S = Surface> {
    bounds: Bounds,
    instructions: Instructions,
    surface: PhantomData<fn(&S)>,
}

impl Pyramid {
    /// Returns `true` if a pyramid can be built over `[columns, rows]` cells.
    #[must_use]
    pub const fn holds(cells: [usize; 2]) -> bool {
        Bounds::hold(cells)
    }
}

#[expect(private_bounds, reason = "for the surfaces of this crate only")]
impl<S: SearchedGrid> Pyramid<S> {
    /// Builds the bounds over `surface`, to be searched with the best instructions of this machine.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if there are more cells than 30 bits can number.
    pub fn build(surface: &S) -> Result<Self, BuildError> {
        Ok(Self {
            bounds: build(surface)?,
            instructions: Instructions::best(),
            surface: PhantomData,
        })
    }

    /// This pyramid, searched with the given instructions, or portably if the machine lacks them.
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

/// Bounds of a [`Pyramid`], for an engine that searches it elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct PyramidTable<'a> {
    /// Bounds of all nodes in steps, level by level, row by row: that of rays above in the low half of a word, that of rays below in the
    /// high half.
    pub nodes: &'a [u32],
    /// First node of each level.
    pub first: [i32; MAX_LEVELS + 1],
    /// Nodes in a row of each level.
    pub width: [i32; MAX_LEVELS + 1],
    /// Lowest level that has bounds, and the highest; level 0 is a cell.
    pub levels: [usize; 2],
    /// Lowest bound, and height of a step.
    pub scale: [f64; 2],
}

impl<S> Pyramid<S> {
    /// Bounds of all nodes.
    #[must_use]
    pub fn table(&self) -> PyramidTable<'_> {
        let Bounds {
            nodes,
            top,
            lowest_level,
            first,
            width,
            lowest,
            step,
            ..
        } = &self.bounds;
        PyramidTable {
            nodes,
            first: *first,
            width: *width,
            levels: [*lowest_level, *top],
            scale: [f64::from(*lowest), f64::from(*step)],
        }
    }
}

thread_local! {
    /// Memory for rays that each thread uses again and again.
    static RAYS: Cell<Rays> = Cell::default();
}

impl<S: SearchedGrid> Accelerator<S> for Pyramid<S> {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Pyramid
    }

    fn bytes(&self) -> usize {
        self.bounds.bytes()
    }

    fn instructions(&self) -> Option<String> {
        Some(self.instructions.to_string())
    }

    fn closest_hit(&self, surface: &S, query: &Query) -> Option<Hit<S::Facet>> {
        quadtree::closest_hit(&self.bounds, surface, query)
    }

    fn closest_hits(
        &self,
        surface: &S,
        rays: RayColumns<'_>,
        which: &[u32],
        hits: &mut Vec<Option<Hit<S::Facet>>>,
    ) {
        let mut lanes = RAYS.take();
        self.instructions.run(Load {
            surface,
            bounds: &self.bounds,
            rays,
            which,
            into: &mut lanes,
        });
        instructions::search::<S>(&self.bounds, &mut lanes, self.instructions);
        hits.clear();
        hits.resize(which.len(), None);
        let mut open = std::mem::take(&mut lanes.open);
        self.instructions.run(Meet {
            surface,
            rays,
            which,
            answers: &lanes.answers,
            hits,
            open: &mut open,
        });
        for place in open.drain(..) {
            hits[place] = self.closest_hit(surface, &rays.query(which[place] as usize));
        }
        lanes.open = open;
        RAYS.set(lanes);
    }
}
