//! Draws the axes of polarised rays at an interface, and the signs of the Stokes vector.
//!
//! The figure is a PNG file in the folder for temporary files.
//!
//! ```text
//! cargo run --release --example polarisation_axes
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::{PI, TAU};

use asperity_io::write_bytes;
use asperity_optics::{dielectric, from_spherical, reference_axes, reflect, refract};
use asperity_plot::{Colour, Diagram, DiagramLabel, DiagramPanel, DiagramPath, Stroke};

const INK: Colour = Colour::Component(0);
const GREY: Colour = Colour::Nth(7);
const S: Colour = Colour::Nth(0);
const P: Colour = Colour::Nth(1);
const V: Colour = Colour::Nth(2);

fn path(stroke: Stroke, colour: Colour, points: Vec<[f64; 2]>) -> DiagramPath {
    DiagramPath {
        stroke,
        colour,
        points,
    }
}

fn label(text: &str, colour: Colour, at: [f64; 2]) -> DiagramLabel {
    DiagramLabel {
        text: text.into(),
        colour,
        at,
    }
}

/// A point of space as it is seen: x to the right, z up, and y away from the viewer.
fn seen(point: impl Into<[f64; 3]>) -> [f64; 2] {
    let [x, y, z] = point.into();
    [x - 0.5 * y, z + 0.17 * y]
}

/// Light that travels towards +x is reflected and refracted at a horizontal interface.
fn rays() -> DiagramPanel {
    let corners = [
        [-0.7, -0.6],
        [0.7, -0.6],
        [0.7, 0.6],
        [-0.7, 0.6],
        [-0.7, -0.6],
    ];
    let interface = corners.map(|[x, y]| seen([x, y, 0.0])).to_vec();
    let mut panel = DiagramPanel {
        caption: "At an interface".into(),
        paths: vec![
            path(Stroke::Line, GREY, interface),
            path(Stroke::Guide, INK, vec![[0.0, -0.9], [0.0, 0.9]]),
        ],
        labels: vec![label("z", INK, [0.0, 0.96])],
    };
    let (wi, normal, eta) = (from_spherical(0.75, PI), from_spherical(0.0, 0.0), 1.5);
    let refracted = refract(wi, normal, eta, dielectric(wi.z, eta).cos_theta_t);
    let origin = 0.0 * wi;
    // Each with its name, where it begins, and where along it the axes are drawn.
    let rays = [
        ("k", wi, -wi, 0.4),
        ("k′", origin, reflect(wi, normal), 0.6),
        ("k″", origin, refracted, 0.6),
    ];
    for (name, from, k, fraction) in rays {
        let [s, p] = reference_axes(k);
        let ray = vec![seen(from), seen(from + k)];
        panel.paths.push(path(Stroke::Arrow, INK, ray));
        let place = seen(from + 0.9 * k - 0.08 * p);
        panel.labels.push(label(name, INK, place));
        let foot = from + fraction * k;
        for (name, axis, colour) in [("s", s, S), ("p", p, P)] {
            let arrow = vec![seen(foot), seen(foot + 0.32 * axis)];
            panel.paths.push(path(Stroke::Arrow, colour, arrow));
            let place = seen(foot + 0.41 * axis);
            panel.labels.push(label(name, colour, place));
        }
    }
    panel
}

/// States of polarisation as a viewer sees them whom the light comes towards.
fn states() -> DiagramPanel {
    // The real field of Es = 1, Ep = i over a period, at the time factor exp(-i w t).
    let turning = |phase: f64| [0.45 * phase.cos(), 0.45 * phase.sin()];
    let circle = (0..=58).map(|i| turning(TAU * f64::from(i) / 64.0));
    DiagramPanel {
        caption: "Looking against the ray".into(),
        paths: vec![
            path(Stroke::Arrow, S, vec![[0.0, 0.0], [0.75, 0.0]]),
            path(Stroke::Arrow, P, vec![[0.0, 0.0], [0.0, 0.75]]),
            path(Stroke::Guide, INK, vec![[-0.55, -0.55], [0.55, 0.55]]),
            path(Stroke::Guide, INK, vec![[-0.75, 0.0], [0.0, 0.0]]),
            path(Stroke::Guide, INK, vec![[0.0, -0.75], [0.0, 0.0]]),
            path(Stroke::Arrow, V, circle.collect()),
        ],
        labels: vec![
            label("s", S, [0.82, 0.0]),
            label("p", P, [0.0, 0.83]),
            label("+Q", INK, [-0.85, 0.0]),
            label("−Q", INK, [0.0, -0.83]),
            label("+U", INK, [0.63, 0.62]),
            label("+V", V, [-0.42, 0.38]),
        ],
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let figure = Diagram {
        title: "Axes of polarised light".into(),
        subtitle: "s = z × k / |z × k|, p = k × s, for every ray; y points away from the viewer on the left".into(),
        panels: vec![rays(), states()],
    };
    let file = std::env::temp_dir().join("asperity_polarisation_axes.png");
    write_bytes(&file, &figure.draw()?.png()?)?;
    println!("{}", file.display());
    Ok(())
}
