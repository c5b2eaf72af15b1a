//! Exact properties of structures, for any seed.

use asperity_synthesis::{
    Arrangement, GrooveProfile, Grooves, Pyramids, SphericalSegments, Structure, StructureSynthesis,
};
use rayon::ThreadPoolBuilder;

use super::{GROOVES, PYRAMIDS, SEGMENTS, one_of_each, planned};

#[test]
fn heights_do_not_depend_on_the_number_of_threads() {
    for structure in one_of_each() {
        let synthesis = planned(structure, 128, 1.0);
        let with = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let heights = pool.unwrap().install(|| synthesis.heights(7, 3)).unwrap();
            heights.into_iter().map(f64::to_bits).collect::<Vec<u64>>()
        };
        assert_eq!(with(1), with(3), "{}", structure.name());
    }
}

/// Samples that both grids have lie at the same places to rounding, at most at slopes of some ten; hemispheres, which are steeper,
/// are none of these.
#[test]
fn a_finer_grid_has_the_same_surface() {
    for structure in one_of_each() {
        let coarse = planned(structure, 128, 1.0).heights(5, 0).unwrap();
        let fine = planned(structure, 256, 0.5).heights(5, 0).unwrap();
        for iy in 0..128 {
            for ix in 0..128 {
                let (a, b) = (coarse[iy * 128 + ix], fine[2 * iy * 256 + 2 * ix]);
                assert!((a - b).abs() < 1e-10, "{}: {a} {b}", structure.name());
            }
        }
    }
}

#[test]
fn realisations_differ_where_anything_is_random() {
    for structure in one_of_each() {
        let synthesis = planned(structure, 64, 2.0);
        let [first, same, other, seed] =
            [(1, 0), (1, 0), (1, 1), (2, 0)].map(|(s, r)| synthesis.heights(s, r).unwrap());
        assert_eq!(first, same);
        let is_fixed = match structure {
            Structure::Grooves(grooves) => grooves.randomness == 0.0,
            Structure::Inverted(_) => true,
            _ => false,
        };
        assert_eq!(first == other, is_fixed, "{}", structure.name());
        assert_eq!(first == seed, is_fixed, "{}", structure.name());
    }
}

/// No step over the border is larger than the steepest flank: heights join periodically. Rows are skewed against columns.
#[test]
fn tiles_join_without_a_step() {
    for structure in one_of_each() {
        let (nx, ny) = (160, 128);
        let synthesis = StructureSynthesis::new(structure, [ny, nx], [1.0, 1.0], false).unwrap();
        let heights = synthesis.heights(11, 2).unwrap();
        let at = |ix: usize, iy: usize| heights[(iy % ny) * nx + ix % nx];
        let (mut within, mut across) = (0.0_f64, 0.0_f64);
        for iy in 0..ny {
            for ix in 0..nx {
                let right = (at(ix + 1, iy) - at(ix, iy)).abs();
                let up = (at(ix, iy + 1) - at(ix, iy)).abs();
                for (step, is_last) in [(right, ix + 1 == nx), (up, iy + 1 == ny)] {
                    let worst = if is_last { &mut across } else { &mut within };
                    *worst = worst.max(step);
                }
            }
        }
        assert!(
            across <= 1.01 * within,
            "{}: {across} {within}",
            structure.name()
        );
    }
}

/// Ridges and bottoms lie on samples, so that each step is one of the flanks.
#[test]
fn steps_of_v_grooves_are_their_flanks() {
    let synthesis = planned(Structure::Grooves(GROOVES), 64, 1.0);
    let heights = synthesis.heights(0, 0).unwrap();
    for iy in 0..64 {
        for ix in 0..64 {
            let (here, next) = (heights[iy * 64 + ix], heights[(iy + 1) % 64 * 64 + ix]);
            assert!(((here - next).abs() - 0.5).abs() < 1e-12);
            assert_eq!(here, heights[iy * 64]);
        }
    }
    assert_eq!(synthesis.expected().mean_square_slope, Some(0.25));
    assert_eq!(synthesis.expected().depth, Some(4.0));
}

/// `cos^2` of the blaze angle of each period falls along the direction 90 degrees right of the grooves, here +x, at the slope of the
/// blaze angle; the rest rises at right angles to it.
#[test]
fn blazed_grooves_have_facets_at_right_angles() {
    let structure = |depth| {
        Structure::Grooves(Grooves {
            profile: GrooveProfile::Blazed,
            depth,
            width: 20.0,
            azimuth: std::f64::consts::FRAC_PI_2,
            ..GROOVES
        })
    };
    // sin(2 blaze) = 2 * 8 / 20 = 0.8, so that tan(blaze) = 1/2 and cos^2 = 0.8: the bottom lies at 16
    let heights = planned(structure(8.0), 20, 1.0).heights(0, 0).unwrap();
    for (ix, h) in heights[..20].iter().enumerate() {
        let x = ix as f64;
        let expected = if x <= 16.0 {
            -0.5 * x
        } else {
            -8.0 + 2.0 * (x - 16.0)
        };
        assert!((h - expected).abs() < 1e-12, "{ix}: {h}");
    }
}

/// Phases of oblique grooves grow by whole numbers along both sides, and the nearest such grooves are taken.
#[test]
fn oblique_grooves_are_adjusted_and_reported() {
    let azimuth = 30_f64.to_radians();
    let structure = Structure::Grooves(Grooves { azimuth, ..GROOVES });
    let synthesis = planned(structure, 256, 1.0);
    // 256 / 16 = 16 periods: 16 sin 30 = 8 along x, 16 cos 30 = 13.86, 14, along y
    let [period, found] = synthesis.period_and_azimuth().unwrap();
    assert!((period - 256.0 / 8_f64.hypot(14.0)).abs() < 1e-12);
    assert!((found.tan() - 8.0 / 14.0).abs() < 1e-12, "{found}");
    let heights = synthesis.heights(0, 0).unwrap();
    // Along the grooves, 14 samples in x and 8 in y, heights do not change
    for i in 0..18 {
        let h = heights[8 * i % 256 * 256 + 14 * i % 256];
        assert!((h - heights[0]).abs() < 1e-10, "{i}: {h}");
    }
}

