//! Lengths of a surface that are compared with the wavelength: of random surfaces from their spectrum, of given ones
//! from heights or triangles.

use std::sync::Arc;

use asperity_numerics::elementary::exp;
use asperity_simulate::RandomSurfaces;
use asperity_surface::{Border, HeightBlocks, HeightField, LengthUnit, QuickRoughness};
use asperity_tracer::{Geometry, MeshSurface, Triangles};

/// Height, correlation length and curvature of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceLengths {
    /// Root mean square height.
    pub sigma: f64,
    /// The shorter 1/e correlation length; `None` where the surface has none, or it is not known.
    pub tau: Option<f64>,
    /// Root mean square second derivative along the axis where it is larger; `None` where it is not known.
    pub curvature: Option<f64>,
    /// Unit of the lengths.
    pub unit: LengthUnit,
    /// Heights of each surface; none where they are Gaussian.
    pub heights: Arc<[HeightBlocks]>,
}

impl SurfaceLengths {
    /// Lengths of random surfaces, by what they are drawn by; heights that are not Gaussian by two of them.
    #[must_use]
    pub fn of_random(surfaces: &RandomSurfaces, unit: LengthUnit) -> Self {
        let recipe = surfaces.recipe();
        let [first, second] = recipe.correlation_lengths();
        Self {
            sigma: recipe.sigma(),
            tau: Some(first.min(second)),
            curvature: recipe.curvature(),
            unit,
            // A run of surfaces that cannot be drawn has failed before
            heights: surfaces.height_blocks().unwrap_or_default(),
        }
    }

    /// Returns `true` of a unit in which lengths are compared with a wavelength.
    pub(crate) fn are_comparable(unit: LengthUnit) -> bool {
        LengthUnit::Nanometre.conversion(unit).is_some()
    }

    /// Fraction of a wave that stays coherent if a height `h` shifts its phase by `wave_number * h`, by the heights where they are
    /// known: `exp(-(wave_number sigma)^2)` of Gaussian ones, the mean over all surfaces of others.
    #[must_use]
    pub fn coherent_fraction(&self, wave_number: f64) -> f64 {
        if self.heights.is_empty() {
            return exp(-(wave_number * self.sigma).powi(2));
        }
        let of_each = self.heights.iter();
        let sum: f64 = of_each.map(|one| one.coherent_fraction(wave_number)).sum();
        sum / self.heights.len() as f64
    }

    /// The shortest of both surfaces, of which all are to be long against the wavelength.
    pub(crate) fn shortest(self, other: Self) -> Self {
        let of_both = |a: Option<f64>, b: Option<f64>, pick: fn(f64, f64) -> f64| {
            a.zip(b).map(|(a, b)| pick(a, b))
        };
        Self {
            sigma: self.sigma.min(other.sigma),
            tau: of_both(self.tau, other.tau, f64::min),
            curvature: of_both(self.curvature, other.curvature, f64::max),
            unit: self.unit,
            heights: self
                .heights
                .iter()
                .chain(&*other.heights)
                .cloned()
                .collect(),
        }
    }

    /// Lengths of a height map, by neighbouring samples; the correlation length is that of [`QuickRoughness`].
    #[must_use]
    pub fn of_field(field: &HeightField) -> Self {
        let roughness = QuickRoughness::of(field);
        let taus = [roughness.tau_x, roughness.tau_y].into_iter().flatten();
        Self {
            sigma: roughness.sq,
            tau: taus.reduce(f64::min),
            curvature: Some(root_mean_square_curvature(field)),
            unit: field.unit(),
            heights: [HeightBlocks::of(field)].into(),
        }
    }

    /// Lengths of a triangle mesh, over the area that it covers in the mean plane; without correlation length and curvature.
    #[must_use]
    pub fn of_mesh(mesh: &MeshSurface, unit: LengthUnit) -> Self {
        let (mut area, mut first, mut second) = (0.0, 0.0, 0.0);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let facets = || (0..mesh.facet_count()).map(|index| mesh.corners(mesh.facet(index)));
        for [a, b, c] in facets() {
            range = [a, b, c]
                .iter()
                .fold(range, |[low, high], p| [low.min(p.z), high.max(p.z)]);
            let covered = 0.5 * (b - a).cross(c - a).z.abs();
            area += covered;
            first += covered * (a.z + b.z + c.z) / 3.0;
            // The mean of z^2 over a triangle
            let squares = a.z * a.z + b.z * b.z + c.z * c.z;
            let products = a.z * b.z + b.z * c.z + c.z * a.z;
            second += covered * (squares + products) / 6.0;
        }
        let variance = match area > 0.0 {
            true => second / area - (first / area).powi(2),
            false => 0.0,
        };
        let [x, y] = mesh.extent();
        let in_tile =
            facets().map(|corners| corners.map(|p| [p.x / x, p.y / y, p.z * mesh.unit()]));
        Self {
            // Corners are in tile coordinates
            sigma: variance.max(0.0).sqrt() * mesh.unit(),
            tau: None,
            curvature: None,
            unit,
            heights: [HeightBlocks::of_facets(
                in_tile,
                range.map(|z| z * mesh.unit()),
            )]
            .into(),
        }
    }
}

