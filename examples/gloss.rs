//! Specular gloss of random surfaces of black glass at 20, 60 and 85 degrees: by rays, with coherent light, and by the series of the Kirchhoff
//! approximation for Gaussian heights.
//!
//! The series (Beckmann and Spizzichino 1963) has diffraction and interference, no shadowing and no multiple scattering; rays have the last two alone.
//! It prints a Markdown table in gloss units and draws a figure in the folder for temporary files.
//!
//! ```text
//! cargo run --release --example gloss                # a correlation length of 20 um; some seconds
//! cargo run --release --example gloss -- 2 32        # of 2 um, on 32 surfaces
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::PI;

use asperity_io::write_bytes;
use asperity_optics::{Incidence, Material, dielectric};
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
use asperity_simulate::{
    Case, CaseApertures, Effort, Light, Outcome, Settings, Silent, SurfaceSource, simulate,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Aperture, ApertureShape, Estimate, Sides, TallyResult, TallySpec};

const WAVELENGTH_UM: f64 = 0.55;
const INDEX: f64 = 1.567;
const THETAS: [f64; 3] = [20.0, 60.0, 85.0];
const SIGMAS_UM: [f64; 10] = [0.01, 0.02, 0.035, 0.05, 0.075, 0.1, 0.15, 0.2, 0.3, 0.4];

/// Rays on each surface.
const RAYS: u64 = 16_384;

/// Gloss of one surface at one angle, in gloss units.
struct Gloss {
    by_rays: Estimate,
    together: Estimate,
    series: f64,
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|one| one.parse::<u32>());
    let tau_um = f64::from(arguments.next().and_then(Result::ok).unwrap_or(20));
    let surfaces = u64::from(arguments.next().and_then(Result::ok).unwrap_or(8));

    let mut cases = Vec::new();
    for sigma in SIGMAS_UM {
        let psd = Psd::gaussian(sigma, tau_um)?;
        let drawn = Synthesis::new(psd, [128, 128], [tau_um / 12.0; 2], false)?;
        for theta in THETAS {
            let light = Light::from_above(Incidence::from_degrees(theta, 0.0)?);
            let source = SurfaceSource::random(drawn.clone());
            cases.push(Case::new(source, Material::dielectric(INDEX)?, light));
        }
    }
    let settings = Settings {
        tally: TallySpec::default().with_sides(Sides::Reflected),
        effort: Effort::Rays {
            total: surfaces * RAYS,
            surfaces,
        },
        ..Settings::default()
    };
    let outcomes = simulate(&cases, &settings, &Silent)?;

    println!("| sigma (um) | angle | by rays | with coherent light | series |");
    println!("|---|---|---|---|---|");
    let mut found = Vec::new();
    for (of_sigma, sigma) in outcomes.chunks(THETAS.len()).zip(SIGMAS_UM) {
        for (outcome, theta) in of_sigma.iter().zip(THETAS) {
            let one = gloss(outcome, sigma, tau_um).ok_or("no aperture of a glossmeter")?;
            println!(
                "| {sigma} | {theta} | {} | {} | {:.2} |",
                shown(one.by_rays),
                shown(one.together),
                one.series
            );
            found.push(one);
        }
    }
    let curves = THETAS.iter().enumerate().flat_map(|(number, theta)| {
        let points = |value: fn(&Gloss) -> Estimate| {
            let of_theta = found[number..].iter().step_by(THETAS.len());
            let points = SIGMAS_UM.iter().zip(of_theta);
            points.map(|(&x, one)| point(x, value(one))).collect()
        };
        let aperture = CaseApertures::of(&cases[number]).gloss;
        let line = (0..=160).filter_map(|i| {
            let sigma = 0.0025 * f64::from(i);
            Some(Point::exact(sigma, series(sigma, tau_um, aperture?)))
        });
        let curve = |name: &str, style, points| Curve {
            name: format!("{theta}°, {name}"),
            colour: Colour::Nth(number),
            style,
            points,
        };
        [
            curve("Kirchhoff series", Style::Line(0), line.collect()),
            curve("by rays", Style::Hollow(number), points(|one| one.by_rays)),
            curve(
                "with coherent light",
                Style::Points(number),
                points(|one| one.together),
            ),
        ]
    });
    let figure = Curves {
        title: "Specular gloss of black glass".into(),
        subtitle: format!("Gaussian heights, τ = {tau_um} µm, λ = 550 nm"),
        x: CurveAxis {
            label: "σ (µm)".into(),
            range: Some([0.0, 0.42]),
        },
        y: CurveAxis {
            label: "gloss (GU)".into(),
            range: Some([0.0, 105.0]),
        },
        log_from: None,
        curves: curves.collect(),
        notes: Vec::new(),
    };
    let path = std::env::temp_dir().join(format!("asperity_gloss_{tau_um}um.png"));
    write_bytes(&path, &figure.draw()?.png()?)?;
    println!("\n{}", path.display());
    Ok(())
}

