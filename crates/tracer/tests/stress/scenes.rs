//! Surfaces that are hard on rays.

use asperity_surface::{Border, HeightField};
use asperity_synthesis::{Psd, Synthesis};

use crate::stressed::Stressed;

/// A surface and what it is called in the table.
pub(crate) struct Scene<G> {
    pub(crate) name: String,
    pub(crate) surface: G,
}

const BORDERS: [Border; 3] = [Border::Periodic, Border::Mirrored, Border::Open];

/// A Gaussian surface of smoothness `s`, two spacings a correlation length: rough from facet to
/// facet. `shape`: `[ny, nx]`.
pub(crate) fn gaussian(s: f64, shape: [usize; 2], spacing: [f64; 2], seed: u64) -> HeightField {
    let tau = 2.0 * spacing[0].max(spacing[1]);
    let psd = Psd::gaussian(tau / s, tau).unwrap();
    let synthesis = Synthesis::new(psd, shape, spacing, true).unwrap();
    synthesis.draw(seed, 0).unwrap()
}

/// `field` with every height passed through `change`.
fn changed(field: &HeightField, change: impl Fn(f64) -> f64) -> HeightField {
    let heights = field.heights().iter().map(|&h| change(h)).collect();
    field.with_heights(heights).unwrap()
}

/// Heights from `(column, row)`, spacing one.
fn drawn([ny, nx]: [usize; 2], height: impl Fn(usize, usize) -> f64) -> HeightField {
    let heights = (0..nx * ny).map(|i| height(i % nx, i / nx)).collect();
    HeightField::new(heights, [ny, nx], [1.0; 2]).unwrap()
}

/// `field` in units `scale` times as small: heights and spacings times `scale`.
pub(crate) fn scaled(field: &HeightField, scale: f64) -> HeightField {
    let heights = field.heights().iter().map(|h| h * scale).collect();
    let spacing = field.spacing().map(|d| d * scale);
    HeightField::new(heights, field.shape(), spacing)
        .unwrap()
        .with_border(field.border())
}

/// All scenes: each of them small enough for brute force.
pub(crate) fn all<G: Stressed>() -> Vec<Scene<G>> {
    let one = [1.0; 2];
    let mut scenes = Vec::new();
    let mut push = |name: String, field: HeightField| {
        let surface = G::through(field);
        scenes.push(Scene { name, surface });
    };
    for (i, s) in [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0]
        .into_iter()
        .enumerate()
    {
        let field = gaussian(s, [12, 16], one, i as u64);
        push(format!("s = {s}"), field);
    }
    for (ny, nx) in [(2, 2), (2, 3), (5, 7), (64, 64), (37, 100)] {
        for border in BORDERS {
            let field = gaussian(1.0, [ny, nx], one, 20);
            push(format!("{nx} x {ny}, {border}"), field.with_border(border));
        }
    }
    for (dx, dy) in [(1.0, 3.0), (3.0, 1.0), (1.0, 0.01), (0.001, 1.0)] {
        for border in [Border::Periodic, Border::Mirrored] {
            let field = gaussian(1.0, [8, 10], [dx, dy], 30);
            push(
                format!("spacing {dx} x {dy}, {border}"),
                field.with_border(border),
            );
        }
    }
    for scale in [1e-9, 1e9] {
        let field = scaled(&gaussian(0.5, [9, 11], one, 40), scale);
        push(format!("scale {scale:e}"), field);
    }
    let field = gaussian(1.0, [9, 11], one, 41);
    push("offset 1e6 sigma".into(), changed(&field, |h| h + 2e6));
    for border in BORDERS {
        let rough = gaussian(0.5, [10, 12], one, 50);
        let plateaus = changed(&rough, |h| h.clamp(-1.0, 0.5));
        push(format!("plateaus, {border}"), plateaus.with_border(border));
        let steps = changed(&rough, |h| (0.5 * h).round());
        push(format!("steps, {border}"), steps.with_border(border));
        // Alternating corners: every diagonal is a ridge or a valley, every cell a saddle.
        let saddles = drawn([8, 10], |ix, iy| ((ix + iy) % 2) as f64);
        push(format!("saddles, {border}"), saddles.with_border(border));
        let spikes = drawn([8, 9], |ix, iy| match 31 * ix + 17 * iy {
            i if i % 13 == 0 => 1e4,
            i if i % 13 == 5 => -1e4,
            i => 1e-3 * (i % 7) as f64,
        });
        push(format!("spikes, {border}"), spikes.with_border(border));
        let flat = drawn([4, 5], |_, _| 7.0);
        push(format!("flat, {border}"), flat.with_border(border));
    }
    push("offset 1e9 sigma".into(), changed(&field, |h| h + 2e9));
    for border in BORDERS {
        let field = gaussian(0.3, [2, 4], one, 20);
        push(format!("4 x 2, {border}"), field.with_border(border));
    }
    for (dx, dy) in [(1.0, 1000.0), (1000.0, 1.0)] {
        let field = gaussian(1.0, [8, 10], [dx, dy], 30);
        push(format!("spacing {dx} x {dy}"), field);
    }
    // As high as surfaces may be, with room for a spline that overshoots.
    for height in [1e3, 5e4] {
        let spike = drawn([7, 8], |ix, iy| match [ix, iy] {
            [3, 4] => height,
            _ => 1e-3 * ((31 * ix + 17 * iy) % 7) as f64,
        });
        push(format!("one spike of {height:e}"), spike);
    }
    scenes
}
