//! Intake: checks and repairs triangles, so that they form a surface on which light can be traced.
//!
//! Vertices are brought into tile coordinates, those of opposite borders made to match, and edges and
//! borders checked: which triangles meet where, and whether they part above from below.

use std::collections::HashMap;

use asperity_surface::Border;
use glam::DVec3;

use super::error::MeshSurfaceError;

/// Longest side of the bounding box, tile coordinates.
pub(super) const LONGEST: f64 = 1024.0;

/// Distance within which corners on opposite borders of a periodic tile match, corners lie on a
/// border, and triangles in each other: four roundings to single precision, in which many meshes are kept.
pub(crate) const SEAM: f64 = LONGEST / (1_u64 << 22) as f64;

/// Between the coordinates of the mesh and those of the tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Lowest x and y, and z in the middle.
    origin: DVec3,
    pub(super) scale: f64,
    /// Extent, tile coordinates.
    pub(super) extent: DVec3,
}

impl Frame {
    pub(super) fn around(
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, MeshSurfaceError> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &k in triangles.as_flattened() {
            let p = DVec3::from(vertices[k as usize]);
            low = low.min(p);
            high = high.max(p);
        }
        let extent = high - low;
        let longest = extent.max_element();
        if !(1e-150..=1e150).contains(&longest) || extent.x <= 0.0 || extent.y <= 0.0 {
            return Err(MeshSurfaceError::BadExtent {
                extent: extent.to_array(),
            });
        }
        let scale = LONGEST / longest;
        Ok(Self {
            origin: low.with_z(0.5 * low.z + 0.5 * high.z),
            scale,
            extent: extent * scale,
        })
    }

    pub(super) fn enter(&self, vertex: [f64; 3]) -> DVec3 {
        (DVec3::from(vertex) - self.origin) * self.scale
    }

    pub(super) fn leave(&self, p: DVec3) -> [f64; 3] {
        (p / self.scale + self.origin).to_array()
    }
}

