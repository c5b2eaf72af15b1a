//! Light on structured surfaces: V grooves against geometry, and the energy budget of every structure.

use std::f64::consts::PI;

use asperity_optics::Material;
use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
    StructureSynthesis,
};
use asperity_tally::{
    Component, HemisphereGrid, MAX_LISTED_ORDER, Side, TallyResult, TallySpec, TallyValues,
};
use asperity_tracer::{Pyramid, Surface};
use glam::DVec3;

use crate::common::Run;

const GROOVES: Grooves = Grooves {
    profile: GrooveProfile::V,
    depth: 4.0,
    width: 16.0,
    azimuth: 0.0,
    edge_radius: 0.0,
    randomness: 0.0,
};

/// A tile of `n` x `n` samples with the sides `extent`.
fn surface(structure: Structure, n: u16, extent: f64) -> Surface {
    let spacing = [extent / f64::from(n); 2];
    let synthesis = StructureSynthesis::new(structure, [n.into(); 2], spacing, false);
    Surface::new(synthesis.unwrap().draw(3, 0).unwrap())
}

/// Mean fluxes of vertical light on a surface.
fn lit_from_above(
    surface: &Surface,
    material: Material,
    spec: TallySpec,
    strata: u32,
) -> TallyValues {
    let accelerator = Pyramid::build(surface).unwrap();
    let run = Run {
        theta_deg: 0.0,
        spec,
        ..Run::new(surface, &accelerator, material)
    };
    run.go(1, strata).0.means().clone()
}

/// Vertical light on mirrors whose flanks rise at the angle `a` leaves a flank at `2 a` from the vertical. Below 30 degrees it passes over the
/// opposite flank. Between 30 and 45 degrees it meets that flank if it fell within the fraction `4 sin^2 a - 1` of the first flank next to
/// the bottom, and leaves at `180 - 4 a` degrees to the side of the first.
///
/// Two of the 256 strata along y, at the ends of that fraction, are undecided, in 256 columns each: a standard deviation of
/// `sqrt(2 * 256 / 4) / 256^2 = 1.7e-4`.
#[test]
fn light_on_v_grooves_of_mirrors_leaves_as_geometry_says() {
    let spec = TallySpec::new(HemisphereGrid::new(90, 6).unwrap(), 0.1).unwrap();
    for degrees in [20.3_f64, 38.3] {
        let angle = degrees.to_radians();
        let depth = 8.0 * angle.tan();
        let grooves = Structure::Grooves(Grooves { depth, ..GROOVES });
        let values = lit_from_above(&surface(grooves, 16, 16.0), Material::Mirror, spec, 256);
        let twice = (4.0 * angle.sin().powi(2) - 1.0).max(0.0);
        let at = |component, degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            // Either side of the grooves, which run along x
            [1.0, -1.0]
                .map(|side| {
                    let wo = DVec3::new(0.0, side * sin, cos);
                    let bin = spec.grid().index_of(Side::Reflected, wo);
                    values[spec.grid_entries(component).get(bin)]
                })
                .map(|half| 2.0 * half)
        };
        for (component, degrees, expected) in [
            (Component::Single, 2.0 * degrees, 1.0 - twice),
            (Component::Multiple, 180.0 - 4.0 * degrees, twice),
        ] {
            for found in at(component, degrees) {
                println!("{degrees}: {found} {expected}");
                assert!(
                    (found - expected).abs() < 1e-3,
                    "{degrees}: {found} {expected}"
                );
            }
        }
        assert!((values.budget().reflected - 1.0).abs() < 1e-12);
        assert_eq!(values.budget().lost, 0.0);
    }
}

