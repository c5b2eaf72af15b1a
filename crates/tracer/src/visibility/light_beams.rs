//! Light beams: collimated light inside a medium that has come through one facet of the surface above it.
//!
//! Facets are flat, so light that enters through one continues as a beam of parallel rays, a prism below the facet.
//! Which prisms hold a given point is found by a binary tree over the facets: a node knows the box of its
//! facets, and the bounds of the directions of the refracted light. A point of the medium that is
//! scattered light on its way to the eye so finds the light, which random paths would hardly find behind a
//! refracting surface. Beams end after some tiles, so that few of them contain any one point; light that has come
//! farther is left to chance, by the length of its flight alone.

use asperity_numerics::elementary::acos;
use asperity_optics::{Material, refract};
use asperity_surface::Border;
use glam::DVec3;

use crate::geometry::{Geometry, Triangles};
use crate::periodic::can_traverse;
use crate::sampling::morton::morton_code;

/// Facets of a leaf: few enough to test, enough for the tree to be small compared with the surface.
const LEAF: usize = 8;

/// Length of beams in shorter sides of the tile, where it has neighbours: a point in the medium lies in
/// some `(2 * 16 + 1)^2` tiles at most.
const LONGEST: f64 = 16.0;

/// The beams of light from one direction below all facets of a tile.
pub struct LightBeams<G: Geometry> {
    /// Corners of a facet, which is a triangle.
    corners: fn(&G, G::Facet) -> [DVec3; 3],
    material: Material,
    towards: DVec3,
    /// Facets in an order in which neighbours are near.
    facets: Vec<G::Facet>,
    /// A complete binary tree, root first; the children of node `i` are `2 i + 1` and `2 i + 2`.
    nodes: Vec<Node>,
    leaves: usize,
    /// Length of beams, tile coordinates: light from farther away is left to random paths.
    farthest: f64,
    /// `true` if the light comes from above the horizon.
    is_up: bool,
}

/// A beam that holds a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beam<F> {
    pub(crate) facet: F,
    /// Distance from the facet to the point along the beam, tile coordinates.
    pub(crate) t: f64,
    /// Unit direction of the light, in physical lengths.
    pub(crate) direction: DVec3,
    /// Fraction of the light that the facet transmits, times the solid angle inside over that outside.
    pub(crate) fraction: f64,
}

/// Bounds of some facets; of none, if the lower ones exceed the upper.
#[derive(Clone, Copy)]
struct Node {
    place: Bounds,
    /// Bounds of directions, in tile coordinates.
    direction: Bounds,
}

