//! Spacings: those that a pilot run compares, and the coarsest whose mesh is fine enough for a target.

use super::pilot::Figures;
use crate::errors::convergence::Convergence;
use crate::input::cells::Cells;
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::target::Target;

/// Error of the mesh, of the target.
const MESH_FRACTION: f64 = 1.0 / 3.0;

/// Surfaces of a pilot run, at two spacings.
#[derive(Clone, Debug)]
pub(crate) struct PilotSurfaces {
    pub(crate) fine: RandomSurfaces,
    /// Surfaces at twice the spacing, if there is such a grid.
    pub(crate) coarse: Option<RandomSurfaces>,
    /// Spacings to choose from, over that given.
    candidates: Vec<f64>,
    /// The spacing given over that of the fine surfaces.
    given: f64,
    convergence: Convergence,
}

impl PilotSurfaces {
    /// Returns the pilot surfaces for a given spacing. Facets are compared at that and at twice that, which need not resolve the
    /// surfaces, and chosen from half to twice the given spacing; smooth cells from two to four thirds of it, so from 6 to
    /// 3 per correlation length where 4 are given, between which they are compared.
    pub(crate) fn new(given: &RandomSurfaces) -> Self {
        let (candidates, coarse, insist) = match given.cells() {
            Cells::Flat => ([2.0, 1.0, 0.5], 2.0, true),
            Cells::Smooth => ([4.0 / 3.0, 1.0, 2.0 / 3.0], 4.0 / 3.0, false),
        };
        let convergence = Convergence::of_random(given, coarse);
        let pair = given.respaced(coarse, insist).and_then(|coarse| {
            let fine = coarse.respaced(0.5, insist)?;
            Some((fine, coarse))
        });
        let (fine, coarse) = match pair {
            Some((fine, coarse)) => (fine, Some(coarse)),
            None => (given.clone(), None),
        };
        Self {
            given: given.spacing()[0] / fine.spacing()[0],
            candidates: candidates.to_vec(),
            fine,
            coarse,
            convergence,
        }
    }

    /// The spacings to choose from that resolve the surfaces, with `scale` over the spacing given, the coarsest first.
    pub(crate) fn candidates(&self, given: &RandomSurfaces) -> Vec<(f64, RandomSurfaces)> {
        let of_scale = |scale: f64| match scale {
            1.0 => Some((1.0, given.clone())),
            _ => Some((scale, given.respaced(scale, false)?)),
        };
        self.candidates
            .iter()
            .copied()
            .filter_map(of_scale)
            .collect()
    }

    /// Error that a mesh of `scale` times the spacing given adds to that of a case.
    pub(crate) fn mesh_error(&self, case: &Figures, scale: f64) -> Option<f64> {
        case.mesh_error(scale * self.given, self.convergence)
    }

    /// Warning of a mesh error whose order is unknown.
    pub(crate) const fn warning(&self) -> Option<&'static str> {
        self.convergence.warning()
    }

    /// The coarsest of the spacings `scales` at which the mesh error of every case is small compared with the
    /// target, or the finest.
    pub(crate) fn choose(
        &self,
        cases: &[Figures],
        target: Target,
        scales: &[f64],
    ) -> ChosenSpacing {
        let worst = |scale: f64| {
            let errors = cases.iter().map(|case| self.mesh_error(case, scale));
            let errors: Option<Vec<f64>> = errors.collect();
            errors.map(|errors| errors.into_iter().fold(0.0, f64::max))
        };
        let given = ChosenSpacing {
            scale: 1.0,
            mesh_error: worst(1.0),
            fine_enough: true,
        };
        if given.mesh_error.is_none() {
            return given;
        }
        let mut chosen = given;
        for &scale in scales {
            let mesh_error = worst(scale);
            let most = MESH_FRACTION * target.error();
            chosen = ChosenSpacing {
                scale,
                mesh_error,
                fine_enough: mesh_error.is_some_and(|error| error <= most),
            };
            if chosen.fine_enough {
                break;
            }
        }
        chosen
    }
}

