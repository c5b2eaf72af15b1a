//! A second way to find hits, and how far two ways may differ by rounding.

use asperity_surface::Triangle;
use asperity_tracer::{Facet, Geometry, Hit, Query, Surface, Triangles};
use glam::DVec3;

use crate::ground::{Ground, over_box};
use crate::stressed::Stressed;

/// Möller and Trumbore's numbers: barycentric coordinates `[1 - u - v, u, v]` and ray parameter of
/// the point where a ray meets the plane of a facet.
struct Meeting {
    weights: [f64; 3],
    t: f64,
    determinant: f64,
    /// Largest error of a weight, by rounding, of either way.
    weight_error: f64,
    /// Error bound of `t`.
    t_error: f64,
}

/// `|x| + |y| + |z|`.
fn norm(p: DVec3) -> f64 {
    p.abs().element_sum()
}

/// Point where the ray of `query` meets the plane of `facet`.
///
/// `height_error`: by how much the heights themselves are uncertain.
///
/// # The band
/// With `eps = 2^-53`, `e1` and `e2` the edges from corner `a`, `s = origin - a`, `S = |s|`,
/// `D = |d|`, `E = max(|e1|, |e2|)`, all norms sums of absolute values, and
/// `det = e1 . (d x e2)`, which is minus the rate of the height above the facet's plane along the ray:
///
/// - *Möller and Trumbore*: `s` and the edges are rounded once (1 eps each), each component of a cross
///   product takes two products and a difference (3), a dot product three more (3): numerators and
///   determinant are off by 8 eps of the product of their norms. So `u = (s . p) / det` is off by
///   `8 eps D E (S + |u| E) / |det|` and an eps of `u`, and `t = (e2 . q) / det` by
///   `8 eps E (S E + |t| D E) / |det|`.
/// - *`Surface::intersect`*: the height above the plane at the origin, `((oz - z00) - pc x) - pr y`,
///   is off by 5 eps `S E`, its rate by 5 eps `D E`, so the meeting is off by
///   `5 eps E (S + |t| D) / |det|` in `t`, and in a weight, which changes by at most `2 D` a unit of
///   `t`, by twice `D` times that. Weights at the origin are off by 2 eps `S`. `S` is taken from a
///   corner of the facet instead of its cell's, which adds at most `E` to it.
///
/// At the facet `|t| D <= S + E` (times the 3 / sqrt 3 between norms). Together below
/// `(8 + 2 * 5 * 3) eps D E (S + E) / |det|`; 64 leaves room for second orders. Twice that, because the
/// weights that are compared with the band are off by as much themselves.
fn meeting(surface: &Surface, facet: Facet, query: &Query, height_error: f64) -> Meeting {
    let ray = query.ray;
    let [a, b, c] = surface.corners(facet);
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let s = ray.origin - a;
    let q = s.cross(e1);
    let determinant = e1.dot(p);
    let (u, v) = (s.dot(p) / determinant, ray.direction.dot(q) / determinant);
    let t = e2.dot(q) / determinant;

    let eps = 0.5 * f64::EPSILON;
    let (s, d, e) = (norm(s), norm(ray.direction), norm(e1).max(norm(e2)));
    let reach = s + t.abs().min(f64::MAX) * d + e;
    let t_error = (128.0 * eps * e * e * reach + 4.0 * height_error) / determinant.abs();
    Meeting {
        weights: [1.0 - u - v, u, v],
        t,
        determinant,
        weight_error: 2.0 * d * t_error,
        t_error,
    }
}

/// Möller and Trumbore 1997, without tolerance, culled by side: the facet passed first.
pub(crate) fn closest_hit(surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
    let mut closest = None;
    for facet in surface.facets() {
        let (t, determinant, inside) = moeller_trumbore(surface, facet, query);
        if query.half_space.sign() * determinant <= 0.0 {
            continue;
        }
        let hit = Hit { t, facet };
        if inside && t >= 0.0 && hit.is_before(&closest) {
            closest = Some(hit);
        }
    }
    closest
}

