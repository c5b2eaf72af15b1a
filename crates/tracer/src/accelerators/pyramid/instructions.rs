//! Instructions: searches the pyramid with those of the machine.

#[cfg(target_arch = "x86_64")]
use std::marker::PhantomData;

#[cfg(target_arch = "x86_64")]
use asperity_numerics::vector::x86::{Avx2, Avx512};

use super::bounds::Bounds;
use super::cells::SearchedGrid;
use super::rays::Rays;
use super::scalar;
#[cfg(target_arch = "x86_64")]
use super::wide::SearchAll;
use crate::vector::Instructions;

/// Searches all rays with the given instructions, or portably where the machine lacks them.
pub(super) fn search<S: SearchedGrid>(
    bounds: &Bounds,
    rays: &mut Rays,
    instructions: Instructions,
) {
    match instructions {
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 if let Some(lanes) = Avx512::detect() => {
            lanes.run(SearchAll::<_, S> {
                lanes,
                bounds,
                rays,
                cells: PhantomData,
            })
        }
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 if let Some(lanes) = Avx2::detect() => lanes.run(SearchAll::<_, S> {
            lanes,
            bounds,
            rays,
            cells: PhantomData,
        }),
        _ => scalar::search::<S>(bounds, rays),
    }
}
