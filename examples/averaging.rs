//! Cost of averaging s and p at every facet, as most scattering models and ray tracers do: reflected light with its
//! polarisation tracked, less the same averaged, over smoothness, material and angle.
//!
//! Both are traced on the same paths, so that the difference has a small error of its own. It prints a Markdown table, in
//! 1e-5 of the incident flux, with percentages of the reflected flux, and draws a figure in the folder for temporary files.
//!
//! ```text
//! cargo run --release --example averaging                  # s = 2, glass; some seconds
//! cargo run --release --example averaging -- all 32        # all cases, on 32 surfaces
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_io::write_bytes;
use asperity_optics::{Incidence, Material};
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
use asperity_simulate::{
    Case, Effort, Estimator, Light, Outcome, Settings, Silent, SurfaceSource, simulate,
};
use asperity_synthesis::{Psd, SplineSynthesis};
use asperity_tally::{Component, Estimate, Measure, Side, TallyResult, TallySpec};
use asperity_tracer::{PathSettings, Polarisation};

const THETAS: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0];

/// Rays on each surface.
const RAYS: u64 = 65_536;

/// Surfaces and what they are made of.
struct Scene {
    smoothness: f64,
    name: &'static str,
    material: Material,
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let all = arguments.first().is_some_and(|first| first == "all");
    let surfaces = match arguments.get(1) {
        Some(count) if all => count.parse()?,
        _ => 8,
    };
    let glass = Material::dielectric(1.5)?;
    let out_of_glass = Material::dielectric(1.0 / 1.5)?;
    let gold = Material::conductor(0.43, 2.455)?;
    let mut scenes = vec![(2.0, "1.5", glass)];
    if all {
        scenes = vec![
            (6.0, "1.5", glass),
            (3.0, "1.5", glass),
            (2.0, "1.5", glass),
            (1.0, "1.5", glass),
            (2.0, "1/1.5", out_of_glass),
            (1.0, "1/1.5", out_of_glass),
            (2.0, "gold", gold),
            (1.0, "gold", gold),
        ];
    }
    let mut curves = Vec::new();
    println!("| s | n |{}", THETAS.map(|t| format!(" {t} |")).concat());
    println!("|---|---|{}", "---|".repeat(THETAS.len()));
    for (number, (smoothness, name, material)) in scenes.into_iter().enumerate() {
        let scene = Scene {
            smoothness,
            name,
            material,
        };
        let found = differences(&scene, surfaces)?;
        let cells = found.iter().map(|[difference, percent]| {
            let se = difference.se.unwrap_or(f64::NAN);
            format!(
                " {:.1}({:.1}) [{:.2}] |",
                1e5 * difference.mean,
                1e5 * se,
                percent.mean
            )
        });
        println!("| {smoothness} | {name} |{}", cells.collect::<String>());
        curves.push(curve(&scene, number, &found));
    }
    let figure = Curves {
        title: "Reflected flux: what tracking polarisation adds to averaging s and p".into(),
        subtitle: format!("Gaussian surfaces, unpolarised light, {surfaces} surfaces each"),
        x: CurveAxis {
            label: "θᵢ (degrees)".into(),
            range: Some([0.0, 90.0]),
        },
        y: CurveAxis {
            label: "(tracked − averaged) / tracked (%)".into(),
            range: None,
        },
        log_from: None,
        curves,
        notes: vec!["Gold: n = 0.43 + 2.455 i.".into()],
    };
    let path = std::env::temp_dir().join("asperity_averaging.png");
    write_bytes(&path, &figure.draw()?.png()?)?;
    println!("\n{}", path.display());
    Ok(())
}

/// Tracked less averaged at each angle: reflected flux, and percent of that.
fn differences(
    scene: &Scene,
    surfaces: u64,
) -> Result<Vec<[Estimate; 2]>, Box<dyn std::error::Error>> {
    let tau = 4.0;
    let psd = Psd::gaussian(tau / scene.smoothness, tau)?;
    let drawn = SplineSynthesis::new(psd, [128, 128], [1.0, 1.0], false)?;
    let mut cases = Vec::new();
    for theta in THETAS {
        let light = Light {
            spread: None,
            random_azimuth: true,
            ..Light::from_above(Incidence::from_degrees(theta, 0.0)?)
        };
        let source = SurfaceSource::random(drawn.clone());
        cases.push(Case::new(source, scene.material, light));
    }
    let polarisation = Polarisation::Both;
    let settings = Settings {
        tally: TallySpec::default().with_polarimetry(polarisation.polarimetry()),
        paths: PathSettings::default()
            .with_polarisation(polarisation)
            .into(),
        estimator: Estimator::Plain,
        effort: Effort::Rays {
            total: surfaces * RAYS,
            surfaces,
        },
        ..Settings::default()
    };
    let outcomes = simulate(&cases, &settings, &Silent)?;
    outcomes.iter().map(of_outcome).collect()
}

fn of_outcome(outcome: &Outcome) -> Result<[Estimate; 2], Box<dyn std::error::Error>> {
    let statistics = &outcome.statistics;
    let spec = statistics.spec();
    let flux = spec.flux_entry(Side::Reflected, Component::All);
    let entry = spec.measure_entry(flux, Measure::Averaging);
    let difference = statistics.at(entry.ok_or("the difference is not kept")?);
    let ratio = statistics.over_flux(flux, Measure::Averaging);
    let ratio = ratio.ok_or("nothing is reflected")?;
    let percent = Estimate {
        mean: 100.0 * ratio.mean,
        se: ratio.se.map(|se| 100.0 * se),
    };
    Ok([difference, percent])
}

fn curve(scene: &Scene, number: usize, found: &[[Estimate; 2]]) -> Curve {
    let points = THETAS
        .into_iter()
        .zip(found)
        .map(|(x, [_, percent])| Point {
            x,
            y: percent.mean,
            se: percent.se,
            x_range: None,
        });
    Curve {
        name: format!(
            "s = {}, {}",
            scene.smoothness,
            match scene.name {
                "gold" => "gold".to_owned(),
                index => format!("n = {index}"),
            }
        ),
        colour: Colour::Nth(number),
        style: Style::Joined(number),
        points: points.collect(),
    }
}
