//! Lobe bins: bins of a case that refine around its lobes, where those are narrower than bins of equal angles.

use asperity_tally::{HemisphereGrid, Side, SideEdges};

use super::graded::{Grading, divide};
use super::lobe::Lobe;
use crate::input::case::CaseBins;

/// Width of the finest bin over the half width of the lobe. The mean over a bin in the middle of a Gaussian lobe is then 0.2 % below its
/// peak; lobes of measured surfaces are sharper.
const FINEST: f64 = 0.125;

impl CaseBins {
    /// Bins that refine around these lobes, of reflected and transmitted light, and are elsewhere no wider than those of `coarse`; `None` if
    /// that resolves all lobes, or those that it does not are as narrow as those of a mirror.
    ///
    /// Each side has edges of its own. Azimuths are symmetric about the plane of incidence, and no edge runs through the middle of a lobe.
    /// The in-plane slice takes at most an eighth of the half width of a lobe on either side.
    #[must_use]
    pub fn around(lobes: [Option<Lobe>; 2], coarse: HemisphereGrid) -> Option<Self> {
        let lobes = lobes.map(|lobe| lobe.filter(|lobe| !lobe.is_mirror_like()));
        let phi_deg = lobes.iter().flatten().map(|lobe| lobe.phi_deg).next()?;
        if lobes.iter().flatten().all(|lobe| lobe.is_resolved(&coarse)) {
            return None;
        }
        let mut theta = Side::BOTH.map(|side| theta_edges(side, lobes[side.index()], &coarse));
        let rings = theta.each_ref().map(Vec::len).into_iter().max()? - 1;
        theta.iter_mut().for_each(|edges| divide(edges, rings));
        let phi = phi_edges(lobes, phi_deg, &coarse);
        let mut sides = Side::BOTH.into_iter().zip(theta.into_iter().zip(phi));
        let mut next = || {
            let (side, (theta, phi)) = sides.next()?;
            SideEdges::new(side, theta, phi).ok()
        };
        let grid = HemisphereGrid::with_edges([next()?, next()?]).ok()?;
        let slices = lobes
            .iter()
            .flatten()
            .filter(|lobe| !lobe.is_resolved(&coarse));
        let in_plane_half_width = slices
            .map(|lobe| (FINEST * lobe.half_width_deg[1] / lobe.sin_theta()).to_radians())
            .fold(f64::INFINITY, f64::min);
        Some(Self {
            grid,
            in_plane_half_width,
        })
    }
}

/// Edges of rings of a side, from +z.
fn theta_edges(side: Side, lobe: Option<Lobe>, coarse: &HemisphereGrid) -> Vec<f64> {
    let coarsest = 90.0 / coarse.n_theta() as f64;
    let start = 90.0 * side.index() as f64;
    let grading = match lobe {
        Some(lobe) => Grading {
            centre: lobe.theta_deg,
            finest: (FINEST * lobe.half_width_deg[0]).min(coarsest),
            coarsest,
        },
        None => Grading {
            centre: 180.0 * side.index() as f64,
            finest: coarsest,
            coarsest,
        },
    };
    grading.edges([start, start + 90.0])
}