#[derive(Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl<G: Geometry> LightBeams<G> {
    /// Beams of light that falls on `geometry`, of a dielectric `material`, from the direction `towards`.
    #[must_use]
    pub fn new(geometry: &G, material: Material, towards: DVec3) -> Self
    where
        G: Triangles,
    {
        let [cx, cy] = geometry.extent();
        let scale = DVec3::new(65_535.0 / cx, 65_535.0 / cy, 0.0);
        let mut keyed: Vec<(u64, G::Facet)> = (0..geometry.facet_count())
            .map(|index| {
                let facet = geometry.facet(index);
                let [a, b, c] = geometry.corners(facet);
                let place = ((a + b + c) / 3.0 * scale).max(DVec3::ZERO);
                (morton_code([place.x as u32, place.y as u32]), facet)
            })
            .collect();
        keyed.sort_unstable();
        let facets: Vec<G::Facet> = keyed.into_iter().map(|(_, facet)| facet).collect();
        let leaves = facets.len().div_ceil(LEAF).next_power_of_two();
        let mut beams = Self {
            corners: G::corners,
            material,
            towards,
            facets,
            nodes: vec![Node::NONE; 2 * leaves - 1],
            leaves,
            farthest: match geometry.border() {
                Border::Open => f64::INFINITY,
                _ => LONGEST * cx.min(cy / geometry.aspect()),
            },
            is_up: true,
        };
        beams.aim(geometry, towards);
        beams
    }

    /// Aims the beams at these facets from another direction.
    pub fn aim(&mut self, geometry: &G, towards: DVec3) {
        self.towards = towards;
        // The rest of a disc at the horizon lights nothing, behind so many tiles.
        let theta = acos(towards.z.clamp(-1.0, 1.0));
        self.is_up = towards.z > 0.0 && can_traverse(geometry, theta);
        for leaf in 0..self.leaves {
            let mut node = Node::NONE;
            for &facet in self.of_leaf(leaf) {
                if let Some((direction, _)) = self.refracted(geometry, facet) {
                    let aspect = DVec3::new(1.0, geometry.aspect(), 1.0);
                    node.direction.add(direction * aspect);
                    for corner in (self.corners)(geometry, facet) {
                        node.place.add(corner);
                    }
                }
            }
            self.nodes[self.leaves - 1 + leaf] = node;
        }
        for i in (0..self.leaves - 1).rev() {
            let [a, b] = [2 * i + 1, 2 * i + 2].map(|child| self.nodes[child]);
            self.nodes[i] = Node {
                place: a.place.with(b.place),
                direction: a.direction.with(b.direction),
            };
        }
    }

    /// The direction towards the light.
    #[must_use]
    pub const fn towards(&self) -> DVec3 {
        self.towards
    }

    /// Returns `true` if light goes down wherever it enters, in a medium of higher index or of the same.
    pub(crate) fn is_denser_below(&self) -> bool {
        self.material
            .transmitting_index()
            .is_some_and(|eta| eta >= 1.0)
    }

    /// The length of beams, tile coordinates, beyond which light is left to chance.
    pub(crate) const fn farthest(&self) -> f64 {
        self.farthest
    }

    /// Hands on the beams that hold the point `x`, tile coordinates, within `reach` of their facets.
    ///
    /// `is_periodic`: `true` if the tile is one of a period.
    pub(crate) fn holding(
        &self,
        geometry: &G,
        x: DVec3,
        reach: f64,
        is_periodic: bool,
        mut each: impl FnMut(Beam<G::Facet>),
    ) {
        let root = &self.nodes[0];
        let reach = reach.min(self.farthest);
        let Some([near, far]) = root.distances(x, reach) else {
            return;
        };
        // Tiles from which light comes so far, few as `far` is bounded.
        let mut tiles = [[0.0, 0.0]; 2];
        for (axis, size) in geometry.extent().into_iter().enumerate() {
            if is_periodic {
                let (low, high) = (root.direction.low[axis], root.direction.high[axis]);
                let from = x[axis] - (near * high).max(far * high);
                let to = x[axis] - (near * low).min(far * low);
                tiles[axis] = [(from / size).floor(), (to / size).floor()];
            }
        }
        let [[x0, x1], [y0, y1]] = tiles;
        let [cx, cy] = geometry.extent();
        let (mut i, mut j) = (x0, y0);
        while j <= y1 {
            let there = x - DVec3::new(i * cx, j * cy, 0.0);
            self.search(geometry, there, reach, &mut each);
            i += 1.0;
            if i > x1 {
                (i, j) = (x0, j + 1.0);
            }
        }
    }

    fn search(&self, geometry: &G, x: DVec3, reach: f64, each: &mut impl FnMut(Beam<G::Facet>)) {
        // Two children a level, of at most 64 levels.
        let mut stack = [0_usize; 65];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let i = stack[depth];
            if !self.nodes[i].may_hold(x, reach) {
                continue;
            }
            if i + 1 < self.leaves {
                stack[depth] = 2 * i + 1;
                stack[depth + 1] = 2 * i + 2;
                depth += 2;
                continue;
            }
            for &facet in self.of_leaf(i + 1 - self.leaves) {
                if let Some(beam) = self.beam(geometry, facet, x, reach) {
                    each(beam);
                }
            }
        }
    }

    /// The beam below one facet, if it holds the point.
    fn beam(&self, geometry: &G, facet: G::Facet, x: DVec3, reach: f64) -> Option<Beam<G::Facet>> {
        let (direction, fraction) = self.refracted(geometry, facet)?;
        let along = direction * DVec3::new(1.0, geometry.aspect(), 1.0);
        let [a, b, c] = (self.corners)(geometry, facet);
        let normal = (b - a).cross(c - a);
        let t = normal.dot(x - a) / normal.dot(along);
        if !(t > 0.0 && t <= reach) {
            return None;
        }
        let p = x - t * along;
        let within = [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(from, to)| (to - from).cross(p - from).dot(normal) >= 0.0);
        within.then_some(Beam {
            facet,
            t,
            direction,
            fraction,
        })
    }

    /// The direction of light refracted by a facet that faces it, and its fraction.
    ///
    /// Solid angles on both sides of an interface keep `n^2 cos`, so that `d omega_t / d omega_i` is
    /// `cos(alpha) / (eta^2 cos(beta))`.
    fn refracted(&self, geometry: &G, facet: G::Facet) -> Option<(DVec3, f64)> {
        let eta = self.material.transmitting_index()?;
        let [a, ..] = (self.corners)(geometry, facet);
        let m = geometry.normal_at(facet, a);
        let cos_theta_i = self.towards.dot(m);
        if cos_theta_i <= 0.0 || !self.is_up {
            return None;
        }
        let fresnel = self.material.fresnel(cos_theta_i.min(1.0));
        if fresnel.transmitted <= 0.0 {
            return None;
        }
        let direction = refract(self.towards, m, eta, fresnel.cos_theta_t);
        let cos_theta_t = -direction.dot(m);
        let fraction = fresnel.transmitted * cos_theta_i / (eta * eta * cos_theta_t);
        Some((direction, fraction))
    }

    fn of_leaf(&self, leaf: usize) -> &[G::Facet] {
        let count = self.facets.len();
        &self.facets[(leaf * LEAF).min(count)..((leaf + 1) * LEAF).min(count)]
    }
}

