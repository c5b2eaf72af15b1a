//! Heights at which rays meet their next facets.

use asperity_numerics::random::open_unit;
use asperity_numerics::vector::Stage;

use super::columns::Hits;
use super::draws;
use crate::models::heitz::height::Height;

/// Finds the heights at which new rays meet their first facets.
pub(super) struct Start<'a> {
    pub(super) key: [u64; 2],
    pub(super) lambda: f64,
    pub(super) walks: &'a [u64],
    pub(super) heights: &'a mut [f64],
}

impl Stage for Start<'_> {
    #[inline(always)]
    fn run(self) {
        for (height, walk) in self.heights.iter_mut().zip(self.walks) {
            let u = open_unit(draws::of_start(self.key, *walk));
            let first = Height::ABOVE_ALL.descended(self.lambda, u);
            *height = first.logarithm();
        }
    }
}

/// Hits of the next step, of which the heights are still those of the last one.
#[derive(Default)]
pub(super) struct Next {
    pub(super) hits: Hits,
    pub(super) lambda: Vec<f64>,
    pub(super) blocked: Vec<f64>,
    pub(super) u: Vec<f64>,
}

impl Stage for &mut Next {
    #[inline(always)]
    fn run(self) {
        let n = self.hits.len();
        let heights = &mut self.hits.height[..n];
        let z = &self.hits.w[2][..n];
        let (lambda, blocked, u) = (&self.lambda[..n], &self.blocked[..n], &self.u[..n]);
        for i in 0..n {
            let height = Height::at(heights[i]);
            let up = height.ascended(lambda[i], blocked[i], u[i]).logarithm();
            let down = height.descended(lambda[i], u[i]).logarithm();
            heights[i] = if z[i] < 0.0 { up } else { down };
        }
    }
}

impl Next {
    pub(super) fn clear(&mut self) {
        let Hits {
            walk,
            path,
            is_behind,
            w,
            height,
            weight,
            threshold,
            light,
        } = &mut self.hits;
        walk.clear();
        path.clear();
        is_behind.clear();
        let columns = [height, weight, threshold]
            .into_iter()
            .chain(w)
            .chain(light);
        let columns = columns.chain([&mut self.lambda, &mut self.blocked, &mut self.u]);
        columns.for_each(Vec::clear);
    }
}
