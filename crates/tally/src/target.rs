//! Targets: which entries an exit counts for, in arithmetic without branches, so that many are found by vector instructions.

use crate::EventPath;
use crate::component::MAX_LISTED_ORDER;
use crate::places::{
    BINS_START, MAX_LISTED_PATH, ORDERS_START, PATH_ENTRIES, PATHS_START, Places, RING_COMPONENTS,
};

/// The entries that every exit counts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    /// Flux of its order.
    pub(crate) order: u32,
    /// Flux of its event path.
    pub(crate) path: u32,
    /// Flux in its ring.
    pub(crate) ring: u32,
    /// Flux in its bin.
    pub(crate) bin: u32,
}

impl Places {
    /// The entries of an exit on side number `side`, in a ring and a sector.
    #[inline(always)]
    pub(crate) fn target(&self, side: u32, path: EventPath, ring: u32, sector: u32) -> Target {
        const LISTED_ORDERS: u32 = MAX_LISTED_ORDER as u32;
        const LISTED_PATHS: u32 = MAX_LISTED_PATH as u32;
        let order = path.order();
        // All paths of fewer interactions stand before a listed one; one entry is for all others.
        let is_listed = (order.wrapping_sub(1)) < LISTED_PATHS;
        let listed = (1_u32 << (order & 31))
            .wrapping_sub(2)
            .wrapping_add(path.code());
        let number = if is_listed {
            listed
        } else {
            PATH_ENTRIES as u32 - 1
        };
        let before = order.max(1) - 1;
        let multiple = u32::from(order > 1);
        let [n_theta, n_phi] = [self.grid.n_theta() as u32, self.grid.n_phi() as u32];
        let group = side * RING_COMPONENTS as u32 + before.min(3);
        let of_components = multiple * self.grid.len() as u32;
        Target {
            order: ORDERS_START as u32 + side * LISTED_ORDERS + before.min(LISTED_ORDERS - 1),
            path: PATHS_START as u32 + side * PATH_ENTRIES as u32 + number,
            ring: self.rings_base() as u32 + group * n_theta + ring,
            bin: BINS_START as u32 + of_components + (side * n_theta + ring) * n_phi + sector,
        }
    }
}