/// Ray parameter, determinant, and whether the plane is met inside the facet, edges included.
pub(crate) fn moeller_trumbore(surface: &Surface, facet: Facet, query: &Query) -> (f64, f64, bool) {
    let ray = query.ray;
    let [a, b, c] = surface.corners(facet);
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let s = ray.origin - a;
    let q = s.cross(e1);
    let determinant = e1.dot(p);
    let (u, v) = (s.dot(p) / determinant, ray.direction.dot(q) / determinant);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (e2.dot(q) / determinant, determinant, inside)
}

/// Returns `true` if rounding may decide whether the ray passes `facet`: it meets the plane within the band around an
/// edge, within the band around its own origin, or runs along the plane.
fn undecided(surface: &Surface, facet: Facet, query: &Query, height_error: f64) -> bool {
    let m = meeting(surface, facet, query, height_error);
    let all_inside = m.weights.iter().all(|w| *w > m.weight_error) && m.t > m.t_error;
    let some_outside = m.weights.iter().any(|w| *w < -m.weight_error) || m.t < -m.t_error;
    // A determinant below its own error makes every weight uncertain by more than one.
    let decided = m.weight_error < 1.0 && (all_inside || some_outside);
    !decided || m.determinant == 0.0
}

/// Comparison of two ways to find a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// One facet, and parameters that agree within their errors.
    Same,
    /// Another facet, where rounding decides.
    Band,
    /// Another facet, or another parameter.
    Different,
}

/// Compares two answers to `query` that may differ by rounding alone.
pub(crate) fn compare(
    surface: &Surface,
    query: &Query,
    found: Option<Hit<Facet>>,
    expected: Option<Hit<Facet>>,
    height_error: f64,
) -> Verdict {
    let first = match (found, expected) {
        (None, None) => return Verdict::Same,
        (Some(a), Some(b)) if a.facet == b.facet => {
            let m = meeting(surface, a.facet, query, height_error);
            // Where the ray runs along the plane, any point of the facet is as good.
            let same = (a.t - b.t).abs() <= m.t_error;
            return if same {
                Verdict::Same
            } else {
                Verdict::Different
            };
        }
        // The facet met first by one way was refused by the other.
        (Some(a), Some(b)) if a.t <= b.t => a,
        (_, Some(b)) => b,
        (Some(a), None) => a,
    };
    // A ray so flat that rounding of its place, times the slope, is more than its fall over a column
    // runs on within rounding of the surface for some columns.
    let ray = query.ray;
    let reach = norm(ray.origin) + first.t * norm(ray.direction);
    let [low, high] = surface.z_range();
    let level = 64.0 * f64::EPSILON * reach * (1.0 + high - low) / ray.direction.z.abs();
    let columns = 1 + level.min(1e3) as u32;
    let near = around(surface, first.facet, columns);
    if near
        .into_iter()
        .any(|facet| undecided(surface, facet, query, height_error))
    {
        Verdict::Band
    } else {
        Verdict::Different
    }
}

/// The facets of the tile within so many `columns` of a facet: with 1, those that share a corner.
///
/// Facets around one. If rounding lets a ray through a facet, the next one catches the ray as it enters, which the
/// textbook does not.
fn around(surface: &Surface, facet: Facet, columns: u32) -> Vec<Facet> {
    let [cx, cy] = surface.cells().map(|n| n as u32);
    let span = |i: u32, n: u32| i.saturating_sub(columns)..(i + columns + 1).min(n);
    span(facet.iy, cy)
        .flat_map(|iy| span(facet.ix, cx).map(move |ix| [ix, iy]))
        .flat_map(|[ix, iy]| {
            [Triangle::Lower, Triangle::Upper].map(|triangle| Facet { iy, ix, triangle })
        })
        .collect()
}

/// Returns `true` if the ray is in the half space that it claims where it first comes over the tile. Only then do its
/// hits in this tile make sense.
pub(crate) fn comes_in_its_medium<G: Stressed>(surface: &G, query: &Query) -> bool {
    // A ray that passes the tile by is nowhere wrong.
    let Some([start, _]) = over_box(surface, &query.ray, f64::INFINITY) else {
        return true;
    };
    let at = query.ray.at(start);
    let ground = Ground::new(surface);
    let height = query.half_space.sign() * (at.z - ground.height_in_tile(at.x, at.y));
    height >= -ground.tolerance_in_tile(&query.ray, start)
}
