//! Bins on either side of the plane of incidence: the same light on average, and averaged where that is so.

use asperity_optics::Incidence;
use asperity_simulate::{Case, Effort, Estimator, Outcome, Settings};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{
    Component, HemisphereGrid, Measure, Mirror, Polarimetry, TallyResult, TallySpec,
};
use asperity_tracer::Polarisation;

use crate::support::{Rough, glass, run};

const SECTORS: usize = 12;

fn settings(surfaces: u64, rays: u64) -> Settings {
    let grid = HemisphereGrid::new(6, SECTORS).unwrap();
    Settings {
        tally: TallySpec::new(grid, 0.1).unwrap(),
        effort: Effort::Rays {
            total: rays,
            surfaces,
        },
        ..Settings::default()
    }
}

/// Rough glass, on which much light is scattered more than once.
fn case() -> Case {
    Rough::smooth(1.5, 6.0, 96).case(glass(), 50.0)
}

fn unfolded(case: Case, settings: Settings) -> Outcome {
    let fold = false;
    run(case, &Settings { fold, ..settings })
}

#[test]
fn folded_bins_are_averages_and_all_else_stays() {
    for estimator in [Estimator::Plain, Estimator::Controlled] {
        let settings = Settings {
            estimator,
            ..settings(8, 40_000)
        };
        let folded = run(case(), &settings);
        let before = unfolded(case(), settings);
        assert!(folded.work.folded && !before.work.folded);
        let mirror = Mirror::about(0.0, &settings.tally.grid()).unwrap();
        for (surface, before) in folded.surfaces.iter().zip(&before.surfaces) {
            let mut expected = before.clone();
            mirror.fold(&mut expected);
            assert_ne!(surface, before);
            let pairs = surface.iter().zip(expected.iter());
            // Blocks are folded before they are averaged.
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-15, "{off}");
        }
        assert_eq!(folded.statistics.budget(), before.statistics.budget());
    }
}

/// Mirrored entries differ by chance alone: fluxes, and elements of Mueller matrices with their signs.
#[test]
fn light_is_mirrored_about_the_plane_of_incidence() {
    let mut settings = settings(400, 2_000_000);
    settings.tally = settings.tally.with_polarimetry(Polarimetry::Mueller);
    settings.paths = settings.paths.with_polarisation(Polarisation::Mueller);
    let outcome = unfolded(case(), settings);
    let spec = settings.tally;
    let elements = (0..16).map(|i| Measure::Element {
        row: i / 4,
        column: i % 4,
    });
    let mut odd_is_seen = 0.0_f64;
    for measure in elements {
        let Measure::Element { row, column } = measure else {
            unreachable!()
        };
        let sign = if (row < 2) == (column < 2) { 1.0 } else { -1.0 };
        let (mut squares, mut count) = (0.0, 0.0);
        let bins = spec.recorded_entries(Component::All);
        for i in (0..bins.len()).filter(|i| i % SECTORS < SECTORS / 2) {
            let partner = i / SECTORS * SECTORS + SECTORS - 1 - i % SECTORS;
            let [a, b] = [i, partner].map(|i| spec.measure_entry(bins.get(i), measure).unwrap());
            let differences: Vec<f64> = outcome
                .surfaces
                .iter()
                .map(|s| s[a] - sign * s[b])
                .collect();
            let n = differences.len() as f64;
            let mean = differences.iter().sum::<f64>() / n;
            let variance =
                differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
            if variance > 0.0 {
                squares += mean * mean / variance;
                count += 1.0;
            }
            if sign < 0.0 {
                let of = outcome.statistics.at(a);
                odd_is_seen = odd_is_seen.max((of.mean / of.se.unwrap()).abs());
            }
        }
        // Close to one; bins share surfaces and paths, and those of few rays scatter more.
        let reduced = squares / count;
        println!("{measure}: {reduced:.2} of {count}");
        assert!((0.6..1.6).contains(&reduced), "{measure} {reduced}");
    }
    assert!(odd_is_seen > 10.0, "{odd_is_seen}");
}

/// Rays on either side are independent; surfaces are the same.
#[test]
fn folding_halves_the_variance_of_rays() {
    let settings = Settings {
        estimator: Estimator::Plain,
        ..settings(24, 24_000)
    };
    let squares = |outcome: &Outcome| -> f64 {
        let bins = settings.tally.recorded_entries(Component::All);
        bins.iter()
            .map(|bin| outcome.statistics.at(bin).se.unwrap().powi(2))
            .sum()
    };
    let ratio = squares(&unfolded(case(), settings)) / squares(&run(case(), &settings));
    println!("{ratio:.2}");
    assert!((1.7..2.2).contains(&ratio), "{ratio}");
}

/// Off its axes an anisotropic surface has no such symmetry, nor has light of fixed azimuth off the axes of the samples.
#[test]
fn what_is_not_symmetric_is_not_folded() {
    let folds = |tau_y: f64, axis: f64, phi: f64| {
        let psd = Psd::anisotropic_gaussian(3.0, 6.0, tau_y, f64::to_radians(axis)).unwrap();
        let synthesis = Synthesis::new(psd, [64; 2], [1.0; 2], false).unwrap();
        let mut case = case();
        case.surface = asperity_simulate::SurfaceSource::random(synthesis);
        case.light.random_azimuth = false;
        case.light.incidence = Incidence::from_degrees(30.0, phi).unwrap();
        run(case, &settings(2, 1000)).work.folded
    };
    assert!(folds(6.0, 0.0, 0.0) && folds(8.0, 0.0, 0.0) && folds(8.0, 90.0, 270.0));
    assert!(!folds(8.0, 30.0, 0.0) && !folds(8.0, 0.0, 45.0) && !folds(6.0, 0.0, 10.0));
}