/// Edges of sectors of both sides: as many, those of `coarse` if they are narrow enough.
fn phi_edges(lobes: [Option<Lobe>; 2], phi_deg: f64, coarse: &HemisphereGrid) -> [Vec<f64>; 2] {
    let coarsest = 360.0 / coarse.n_phi() as f64;
    let finest = lobes.map(|lobe| {
        let of_lobe = |lobe: Lobe| FINEST * lobe.half_width_deg[1] / lobe.sin_theta();
        lobe.map_or(coarsest, of_lobe).min(coarsest)
    });
    if finest == [coarsest; 2] {
        return Side::BOTH.map(|side| coarse.phi_edges_deg(side));
    }
    let mut halves = finest.map(|finest| {
        let grading = Grading {
            centre: 0.0,
            finest,
            coarsest,
        };
        grading.half_turn()
    });
    let most = halves.each_ref().map(Vec::len).into_iter().max();
    let first = (phi_deg - 180.0).rem_euclid(360.0);
    for half in &mut halves {
        // The central bin stays as narrow as it is.
        divide(half, most.unwrap_or(0) - 1);
    }
    halves.map(|half| {
        let centre = first + 180.0;
        let before = half[..half.len() - 1].iter().rev().map(|off| centre - off);
        let after = half[..half.len() - 1].iter().map(|off| centre + off);
        let inner = before.chain(after);
        [first]
            .into_iter()
            .chain(inner)
            .chain([first + 360.0])
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tally::Mirror;

    use super::*;
    use crate::input::case::{Case, Light};
    use crate::input::surface_source::SurfaceSource;

    fn case(smoothness: f64, eta: f64, theta: f64, phi: f64) -> Case {
        let psd = Psd::gaussian(8.0 / smoothness, 8.0).unwrap();
        let synthesis = Synthesis::new(psd, [64, 64], [1.0, 1.0], true).unwrap();
        Case::new(
            SurfaceSource::random(synthesis),
            Material::dielectric(eta).unwrap(),
            Light::from_above(Incidence::from_degrees(theta, phi).unwrap()),
        )
    }

    fn bins(case: &Case) -> Option<CaseBins> {
        CaseBins::around(Lobe::of_case(case), HemisphereGrid::default())
    }

    #[test]
    fn wide_lobes_keep_bins_of_equal_angles() {
        for (smoothness, theta) in [
            (1.0, 0.0),
            (2.0, 0.0),
            (2.0, 30.0),
            (2.0, 70.0),
            (0.5, 45.0),
        ] {
            assert_eq!(
                bins(&case(smoothness, 1.5, theta, 0.0)),
                None,
                "{smoothness} {theta}"
            );
        }
    }

    #[test]
    fn the_bins_in_the_middle_of_narrow_lobes_are_narrow_and_centred() {
        for smoothness in [6.0, 40.0, 1000.0] {
            for theta in [0.0, 0.3, 30.0, 75.0] {
                for phi in [0.0, 90.0, 123.4] {
                    for eta in [1.5, 1.0 / 1.5] {
                        let case = case(smoothness, eta, theta, phi);
                        let lobes = Lobe::of_case(&case);
                        let grid = bins(&case).unwrap().grid;
                        for lobe in lobes.into_iter().flatten() {
                            let [along, across] = lobe.bin_deg(&grid);
                            let [wide, high] = lobe.half_width_deg;
                            // A bin at the pole reaches half as far.
                            assert!(along < 1.1 * FINEST * wide.max(0.1), "{lobe:?} {along}");
                            assert!(across < 1.1 * FINEST * high.max(0.1), "{lobe:?} {across}");
                            assert!(lobe.shortfall(&grid) < 0.016, "{lobe:?}");
                        }
                        let incidence = case.light.incidence;
                        assert!(Mirror::about(incidence.phi(), &grid).is_some() || phi == 123.4);
                        if theta > 1.0 {
                            assert!(Mirror::about(incidence.phi(), &grid).is_some());
                        }
                        assert!(grid.bins_per_side() < 20_000, "{grid}");
                    }
                }
            }
        }
    }

    #[test]
    fn lobes_of_mirrors_are_not_refined() {
        assert_eq!(bins(&case(1e7, 1.5, 30.0, 0.0)), None);
    }

    /// Half widths by the formulas of the module: s = 40 has slopes of `sqrt(2) / 40`.
    #[test]
    fn lobes_have_the_widths_of_facets_turned_by_their_deviation() {
        let [reflected, transmitted] =
            Lobe::of_case(&case(40.0, 1.5, 60.0, 10.0)).map(Option::unwrap);
        let half = (1.1774 * 2.0_f64.sqrt() / 40.0).to_degrees();
        let near = |found: f64, expected: f64| {
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}")
        };
        near(reflected.half_width_deg[0], 2.0 * half);
        near(reflected.half_width_deg[1], half);
        let sin_t = 60.0_f64.to_radians().sin() / 1.5;
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        near(
            transmitted.half_width_deg[0],
            half * (1.0 - 0.5 / (1.5 * cos_t)),
        );
        near(transmitted.half_width_deg[1], half * (cos_t - 0.5 / 1.5));
        near(transmitted.theta_deg, 180.0 - sin_t.asin().to_degrees());
        near(transmitted.phi_deg, 190.0);
    }

    /// Snell's law twice, at a facet that is turned a little in the plane of incidence, and at the level bottom.
    #[test]
    fn a_level_bottom_widens_the_lobe_of_transmitted_light() {
        let (eta, theta) = (1.5, 40.0_f64.to_radians());
        let mut case = case(40.0, eta, 40.0, 0.0);
        let phase = PhaseFunction::Isotropic;
        let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, phase).unwrap();
        case.layers = vec![Layer::slab(clear, 30.0, Bottom::interface(1.0 / eta)).unwrap()];
        let [_, lobe] = Lobe::of_case(&case).map(Option::unwrap);
        let leaves = |turn: f64| {
            let inside = turn + ((theta - turn).sin() / eta).asin();
            (eta * inside.sin()).asin()
        };
        let turn = 1e-6;
        let along = (leaves(turn) - leaves(-turn)) / (2.0 * turn);
        let half = (1.1774 * 2.0_f64.sqrt() / 40.0).to_degrees();
        assert!((lobe.half_width_deg[0] / (half * along) - 1.0).abs() < 1e-3);
        // Across it the tangential direction alone is bent, by the index.
        let cos_t = (1.0 - (theta.sin() / eta).powi(2)).sqrt();
        let across = eta * cos_t - theta.cos();
        assert!((lobe.half_width_deg[1] / (half * across) - 1.0).abs() < 1e-3);
        assert!((lobe.theta_deg - 140.0).abs() < 1e-9);
        assert!(bins(&case).is_some());
        case.layers = vec![Layer::slab(clear, 30.0, Bottom::interface(1.2)).unwrap()];
        assert_eq!(Lobe::of_case(&case)[1], None);
    }
}
