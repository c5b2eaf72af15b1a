//! Structured surfaces have the statistics that are known in closed form, and the bytes that their seed determines.

mod exact;
mod refusals;
mod statistics;

use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
    StructureSynthesis,
};

pub(crate) const SEGMENTS: SphericalSegments = SphericalSegments {
    depth: 3.0,
    width: 16.0,
    density: 0.4,
    edge_radius: 0.0,
    randomness: 0.0,
    arrangement: Arrangement::Random,
};

pub(crate) const GROOVES: Grooves = Grooves {
    profile: GrooveProfile::V,
    depth: 4.0,
    width: 16.0,
    azimuth: 0.0,
    edge_radius: 0.0,
    randomness: 0.0,
};

pub(crate) const SCRATCHES: Scratches = Scratches {
    depth: 2.0,
    width: 8.0,
    length: 100.0,
    density: 0.5,
    azimuth: 0.3,
    spread: 0.2,
    edge_radius: 0.0,
    randomness: 0.0,
};

pub(crate) const CRACKS: Cracks = Cracks {
    depth: 3.0,
    width: 8.0,
    density: 0.4,
    edge_radius: 0.0,
};

pub(crate) const PYRAMIDS: Pyramids = Pyramids {
    depth: 8.0 * std::f64::consts::SQRT_2,
    width: 16.0,
    density: 1.5,
    randomness: 0.0,
    arrangement: Arrangement::Random,
};

/// One of each kind, with all that is random.
pub(crate) fn one_of_each() -> Vec<Structure> {
    let segments = SphericalSegments {
        edge_radius: 1.0,
        randomness: 0.3,
        ..SEGMENTS
    };
    let [separate, lattice] = [Arrangement::Separate, Arrangement::Lattice];
    vec![
        Structure::Pits(segments),
        Structure::Pits(SphericalSegments {
            arrangement: separate,
            density: 0.3,
            ..segments
        }),
        Structure::Caps(SphericalSegments {
            arrangement: lattice,
            density: 0.9,
            ..segments
        }),
        Structure::Grooves(Grooves {
            edge_radius: 0.2,
            randomness: 0.3,
            ..GROOVES
        }),
        Structure::Grooves(Grooves {
            profile: GrooveProfile::Sine,
            azimuth: 0.4,
            ..GROOVES
        }),
        Structure::Grooves(Grooves {
            profile: GrooveProfile::Blazed,
            azimuth: std::f64::consts::FRAC_PI_2,
            randomness: 0.3,
            ..GROOVES
        }),
        Structure::Scratches(Scratches {
            edge_radius: 0.2,
            randomness: 0.5,
            ..SCRATCHES
        }),
        Structure::Cracks(Cracks {
            edge_radius: 0.5,
            ..CRACKS
        }),
        Structure::Pyramids(Pyramids {
            randomness: 0.5,
            ..PYRAMIDS
        }),
        Structure::Inverted(Pyramids {
            arrangement: lattice,
            density: 1.0,
            ..PYRAMIDS
        }),
    ]
}

pub(crate) fn planned(structure: Structure, n: usize, spacing: f64) -> StructureSynthesis {
    StructureSynthesis::new(structure, [n, n], [spacing, spacing], false).unwrap()
}