pub(super) fn check_indices(
    vertices: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> Result<(), MeshSurfaceError> {
    if triangles.is_empty() {
        return Err(MeshSurfaceError::NoTriangles(0));
    }
    if triangles.len() > 1 << 31 {
        return Err(MeshSurfaceError::TooManyTriangles(triangles.len()));
    }
    for (i, corners) in triangles.iter().enumerate() {
        for &k in corners {
            match vertices.get(k as usize) {
                None => {
                    return Err(MeshSurfaceError::NoSuchVertex {
                        triangle: i,
                        corners: *corners,
                        vertices: vertices.len(),
                    });
                }
                Some(position) if position.iter().any(|x| !x.is_finite()) => {
                    return Err(MeshSurfaceError::NotFinite {
                        vertex: k as usize,
                        position: *position,
                    });
                }
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// Puts what lies on a border of the tile to rounding exactly there, and makes opposite borders of a
/// periodic tile equal. Fails with a vertex that has no counterpart.
pub(super) fn align(
    vertices: &mut [DVec3],
    triangles: &[[u32; 3]],
    axis: usize,
    extent: f64,
    border: Border,
) -> Result<(), DVec3> {
    if border == Border::Open {
        return Ok(());
    }
    let mut used = vec![false; vertices.len()];
    for &k in triangles.as_flattened() {
        used[k as usize] = true;
    }
    let (mut lows, mut highs) = (Vec::new(), Vec::new());
    for (k, p) in vertices.iter_mut().enumerate().filter(|(k, _)| used[*k]) {
        if p[axis] <= SEAM {
            p[axis] = 0.0;
            lows.push(k);
        } else if p[axis] >= extent - SEAM {
            p[axis] = extent;
            highs.push(k);
        }
    }
    if border == Border::Mirrored {
        return Ok(());
    }
    // A grid so wide that counterparts are in the same cell or in a neighbour.
    let along = |p: DVec3| [p[1 - axis], p.z];
    let cell = |p: DVec3| along(p).map(|x| (x / SEAM).floor() as i64);
    let mut grid: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for &k in &highs {
        grid.entry(cell(vertices[k])).or_default().push(k);
    }
    let mut matched = 0;
    for &low in &lows {
        let p = vertices[low];
        let [i, j] = cell(p);
        let apart = |k: usize| {
            let [u, v] = along(vertices[k] - p);
            u.abs().max(v.abs())
        };
        let nearest = (-1..=1)
            .flat_map(|di| (-1..=1).map(move |dj| [i + di, j + dj]))
            .filter_map(|place| {
                let found = grid.get(&place)?.iter().enumerate();
                let (at, &k) = found.min_by(|a, b| apart(*a.1).total_cmp(&apart(*b.1)))?;
                Some((place, at, k))
            })
            .min_by(|a, b| apart(a.2).total_cmp(&apart(b.2)))
            .filter(|(_, _, k)| apart(*k) <= SEAM);
        let (place, at, k) = nearest.ok_or(p)?;
        if let Some(rest) = grid.get_mut(&place) {
            rest.swap_remove(at);
        }
        vertices[k] = p;
        vertices[k][axis] = extent;
        matched += 1;
    }
    if matched == highs.len() {
        return Ok(());
    }
    let single = |k: &&usize| {
        grid.get(&cell(vertices[**k]))
            .is_some_and(|c| c.contains(*k))
    };
    highs
        .iter()
        .find(single)
        .map_or(Ok(()), |k| Err(vertices[*k]))
}

/// Returns `true` if the corners lie on one line to rounding, so that there is no normal.
pub(super) fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let longest = u.length().max(v.length()).max((c - b).length());
    // Coordinates are rounded to 2^-53 of their size, and that times an edge is an area.
    u.cross(v).length() <= longest * LONGEST / (1_u64 << 52) as f64
}

/// Edges of one triangle only.
#[derive(Default)]
pub(super) struct SingleEdges {
    /// On the border of the tile: both ends, in the direction in which the triangle runs.
    pub(super) rim: Vec<[DVec3; 2]>,
    /// Number of open edges inside the tile, and one of them.
    pub(super) open: usize,
    one_open: [DVec3; 2],
}

/// Checks what meets at each edge.
pub(super) fn check_edges(
    frame: &Frame,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<SingleEdges, MeshSurfaceError> {
    // Both ends, the smaller first, and whether the triangle runs from the smaller to the larger.
    let mut edges: Vec<(u32, u32, bool)> = triangles
        .iter()
        .flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)])
        .map(|(p, q)| (p.min(q), p.max(q), p < q))
        .collect();
    edges.sort_unstable();
    let mut single = SingleEdges::default();
    for edge in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let ends = [edge[0].0, edge[0].1].map(|k| vertices[k as usize]);
        let [from, to] = ends.map(|p| frame.leave(p));
        match *edge {
            [(_, _, forward)] if lies_on_border(ends, frame.extent) => {
                let [p, q] = ends;
                single.rim.push(if forward { [p, q] } else { [q, p] });
            }
            [_] => {
                single.open += 1;
                single.one_open = ends;
            }
            [(_, _, one), (_, _, other)] if one != other => {}
            [_, _] => return Err(MeshSurfaceError::Inconsistent { from, to }),
            _ => {
                return Err(MeshSurfaceError::Branching {
                    triangles: edge.len(),
                    from,
                    to,
                });
            }
        }
    }
    Ok(single)
}

/// Checks that the mesh is a ground. If every edge has two triangles, its own or those of neighbouring tiles, the layers
/// over a point that face up, less those that face down, are equally many everywhere; a ground has one more.
pub(super) fn check_ground(
    frame: &Frame,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    edges: &SingleEdges,
    border: Border,
) -> Result<(), MeshSurfaceError> {
    let gaps = |count: usize, [from, to]: [DVec3; 2]| MeshSurfaceError::Gaps {
        edges: count,
        from: frame.leave(from),
        to: frame.leave(to),
        border,
    };
    if edges.open > 0 {
        return Err(gaps(edges.open, edges.one_open));
    }
    if border == Border::Periodic {
        let unmatched = unmatched_rim(&edges.rim, frame.extent);
        if let Some(&one) = unmatched.first() {
            return Err(gaps(unmatched.len(), one));
        }
    }
    let projected: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|k| vertices[k as usize]);
            0.5 * (b - a).cross(c - a).z
        })
        .sum();
    match (projected / (frame.extent.x * frame.extent.y)).round() as i64 {
        1 => Ok(()),
        layers => Err(MeshSurfaceError::NotOneGround { layers, border }),
    }
}

/// Edges on the border of a periodic tile whose counterpart on the opposite border does not run the
/// other way, or is not there.
fn unmatched_rim(rim: &[[DVec3; 2]], extent: DVec3) -> Vec<[DVec3; 2]> {
    // Borders have been made equal to the bit.
    let name = |[mut p, mut q]: [DVec3; 2]| {
        for k in 0..2 {
            if p[k] == extent[k] && q[k] == extent[k] {
                (p[k], q[k]) = (0.0, 0.0);
            }
        }
        [p, q].map(|end| end.to_array().map(f64::to_bits))
    };
    let mut runs: HashMap<_, usize> = HashMap::new();
    for &edge in rim {
        *runs.entry(name(edge)).or_default() += 1;
    }
    let is_single = |&[p, q]: &[DVec3; 2]| runs.get(&name([q, p])) != Some(&1);
    rim.iter().copied().filter(is_single).collect()
}

/// Returns `true` if an edge lies on one side of the tile.
pub(super) fn lies_on_border([p, q]: [DVec3; 2], extent: DVec3) -> bool {
    (0..2).any(|k| p[k].max(q[k]) <= SEAM || p[k].min(q[k]) >= extent[k] - SEAM)
}

/// Returns `true` if the mesh shows its back to the light: more area faces downwards than upwards, or, if it is closed,
/// it faces inwards.
pub(super) fn faces_away(vertices: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let (mut area, mut upward, mut volume) = (0.0, 0.0, 0.0);
    let middle = vertices[triangles[0][0] as usize];
    for t in triangles {
        let [a, b, c] = t.map(|k| vertices[k as usize] - middle);
        let n = (b - a).cross(c - a);
        area += n.length();
        upward += n.z;
        volume += a.dot(n);
    }
    // The sum over a closed mesh is zero but for rounding.
    if f64::abs(upward) > 1e-9 * area {
        upward < 0.0
    } else {
        volume < 0.0
    }
}
