//! A medium between flat faces against rays that know nothing of its closed forms.

use std::f64::consts::{PI, TAU};

use asperity_analysis::{FlatLayers, LayerPaths, sidak_z_threshold};
use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_tally::{Azimuth, Component, HemisphereGrid, Side, TallySpec};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One layer and the light on it.
#[derive(Clone, Copy)]
struct Case {
    eta: f64,
    tau: f64,
    albedo: f64,
    g: f64,
    bottom: Bottom,
    theta: f64,
}

/// A ray that left: side, direction, scatterings, faces met.
type Left = (Side, [f64; 3], u32, u32);

/// Fresnel's reflectance as textbooks have it, and the cosine behind.
fn fresnel(c: f64, n: f64) -> (f64, f64) {
    let sin = (1.0 - c * c).sqrt() / n;
    if sin >= 1.0 {
        return (1.0, 0.0);
    }
    let t = (1.0 - sin * sin).sqrt();
    let s = (c - n * t) / (c + n * t);
    let p = (n * c - t) / (n * c + t);
    (0.5 * (s * s + p * p), t)
}

/// Follows one ray, by chance at every face and in the medium, until it leaves, ends or is scattered
/// twice. Lengths in mean free paths; light comes along -x.
fn follow(case: &Case, rng: &mut ChaCha8Rng) -> Option<Left> {
    let uniform = |rng: &mut ChaCha8Rng| rng.random::<f64>();
    let theta = case.theta.to_radians();
    let (mut scatterings, mut faces) = (0, 1);
    let (r, inside) = fresnel(theta.cos(), case.eta);
    if uniform(rng) < r {
        return Some((Side::Reflected, [-theta.sin(), 0.0, theta.cos()], 0, 1));
    }
    let mut d = [-theta.sin() / case.eta, 0.0, -inside];
    let mut depth = 0.0;
    loop {
        depth -= d[2] * -(1.0 - uniform(rng)).ln();
        if depth > 0.0 && depth < case.tau {
            if uniform(rng) >= case.albedo || scatterings == 1 {
                return None;
            }
            scatterings += 1;
            d = scattered(d, case.g, rng);
            continue;
        }
        let up = d[2] > 0.0;
        depth = if up { 0.0 } else { case.tau };
        let n = match (up, case.bottom) {
            (true, _) => 1.0 / case.eta,
            (false, Bottom::Face(Material::Dielectric { eta })) => eta,
            (false, Bottom::Open) => return Some((Side::Transmitted, d, scatterings, faces)),
            (false, Bottom::MIRROR) => 0.0,
            _ => return None,
        };
        faces += 1;
        let (r, t) = fresnel(d[2].abs(), n);
        if uniform(rng) < r {
            d[2] = -d[2];
            continue;
        }
        let (side, z) = if up {
            (Side::Reflected, t)
        } else {
            (Side::Transmitted, -t)
        };
        return Some((side, [d[0] / n, d[1] / n, z], scatterings, faces));
    }
}

/// Henyey and Greenstein 1941, by rejection from an even sphere: the definition and nothing else.
fn scattered(d: [f64; 3], g: f64, rng: &mut ChaCha8Rng) -> [f64; 3] {
    let most = (1.0 + g.abs()) / (1.0 - g.abs()).powi(2);
    loop {
        let z = 2.0 * rng.random::<f64>() - 1.0;
        let (s, phi) = ((1.0 - z * z).sqrt(), TAU * rng.random::<f64>());
        let w = [s * phi.cos(), s * phi.sin(), z];
        let cos = d[0] * w[0] + d[1] * w[1] + d[2] * w[2];
        let value = (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cos).powf(1.5);
        if rng.random::<f64>() * most < value {
            return w;
        }
    }
}

const RAYS: u32 = 100_000;

fn spec() -> TallySpec {
    let grid = HemisphereGrid::new(6, 8).unwrap();
    TallySpec::new(grid, 0.1).unwrap().with_medium()
}

fn model(case: &Case, paths: LayerPaths) -> FlatLayers {
    let phase = PhaseFunction::henyey_greenstein(case.g).unwrap();
    let medium = ParticipatingMedium::from_mean_free_path(2.0, case.albedo, phase).unwrap();
    let layer = Layer::slab(medium, 2.0 * case.tau, case.bottom).unwrap();
    let top = Material::Dielectric { eta: case.eta };
    FlatLayers::new(top, &[layer], paths).unwrap()
}

/// Counts of the rays that `counts` takes, by bin.
/// Rays are turned about the vertical, and angles chosen, so that what goes straight lies on no edge of bins.
const TURN: f64 = 0.1;