/// Flux of V grooves of mirrors by order, from 0 on, with half an opening of `half` radians, for light across them at `theta` from the vertical.
///
/// Reflected in the flanks that it meets, the groove becomes a fan of grooves about its bottom, through which light goes straight on. At unit
/// length of the flanks, a path at the distance `p` from the bottom crosses the flank `k` on its side if `p < sin((2k - 1) half ± theta)`, as long as
/// that flank is less than half a turn away.
fn flux_by_order(half: f64, theta: f64) -> [f64; MAX_LISTED_ORDER + 1] {
    let sides = [theta, -theta].map(|theta| {
        let mut reach = f64::INFINITY;
        let mut beyond = [0.0; MAX_LISTED_ORDER + 2];
        for (k, beyond) in (1..).zip(&mut beyond) {
            let angle = f64::from(2 * k - 1) * half + theta;
            reach = if angle < PI {
                angle.sin().min(reach)
            } else {
                0.0
            };
            *beyond = reach.max(0.0);
        }
        beyond
    });
    let of = |k: usize| (sides[0][k] + sides[1][k]) / (sides[0][0] + sides[1][0]);
    std::array::from_fn(|order| order.checked_sub(1).map_or(0.0, |k| of(k) - of(k + 1)))
}

/// Light on V grooves of mirrors is divided by order as the fan of grooves says, at any spacing, along rows and along either diagonal of the cells:
/// facets are the grooves.
///
/// Where an order ends on a flank, strata are undecided. Four such lines, no longer than the diagonal of the tile, cross fewer than `2 * 128`
/// strata each: a standard deviation below `sqrt(4 * 256 / 4) / 128^2 = 1e-3`, of which four are allowed.
#[test]
fn light_on_v_grooves_is_divided_by_order_as_geometry_says_at_any_spacing() {
    for (azimuth, width) in [
        (0.0_f64, 16.0),
        (45.0, 128_f64.sqrt()),
        (135.0, 128_f64.sqrt()),
    ] {
        for (tilt, theta_deg) in [(38.3_f64, 0.0_f64), (65.0, 0.0), (38.3, 20.0), (65.0, 20.0)] {
            let expected = flux_by_order((90.0 - tilt).to_radians(), theta_deg.to_radians());
            let grooves = Structure::Grooves(Grooves {
                depth: 0.5 * width * tilt.to_radians().tan(),
                width,
                azimuth: azimuth.to_radians(),
                ..GROOVES
            });
            for n in [16, 32, 64] {
                let surface = surface(grooves, n, 16.0);
                let accelerator = Pyramid::build(&surface).unwrap();
                let run = Run {
                    theta_deg,
                    phi_deg: azimuth + 90.0,
                    ..Run::new(&surface, &accelerator, Material::Mirror)
                };
                let (statistics, _) = run.go(1, 128);
                let values = statistics.means();
                for (order, expected) in expected.iter().enumerate().skip(1) {
                    let found = values.order(Side::Reflected, order);
                    let case = format!(
                        "azimuth {azimuth}, tilt {tilt}, theta {theta_deg}, {n}, order {order}"
                    );
                    assert!(
                        (found - expected).abs() < 4e-3,
                        "{case}: {found} {expected}"
                    );
                }
                assert!((values.budget().reflected - 1.0).abs() < 1e-12);
                assert_eq!(values.budget().lost, 0.0);
            }
        }
    }
}

