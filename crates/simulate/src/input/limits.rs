//! Limits: checks memory and grazing light before the work begins.

use std::f64::consts::FRAC_PI_4;

use asperity_io::available_memory;
use asperity_optics::Incidence;
use asperity_tally::TallySpec;
use asperity_tracer::{
    AcceleratorKind, Geometry, MAX_TILES_AT_45_DEGREES, Shape, can_traverse, tiles_crossed,
};

use crate::error::SimulateError;

/// Most memory for the results of a run.
const RESULT_BUDGET: f64 = 4.0 * GIB;

/// Memory for the tallies of ray blocks that are traced side by side, and of those traced before.
pub(crate) const TALLY_BUDGET: usize = 1 << 28;

const GIB: f64 = (1_u64 << 30) as f64;

/// Refuses what needs more than the memory that is left, where the system says how much that is.
///
/// # Errors
/// [`SimulateError::NotEnoughMemory`].
pub fn check_memory(what: &'static str, bytes: usize) -> Result<(), SimulateError> {
    match available_memory() {
        Some(available) if bytes as u64 > available => Err(SimulateError::NotEnoughMemory {
            what,
            needed: bytes as f64 / GIB,
            available: available as f64 / GIB,
        }),
        _ => Ok(()),
    }
}

/// Bytes of a pyramid per cell: numbers in single precision, and a word for every node.
const PYRAMID: usize = 6;

/// Bytes that a height field of `[ny, nx]` samples takes while it is traced with an accelerator, at the
/// peak, which is that of building it.
pub fn traced_bytes([ny, nx]: [usize; 2], accelerator: AcceleratorKind) -> usize {
    // Measured, in bytes per cell: the heights, and 1 for the bounds of slopes and for rounding up.
    let heights = 8 + 1;
    let of_accelerator = match accelerator {
        // Two facets, each with its box while the hierarchy is built, and its part of the nodes.
        AcceleratorKind::Mesh => 541,
        AcceleratorKind::Pyramid | AcceleratorKind::Auto => PYRAMID,
        _ => 0,
    };
    nx.saturating_mul(ny)
        .saturating_mul(heights + of_accelerator)
}

/// Bytes that a height field of `[ny, nx]` samples takes while it is traced, and, if it is refined, with
/// it a finer and a coarser mesh of it, each with its accelerator.
pub(crate) fn meshes_bytes(
    [ny, nx]: [usize; 2],
    accelerator: AcceleratorKind,
    is_flat: bool,
    refine: bool,
) -> usize {
    let of_mesh =
        |[ny, nx]: [usize; 2]| traced_bytes([ny, nx], accelerator.on_height_field(is_flat));
    let given = of_mesh([ny, nx]);
    if !refine {
        return given;
    }
    let finer = of_mesh([ny.saturating_mul(2), nx.saturating_mul(2)]);
    let coarser = of_mesh([ny.div_ceil(2), nx.div_ceil(2)]);
    given.saturating_add(finer).saturating_add(coarser)
}

/// Bytes that a smooth surface of `[ny, nx]` samples takes, without an accelerator.
pub(crate) const fn smooth_bytes([ny, nx]: [usize; 2]) -> usize {
    // Per cell: a coefficient, and 1 for the bounds of slopes.
    const PER_CELL: usize = 8 + 1;
    nx.saturating_mul(ny).saturating_mul(PER_CELL)
}

/// Bytes that the accelerator of a smooth surface of `[ny, nx]` samples takes.
const fn smooth_accelerator_bytes([ny, nx]: [usize; 2], accelerator: AcceleratorKind) -> usize {
    let cells = nx.saturating_mul(ny);
    match accelerator {
        AcceleratorKind::Mesh => hierarchy_bytes(cells),
        // A word more for the bounds of each cell.
        AcceleratorKind::Pyramid | AcceleratorKind::Auto => cells.saturating_mul(PYRAMID + 4),
        _ => 0,
    }
}

/// Bytes that a smooth surface of `[ny, nx]` samples takes while it is traced with an accelerator.
pub const fn smooth_traced_bytes(shape: [usize; 2], accelerator: AcceleratorKind) -> usize {
    smooth_bytes(shape).saturating_add(smooth_accelerator_bytes(shape, accelerator))
}

/// Bytes that a smooth surface of `[ny, nx]` samples takes while it is traced, and, if it is refined, with it a finer and
/// a coarser one, each with its accelerator.
pub(crate) fn smooth_meshes_bytes(
    [ny, nx]: [usize; 2],
    accelerator: AcceleratorKind,
    refine: bool,
) -> usize {
    let of_shape = |shape: [usize; 2]| smooth_traced_bytes(shape, accelerator);
    let given = of_shape([ny, nx]);
    if !refine {
        return given;
    }
    let finer = of_shape([ny.saturating_mul(2), nx.saturating_mul(2)]);
    let coarser = of_shape([ny.div_ceil(2), nx.div_ceil(2)]);
    given.saturating_add(finer).saturating_add(coarser)
}

/// Bytes that the hierarchy over the triangles of a mesh takes in addition to the mesh: as over those of a cell,
/// without their heights.
const fn hierarchy_bytes(triangles: usize) -> usize {
    triangles.saturating_mul(270)
}

