//! Explicit results against those of an independent tracer, which averages s and p at every facet.
//!
//! The large reference files are no part of the project: where `../shared` is missing, the tests that
//! need it say so and pass. The essentials, the ensemble means of random surfaces, stand here.

use std::f64::consts::PI;
use std::path::PathBuf;

use asperity_io::read_height_map;
use asperity_optics::{Film, Films, Incidence, Material};
use asperity_simulate::{
    Case, Effort, Estimator, Light, Settings, Silent, SurfaceSource, simulate,
};
use asperity_studies::VerifyConfig;
use asperity_surface::{Border, MissingPolicy};
use asperity_tally::{Component, Entry, Estimate, Side, TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::{PathSettings, Polarisation};
use serde_json::Value;

fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/reference")
        .join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

fn json(name: &str) -> Option<Value> {
    let text = std::fs::read_to_string(shared(name)?).unwrap();
    Some(serde_json::from_str(&text).unwrap())
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

/// A family of comparisons: each within 4.5 standard errors, and all together as scattered as their
/// errors say. Of 900 comparisons of normal errors, one is off by 4 in one run of 18, by 4.5 in one
/// of 160.
#[derive(Default)]
struct Family {
    z: Vec<f64>,
}

impl Family {
    /// Compares where both sides rest on about 20 rays or more: n rays give a relative error of
    /// about 1 / sqrt(n), so one above 1 / sqrt(20) speaks of fewer.
    fn compare(&mut self, what: &str, found: Estimate, reference: f64, reference_se: f64) {
        let se = found.se.unwrap();
        let enough = |mean: f64, se: f64| se > 0.0 && se < mean / 20_f64.sqrt();
        if !(enough(found.mean, se) && enough(reference, reference_se)) {
            return;
        }
        let z = (found.mean - reference) / se.hypot(reference_se);
        assert!(
            z.abs() < 4.5,
            "{what}: {} +- {se}, reference {reference}, z = {z:.2}",
            found.mean
        );
        self.z.push(z);
    }

    /// Chi-squared per degree of freedom. Independent comparisons would scatter about 1 by
    /// sqrt(2 / n); bins of one run are correlated, mostly pairwise between neighbours and between
    /// orders, so that the scatter is up to sqrt(2) times that. Four of those are allowed.
    fn check(&self, least: usize) {
        let n = self.z.len();
        assert!(n >= least, "only {n} comparisons");
        let chi_squared = self.z.iter().map(|z| z * z).sum::<f64>() / n as f64;
        let scatter = (2.0 / n as f64).sqrt() * 2_f64.sqrt();
        println!("{n} comparisons, chi-squared per degree of freedom {chi_squared:.3}");
        assert!(
            (chi_squared - 1.0).abs() < 4.0 * scatter,
            "{chi_squared} over {n}"
        );
    }
}

/// Compares the rings or in-plane bins of one side and order class with a reference list.
fn compare_bins(
    family: &mut Family,
    what: &str,
    statistics: &TallyStatistics,
    entries: impl DoubleEndedIterator<Item = Entry> + ExactSizeIterator,
    (values, errors): (&Value, &Value),
) {
    let (values, errors) = (numbers(values), numbers(errors));
    assert_eq!(values.len(), entries.len());
    for (i, ((entry, value), error)) in entries.zip(values).zip(errors).enumerate() {
        family.compare(
            &format!("{what} bin {i}"),
            statistics.at(entry),
            value,
            error,
        );
    }
}

#[test]
fn one_surface_agrees_with_an_independent_tracer() {
    let Some(path) = shared("gauss_n512_tau16_s2.npy") else {
        return;
    };
    let Some(reference) = json("explicit_s2_eta1.5.json") else {
        return;
    };
    let field = read_height_map(path)
        .unwrap()
        .into_height_field(MissingPolicy::Refuse, Border::Periodic)
        .unwrap();
    for (theta, seed) in [(30.0, 1), (60.0, 2)] {
        let config = reference["configs"]
            .as_array()
            .unwrap()
            .iter()
            .find(|c| c["theta_i_deg"].as_f64() == Some(theta))
            .unwrap();
        let spec = TallySpec::default();
        let settings = Settings {
            tally: spec,
            estimator: Estimator::Plain,
            seed,
            paths: PathSettings::default()
                .with_polarisation(Polarisation::Averaged)
                .into(),
            effort: Effort::rays(1_000_000),
            ..Settings::default()
        };
        // Reference light travels towards +x: it comes from azimuth 180 deg.
        let incidence = Incidence::from_degrees(theta, 180.0).unwrap();
        let glass = Material::dielectric(1.5).unwrap();
        let surface = SurfaceSource::height_field(field.clone());
        let case = Case::new(surface, glass, Light::from_above(incidence));
        let outcome = &simulate(&[case], &settings, &Silent).unwrap()[0];
        let statistics = &outcome.statistics;
        let budget: f64 = statistics.means().budget().total();
        assert!((budget - 1.0).abs() < 1e-12);
        assert_eq!(statistics.means().budget().lost, 0.0);

        let mut family = Family::default();
        for (side, letter) in [(Side::Reflected, "R"), (Side::Transmitted, "T")] {
            let number = |key: &str| config[key].as_f64().unwrap();
            let total = statistics.flux(side, Component::All);
            family.compare(
                letter,
                total,
                number(letter),
                number(&format!("{letter}_se")),
            );
            let orders = numbers(&config[format!("{letter}_by_exact_order_1_to_11_then_12plus")]);
            let errors = numbers(&config[format!("{letter}_by_exact_order_se")]);
            for order in 1..=11 {
                let found = statistics.at(spec.order_entry(side, order));
                let what = format!("{letter} order {order} at {theta} deg");
                family.compare(&what, found, orders[order - 1], errors[order - 1]);
            }
            for (class, k) in Component::RINGS.into_iter().zip(0..) {
                let pick = |histogram: &str| {
                    let histogram = &config[format!("{letter}_{histogram}")];
                    if class == Component::All {
                        (histogram["total"].clone(), histogram["total_se"].clone())
                    } else {
                        (
                            histogram["by_order"][k].clone(),
                            histogram["by_order_se"][k].clone(),
                        )
                    }
                };
                // Reference rings of transmission count from -z, ours from +z.
                let rings = spec.ring_entries(side, class).iter();
                let (values, errors) = pick("theta_hist");
                let what = format!("{letter} {class:?} theta at {theta} deg");
                match side {
                    Side::Reflected => {
                        compare_bins(&mut family, &what, statistics, rings, (&values, &errors));
                    }
                    Side::Transmitted => {
                        let rings = rings.rev();
                        compare_bins(&mut family, &what, statistics, rings, (&values, &errors));
                    }
                }
                let (values, errors) = pick("inplane");
                let what = format!("{letter} {class:?} in plane at {theta} deg");
                let entries = spec.in_plane_entries(side, class).iter();
                compare_bins(&mut family, &what, statistics, entries, (&values, &errors));
            }
        }
        family.check(250);
    }
}

/// Eta, theta, and R, T, R1, T1 each with its standard error: means over 12 random surfaces of
/// smoothness 3, N = 512, tau = 16, of an independent program; facets, as here.
type EnsembleRow = (f64, f64, [[f64; 2]; 4]);

const ENSEMBLE: [EnsembleRow; 4] = [
    (
        0.714285714,
        30.0,
        [
            [0.314529034, 0.00136968941],
            [0.685471934, 0.00136994476],
            [0.140706757, 0.000796635682],
            [0.676552313, 0.00136824045],
        ],
    ),
    (
        1.4,
        30.0,
        [
            [0.026368545, 7.16376138e-05],
            [0.973629834, 7.15042309e-05],
            [0.0250886554, 7.8876641e-05],
            [0.958266449, 0.000121377711],
        ],
    ),
    (
        1.4,
        0.0,
        [
            [0.0238465232, 8.7646757e-05],
            [0.976155267, 8.69907938e-05],
            [0.023149127, 9.47150648e-05],
            [0.96895087, 5.38996183e-05],
        ],
    ),
    (
        0.714285714,
        0.0,
        [
            [0.139335789, 0.00189080012],
            [0.860665356, 0.00189006804],
            [0.0333611812, 0.000145498011],
            [0.849125825, 0.00226915829],
        ],
    ),
];

/// A film of MgF2, n = 1.38, on glass, n = 1.5, on every facet; sequences of transfer matrices in the reference.
#[test]
fn films_on_facets_agree_with_an_independent_tracer() {
    let (Some(path), Some(reference)) = (shared("gauss_n512_tau16_s2.npy"), json("films.json"))
    else {
        return;
    };
    let map = read_height_map(path).unwrap();
    let field = map.into_height_field(MissingPolicy::Refuse, Border::Periodic);
    let surface = SurfaceSource::height_field(field.unwrap());
    let film = Film {
        eta: 1.38,
        kappa: 0.0,
        phase: 2.0 * PI * 100.0 / 550.0,
    };
    let coated = Material::coated(Films::new(&[film]).unwrap(), 1.5, 0.0).unwrap();
    let light = Light::from_above(Incidence::from_degrees(30.0, 0.0).unwrap());
    let case = Case::new(surface, coated, light);
    let rough = &reference["rough"][0];
    let mut family = Family::default();
    for (polarisation, name) in [
        (Polarisation::Averaged, "averaged"),
        (Polarisation::Tracked, "tracked"),
    ] {
        let settings = Settings {
            estimator: Estimator::Plain,
            seed: 5,
            paths: PathSettings::default()
                .with_polarisation(polarisation)
                .into(),
            effort: Effort::rays(400_000),
            ..Settings::default()
        };
        let outcome = &simulate(std::slice::from_ref(&case), &settings, &Silent).unwrap()[0];
        for (side, letter) in [(Side::Reflected, "R"), (Side::Transmitted, "T")] {
            let what = format!("{letter}_{name}");
            let [mean, se] = numbers(&rough[&what])[..] else {
                panic!("{what}");
            };
            let found = outcome.statistics.flux(side, Component::All);
            family.compare(&what, found, mean, se);
        }
    }
    assert_eq!(family.z.len(), 4);
}

#[test]
fn random_surfaces_agree_with_an_independent_ensemble() {
    let config = VerifyConfig::from_toml(
        "
        [surface]
        smoothness = 3
        cells = \"flat\"
        [material]
        eta = [1.4, 0.714285714]
        [light]
        theta = [0, 30]
        [run]
        realisations = 24
        rays = 2e5
        seed = 3
        bins = \"18x36\"
        polarisation = \"averaged\"
        [compare]
        models = []
        ",
    )
    .unwrap();
    let plan = config.plan().unwrap();
    let outcomes = simulate(&plan.cases, &plan.settings, &Silent).unwrap();
    let spec = plan.settings.tally;
    let in_plane = json("ensemble_s3.json");
    let mut family = Family::default();
    for outcome in &outcomes {
        let case = &outcome.case;
        let Material::Dielectric { eta } = case.material else {
            unreachable!()
        };
        let theta = case.light.incidence.theta_deg();
        let (_, _, row) = ENSEMBLE
            .iter()
            .find(|(e, t, _)| (e - eta).abs() < 1e-6 && *t == theta)
            .unwrap();
        let statistics = &outcome.statistics;
        assert_eq!(statistics.means().budget().lost, 0.0);
        let [r, t, r1, t1] = *row;
        let single = |side| statistics.at(spec.order_entry(side, 1));
        for (what, found, [reference, se]) in [
            ("R", statistics.budget().reflected, r),
            ("T", statistics.budget().transmitted, t),
            ("R1", single(Side::Reflected), r1),
            ("T1", single(Side::Transmitted), t1),
        ] {
            family.compare(&format!("{} {what}", case.label()), found, reference, se);
        }
        let Some(reference) = &in_plane else { continue };
        let reference = reference["cases"]
            .as_array()
            .unwrap()
            .iter()
            .find(|c| {
                (c["n"].as_f64().unwrap() - eta).abs() < 1e-6
                    && c["theta_i_deg"].as_f64() == Some(theta)
            })
            .unwrap();
        let values = numbers(&reference["inplane_rho_cos_order1"]);
        let errors = numbers(&reference["inplane_rho_cos_order1_se"]);
        let view = statistics.in_plane(Side::Transmitted, Component::Single);
        for (i, found) in view.iter().enumerate() {
            let per_sr = 1.0 / view.filter().solid_angle(i);
            let found = Estimate {
                mean: found.mean * per_sr,
                se: found.se.map(|se| se * per_sr),
            };
            family.compare(
                &format!("{} in plane {i}", case.label()),
                found,
                values[i],
                errors[i],
            );
        }
    }
    family.check(16);
}
