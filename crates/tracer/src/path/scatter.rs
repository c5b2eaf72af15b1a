//! Scatter: what facets of the upper surface do with the light that has arrived, many at a time.
//!
//! The same as [`crate::interaction::facet::scatter`], which tests hold against it.

use asperity_optics::{Material, dielectric, reflect, refract};
use glam::DVec3;

use super::arrivals::Arrivals;
use crate::vector::Stage;

/// Shares of the flux that facets reflect and transmit, and where to.
#[derive(Default)]
pub(super) struct ScatteredLight {
    pub(super) reflected: Vec<f64>,
    pub(super) transmitted: Vec<f64>,
    /// Unit vectors in the orientation of the tile; of no meaning where nothing is transmitted.
    pub(super) wo: [Vec<f64>; 3],
    pub(super) wt: [Vec<f64>; 3],
    /// What paths carry of reflected and of transmitted light, as [`super::segments::Segments::light`] keeps it.
    pub(super) light: [Vec<Vec<f64>>; 2],
}

impl ScatteredLight {
    /// Resizes all columns to `n` arrivals.
    pub(super) fn resize(&mut self, n: usize) {
        let columns = self.wo.iter_mut().chain(&mut self.wt);
        for column in columns.chain([&mut self.reflected, &mut self.transmitted]) {
            column.resize(n, 0.0);
        }
    }
}

/// Computes what becomes of all arrivals.
pub(super) struct Scatter<'a, F> {
    pub(super) arrivals: &'a Arrivals<F>,
    /// Sign of the half space of the light.
    pub(super) incident: f64,
    pub(super) material: Material,
    pub(super) into: &'a mut ScatteredLight,
}

impl<F: Copy> Stage for Scatter<'_, F> {
    #[inline(always)]
    fn run(self) {
        let n = self.arrivals.len();
        self.into.resize(n);
        let ScatteredLight {
            reflected,
            transmitted,
            wo,
            wt,
            ..
        } = self.into;
        let at = &self.arrivals.at;
        let [dx, dy, dz] = at.direction.each_ref().map(|column| &column[..n]);
        let [mx, my, mz] = self.arrivals.normal.each_ref().map(|column| &column[..n]);
        let side = &at.side[..n];
        let (reflected, transmitted) = (&mut reflected[..n], &mut transmitted[..n]);
        let [ox, oy, oz] = wo.each_mut().map(|column| &mut column[..n]);
        let [tx, ty, tz] = wt.each_mut().map(|column| &mut column[..n]);
        // What a facet sees of the light that has arrived: where it comes from, and the normal on its side
        macro_rules! facing {
            ($i:ident) => {{
                let q = side[$i];
                let wi = DVec3::new(-dx[$i], -dy[$i], -dz[$i]);
                let m = DVec3::new(q * mx[$i], q * my[$i], q * mz[$i]);
                let cos_theta_i = wi.dot(m);
                let cos_theta_i = if cos_theta_i > 0.0 { cos_theta_i } else { 0.0 };
                let cos_theta_i = if cos_theta_i < 1.0 { cos_theta_i } else { 1.0 };
                (wi, m, cos_theta_i)
            }};
        }
        // Reflect by the Fresnel equations of the material
        match self.material {
            Material::Dielectric { eta } => {
                let etas = [eta, 1.0 / eta];
                for i in 0..n {
                    let (wi, m, cos_theta_i) = facing!(i);
                    let is_entering = side[i] == self.incident;
                    let eta = if is_entering { etas[0] } else { etas[1] };
                    let fresnel = dielectric(cos_theta_i, eta);
                    reflected[i] = fresnel.reflected;
                    transmitted[i] = fresnel.transmitted;
                    let direction = refract(wi, m, eta, fresnel.cos_theta_t);
                    tx[i] = direction.x;
                    ty[i] = direction.y;
                    tz[i] = direction.z;
                }
            }
            material => {
                transmitted.fill(0.0);
                for (i, reflected) in reflected.iter_mut().enumerate() {
                    let (_, _, cos_theta_i) = facing!(i);
                    *reflected = material.fresnel(cos_theta_i).reflected;
                }
            }
        }
        for i in 0..n {
            let (wi, m, _) = facing!(i);
            let direction = reflect(wi, m);
            ox[i] = direction.x;
            oy[i] = direction.y;
            oz[i] = direction.z;
        }
    }
}
