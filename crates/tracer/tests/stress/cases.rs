//! Light of every kind that a scene can be lit with.

use asperity_optics::Material;
use asperity_tracer::{Geometry, HalfSpace, tiles_crossed};

use crate::Effort;
use crate::stressed::Stressed;

const THETAS: [f64; 8] = [0.0, 30.0, 60.0, 80.0, 85.0, 89.0, 89.9, 89.99];

const ETAS: [f64; 8] = [0.25, 1.0 / 1.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 2.5, 4.0];

/// Slope above which light is reflected so often that one case must stand for all.
const SPIKY: f64 = 1e3;

/// Light of one case.
#[derive(Clone, Copy)]
pub(super) struct Case {
    pub(super) theta_deg: f64,
    pub(super) material: Material,
    pub(super) incident: HalfSpace,
}

/// Cases of light that a scene can be lit with: angles at which light need not cross more tiles than
/// a ray may, glass of every index, gold and a mirror, from either side.
pub(super) fn cases<G: Stressed>(index: usize, surface: &G, effort: Effort) -> Vec<Case> {
    let mut materials: Vec<_> = ETAS.map(|eta| Material::dielectric(eta).unwrap()).into();
    materials.push(Material::conductor(0.21, 3.272).unwrap());
    materials.push(Material::Mirror);
    let thetas = THETAS
        .into_iter()
        .filter(|theta| tiles_crossed(surface, theta.to_radians()) < effort.tiles);
    let every_case = effort.every_case && Stressed::steepest_slope(surface) < SPIKY;
    let mut cases = Vec::new();
    for (i, theta_deg) in thetas.enumerate() {
        for (j, &material) in materials.iter().enumerate() {
            // Of 20 cases an angle, the small effort takes one or two, others for other scenes.
            for (k, incident) in [HalfSpace::Above, HalfSpace::Below].into_iter().enumerate() {
                if every_case || (2 * j + k + 7 * i + 3 * index).is_multiple_of(17) {
                    cases.push(Case {
                        theta_deg,
                        material,
                        incident,
                    });
                }
            }
        }
    }
    cases
}

/// Returns `true` if brute force would take long for a ray that goes down to the lowest point.
pub(super) fn is_long<G: Geometry>(surface: &G, case: Case) -> bool {
    let tiles = tiles_crossed(surface, case.theta_deg.to_radians());
    (tiles + 1.0) * surface.facet_count() as f64 > 2e4
}