impl Node {
    const NONE: Self = Self {
        place: Bounds::NONE,
        direction: Bounds::NONE,
    };

    /// Between which distances from the facets, of `reach` at most, light of these directions may come to
    /// the height of `x`.
    fn distances(&self, x: DVec3, reach: f64) -> Option<[f64; 2]> {
        let Bounds { low, high } = self.place;
        if low.z > high.z {
            return None;
        }
        // Light goes down below a height field, unless the medium is the thinner one; beneath an overhang it
        // may rise.
        let fall = [-self.direction.high.z, -self.direction.low.z];
        let depth = [low.z - x.z, high.z - x.z];
        if fall[0] <= 0.0 {
            return Some([0.0, reach]);
        }
        if depth[1] < 0.0 {
            return None;
        }
        // Rounding is far below this.
        let least = (depth[0] / fall[1]).max(0.0) * (1.0 - 1e-9);
        let most = (depth[1] / fall[0]).min(reach) * (1.0 + 1e-9);
        (least <= most).then_some([least, most])
    }

    /// Returns `true` if a beam of one of the facets may hold `x`.
    fn may_hold(&self, x: DVec3, reach: f64) -> bool {
        let Some([near, far]) = self.distances(x, reach) else {
            return false;
        };
        [0, 1].into_iter().all(|axis| {
            let (low, high) = (self.direction.low[axis], self.direction.high[axis]);
            let least = (near * low).min(far * low) - 1e-9;
            let most = (near * high).max(far * high) + 1e-9;
            x[axis] - self.place.high[axis] <= most && x[axis] - self.place.low[axis] >= least
        })
    }
}

impl Bounds {
    const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    fn add(&mut self, p: DVec3) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }

    fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}
