//! Light on structured surfaces: V grooves against geometry, and the energy budget of every structure.

use asperity_optics::Material;
use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
    StructureSynthesis,
};
use asperity_tally::{Component, HemisphereGrid, Side, TallyResult, TallySpec};
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

fn surface(structure: Structure, n: usize) -> Surface {
    let synthesis = StructureSynthesis::new(structure, [n, n], [1.0, 1.0], false).unwrap();
    Surface::new(synthesis.draw(3, 0).unwrap())
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
        let grooves = surface(Structure::Grooves(Grooves { depth, ..GROOVES }), 16);
        let accelerator = Pyramid::build(&grooves).unwrap();
        let run = Run {
            theta_deg: 0.0,
            spec,
            ..Run::new(&grooves, &accelerator, Material::Mirror)
        };
        let (statistics, _) = run.go(1, 256);
        let values = statistics.means();
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
            let spacing = [16.0 / f64::from(n); 2];
            let shape = [n as usize; 2];
            let synthesis = StructureSynthesis::new(structure, shape, spacing, false).unwrap();
            let surface = Surface::new(synthesis.draw(3, 0).unwrap());
            let accelerator = Pyramid::build(&surface).unwrap();
            let run = Run {
                theta_deg: 0.0,
                spec,
                ..Run::new(&surface, &accelerator, Material::Mirror)
            };
            let (statistics, _) = run.go(1, 256);
            let values = statistics.means();
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
            let spacing = [16.0 / n as f64; 2];
            let synthesis = StructureSynthesis::new(structure, [n; 2], spacing, false).unwrap();
            let surface = Surface::new(synthesis.draw(3, 0).unwrap());
            let accelerator = Pyramid::build(&surface).unwrap();
            let glass = Material::dielectric(1.5).unwrap();
            let run = Run {
                theta_deg: 0.0,
                ..Run::new(&surface, &accelerator, glass)
            };
            let (statistics, _) = run.go(1, 128);
            let values = statistics.means();
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
        let surface = surface(structure, 128);
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