/// Root mean square second derivative of the heights along the axis where it is larger, from neighbouring samples.
fn root_mean_square_curvature(field: &HeightField) -> f64 {
    let ([ny, nx], [dx, dy]) = (field.shape(), field.spacing());
    // Over a periodic border there are as many as samples, else none at its two ends
    let range = |n: usize| match field.border() {
        Border::Periodic => 0..n,
        _ => 1..n.max(2) - 1,
    };
    let (columns, rows) = (range(nx), range(ny));
    let row = |iy: usize| &field.heights()[iy % ny * nx..][..nx];
    let second = |[a, b, c]: [f64; 3], d: f64| ((a - 2.0 * b + c) / (d * d)).powi(2);
    let (mut along_x, mut along_y) = (0.0, 0.0);
    let (mut of_x, mut of_y) = (vec![0.0; nx], vec![0.0; nx]);
    for iy in 0..ny {
        let here = row(iy);
        for (value, three) in of_x[1..].iter_mut().zip(here.windows(3)) {
            *value = second([three[0], three[1], three[2]], dx);
        }
        for ix in [0, nx - 1] {
            let three = [ix + nx - 1, ix, ix + 1].map(|ix| here[ix % nx]);
            of_x[ix] = match columns.contains(&ix) {
                true => second(three, dx),
                false => 0.0,
            };
        }
        of_y.fill(0.0);
        if rows.contains(&iy) {
            let (before, after) = (row(iy + ny - 1), row(iy + 1));
            for (ix, value) in of_y.iter_mut().enumerate() {
                *value = second([before[ix], here[ix], after[ix]], dy);
            }
        }
        // Both sums wait for their last additions at the same time
        for (x, y) in of_x.iter().zip(&of_y) {
            along_x += x;
            along_y += y;
        }
    }
    let counts = [columns.len() * ny, rows.len() * nx].map(|count| count.max(1) as f64);
    (along_x / counts[0]).max(along_y / counts[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;

    #[test]
    fn lengths_of_a_spectrum_are_those_of_its_surfaces() {
        let psd = Psd::anisotropic_gaussian(2.0, 16.0, 32.0, 0.0).unwrap();
        let synthesis = Synthesis::new(psd, [1024, 1024], [1.0, 1.0], false).unwrap();
        let exact = SurfaceLengths::of_random(&synthesis.clone().into(), LengthUnit::Micrometre);
        let field = synthesis.draw(3, 0).unwrap();
        let found = SurfaceLengths::of_field(&field.with_unit(LengthUnit::Micrometre));
        // 2000 independent areas: 1 to 3 percent each
        assert!((found.sigma / exact.sigma - 1.0).abs() < 0.05, "{found:?}");
        let tau = found.tau.unwrap() / exact.tau.unwrap();
        assert!((tau - 1.0).abs() < 0.05, "{found:?}");
        let curvature = found.curvature.unwrap() / exact.curvature.unwrap();
        assert!((curvature - 1.0).abs() < 0.05, "{found:?}");
        assert_eq!(found.unit, exact.unit);
        // 16 by 32 correlation lengths leave about 1/4000 of speckle
        let [drawn, formula] = [&found, &exact].map(|one| one.coherent_fraction(0.5));
        assert!((drawn / formula - 1.0).abs() < 0.1, "{drawn} {formula}");
    }

    /// Second derivatives one by one.
    #[test]
    fn curvature_is_that_of_all_samples() {
        for [ny, nx] in [[2, 2], [2, 5], [7, 2], [6, 9]] {
            let heights = (0..nx * ny).map(|i| ((i * i) as f64 * 0.37).sin());
            let field = HeightField::new(heights.collect(), [ny, nx], [0.5, 2.0]).unwrap();
            for border in [Border::Periodic, Border::Open] {
                let field = field.clone().with_border(border);
                let inside =
                    |i: usize, n: usize| border == Border::Periodic || (i > 0 && i + 1 < n);
                let second = |[a, b, c]: [f64; 3], d: f64| ((a - 2.0 * b + c) / (d * d)).powi(2);
                let (mut x, mut y) = ((0.0, 0.0_f64), (0.0, 0.0_f64));
                for (ix, iy) in (0..nx * ny).map(|i| (i % nx, i / nx)) {
                    if inside(ix, nx) {
                        let three = [ix + nx - 1, ix, ix + 1].map(|ix| field.height(ix % nx, iy));
                        x = (x.0 + second(three, 0.5), x.1 + 1.0);
                    }
                    if inside(iy, ny) {
                        let three = [iy + ny - 1, iy, iy + 1].map(|iy| field.height(ix, iy % ny));
                        y = (y.0 + second(three, 2.0), y.1 + 1.0);
                    }
                }
                let [x, y] = [x, y].map(|(sum, count)| sum / count.max(1.0));
                assert_eq!(root_mean_square_curvature(&field), x.max(y).sqrt());
            }
        }
    }

    #[test]
    fn a_mesh_has_the_height_of_its_triangles() {
        let text = "v 0 0 0\nv 3 0 0\nv 3 2 6\nv 0 2 6\nf 1 2 3\nf 1 3 4\n";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ramp.obj");
        std::fs::write(&path, text).unwrap();
        let read = asperity_io::read_mesh(&path).unwrap();
        let mesh = MeshSurface::new(&read.vertices, read.triangles, Border::Open).unwrap();
        let found = SurfaceLengths::of_mesh(&mesh, LengthUnit::Metre);
        // Heights spread evenly from 0 to 6
        assert!(
            (found.sigma - 6.0 / 12_f64.sqrt()).abs() < 1e-12,
            "{found:?}"
        );
        assert_eq!((found.tau, found.curvature), (None, None));
        let half = 0.5 * 6.0 * 0.7_f64;
        let coherent = (half.sin() / half).powi(2);
        assert!(
            (found.coherent_fraction(0.7) - coherent).abs() < 1e-5,
            "{found:?}"
        );
    }
}
