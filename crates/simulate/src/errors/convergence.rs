//! Convergence: what meshes of two spacings tell of the error of the finer one.

use asperity_surface::HeightField;
use serde::{Deserialize, Serialize};

use crate::input::cells::Cells;

use crate::input::random_surfaces::RandomSurfaces;

/// Largest ratio of spacing to radius of curvature, root mean square, at which facets are of second order: that of a
/// Gaussian surface, `sqrt(12) d / (s tau)`, at `s tau / d = 16`.
const LARGEST_TURN: f64 = 3.464_101_615_137_754_6 / 16.0;

/// Convergence of the mesh error with the spacing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Convergence {
    /// Smooth cells: fourth order.
    Fourth,
    /// Facets much smaller than the radii of curvature: second order.
    Second,
    /// Facets that cut across the edges of a structure, or across those that erosion leaves: first order.
    First,
    /// Larger facets, which show no order yet.
    Unresolved,
}

impl Convergence {
    /// Convergence on these random surfaces, the coarser of two with `scale` times their spacing.
    pub(crate) fn of_random(surfaces: &RandomSurfaces, scale: f64) -> Self {
        match (surfaces.cells(), surfaces.recipe().curvature()) {
            (Cells::Smooth, Some(_)) => Self::Fourth,
            (Cells::Flat, Some(curvature)) => {
                let [dx, dy] = surfaces.spacing();
                Self::of_facets(curvature * scale * dx.max(dy))
            }
            (Cells::Flat, None) if surfaces.recipe().is_measured() => Self::First,
            // Without a curvature there is no order.
            (_, None) => Self::Unresolved,
        }
    }

    /// Convergence of the facets of a height field, the coarser of two meshes.
    pub(crate) fn of_field(field: &HeightField) -> Self {
        let [dx, dy] = field.spacing();
        let [ny, nx] = field.shape();
        let rms = |lines: usize, length: usize, d: f64, at: &dyn Fn(usize, usize) -> f64| {
            let squares = (0..lines).flat_map(|line| {
                (2..length).map(move |i| {
                    let turn = at(line, i) - 2.0 * at(line, i - 1) + at(line, i - 2);
                    (turn / d).powi(2)
                })
            });
            let count = (lines * length.saturating_sub(2)).max(1);
            (squares.sum::<f64>() / count as f64).sqrt()
        };
        let along_x = rms(ny, nx, dx, &|iy, ix| field.height(ix, iy));
        let along_y = rms(nx, ny, dy, &|ix, iy| field.height(ix, iy));
        Self::of_facets(along_x.max(along_y))
    }

    /// Convergence of facets that turn by `turn`, root mean square slope, from one sample to the next.
    fn of_facets(turn: f64) -> Self {
        if turn <= LARGEST_TURN {
            Self::Second
        } else {
            Self::Unresolved
        }
    }

    /// Error of the finer of two meshes, one of half the spacing of the other, as part of what they differ by.
    pub(crate) const fn remaining(self) -> f64 {
        match self {
            Self::Fourth => 1.0 / 15.0,
            Self::Second => 1.0 / 3.0,
            Self::First | Self::Unresolved => 1.0,
        }
    }

    /// Fraction of the difference that is left in a mesh of `scale` times the spacing of the finer one.
    pub(crate) fn remaining_at(self, scale: f64) -> f64 {
        self.remaining()
            * match self {
                Self::Fourth => scale.powi(4),
                Self::Second => scale * scale,
                Self::First => scale,
                // A finer mesh may be no better.
                Self::Unresolved => scale.max(1.0),
            }
    }

    /// The part in words.
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Fourth => {
                "a fifteenth of the given surface less that of half its spacing, which is the one reported, as for fourth order"
            }
            Self::Second => {
                "a third of the given mesh less that of half its spacing, which is the one reported, as for second order"
            }
            Self::First => {
                "all of the given mesh less that of half its spacing, which is the one reported, as for first order: facets cut across edges or curves of a structure, or follow them exactly"
            }
            Self::Unresolved => {
                "all of the given mesh less that of half its spacing, which is the one reported, since its facets are too large for the curvature to show second order"
            }
        }
    }

    /// Warning for the reader.
    pub(crate) const fn warning(self) -> Option<&'static str> {
        match self {
            Self::Unresolved => Some(
                "facets are too large for the curvature of the surface (s tau / d below 16), so the mesh error falls more slowly than by second order and may exceed the whole difference between spacings: give a finer spacing",
            ),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_surface::Border;
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;

    fn flat(smoothness: f64, spacing: f64) -> Synthesis {
        let psd = Psd::gaussian(16.0 / smoothness, 16.0).unwrap();
        let n = (512.0 / spacing) as usize;
        Synthesis::new(psd, [n, n], [spacing; 2], true).unwrap()
    }

    #[test]
    fn facets_are_of_second_order_from_sixteen_spacings_per_radius_of_curvature() {
        let of = |smoothness: f64, spacing: f64| {
            Convergence::of_random(&flat(smoothness, spacing).into(), 1.0)
        };
        assert_eq!(of(1.0, 1.0), Convergence::Second);
        assert_eq!(of(0.99, 1.0), Convergence::Unresolved);
        assert_eq!(of(3.0, 2.0), Convergence::Second);
        assert_eq!(of(0.5, 1.0), Convergence::Unresolved);
    }

    /// The heights of a surface tell the same as its spectrum.
    #[test]
    fn curvature_of_given_heights_is_that_of_their_spectrum() {
        for (smoothness, expected) in [(1.2, Convergence::Second), (0.8, Convergence::Unresolved)] {
            let field = flat(smoothness, 1.0).draw(3, 0).unwrap();
            assert_eq!(Convergence::of_field(&field), expected, "{smoothness}");
        }
        let ramp = (0..64).map(|i| f64::from(i % 8)).collect();
        let ramp = HeightField::new(ramp, [8, 8], [1.0; 2]).unwrap();
        let ramp = ramp.with_border(Border::Open);
        assert_eq!(Convergence::of_field(&ramp), Convergence::Second);
    }

    #[test]
    fn an_error_scales_by_its_order() {
        let at = |convergence: Convergence| [0.5, 1.0, 2.0].map(|s| convergence.remaining_at(s));
        assert_eq!(at(Convergence::Second), [1.0 / 12.0, 1.0 / 3.0, 4.0 / 3.0]);
        assert_eq!(at(Convergence::Fourth)[2], 16.0 / 15.0);
        assert_eq!(at(Convergence::Unresolved), [1.0, 1.0, 2.0]);
    }
}
