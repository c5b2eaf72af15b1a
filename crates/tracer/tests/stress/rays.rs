//! Rays that are hard on surfaces.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use asperity_tracer::{Geometry, HalfSpace, Query, TileRay};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::stressed::Stressed;

/// Ways in which a ray tries to slip through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// From outside onto the tile, theta from 0 to within 1e-6 of a right angle.
    Outside,
    /// From 1e4 to 1e7 columns away.
    Far,
    /// Along an axis or a diagonal, exactly or off it by next to nothing; level ones too.
    Axis,
    /// Straight down or up, onto facets, vertices, edges and diagonals.
    Vertical,
    /// At a vertex, or a point of an edge or a diagonal.
    Aimed,
    /// In the tangent plane at a point of a facet, from the point, from before it, or from nearby.
    InPlane,
    /// From a vertex, or a point of an edge or a diagonal, anywhere.
    FromCorners,
    /// Away from a facet, as after an interaction.
    FromFacets,
}

impl Family {
    pub(crate) const ALL: [Self; 8] = [
        Self::Outside,
        Self::Far,
        Self::Axis,
        Self::Vertical,
        Self::Aimed,
        Self::InPlane,
        Self::FromCorners,
        Self::FromFacets,
    ];
}

/// Parts of a column by which a direction may be off an axis: nothing, and what is lost in rounding
/// in double precision, in single precision, and in the range of either.
const OFF_AXIS: [f64; 6] = [0.0, 1e-9, 6e-17, 1e-40, 1e-300, 5e-324];

/// A physical direction of unit length that goes to the other side: down for `Above`.
fn onward(rng: &mut ChaCha8Rng, half_space: HalfSpace) -> DVec3 {
    let turn = rng.random_range(0.0..TAU);
    let steepness = 10_f64.powf(rng.random_range(-6.0..1.5));
    DVec3::new(turn.cos(), turn.sin(), -half_space.sign() * steepness).normalize()
}

/// A physical direction, in tile coordinates.
fn in_tile<G: Geometry>(surface: &G, d: DVec3) -> DVec3 {
    DVec3::new(d.x, d.y * surface.aspect(), d.z)
}

fn any_facet<G: Geometry>(surface: &G, rng: &mut ChaCha8Rng) -> G::Facet {
    surface.facet(rng.random_range(0..surface.facet_count()))
}

/// Coordinates in a cell: of a corner, of a point of an edge or of the diagonal.
fn on_the_frame(rng: &mut ChaCha8Rng) -> [f64; 2] {
    let along = match rng.random_range(0..3) {
        0 => 0.5,
        1 => 0.25,
        _ => rng.random::<f64>(),
    };
    let side = f64::from(rng.random_range(0..2));
    match rng.random_range(0..4) {
        0 => [f64::from(rng.random_range(0..2)), side],
        1 => [along, side],
        2 => [side, along],
        _ => [along, along],
    }
}

/// A random vertex, or point of an edge or a diagonal.
pub(crate) fn frame_point<G: Stressed>(surface: &G, rng: &mut ChaCha8Rng) -> DVec3 {
    frame_point_of(surface, any_facet(surface, rng), rng)
}

/// A random corner of the cell of `facet`, or point of its edges or its diagonal.
fn frame_point_of<G: Stressed>(surface: &G, facet: G::Facet, rng: &mut ChaCha8Rng) -> DVec3 {
    let cell = G::cell_of(facet);
    let place = on_the_frame(rng);
    point_at(surface, G::facet_at(cell, place), place)
}

/// A random point of a facet.
fn inner_point<G: Stressed>(surface: &G, facet: G::Facet, rng: &mut ChaCha8Rng) -> DVec3 {
    let [u, v] = [rng.random::<f64>(), rng.random::<f64>()];
    let is_inside = G::facet_at(G::cell_of(facet), [u, v]) == facet;
    point_at(surface, facet, if is_inside { [u, v] } else { [v, u] })
}

/// The point of a facet at `[u, v]` of its cell.
fn point_at<G: Stressed>(surface: &G, facet: G::Facet, [u, v]: [f64; 2]) -> DVec3 {
    let [ix, iy] = G::cell_of(facet).map(f64::from);
    surface.snap(facet, DVec3::new(ix + u, iy + v, 0.0))
}