/// Vertical light on one shallow cap or pit of mirrors is reflected once, by a facet at the distance `r` from its axis at twice the angle of
/// `sin a = r / R`; the rest of the tile is level. So the flux within the angle `t` of the vertical is `1 - c + c (sin(t / 2) / sin(edge))^2`, with the
/// coverage `c`.
///
/// Facets are chords, so that only light of cells that the rim or the circle of a ring's edge crosses can leave elsewhere: a circle of radius `r`
/// crosses no more than `8 r / spacing + 4` cells. The sum of all deviations is at most twice that light, and falls with the spacing.
#[test]
fn light_on_caps_and_pits_leaves_as_geometry_says_but_for_cells_across_circles() {
    let spec = TallySpec::new(HemisphereGrid::new(9, 1).unwrap(), 0.1).unwrap();
    let edge = 24_f64.to_radians();
    let radius = 12.0 / edge.sin();
    let segments = SphericalSegments {
        depth: radius * (1.0 - edge.cos()),
        width: 24.0,
        density: 0.44,
        edge_radius: 0.0,
        randomness: 0.0,
        arrangement: Arrangement::Separate,
    };
    for structure in [Structure::Caps(segments), Structure::Pits(segments)] {
        let coverage = 144.0 * PI / 1024.0;
        let mut deviations = Vec::new();
        for n in [32_u16, 64, 128] {
            let spacing = 32.0 / f64::from(n);
            let synthesis = StructureSynthesis::new(structure, [n.into(); 2], [spacing; 2], false);
            assert!(!synthesis.unwrap().is_exact(3, 0).unwrap());
            let values = lit_from_above(&surface(structure, n, 32.0), Material::Mirror, spec, 256);
            let within = |degrees: f64| {
                let on_cap = (0.5 * degrees.to_radians()).sin() / edge.sin();
                1.0 - coverage + coverage * on_cap.min(1.0).powi(2)
            };
            let (mut deviation, mut cells) = (0.0, 0.0);
            for ring in 0..9_u8 {
                let [low, high] = [ring, ring + 1].map(|k| 10.0 * f64::from(k));
                let least = if ring == 0 { 0.0 } else { within(low) };
                let expected = within(high) - least;
                let found = values
                    .rings(Side::Reflected, Component::Single)
                    .get(ring.into());
                deviation += f64::abs(found - expected);
                let circle = radius * (0.5 * high.to_radians()).sin();
                cells += 8.0 * circle.min(12.0) / spacing + 4.0;
                if circle >= 12.0 {
                    break;
                }
            }
            let bound = 2.0 * cells * (spacing / 32.0).powi(2);
            println!("{} {n}: {deviation}, at most {bound}", structure.name());
            assert!(deviation < bound, "{} {n}", structure.name());
            let multiple = values.flux(Side::Reflected, Component::Multiple);
            assert!(multiple <= bound, "{} {n}: {multiple}", structure.name());
            deviations.push(deviation);
        }
        assert!(deviations[2] < 0.5 * deviations[0], "{deviations:?}");
    }
}

/// Vertical light on touching pyramids of mirrors. In any vertical plane across a facet, upright pyramids are V grooves that end where
/// the facet does, in the same proportion: light that meets two flanks is the fraction `f = 4 sin^2 a - 1` of a facet, as on grooves. In inverted
/// ones the second flank is met if the first is met within `f` of the half width from the middle: the fraction `f^2`.
///
/// No cell is cut across a crease, at any spacing, so that light goes nowhere else. Each of four facets is met by half of the 256 strata or
/// columns; the edges of these fractions are undecided in `2 * 256` strata: a standard deviation of some 2e-4.
#[test]
fn light_on_pyramids_of_mirrors_leaves_as_geometry_says_at_any_spacing() {
    let spec = TallySpec::new(HemisphereGrid::new(90, 6).unwrap(), 0.1).unwrap();
    let angle = 38.3_f64.to_radians();
    let fraction = 4.0 * angle.sin().powi(2) - 1.0;
    let pyramids = Pyramids {
        depth: 8.0 * angle.tan(),
        width: 16.0,
        density: 1.0,
        randomness: 0.0,
        arrangement: Arrangement::Lattice,
    };
    for (structure, twice) in [
        (Structure::Pyramids(pyramids), fraction),
        (Structure::Inverted(pyramids), fraction * fraction),
    ] {
        for n in [16, 32, 64] {
            let values = lit_from_above(&surface(structure, n, 16.0), Material::Mirror, spec, 256);
            for (component, degrees, expected) in [
                (Component::Single, 76.6_f64, 1.0 - twice),
                (Component::Multiple, 180.0 - 4.0 * 38.3, twice),
            ] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let bins = (0..6).map(|i| {
                    let (y, x) = (f64::from(60 * i) + 30.0).to_radians().sin_cos();
                    let wo = DVec3::new(sin * x, sin * y, cos);
                    values[spec
                        .grid_entries(component)
                        .get(spec.grid().index_of(Side::Reflected, wo))]
                });
                let found: f64 = bins.sum();
                println!("{} {n}: {found} {expected}", structure.name());
                assert!((found - expected).abs() < 1e-3, "{structure:?} {n}");
            }
        }
    }
}

