//! Evaluates the Beckmann distribution and Smith's masking, and draws the masking function as a figure.
//!
//! The figure is an SVG file in the folder for temporary files.
//!
//! ```text
//! cargo run --release --example masking_figure
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_analysis::{Beckmann, Masking, SlopeCovariance};
use asperity_io::write_bytes;
use asperity_optics::from_spherical;
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axis = |label: &str, range| CurveAxis {
        label: label.into(),
        range: Some(range),
    };
    let mut figure = Curves {
        title: "Smith's masking".into(),
        subtitle: "Gaussian slopes".into(),
        x: axis("θ (degrees)", [0.0, 90.0]),
        y: axis("G1", [0.0, 1.0]),
        log_from: None,
        curves: Vec::new(),
        notes: Vec::new(),
    };
    let w = |theta_deg: f64| from_spherical(theta_deg.to_radians(), 0.0);
    for (i, smoothness) in [1.0, 3.0, 10.0].into_iter().enumerate() {
        let distribution = Beckmann::new(SlopeCovariance::isotropic(smoothness)?);
        let g2 = |masking| distribution.g2(w(60.0), w(70.0), masking);
        let (d, lambda) = (distribution.d(w(0.0)), distribution.lambda(w(60.0)));
        let (separable, correlated) = (g2(Masking::Separable), g2(Masking::HeightCorrelated));
        println!("s = {smoothness:>2}: D(0) = {d:.4}, Lambda(60 deg) = {lambda:.4}");
        println!("        G2 = {separable:.4} separable, {correlated:.4} height-correlated");
        let g1 = |theta: f64| Point::exact(theta, distribution.g1(w(theta)));
        figure.curves.push(Curve {
            name: format!("s = {smoothness}"),
            colour: Colour::Nth(i),
            style: Style::Line(i),
            points: (0..90).map(|theta| g1(theta.into())).collect(),
        });
    }
    let path = std::env::temp_dir().join("asperity_masking.svg");
    write_bytes(&path, figure.draw()?.svg()?.as_bytes())?;
    println!("{}", path.display());
    Ok(())
}
