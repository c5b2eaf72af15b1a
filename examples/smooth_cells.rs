//! Mesh error of facets and of smooth cells: the same random surfaces at several spacings, lit by the same rays.
//!
//! Prints what each adds to the flux reflected (R) and transmitted after one interaction (T1) and two (T2), times 1e4,
//! with the standard error of the last digits in brackets, and the root of the sum of squares of what it adds to rings
//! of five degrees, noise taken out. The reference is smooth cells at 16 samples per correlation length.
//!
//! ```text
//! cargo run --release --example smooth_cells              # s = 1, light leaving glass: seconds
//! cargo run --release --example smooth_cells -- all 40    # all cases, 40 surfaces each: minutes
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Incidence, Material};
use asperity_synthesis::{Psd, SplineSynthesis, Synthesis};
use asperity_tally::{Component, Side, TallyResult, TallySpec, TallyValues};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, HalfSpace, Illumination, PathSettings, PathStream,
    Polarisation, SmoothSurface, Surface, Tracer,
};
use std::error::Error;

/// Correlation lengths along the side of a tile.
const TILE: usize = 16;

/// Rays along the side of the square that falls on a surface.
const STRATA: u32 = 128;

/// A case: smoothness, index of refraction, angle of incidence in degrees.
type Case = (f64, f64, f64);

/// Cells, and how many of them there are in a correlation length.
#[derive(Clone, Copy)]
enum Cells {
    Facets(usize),
    Smooth(usize),
}

fn trace<G: BuildAccelerator>(
    surface: &G,
    case: Case,
    number: u64,
) -> Result<TallyValues, Box<dyn Error>> {
    let (_, eta, theta_deg) = case;
    let accelerator = surface.accelerator(AcceleratorKind::Auto)?;
    let material = Material::dielectric(eta)?;
    // s and p are averaged at every facet, as most models do.
    let settings = PathSettings::default().with_polarisation(Polarisation::Averaged);
    let tracer = Tracer::new(surface, &*accelerator, material, HalfSpace::Above, settings);
    let light = Illumination::new(Incidence::from_degrees(theta_deg, 0.0)?, false);
    let stream = PathStream::new(1, number);
    Ok(tracer
        .batch(&light, STRATA, TallySpec::default(), None, stream)
        .0)
}

/// Compared figures of one surface: R, T1, T2, then the rings of both sides.
fn find(cells: Cells, case: Case, number: u64) -> Result<Vec<f64>, Box<dyn Error>> {
    let psd = Psd::gaussian(1.0 / case.0, 1.0)?;
    let (Cells::Facets(per_tau) | Cells::Smooth(per_tau)) = cells;
    let (shape, spacing) = ([TILE * per_tau; 2], [1.0 / per_tau as f64; 2]);
    let values = match cells {
        Cells::Facets(_) => {
            let field = Synthesis::new(psd, shape, spacing, false)?.draw(1, number)?;
            trace(&Surface::new(field), case, number)?
        }
        Cells::Smooth(_) => {
            let spline = SplineSynthesis::new(psd, shape, spacing, false)?.draw(1, number)?;
            trace(&SmoothSurface::new(spline), case, number)?
        }
    };
    let mut found = vec![
        values.flux(Side::Reflected, Component::All),
        values.flux(Side::Transmitted, Component::Order(1)),
        values.flux(Side::Transmitted, Component::Order(2)),
    ];
    for side in Side::BOTH {
        found.extend(values.rings(side, Component::All).iter());
    }
    Ok(found)
}

/// Mean and standard error.
fn mean(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    [mean, (squares / (n * (n - 1.0))).sqrt()]
}

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let all = arguments.first().is_some_and(|first| first == "all");
    let surfaces: u64 = match arguments.get(1) {
        Some(number) if all => number.parse()?,
        _ => 8,
    };
    if surfaces < 2 {
        return Err("errors take two surfaces at least".into());
    }
    let mut cases = vec![(1.0, 1.0 / 1.5, 0.0)];
    if all {
        cases.clear();
        for s in [3.0, 1.0, 0.5] {
            for eta in [1.5, 1.0 / 1.5] {
                cases.extend([0.0, 30.0, 60.0, 80.0].map(|theta| (s, eta, theta)));
            }
        }
    }
    let compared = [
        Cells::Facets(8),
        Cells::Facets(16),
        Cells::Facets(32),
        Cells::Smooth(3),
        Cells::Smooth(4),
        Cells::Smooth(6),
    ];
    println!("| s | n | theta | cells | R | T1 | T2 | rings |");
    println!("|---|---|---|---|---|---|---|---|");
    for case in cases {
        let find_all = |cells| -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
            (0..surfaces)
                .map(|number| find(cells, case, number))
                .collect()
        };
        let reference = find_all(Cells::Smooth(16))?;
        let (s, eta, theta_deg) = case;
        let scene = format!("| {s} | {eta:.4} | {theta_deg} |");
        let mut line = format!("{scene} *reference* |");
        for i in 0..3 {
            let values: Vec<f64> = reference.iter().map(|found| found[i]).collect();
            line += &format!(" {:.5} |", mean(&values)[0]);
        }
        println!("{line} |");
        for cells in compared {
            let name = match cells {
                Cells::Facets(n) => format!("facets {n}"),
                Cells::Smooth(n) => format!("smooth {n}"),
            };
            let found = find_all(cells)?;
            let adds = |i: usize| {
                let pairs = found.iter().zip(&reference);
                mean(&pairs.map(|(a, b)| a[i] - b[i]).collect::<Vec<f64>>())
            };
            let mut line = format!("{scene} {name} |");
            for i in 0..3 {
                let [added, error] = adds(i).map(|x| x * 1e4);
                line += &format!(" {added:+.1}({error:.1}) |");
            }
            let squares = (3..reference[0].len()).map(|i| {
                let [added, error] = adds(i);
                added * added - error * error
            });
            let rings = squares.sum::<f64>().max(0.0).sqrt() * 1e4;
            println!("{line} {rings:.0} |");
        }
    }
    Ok(())
}
