//! Half-vectors: reflection of light from one direction over the square of half-vectors of a `.bsdf` file.
//!
//! A point `[x, y]` of the unit square is the half-vector of polar angle `x^2 pi / 2` and azimuth `(2 y - 1) pi`: nodes are dense about the
//! normal, where lobes are narrow. Nodes lie at `k / (n - 1)`, and between them values are bilinear.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_numerics::elementary::sin;
use asperity_optics::from_spherical;
use glam::DVec3;

/// BRDF times cosine at the nodes, 1/sr, columns (polar angle) fastest.
#[derive(Clone, Debug)]
pub(super) struct HalfVectors {
    nodes: usize,
    values: Vec<f64>,
}

impl HalfVectors {
    /// Values at `nodes` times `nodes` half-vectors, of light from the direction `light`; `value` is the BRDF of a direction times its cosine.
    pub(super) fn of(nodes: usize, light: DVec3, value: impl Fn(DVec3) -> f64) -> Self {
        let at = |i: usize| {
            let [x, y] = [i % nodes, i / nodes].map(|k| k as f64 / (nodes - 1) as f64);
            mirrored(light, half_vector([x, y])).map_or(0.0, |leaving| value(leaving).max(0.0))
        };
        let values = (0..nodes * nodes).map(at).collect();
        Self { nodes, values }
    }

    /// The mean with what the mirror image about the plane of incidence has, for light of azimuth zero.
    pub(super) fn symmetric(self) -> Self {
        let Self { nodes, values } = self;
        let mirror = |i: usize| (nodes - 1 - i / nodes) * nodes + i % nodes;
        let mean = |i: usize| 0.5 * (values[i] + values[mirror(i)]);
        let values = (0..values.len()).map(mean).collect();
        Self { nodes, values }
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.values.iter_mut().for_each(|value| *value *= factor);
    }

    /// Number of nodes along either side.
    pub(super) const fn nodes(&self) -> usize {
        self.nodes
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Value at a point of the square.
    pub(super) fn at(&self, point: [f64; 2]) -> f64 {
        let last = self.nodes - 1;
        let [(x, u), (y, v)] = point.map(|at| {
            let scaled = at * last as f64;
            let cell = (scaled as usize).min(last - 1);
            (cell, scaled - cell as f64)
        });
        let row = |y: usize| {
            let values = &self.values[y * self.nodes + x..][..2];
            values[0] + u * (values[1] - values[0])
        };
        row(y) + v * (row(y + 1) - row(y))
    }

    /// Density over the square of light that leaves.
    pub(super) fn density(&self, light: DVec3) -> Vec<f64> {
        let weighted = self.points().map(|(point, value)| {
            value * solid_angle(point) * 4.0 * light.dot(half_vector(point)).max(0.0)
        });
        weighted.collect()
    }

    /// Integral over the solid angle of half-vectors, in units of its own.
    pub(super) fn over_half_vectors(&self) -> f64 {
        let weighted = self
            .points()
            .map(|(point, value)| value * solid_angle(point));
        weighted.sum()
    }

    fn points(&self) -> impl Iterator<Item = ([f64; 2], f64)> {
        let last = (self.nodes - 1) as f64;
        let point = move |i: usize| [i % self.nodes, i / self.nodes].map(|k| k as f64 / last);
        self.values
            .iter()
            .enumerate()
            .map(move |(i, value)| (point(i), *value))
    }
}

/// Integral over the directions in which light leaves, in `parts` times `parts` equal parts of the square.
pub(super) fn integral(light: DVec3, parts: usize, value: impl Fn([f64; 2]) -> f64) -> f64 {
    let points = (0..parts * parts).map(|i| {
        let point = [i % parts, i / parts].map(|k| (k as f64 + 0.5) / parts as f64);
        let leaves = mirrored(light, half_vector(point)).is_some();
        if leaves {
            value(point) * solid_angle(point) * 4.0 * light.dot(half_vector(point))
        } else {
            0.0
        }
    });
    points.sum::<f64>() / (parts * parts) as f64
}

/// The half-vector at a point of the square.
pub(super) fn half_vector([x, y]: [f64; 2]) -> DVec3 {
    from_spherical(x * x * FRAC_PI_2, (2.0 * y - 1.0) * PI)
}

/// The direction on the other side of a half-vector.
pub(super) fn mirror(light: DVec3, half: DVec3) -> DVec3 {
    2.0 * light.dot(half) * half - light
}

/// The direction in which light leaves, if it does so above the horizon.
pub(super) fn mirrored(light: DVec3, half: DVec3) -> Option<DVec3> {
    let leaving = mirror(light, half);
    (light.dot(half) > 0.0 && leaving.z > 0.0).then_some(leaving)
}

/// Solid angle of half-vectors, per area of the square; light that leaves has `4 cos` of the angle between it and them of that.
fn solid_angle([x, _]: [f64; 2]) -> f64 {
    2.0 * PI * PI * x * sin(x * x * FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lambertian_surface_reflects_all_light() {
        for (theta, tolerance) in [(0.0, 2e-4), (0.7, 2e-3), (1.4, 5e-3)] {
            let light = from_spherical(theta, 0.0);
            let square = HalfVectors::of(65, light, |leaving| leaving.z / PI);
            let found = integral(light, 256, |point| square.at(point));
            assert!((found - 1.0).abs() < tolerance, "{theta}: {found}");
        }
    }

    #[test]
    fn values_between_nodes_are_bilinear() {
        let square = HalfVectors {
            nodes: 3,
            values: vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 20.0, 21.0, 22.0],
        };
        for point in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.7], [1.0, 1.0]] {
            let expected = 2.0 * point[0] + 20.0 * point[1];
            assert!((square.at(point) - expected).abs() < 1e-12, "{point:?}");
        }
    }
}