fn shown(value: Estimate) -> String {
    format!("{:.2}({:.2})", value.mean, value.se.unwrap_or(f64::NAN))
}

fn point(x: f64, value: Estimate) -> Point {
    Point {
        x,
        y: value.mean,
        se: value.se,
        x_range: None,
    }
}

/// Phase of a surface, squared.
fn phase_squared(sigma_um: f64, theta: f64) -> f64 {
    (4.0 * PI / WAVELENGTH_UM * sigma_um * theta.cos()).powi(2)
}

/// Gloss of a result; `None` at angles of no glossmeter.
fn gloss(outcome: &Outcome, sigma_um: f64, tau_um: f64) -> Option<Gloss> {
    let (case, statistics) = (&outcome.case, &outcome.statistics);
    let aperture = CaseApertures::of(case).gloss?;
    let number = statistics.spec().apertures().position(aperture)?;
    let flux = statistics.apertures().nth(number)?;
    let unit = 100.0 / dielectric(aperture.theta.cos(), INDEX).reflected;
    let coherent = (-phase_squared(sigma_um, aperture.theta)).exp();
    let scaled = |factor: f64, added: f64| Estimate {
        mean: added + factor * flux.mean,
        se: flux.se.map(|se| factor * se),
    };
    Some(Gloss {
        by_rays: scaled(unit, 0.0),
        together: scaled(unit * (1.0 - coherent), 100.0 * coherent),
        series: series(sigma_um, tau_um, aperture),
    })
}

/// Gloss by the Kirchhoff approximation, `100 exp(-g^2) (1 + sum over m of g^2m / m! P_m)`.
///
/// About the mirror direction the light of the term `m` is Gaussian in the change of the wave vector, with the variance `2 m / tau^2` in each direction.
/// `P_m` is its part in the receptor, averaged over the points of the source. Reflectance is taken as constant over the lobe.
fn series(sigma_um: f64, tau_um: f64, aperture: Aperture) -> f64 {
    let ApertureShape::Receptor { in_plane, across } = aperture.shape else {
        return f64::NAN;
    };
    let part = |[source, receptor]: [f64; 2], scale: f64| {
        const POINTS: u32 = 32;
        let of_point = |i: u32| {
            let at = source * ((f64::from(i) + 0.5) / f64::from(POINTS) - 0.5);
            let edge = |side: f64| libm::erf(scale * (0.5 * receptor + side * at).tan());
            0.5 * (edge(1.0) + edge(-1.0))
        };
        (0..POINTS).map(of_point).sum::<f64>() / f64::from(POINTS)
    };
    let g2 = phase_squared(sigma_um, aperture.theta);
    let mut term = (-g2).exp();
    let mut sum = term;
    for m in 1..=(30.0 + 3.0 * g2) as u32 {
        let m = f64::from(m);
        term *= g2 / m;
        let scale = PI * tau_um / (WAVELENGTH_UM * m.sqrt());
        sum += term * part(in_plane, scale * aperture.theta.cos()) * part(across, scale);
    }
    100.0 * sum
}