fn counted(left: &[Left], counts: impl Fn(&Left) -> bool) -> Vec<f64> {
    let grid = spec().grid();
    let mut bins = vec![0.0; grid.len()];
    for ray in left.iter().filter(|ray| counts(ray)) {
        let [x, y, z] = ray.1;
        let (sin, cos) = TURN.sin_cos();
        let wo = glam::DVec3::new(cos * x - sin * y, sin * x + cos * y, z);
        bins[grid.index_of(ray.0, wo)] += 1.0;
    }
    bins
}

/// z values of counts against expected fractions, where 20 rays are found or expected.
fn z_values(counts: &[f64], expected: &[f64]) -> Vec<f64> {
    let n = f64::from(RAYS);
    counts
        .iter()
        .zip(expected)
        .filter(|(count, fraction)| **count >= 20.0 || n * **fraction >= 20.0)
        // What has no spread must be met to rounding.
        .map(|(count, fraction)| {
            let spread = (n * fraction * (1.0 - fraction)).max(1e-6).sqrt();
            (count - n * fraction) / spread
        })
        .collect()
}

#[test]
fn rays_agree_with_both_models_in_every_bin() {
    let glass = Bottom::interface(1.0 / 1.5);
    let case = |eta, tau, albedo, g, bottom, theta| Case {
        eta,
        tau,
        albedo,
        g,
        bottom,
        theta,
    };
    let cases = [
        case(1.5, 0.1, 0.9, 0.3, glass, 32.0),
        case(1.5, 1.0, 1.0, 0.0, Bottom::interface(1.2), 61.0),
        case(1.3, 0.5, 0.8, -0.4, Bottom::Open, 50.0),
        case(1.5, 0.7, 0.9, 0.5, Bottom::MIRROR, 20.0),
        case(1.5, 40.0, 0.9, 0.2, Bottom::ABSORBING, 46.0),
        case(1.0, 0.3, 1.0, 0.6, Bottom::interface(0.7), 35.0),
        case(0.8, 0.4, 1.0, 0.0, Bottom::interface(1.6), 40.0),
    ];
    let spec = spec();
    let mut families: Vec<(String, Vec<f64>)> = Vec::new();
    for (i, case) in cases.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(i as u64 + 1);
        let left: Vec<Left> = (0..RAYS).filter_map(|_| follow(case, &mut rng)).collect();
        let light = Incidence::from_degrees(case.theta, TURN.to_degrees()).unwrap();
        let tally = |paths| model(case, paths).tally(light, &spec, Azimuth::From(PI + TURN));
        let exact = tally(LayerPaths::All);
        for (scatterings, component) in [(0, Component::Unscattered), (1, Component::ScatteredOnce)]
        {
            let found = counted(&left, |ray| ray.2 == scatterings);
            let z = z_values(&found, &exact[spec.grid_entries(component)]);
            families.push((format!("case {i}, {component}"), z));
        }
        let found = counted(&left, |ray| ray.3 == 1);
        let z = z_values(&found, &exact[spec.grid_entries(Component::Single)]);
        families.push((format!("case {i}, one face"), z));
        if case.bottom == Bottom::MIRROR {
            continue;
        }
        // Through a face on the way in and through one on the way out, which an open bottom is not.
        let open = case.bottom == Bottom::Open;
        let faces = |side| 2 - u32::from(open && side == Side::Transmitted);
        let found = counted(&left, |ray| ray.2 == 1 && ray.3 == faces(ray.0));
        let once = &tally(LayerPaths::HanrahanKrueger)[spec.grid_entries(Component::ScatteredOnce)];
        families.push((format!("case {i}, once, straight"), z_values(&found, once)));
    }
    let all: usize = families.iter().map(|(_, z)| z.len()).sum();
    let bound = sidak_z_threshold(1e-3, all);
    for (name, z) in &families {
        let largest = z.iter().map(|z| z.abs()).fold(0.0, f64::max);
        let mean_square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        // Mean squares of n values scatter by sqrt(2 / n); counts of twenty have heavier tails.
        let scatter = (mean_square - 1.0) / (2.0 / z.len() as f64).sqrt();
        println!(
            "{name}: {} bins, largest |z| {largest:.2}, mean square {mean_square:.2}",
            z.len()
        );
        assert!(largest < bound, "{name}: {largest} of {bound}");
        assert!(z.len() < 10 || scatter < 4.5, "{name}: {scatter}");
    }
    println!("{all} bins in all, bound {bound:.2}");
    assert!(all > 500);
}