/// Apexes and valleys lie on samples, and cells are split along the creases.
#[test]
fn triangles_of_touching_pyramids_have_the_angle_of_facets() {
    let lattice = Pyramids {
        density: 1.0,
        arrangement: Arrangement::Lattice,
        ..PYRAMIDS
    };
    assert!((Pyramids::crystal_height(16.0) - lattice.depth).abs() < 1e-12);
    let angle = lattice.slope().atan().to_degrees();
    assert!((angle - 54.7356).abs() < 1e-4);
    for structure in [Structure::Pyramids(lattice), Structure::Inverted(lattice)] {
        let synthesis = planned(structure, 64, 1.0);
        assert!(synthesis.is_exact(0, 0).unwrap());
        let field = synthesis.draw(0, 0).unwrap();
        for cell in 0..64 * 64 {
            for [x, y] in field.facet_slopes(cell % 64, cell / 64) {
                assert!((x.hypot(y) - lattice.slope()).abs() < 1e-12);
                assert!(x.abs().min(y.abs()) < 1e-12);
            }
        }
        // The samples of the same heights without turned cells are not
        let plain = field.clone().with_turned_cells(None);
        assert!(plain.slope_moments().fourth > 1.01 * field.slope_moments().fourth);
    }
}

/// Grooves at 45 degrees have their edges along one or the other diagonal of cells.
#[test]
fn grooves_along_either_diagonal_are_exact() {
    for azimuth in [45.0_f64, 135.0, -45.0] {
        // 8 periods along x and y; an edge every second sample
        let structure = Structure::Grooves(Grooves {
            width: 8.0 / 2_f64.sqrt(),
            azimuth: azimuth.to_radians(),
            ..GROOVES
        });
        let synthesis = planned(structure, 64, 1.0);
        assert!(synthesis.is_exact(0, 0).unwrap(), "{azimuth}");
        let field = synthesis.draw(0, 0).unwrap();
        let [xx, _, yy] = field.slope_moments().second;
        let expected = synthesis.expected().mean_square_slope.unwrap();
        assert!((xx + yy - expected).abs() < 1e-9, "{azimuth}");
        assert_eq!(field.turned_cells().is_some(), azimuth != 45.0);
    }
}

/// Edges between samples, curves, and edges of features at random are cut by facets.
#[test]
fn surfaces_whose_edges_facets_cut_are_known() {
    let is_exact = |structure, n| planned(structure, n, 1.0).is_exact(1, 0).unwrap();
    assert!(is_exact(Structure::Grooves(GROOVES), 64));
    // 5 periods of 12.8 samples
    let lattice = Pyramids {
        density: 1.0,
        arrangement: Arrangement::Lattice,
        width: 12.8,
        ..PYRAMIDS
    };
    assert!(!is_exact(Structure::Pyramids(lattice), 64));
    for structure in one_of_each() {
        let is_even =
            structure == Structure::Grooves(GROOVES) || matches!(structure, Structure::Inverted(_));
        assert_eq!(is_exact(structure, 128), is_even, "{}", structure.name());
    }
}

/// Rows of a tile that no hexagonal lattice fits exactly move by the least that whole numbers take.
#[test]
fn hexagonal_lattices_are_adjusted_and_reported() {
    let touching = std::f64::consts::PI / (2.0 * 3_f64.sqrt());
    let caps = SphericalSegments {
        density: touching,
        arrangement: Arrangement::Lattice,
        ..SEGMENTS
    };
    let synthesis = planned(Structure::Caps(caps), 128, 1.0);
    // 128 / 16 = 8 columns, 128 / (8 sqrt 3) = 9.24 rows, of which an even number
    let [x, y] = synthesis.pitches().unwrap();
    assert!(
        (x - 16.0).abs() < 1e-12 && (y - 12.8).abs() < 1e-12,
        "{x} {y}"
    );
    let heights = synthesis.heights(0, 0).unwrap();
    assert!((heights[0] - 3.0).abs() < 1e-12);
    assert_eq!(heights[8], 0.0);
}

#[test]
fn smooth_cells_suit_surfaces_without_edges() {
    let suits = |structure, spacing| planned(structure, 256, spacing).suits_smooth_cells();
    let sine = Grooves {
        profile: GrooveProfile::Sine,
        ..GROOVES
    };
    // Radius of curvature 2 (16 / 2 pi)^2 / 4 = 3.24
    assert!(suits(Structure::Grooves(sine), 0.5));
    assert!(!suits(Structure::Grooves(sine), 1.0));
    assert!(!suits(Structure::Grooves(GROOVES), 0.25));
    let rounded = Grooves {
        edge_radius: 4.0,
        ..GROOVES
    };
    assert!(suits(Structure::Grooves(rounded), 1.0));
    let pits = |arrangement| SphericalSegments {
        edge_radius: 4.0,
        arrangement,
        ..SEGMENTS
    };
    assert!(suits(Structure::Pits(pits(Arrangement::Separate)), 1.0));
    assert!(!suits(Structure::Pits(pits(Arrangement::Random)), 1.0));
    assert!(!suits(Structure::Pyramids(PYRAMIDS), 1.0));
}
