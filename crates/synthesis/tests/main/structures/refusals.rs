//! Refusals of structures, and their sentences.

use asperity_surface::LengthUnit;
use asperity_synthesis::{
    Arrangement, Cracks, GrooveProfile, Grooves, Pyramids, Scratches, SphericalSegments, Structure,
    StructureError, StructureSynthesis,
};

use super::{CRACKS, GROOVES, PYRAMIDS, SCRATCHES, SEGMENTS};

fn refused(structure: Structure) -> StructureError {
    StructureSynthesis::new(structure, [256, 256], [1.0, 1.0], false).unwrap_err()
}

#[test]
fn parameters_out_of_range_are_named() {
    let bad = [f64::NAN, f64::INFINITY, -1.0];
    for value in bad {
        for structure in [
            Structure::Pits(SphericalSegments {
                depth: value,
                ..SEGMENTS
            }),
            Structure::Pits(SphericalSegments {
                width: value,
                ..SEGMENTS
            }),
            Structure::Pits(SphericalSegments {
                density: value,
                ..SEGMENTS
            }),
            Structure::Pits(SphericalSegments {
                edge_radius: value,
                ..SEGMENTS
            }),
            Structure::Pits(SphericalSegments {
                randomness: value,
                ..SEGMENTS
            }),
            Structure::Grooves(Grooves {
                depth: value,
                ..GROOVES
            }),
            Structure::Grooves(Grooves {
                width: value,
                ..GROOVES
            }),
            Structure::Grooves(Grooves {
                edge_radius: value,
                ..GROOVES
            }),
            Structure::Grooves(Grooves {
                randomness: value,
                ..GROOVES
            }),
            Structure::Scratches(Scratches {
                length: value,
                ..SCRATCHES
            }),
            Structure::Scratches(Scratches {
                spread: value,
                ..SCRATCHES
            }),
            Structure::Cracks(Cracks {
                density: value,
                ..CRACKS
            }),
            Structure::Pyramids(Pyramids {
                density: value,
                ..PYRAMIDS
            }),
        ] {
            let error = refused(structure);
            assert!(
                matches!(error, StructureError::BadParameter { .. }),
                "{error}"
            );
        }
    }
    let deep = SphericalSegments {
        depth: 8.5,
        ..SEGMENTS
    };
    let sentence = "the depth of pits is 8.5; it must be above 0, up to 8";
    assert_eq!(refused(Structure::Pits(deep)).to_string(), sentence);
    let blazed = Grooves {
        profile: GrooveProfile::Blazed,
        depth: 8.5,
        ..GROOVES
    };
    assert!(
        refused(Structure::Grooves(blazed))
            .to_string()
            .starts_with("the depth of blazed grooves")
    );
    let sine = Grooves {
        profile: GrooveProfile::Sine,
        edge_radius: 1.0,
        ..GROOVES
    };
    assert!(
        refused(Structure::Grooves(sine))
            .to_string()
            .contains("edge radius")
    );
}

#[test]
fn periods_that_do_not_fit_name_those_that_do() {
    let error = refused(Structure::Grooves(Grooves {
        width: 100.0,
        ..GROOVES
    }));
    assert_eq!(
        error.with_unit(LengthUnit::Micrometre).to_string(),
        "the tile is 256 um long along y and holds 2.56 periods of 100 um; a whole number would change the period by \
         more than 10 %: take a side of 200 um or 300 um"
    );
    let lattice = Pyramids {
        width: 150.0,
        density: 1.0,
        arrangement: Arrangement::Lattice,
        ..PYRAMIDS
    };
    assert!(matches!(
        refused(Structure::Inverted(lattice)),
        StructureError::NoWholePeriods { axis: 'x', .. }
    ));
    // 256 / 24 = 10.67 periods become 11, which is near enough
    let near = Structure::Grooves(Grooves {
        width: 24.0,
        ..GROOVES
    });
    let planned = StructureSynthesis::new(near, [256, 256], [1.0, 1.0], false).unwrap();
    assert_eq!(planned.period_and_azimuth().unwrap()[0], 256.0 / 11.0);
}

#[test]
fn surfaces_that_cannot_be_drawn_are_refused() {
    let oblique = Grooves {
        azimuth: 0.5,
        randomness: 0.1,
        ..GROOVES
    };
    assert_eq!(
        refused(Structure::Grooves(oblique)),
        StructureError::ObliqueRandomGrooves
    );
    let narrow = SphericalSegments {
        width: 3.0,
        depth: 1.0,
        ..SEGMENTS
    };
    assert!(matches!(
        refused(Structure::Pits(narrow)),
        StructureError::Unresolved { .. }
    ));
    let insisted = StructureSynthesis::new(Structure::Pits(narrow), [64, 64], [1.0, 1.0], true);
    assert!(insisted.is_ok());
    for length in [1e6, 1e12] {
        let long = Scratches {
            length,
            ..SCRATCHES
        };
        assert!(matches!(
            refused(Structure::Scratches(long)),
            StructureError::BadParameter { name: "length", .. }
        ));
    }
    let many = Cracks {
        width: 1e-6,
        depth: 1e-6,
        ..CRACKS
    };
    let many = StructureSynthesis::new(Structure::Cracks(many), [64, 64], [1.0, 1.0], true);
    assert!(matches!(many, Err(StructureError::TooManyFeatures { .. })));
    let separate = Pyramids {
        arrangement: Arrangement::Separate,
        ..PYRAMIDS
    };
    assert_eq!(
        refused(Structure::Pyramids(separate)),
        StructureError::NoSeparatePyramids
    );
}

/// A wide rounded edge takes so much room that half the tile is too much.
#[test]
fn crowded_features_are_counted() {
    let crowded = SphericalSegments {
        density: 0.5,
        edge_radius: 20.0,
        arrangement: Arrangement::Separate,
        ..SEGMENTS
    };
    let synthesis =
        StructureSynthesis::new(Structure::Pits(crowded), [256, 256], [1.0, 1.0], false).unwrap();
    let error = synthesis.heights(1, 0).unwrap_err();
    assert!(
        matches!(error, StructureError::Crowded { placed, requested } if placed < requested),
        "{error}"
    );
}