/// A ray of one family.
pub(crate) fn draw<G: Stressed>(surface: &G, family: Family, rng: &mut ChaCha8Rng) -> Query {
    let half_space = if rng.random::<bool>() {
        HalfSpace::Above
    } else {
        HalfSpace::Below
    };
    let q = half_space.sign();
    let [cx, cy] = surface.extent();
    let [_, high] = surface.z_range();
    let place = DVec3::new(
        rng.random_range(0.0..cx),
        rng.random_range(0.0..cy),
        q * high,
    );
    let distance = |rng: &mut ChaCha8Rng, range| 10_f64.powf(rng.random_range(range));
    let (origin, direction) = match family {
        Family::Outside => {
            let d = in_tile(surface, onward(rng, half_space));
            (place - d * distance(rng, -6.0..3.0), d)
        }
        Family::Far => {
            let d = in_tile(surface, onward(rng, half_space));
            (place - d * distance(rng, 4.0..7.0), d)
        }
        Family::Axis => {
            let turn = f64::from(rng.random_range(0..8));
            let (sin, cos) = (turn * FRAC_PI_4).sin_cos();
            let tiny = OFF_AXIS[rng.random_range(0..OFF_AXIS.len())];
            let exact = |x: f64| if x.abs() < 1e-9 { tiny } else { x };
            let fall = match rng.random_range(0..4) {
                0 => 0.0,
                1 => OFF_AXIS[rng.random_range(0..OFF_AXIS.len())],
                _ => 10_f64.powf(rng.random_range(-4.0..1.0)),
            };
            // Of the diagonals, half run exactly along those of the cells.
            let d = if turn % 2.0 == 1.0 && rng.random::<bool>() {
                DVec3::new(cos.signum(), sin.signum(), -q * fall)
            } else {
                in_tile(surface, DVec3::new(exact(cos), exact(sin), -q * fall))
            };
            let mut target = place;
            target.z = rng.random_range(-1.0..=1.0) * high;
            if rng.random::<bool>() {
                target = DVec3::new(target.x.round(), target.y.round(), target.z);
            }
            (target - d * distance(rng, -3.0..3.0), d.normalize())
        }
        Family::Vertical => {
            let mut top = match rng.random_range(0..3) {
                0 => place,
                1 => frame_point(surface, rng),
                _ => {
                    let facet = any_facet(surface, rng);
                    inner_point(surface, facet, rng)
                }
            };
            if rng.random::<bool>() {
                top.z = q * (high + distance(rng, -6.0..3.0));
            }
            let down = if rng.random_range(0..4) > 0 { -q } else { q };
            (top, DVec3::new(0.0, 0.0, down))
        }
        Family::Aimed => {
            let target = frame_point(surface, rng);
            let d = in_tile(surface, onward(rng, half_space));
            // From the height of the highest point, if it is not too far, or from anywhere before.
            let back = match rng.random_range(0..3) {
                0 => ((target.z - q * high) / d.z).min(1e6),
                _ => distance(rng, -3.0..3.0),
            };
            (target - d * back, d)
        }
        Family::InPlane => {
            let facet = any_facet(surface, rng);
            let p = match rng.random_range(0..3) {
                0 => frame_point_of(surface, facet, rng),
                _ => inner_point(surface, facet, rng),
            };
            let d = surface.tangent(facet, p, rng);
            let start = match rng.random_range(0..4) {
                0 | 1 => p,
                2 => p - d * distance(rng, -3.0..2.0),
                _ => {
                    // Elsewhere in the cell, or in a neighbouring one.
                    let [ix, iy] = G::cell_of(facet);
                    let [cx, cy] = [cx as u32, cy as u32];
                    let (ix, iy) = (ix + rng.random_range(0..2), iy + rng.random_range(0..2));
                    let place = [rng.random::<f64>(), rng.random::<f64>()];
                    point_at(surface, G::facet_at([ix % cx, iy % cy], place), place)
                }
            };
            (start, d)
        }
        Family::FromCorners => {
            let d = in_tile(surface, onward(rng, half_space));
            let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
            let d = match rng.random_range(0..4) {
                0 => {
                    let turn = f64::from(rng.random_range(0..4)) * FRAC_PI_2;
                    let level = DVec3::new(turn.cos().round(), turn.sin().round(), 0.0);
                    (level + DVec3::Z * d.z).normalize()
                }
                _ => d,
            };
            (frame_point(surface, rng), sign * d)
        }
        Family::FromFacets => {
            let facet = any_facet(surface, rng);
            let d = onward(rng, half_space);
            let start = inner_point(surface, facet, rng);
            let sign = if q * d.dot(surface.normal_at(facet, start)) > 0.0 {
                1.0
            } else {
                -1.0
            };
            (start, in_tile(surface, sign * d))
        }
    };
    Query {
        ray: TileRay { origin, direction },
        half_space,
    }
}
