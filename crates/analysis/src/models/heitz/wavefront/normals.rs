//! Normals of the facets that are hit: trials, until each hit has an accepted one.

use asperity_numerics::vector::Stage;
use glam::DVec3;

use super::columns::{Hits, cut, cut_mut, grow};
use super::draws;
use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slope_frame::SlopeFrame;
use crate::microfacet::visible_normals::propose;

/// Hits whose normals are not accepted yet, field by field, and the normals that were tried.
#[derive(Default)]
pub(super) struct Pending {
    pub(super) hit: Vec<u32>,
    pub(super) walk: Vec<u64>,
    pub(super) order: Vec<u64>,
    pub(super) w: [Vec<f64>; 3],
    pub(super) normal: [Vec<f64>; 3],
    pub(super) is_accepted: Vec<u64>,
}

impl Pending {
    /// Takes all hits.
    pub(super) fn begin(&mut self, hits: &Hits) {
        let n = hits.len();
        self.hit.clear();
        self.hit.extend(0..n as u32);
        self.walk.clone_from(&hits.walk);
        self.order.clear();
        let orders = hits.path.iter().map(|path| u64::from(path.order()));
        self.order.extend(orders);
        self.w.clone_from(&hits.w);
        let normals = self.normal.iter_mut();
        normals.for_each(|column| grow(column, n));
        if self.is_accepted.len() < n {
            self.is_accepted.resize(n, 0);
        }
    }

    /// Writes accepted normals into `normals`, and keeps the other hits.
    pub(super) fn keep(&mut self, normals: &mut [Vec<f64>; 3]) {
        let mut left = 0;
        for j in 0..self.hit.len() {
            let hit = self.hit[j];
            if self.is_accepted[j] == 1 {
                for (normals, tried) in normals.iter_mut().zip(&self.normal) {
                    normals[hit as usize] = tried[j];
                }
                continue;
            }
            self.hit[left] = hit;
            self.walk[left] = self.walk[j];
            self.order[left] = self.order[j];
            let columns = self.w.iter_mut();
            columns.for_each(|column| column[left] = column[j]);
            left += 1;
        }
        self.hit.truncate(left);
    }
}

/// A trial of a visible normal for each pending hit.
pub(super) struct ProposeNormals<'a> {
    pub(super) beckmann: Beckmann,
    pub(super) key: [u64; 2],
    pub(super) trial: u64,
    pub(super) pending: &'a mut Pending,
}

impl Stage for ProposeNormals<'_> {
    #[inline(always)]
    fn run(self) {
        let pending = self.pending;
        let n = pending.hit.len();
        let [mx, my, mz] = cut_mut(&mut pending.normal, n);
        let [wx, wy, wz] = cut(&pending.w, n);
        let (walks, orders) = (&pending.walk[..n], &pending.order[..n]);
        let is_accepted = &mut pending.is_accepted[..n];
        for i in 0..n {
            let w = DVec3::new(wx[i], wy[i], wz[i]);
            let words = draws::of_trial(self.key, walks[i], orders[i], self.trial);
            let frame = SlopeFrame::of_direction(self.beckmann.slopes(), w);
            let (m, accepted) = propose(&frame, w, words);
            mx[i] = m.x;
            my[i] = m.y;
            mz[i] = m.z;
            is_accepted[i] = u64::from(accepted);
        }
    }
}
