//! Polygon: a face of more than three corners, as triangles.
//!
//! A convex one is a fan around its first corner, any other is cut by ear clipping (earcut), in the coordinate plane that it faces most.
//! All corners stay corners of triangles, those on a line between their neighbours included, since triangles of a
//! neighbouring face may end there. Holes are outlines that run to the hole and back along one line.

use earcut::Earcut;

/// Most corners of a face that is not convex: the search for crossing edges takes their square.
const MAX_CORNERS: usize = 4096;

/// Twice the area below which a triangle has none, in squares of the size of the face: some thousand roundings of coordinates, 2^-53 of that
/// size each. Corners on one line that were rounded to single precision have an area, of either sign, and stay corners.
const NO_AREA: f64 = 1e-12;

/// Triangles of a face, by the numbers of their corners in `corners`. They run around as the face does.
///
/// An error says what a face has that is no outline of triangles.
pub(super) fn triangles(corners: &[[f64; 3]]) -> Result<Vec<[usize; 3]>, String> {
    if corners.len() == 3 {
        return Ok(vec![[0, 1, 2]]);
    }
    // A corner that is given twice in a row is one.
    let follows = |k: usize| corners[(k + 1) % corners.len()];
    let own: Vec<usize> = (0..corners.len())
        .filter(|k| corners[*k] != follows(*k))
        .collect();
    let places: Vec<[f64; 3]> = own.iter().map(|k| corners[*k]).collect();
    let fan = (2..own.len()).map(|k| [0, k - 1, k]);
    let flat = projected(&places)?.filter(|flat| !is_convex(flat, NO_AREA));
    let cut = match flat.map(|flat| (cut(&flat), flat)) {
        Some((Ok(cut), _)) => cut,
        Some((Err(_), flat)) if is_convex(&flat, -NO_AREA) => fan.collect(),
        Some((Err(what), _)) => return Err(what),
        None => fan.collect(),
    };
    Ok(cut.iter().map(|t| t.map(|k| own[k])).collect())
}

/// Triangles of an outline that runs counter-clockwise, as they do.
fn cut(outline: &[[f64; 2]]) -> Result<Vec<[usize; 3]>, String> {
    let count = outline.len();
    if count > MAX_CORNERS {
        return Err(format!(
            "{count} corners and is not convex; at most {MAX_CORNERS} are cut into triangles"
        ));
    }
    if has_crossing(outline) {
        return Err(CROSSING.to_owned());
    }
    let mut corners: Vec<usize> = Vec::new();
    Earcut::new().earcut(outline.iter().copied(), &[], &mut corners);
    let (cut, _) = corners.as_chunks::<3>();
    let doubled_area = |t: &[usize; 3]| turn(t.map(|k| outline[k]));
    let is_turned = cut.iter().map(doubled_area).sum::<f64>() < 0.0;
    let turned = |&[a, b, c]: &[usize; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
    let cut: Vec<[usize; 3]> = cut.iter().map(turned).collect();
    if cut.len() + 2 != count || cut.iter().any(|t| doubled_area(t) < -NO_AREA) {
        return Err("an outline that touches itself and is cut into no triangles".to_owned());
    }
    Ok(cut)
}

/// Fault of a face whose outline is no loop.
const CROSSING: &str = "edges that cross each other";

/// The corners in the coordinate plane that the face is closest to, so that it runs counter-clockwise there, in
/// units of its size; `None` if it has no area, or is too large to tell.
fn projected(corners: &[[f64; 3]]) -> Result<Option<Vec<[f64; 2]>>, String> {
    let Some(first) = corners.first() else {
        return Ok(None);
    };
    let from_first = |p: &[f64; 3]| [0, 1, 2].map(|k| p[k] - first[k]);
    let offsets: Vec<[f64; 3]> = corners.iter().map(from_first).collect();
    let size = offsets
        .as_flattened()
        .iter()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    if !(size > 0.0 && size.is_finite()) {
        return Ok(None);
    }
    let offsets: Vec<[f64; 3]> = offsets.iter().map(|p| p.map(|x| x / size)).collect();
    let (mut normal, mut largest) = ([0.0; 3], 0.0_f64);
    for pair in offsets.windows(2) {
        let [[a, b, c], [u, v, w]] = [pair[0], pair[1]];
        let cross = [b * w - c * v, c * u - a * w, a * v - b * u];
        for (sum, x) in normal.iter_mut().zip(cross) {
            *sum += x;
            largest = largest.max(x.abs());
        }
    }
    if largest <= NO_AREA {
        return Ok(None);
    }
    let by_area = |i: &usize, j: &usize| normal[*i].abs().total_cmp(&normal[*j].abs());
    let across = (0..3).max_by(by_area).unwrap_or(2);
    if normal[across].abs() <= NO_AREA {
        return Err(CROSSING.to_owned());
    }
    let (mut x, mut y) = ((across + 1) % 3, (across + 2) % 3);
    if normal[across] < 0.0 {
        (x, y) = (y, x);
    }
    Ok(Some(offsets.iter().map(|p| [p[x], p[y]]).collect()))
}

/// Twice the area of a triangle, positive if it runs counter-clockwise.
fn turn([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Returns `true` if the outline turns left by `least` or more at each corner, and once around.
fn is_convex(outline: &[[f64; 2]], least: f64) -> bool {
    let count = outline.len();
    let at = |k: usize| outline[k % count];
    let turns_left = |k: usize| {
        let [a, b, c] = [at(k), at(k + 1), at(k + 2)];
        let goes_on = || (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) >= 0.0;
        let turn = turn([a, b, c]);
        turn >= least && (turn > NO_AREA || goes_on())
    };
    let steps = (0..count).map(|k| at(k + 1)[0] - at(k)[0]);
    let rising: Vec<bool> = steps.filter(|dx| *dx != 0.0).map(|dx| dx > 0.0).collect();
    let changes = (0..rising.len()).filter(|k| rising[*k] != rising[(k + 1) % rising.len()]);
    changes.count() <= 2 && (0..count).all(turns_left)
}

/// Returns `true` if two edges cross each other between their ends.
fn has_crossing(outline: &[[f64; 2]]) -> bool {
    let count = outline.len();
    let edge = |k: usize| [outline[k], outline[(k + 1) % count]];
    let crosses = |[a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]| {
        let is_apart =
            |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
        let parts = |p, q, [r, s]: [[f64; 2]; 2]| {
            let (r, s) = (turn([p, q, r]), turn([p, q, s]));
            r.min(s) < -NO_AREA && r.max(s) > NO_AREA
        };
        !is_apart(0) && !is_apart(1) && parts(a, b, [c, d]) && parts(c, d, [a, b])
    };
    (0..count).any(|i| (i + 2..count).any(|j| crosses(edge(i), edge(j))))
}
