//! Media between flat faces against rays that know nothing of their closed forms.

use std::f64::consts::{PI, TAU};

use asperity_analysis::{FlatLayers, LayerPaths, sidak_z_threshold};
use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_tally::{
    Azimuth, Component, Event, EventPath, HemisphereGrid, Side, TallySpec, TallyValues,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Layers from above, and the light on them.
#[derive(Clone, Copy)]
struct Case {
    layers: &'static [Slab],
    bottom: Bottom,
    theta: f64,
}

/// One layer.
#[derive(Clone, Copy)]
struct Slab {
    /// Index over that of the medium above.
    eta: f64,
    tau: f64,
    albedo: f64,
    g: f64,
}

/// A ray that left.
struct Left {
    side: Side,
    direction: [f64; 3],
    scatterings: u32,
    /// Interactions with faces, which an open bottom is not.
    path: EventPath,
}

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

/// Follows one ray, by chance at every face and in the media, until it leaves, ends or is scattered
/// twice. Lengths in mean free paths; light comes along -x.
fn follow(case: &Case, rng: &mut ChaCha8Rng) -> Option<Left> {
    let uniform = |rng: &mut ChaCha8Rng| rng.random::<f64>();
    let theta = case.theta.to_radians();
    let mut d = [-theta.sin(), 0.0, -theta.cos()];
    let (mut scatterings, mut path) = (0, EventPath::default());
    // The face that it is at, from above
    let mut face = 0;
    loop {
        // Pass the face or be reflected at it
        let up = d[2] > 0.0;
        let n = match (up, case.layers.get(face), case.bottom) {
            (true, _, _) => 1.0 / case.layers[face].eta,
            (false, Some(below), _) => below.eta,
            (false, None, Bottom::Face(Material::Dielectric { eta })) => eta,
            (false, None, Bottom::Open) => 1.0,
            (false, None, Bottom::MIRROR) => 0.0,
            _ => return None,
        };
        let is_open = face == case.layers.len() && case.bottom == Bottom::Open;
        let (r, t) = fresnel(d[2].abs(), n);
        let event = match uniform(rng) < r {
            true => Event::Reflection,
            false => Event::Transmission,
        };
        if !is_open {
            path = path.then(event);
        }
        if event == Event::Reflection {
            d[2] = -d[2];
        } else {
            d = [d[0] / n, d[1] / n, if up { t } else { -t }];
        }
        let up = d[2] > 0.0;
        let layer = match up {
            true => face.checked_sub(1),
            false => Some(face).filter(|&face| face < case.layers.len()),
        };
        let Some(inside) = layer else {
            let side = if up {
                Side::Reflected
            } else {
                Side::Transmitted
            };
            return Some(Left {
                side,
                direction: d,
                scatterings,
                path,
            });
        };

        // Fly to the next face, scattered on the way
        let Slab { tau, albedo, g, .. } = case.layers[inside];
        let mut depth = if up { tau } else { 0.0 };
        face = loop {
            depth += d[2] * (1.0 - uniform(rng)).ln();
            if depth <= 0.0 {
                break inside;
            }
            if depth >= tau {
                break inside + 1;
            }
            if uniform(rng) >= albedo || scatterings == 1 {
                return None;
            }
            scatterings += 1;
            d = scattered(d, g, rng);
        };
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
    let layer = |(number, slab): (usize, &Slab)| {
        let phase = PhaseFunction::henyey_greenstein(slab.g).unwrap();
        let medium = ParticipatingMedium::from_mean_free_path(2.0, slab.albedo, phase).unwrap();
        let below = case.layers.get(number + 1);
        let bottom = below.map_or(case.bottom, |below| Bottom::interface(below.eta));
        Layer::slab(medium, 2.0 * slab.tau, bottom).unwrap()
    };
    let layers: Vec<Layer> = case.layers.iter().enumerate().map(layer).collect();
    let eta = case.layers[0].eta;
    FlatLayers::new(Material::Dielectric { eta }, &layers, paths).unwrap()
}

/// Rays are turned about the vertical, and angles chosen, so that what goes straight lies on no edge of bins.
const TURN: f64 = 0.1;

/// Counts of the rays that `counts` takes, by bin.
fn counted(left: &[Left], counts: impl Fn(&Left) -> bool) -> Vec<f64> {
    let grid = spec().grid();
    let mut bins = vec![0.0; grid.len()];
    for ray in left.iter().filter(|ray| counts(ray)) {
        let [x, y, z] = ray.direction;
        let (sin, cos) = TURN.sin_cos();
        let wo = glam::DVec3::new(cos * x - sin * y, sin * x + cos * y, z);
        bins[grid.index_of(ray.side, wo)] += 1.0;
    }
    bins
}

/// Counts of rays by event path, and the fractions of a tally of all paths: of light that was not scattered inside, and of all that met one face.
fn by_path(left: &[Left], tally: &TallyValues) -> [Vec<f64>; 2] {
    let spec = tally.spec();
    let mut counts = TallyValues::zeros(*spec);
    let is_listed = |ray: &&Left| ray.scatterings == 0 || ray.path.order() == 1;
    for ray in left.iter().filter(is_listed) {
        counts[spec.event_path_entry(ray.side, ray.path)] += 1.0;
    }
    [&counts, tally].map(|values| {
        let of_side = |side| {
            let listed = spec.listed_paths();
            let listed = listed.map(move |path| spec.event_path_entry(side, path));
            let all = listed.chain([spec.longer_paths_entry(side)]);
            all.map(|entry| values[entry])
        };
        Side::BOTH.into_iter().flat_map(of_side).collect()
    })
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

const fn slab(eta: f64, tau: f64, albedo: f64, g: f64) -> Slab {
    Slab {
        eta,
        tau,
        albedo,
        g,
    }
}

const fn case(layers: &'static [Slab], bottom: Bottom, theta: f64) -> Case {
    Case {
        layers,
        bottom,
        theta,
    }
}

const CASES: [Case; 13] = [
    case(
        &[slab(1.5, 0.1, 0.9, 0.3)],
        Bottom::interface(1.0 / 1.5),
        32.0,
    ),
    case(&[slab(1.5, 1.0, 1.0, 0.0)], Bottom::interface(1.2), 61.0),
    case(&[slab(1.3, 0.5, 0.8, -0.4)], Bottom::Open, 50.0),
    case(&[slab(1.5, 0.7, 0.9, 0.5)], Bottom::MIRROR, 20.0),
    case(&[slab(1.5, 40.0, 0.9, 0.2)], Bottom::ABSORBING, 46.0),
    case(&[slab(1.0, 0.3, 1.0, 0.6)], Bottom::interface(0.7), 35.0),
    case(&[slab(0.8, 0.4, 1.0, 0.0)], Bottom::interface(1.6), 40.0),
    // Two layers over an interface, a mirror, an absorbing and an open bottom
    case(
        &[slab(1.5, 0.3, 0.9, 0.3), slab(0.8, 0.5, 0.7, -0.4)],
        Bottom::interface(1.0 / 1.2),
        32.0,
    ),
    case(
        &[slab(1.3, 0.2, 1.0, 0.6), slab(1.4, 0.6, 0.9, 0.0)],
        Bottom::MIRROR,
        50.0,
    ),
    case(
        &[slab(1.5, 0.4, 0.8, 0.0), slab(1.2, 0.5, 1.0, 0.5)],
        Bottom::ABSORBING,
        20.0,
    ),
    case(
        &[slab(1.0, 0.3, 0.9, 0.5), slab(1.5, 0.4, 0.9, 0.0)],
        Bottom::Open,
        40.0,
    ),
    // Three, the lowest beyond the critical angle of a face
    case(
        &[
            slab(1.6, 0.3, 1.0, 0.2),
            slab(0.5, 0.2, 0.9, 0.0),
            slab(1.5, 0.3, 1.0, 0.7),
        ],
        Bottom::interface(1.1),
        62.0,
    ),
    case(
        &[
            slab(1.4, 0.2, 1.0, 0.0),
            slab(1.2, 0.3, 0.9, 0.4),
            slab(0.7, 0.2, 1.0, -0.3),
        ],
        Bottom::interface(1.0),
        35.0,
    ),
];

#[test]
fn rays_agree_with_both_models_in_every_bin() {
    let spec = spec();
    let mut families: Vec<(String, Vec<f64>)> = Vec::new();
    for (i, case) in CASES.iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(i as u64 + 1);
        let left: Vec<Left> = (0..RAYS).filter_map(|_| follow(case, &mut rng)).collect();
        let light = Incidence::from_degrees(case.theta, TURN.to_degrees()).unwrap();
        let tally = |paths| model(case, paths).tally(light, &spec, Azimuth::From(PI + TURN));
        let exact = tally(LayerPaths::All);
        for (scatterings, component) in [(0, Component::Unscattered), (1, Component::ScatteredOnce)]
        {
            let found = counted(&left, |ray| ray.scatterings == scatterings);
            let z = z_values(&found, &exact[spec.grid_entries(component)]);
            families.push((format!("case {i}, {component}"), z));
        }
        let found = counted(&left, |ray| ray.path.order() == 1);
        let z = z_values(&found, &exact[spec.grid_entries(Component::Single)]);
        families.push((format!("case {i}, one face"), z));
        let [found, expected] = by_path(&left, &exact);
        families.push((format!("case {i}, paths"), z_values(&found, &expected)));
        if case.bottom == Bottom::MIRROR {
            continue;
        }
        // Reflected at no face
        let straight = |ray: &Left| ray.path.code().count_ones() == ray.path.order();
        let found = counted(&left, |ray| ray.scatterings == 1 && straight(ray));
        let letter = tally(LayerPaths::HanrahanKrueger);
        let once = &letter[spec.grid_entries(Component::ScatteredOnce)];
        families.push((format!("case {i}, once, straight"), z_values(&found, once)));
        let orders = 2..=2 * case.layers.len() as u32;
        let found: Vec<f64> = orders
            .clone()
            .map(|order| {
                let counts = |ray: &&Left| {
                    straight(ray) && ray.side == Side::Reflected && ray.path.order() == order
                };
                left.iter().filter(counts).count() as f64
            })
            .collect();
        let of_order = |order| letter[spec.order_entry(Side::Reflected, order as usize)];
        let expected: Vec<f64> = orders.map(of_order).collect();
        families.push((format!("case {i}, orders"), z_values(&found, &expected)));
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