/// Vertical light on facets at 54.74 degrees is reflected downwards, so that none leaves after one reflection.
#[test]
fn no_light_leaves_steep_pyramids_of_glass_after_one_reflection() {
    let pyramids = Pyramids {
        depth: Pyramids::crystal_height(16.0),
        width: 16.0,
        density: 1.0,
        randomness: 0.0,
        arrangement: Arrangement::Lattice,
    };
    for structure in [Structure::Pyramids(pyramids), Structure::Inverted(pyramids)] {
        let mut reflected = Vec::new();
        for n in [16, 32, 64] {
            let glass = Material::dielectric(1.5).unwrap();
            let surface = surface(structure, n, 16.0);
            let values = lit_from_above(&surface, glass, TallySpec::default(), 128);
            let single = values.spec().grid_entries(Component::Single);
            let bins = values.spec().grid().n_theta() * values.spec().grid().n_phi();
            let found: f64 = (0..bins).map(|bin| values[single.get(bin)]).sum();
            assert_eq!(found, 0.0, "{structure:?} {n}");
            reflected.push(values.budget().reflected);
        }
        println!("{}: {reflected:?}", structure.name());
        assert!(reflected.iter().all(|r| (r - reflected[0]).abs() < 2e-4));
    }
}

/// Fluxes add up ray by ray, and no ray is lost, on flat cells of each structure.
#[test]
fn energy_is_conserved_on_every_structure() {
    let segments = SphericalSegments {
        depth: 5.0,
        width: 16.0,
        density: 0.8,
        edge_radius: 0.0,
        randomness: 0.3,
        arrangement: Arrangement::Random,
    };
    let lattice = SphericalSegments {
        density: 0.9,
        edge_radius: 2.0,
        randomness: 0.0,
        arrangement: Arrangement::Lattice,
        ..segments
    };
    let pyramids = Pyramids {
        depth: Pyramids::crystal_height(16.0),
        width: 16.0,
        density: 4.0,
        randomness: 0.5,
        arrangement: Arrangement::Random,
    };
    let grooves = |profile, azimuth| {
        Structure::Grooves(Grooves {
            profile,
            azimuth,
            ..GROOVES
        })
    };
    for structure in [
        Structure::Pits(segments),
        Structure::Caps(lattice),
        grooves(GrooveProfile::V, 0.6),
        grooves(GrooveProfile::Sine, 0.0),
        grooves(GrooveProfile::Blazed, 1.6),
        Structure::Scratches(Scratches {
            depth: 3.0,
            width: 6.0,
            length: 60.0,
            density: 0.8,
            azimuth: 0.3,
            spread: 0.2,
            edge_radius: 0.5,
            randomness: 0.3,
        }),
        Structure::Cracks(Cracks {
            depth: 8.0,
            width: 6.0,
            density: 0.4,
            edge_radius: 0.0,
        }),
        Structure::Pyramids(pyramids),
        Structure::Inverted(pyramids),
    ] {
        let surface = surface(structure, 128, 128.0);
        let accelerator = Pyramid::build(&surface).unwrap();
        for theta_deg in [0.0, 30.0, 70.0] {
            let run = Run {
                theta_deg,
                ..Run::new(&surface, &accelerator, Material::dielectric(1.5).unwrap())
            };
            let (statistics, _) = run.go(1, 64);
            let budget = statistics.means().budget();
            assert!(
                (budget.total() - 1.0).abs() < 1e-12,
                "{structure:?} {theta_deg}"
            );
            assert_eq!(budget.lost, 0.0, "{structure:?} {theta_deg}");
        }
    }
}