/// The spacing that is taken, and what its mesh adds to the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChosenSpacing {
    /// Over the spacing given.
    pub(crate) scale: f64,
    /// Error that the mesh adds to that of the most demanding case; `None` where it is unknown.
    pub(crate) mesh_error: Option<f64>,
    /// `true` if that is small compared with the target.
    pub(crate) fine_enough: bool,
}

#[cfg(test)]
mod tests {
    use asperity_synthesis::Psd;

    use super::*;
    use crate::engine::plan::pilot::tests::figures;
    use crate::input::target::Quantity;

    /// Surfaces of 96 cells, so many to a correlation length, s = 8.
    fn surfaces(cells: Cells, per_length: f64) -> RandomSurfaces {
        let psd = Psd::gaussian(per_length / 8.0, per_length).unwrap();
        RandomSurfaces::new(cells, psd, [96; 2], [1.0; 2], true).unwrap()
    }

    fn chosen(surfaces: &RandomSurfaces, difference: f64) -> ChosenSpacing {
        let target = Target::new(3e-3, Quantity::default()).unwrap();
        let pilot = PilotSurfaces::new(surfaces);
        let candidates = pilot.candidates(surfaces);
        let scales: Vec<f64> = candidates.iter().map(|(scale, _)| *scale).collect();
        let cases = [Some(difference), Some(0.0)].map(|mesh| figures(1.0, 1.0, mesh));
        pilot.choose(&cases, target, &scales)
    }

    #[test]
    fn the_coarsest_spacing_is_taken_whose_mesh_is_good_enough() {
        let flat = surfaces(Cells::Flat, 8.0);
        // 4/3, 1/3 and 1/12 of the difference against a third of the target.
        assert_eq!(chosen(&flat, 7e-4).scale, 2.0);
        assert_eq!(chosen(&flat, 2.9e-3).scale, 1.0);
        assert_eq!(chosen(&flat, 1.1e-2).scale, 0.5);
        assert!(chosen(&flat, 1.1e-2).fine_enough);
        let hopeless = chosen(&flat, 1.0);
        assert_eq!((hopeless.scale, hopeless.fine_enough), (0.5, false));
    }

    /// Three per correlation length against six: 16/15, 0.3375 and 1/15 of the difference.
    #[test]
    fn smooth_cells_are_chosen_by_fourth_order() {
        let smooth = surfaces(Cells::Smooth, 4.0);
        let pilot = PilotSurfaces::new(&smooth);
        assert_eq!(pilot.fine.shape(), [144; 2]);
        assert_eq!(pilot.coarse.unwrap().shape(), [72; 2]);
        assert_eq!(chosen(&smooth, 9e-4).scale, 4.0 / 3.0);
        assert_eq!(chosen(&smooth, 1e-3).scale, 1.0);
        assert_eq!(chosen(&smooth, 2.9e-3).scale, 1.0);
        assert_eq!(chosen(&smooth, 3e-3).scale, 2.0 / 3.0);
        let error = chosen(&smooth, 9e-3).mesh_error.unwrap();
        assert!((error - 9e-3 / 15.0).abs() < 1e-9, "{error}");
    }

    /// The whole difference is the error if facets are too large for an order.
    #[test]
    fn the_whole_difference_counts_where_no_order_is_seen() {
        let psd = Psd::gaussian(8.0, 8.0).unwrap();
        let rough = RandomSurfaces::new(Cells::Flat, psd, [96; 2], [1.0; 2], true).unwrap();
        assert_eq!(chosen(&rough, 9e-4).mesh_error, Some(9e-4));
        assert!(PilotSurfaces::new(&rough).warning().is_some());
    }

    #[test]
    fn a_spacing_that_nothing_is_known_of_stays() {
        let target = Target::new(3e-3, Quantity::default()).unwrap();
        let pilot = PilotSurfaces::new(&surfaces(Cells::Smooth, 3.0));
        assert!(pilot.coarse.is_none());
        let chosen = pilot.choose(&[figures(1.0, 1.0, None)], target, &[1.0, 2.0 / 3.0]);
        assert_eq!((chosen.scale, chosen.mesh_error), (1.0, None));
    }
}