/// Bytes of a tally for each surface and case, with the copies that the comparison makes, and the signs of its flips.
fn result_bytes(spec: &TallySpec, surfaces: u64, cases: usize, refine: bool) -> f64 {
    // A tally, and the squares of its errors; of several meshes, three shifts with theirs.
    let values = if refine { 8.0 } else { 2.0 };
    let tallies = (spec.len() * cases) as f64 * values * (surfaces as f64 + 4.0);
    let signs = surfaces as f64 * 4096.0;
    8.0 * (tallies + signs)
}

/// Refuses more results than memory should hold: a tally for each surface and case, with the copies
/// that the comparison makes, and the signs of its flips.
///
/// # Errors
/// [`SimulateError::TooManyResults`].
pub fn check_results(
    spec: &TallySpec,
    realisations: u64,
    cases: usize,
    refine: bool,
) -> Result<(), SimulateError> {
    let gib = result_bytes(spec, realisations, cases, refine) / GIB;
    if gib * GIB > RESULT_BUDGET {
        let bins = spec.grid().len();
        return Err(SimulateError::TooManyResults {
            bins,
            realisations,
            cases,
            gib,
        });
    }
    Ok(())
}

/// Most cases whose results on as many surfaces fit into memory, at least one.
pub(crate) fn most_cases(spec: &TallySpec, surfaces: u64, refine: bool) -> usize {
    let [of_none, of_one] = [0, 1].map(|cases| result_bytes(spec, surfaces, cases, refine));
    ((RESULT_BUDGET - of_none) / (of_one - of_none)).max(1.0) as usize
}

/// Most surfaces whose results fit in memory with those of all `cases`.
pub(crate) fn most_realisations(spec: &TallySpec, cases: usize) -> u64 {
    let tallies = (spec.len() * cases) as f64;
    let left = RESULT_BUDGET / 8.0 - 8.0 * tallies;
    (left / (2.0 * tallies + 4096.0)).max(1.0) as u64
}

/// Refuses surfaces that are so much higher than their tile is long that tracing would not end in any useful time.
///
/// # Errors
/// [`SimulateError::TooHigh`].
pub fn check_height<G: Geometry>(surface: &G) -> Result<(), SimulateError> {
    let tiles = tiles_crossed(surface, FRAC_PI_4);
    match tiles <= MAX_TILES_AT_45_DEGREES {
        true => Ok(()),
        false => Err(SimulateError::TooHigh { tiles }),
    }
}

/// Refuses light that would cross more tiles than a ray may, and what [`check_height`] does.
fn check_grazing<G: Geometry>(surface: &G, incidence: Incidence) -> Result<(), SimulateError> {
    check_height(surface)?;
    let tiles = tiles_crossed(surface, incidence.theta());
    if can_traverse(surface, incidence.theta()) {
        return Ok(());
    }
    Err(SimulateError::TooGrazing {
        theta_deg: incidence.theta_deg(),
        tiles,
    })
}

/// Bytes that tracing a shape takes, with its bottoms, in addition to what it holds.
pub(crate) fn shape_bytes(shape: &Shape, accelerator: AcceleratorKind, refine: bool) -> usize {
    let of_one = match shape {
        Shape::HeightField { top, .. } => {
            let field = top.field();
            let all = meshes_bytes(field.shape(), accelerator, field.is_flat(), refine);
            all.saturating_sub(size_of_val(field.heights()))
        }
        Shape::Smooth { top, .. } => smooth_accelerator_bytes(top.spline().shape(), accelerator),
        Shape::TriangleMesh { top, .. } => hierarchy_bytes(top.facet_count()),
    };
    of_one.saturating_mul(shape.surfaces())
}

/// Refuses a shape whose tracing takes more memory than is left.
///
/// # Errors
/// [`SimulateError::NotEnoughMemory`].
pub fn check_shape_memory(
    shape: &Shape,
    accelerator: AcceleratorKind,
    refine: bool,
) -> Result<(), SimulateError> {
    let what = "tracing this surface";
    check_memory(what, shape_bytes(shape, accelerator, refine))
}

/// Refuses surfaces that are too high for their tile, and light that would cross more tiles than a ray may.
///
/// # Errors
/// [`SimulateError::TooHigh`] and [`SimulateError::TooGrazing`].
pub fn check_shape(shape: &Shape, incidence: Incidence) -> Result<(), SimulateError> {
    match shape {
        Shape::HeightField { top, .. } => check_grazing(&**top, incidence),
        Shape::Smooth { top, .. } => check_grazing(&**top, incidence),
        Shape::TriangleMesh { top, .. } => check_grazing(&**top, incidence),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_mesh_counts_four_times_and_a_coarser_one_a_quarter() {
        for kind in [AcceleratorKind::Auto, AcceleratorKind::Mesh] {
            let [one, all] =
                [false, true].map(|refine| meshes_bytes([64, 96], kind, false, refine));
            assert_eq!(4 * all, 21 * one, "{kind}");
        }
    }

    #[test]
    fn large_surfaces_fit_unless_triangles_are_held() {
        let side = 16_384;
        let gib = |kind: AcceleratorKind| {
            let kind = kind.on_height_field(false);
            traced_bytes([side, side], kind) as f64 / GIB
        };
        assert!(gib(AcceleratorKind::Auto) < 6.0);
        assert!(gib(AcceleratorKind::Mesh) > 100.0);
        let smooth = smooth_traced_bytes([side, side], AcceleratorKind::Auto) as f64;
        assert!(smooth / GIB < 5.0);
    }
}
