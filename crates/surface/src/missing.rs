//! Height maps as instruments deliver them: with points missing.

use std::str::FromStr;

use crate::harmonic::{GraphLaplacian, solve};
use crate::height_field::check_grid;
use crate::{Border, HeightField, HeightFieldError, LengthUnit, Provenance};

/// What to do with points that have no height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingPolicy {
    /// Refuse the map.
    #[default]
    Refuse,
    /// Fill them smoothly from their surroundings: Laplace's equation over each gap, between the
    /// heights on its rim. A gap stays within the range of its rim, and a tilt is continued across
    /// it. Where a gap reaches the border of the map, it wraps around if the border is periodic, and
    /// otherwise ends level, as if mirrored.
    Fill,
}

impl FromStr for MissingPolicy {
    type Err = MissingError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "refuse" => Ok(Self::Refuse),
            "fill" => Ok(Self::Fill),
            _ => Err(MissingError::UnknownPolicy(text.to_owned())),
        }
    }
}

/// Why a map with missing points makes no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MissingError {
    /// Points are missing and the policy refuses them.
    #[error(
        "{missing} of {total} points are missing (the first at column {ix}, row {iy}); they must be filled first"
    )]
    Refused {
        /// Number of missing points.
        missing: usize,
        /// Number of points.
        total: usize,
        /// Column of the first.
        ix: usize,
        /// Row of the first.
        iy: usize,
    },
    /// Nothing to fill from.
    #[error("all {0} points are missing")]
    NothingLeft(usize),
    /// The gaps did not settle.
    #[error(
        "the filling of missing points did not settle: after {steps} steps the error is still {relative:.1e} of the first"
    )]
    NotSettled {
        /// Steps taken.
        steps: usize,
        /// Estimated error relative to that of the first guess.
        relative: f64,
    },
    /// Unknown name of a policy.
    #[error("unknown policy `{0}` for missing points; allowed are refuse and fill")]
    UnknownPolicy(String),
    /// The points that are there make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// A height map whose points may be missing, marked by NaN.
#[derive(Clone, Debug)]
pub struct RawHeightMap {
    heights: Vec<f64>,
    shape: [usize; 2],
    spacing: [f64; 2],
    spacing_is_known: bool,
    /// Unit of heights and spacings.
    pub unit: LengthUnit,
    /// What lies beyond the border, if the source says.
    pub border: Option<Border>,
    /// How the surface was generated, if the source says.
    pub provenance: Option<Provenance>,
}

impl RawHeightMap {
    /// A map of `shape` `[ny, nx]` and `spacing` `[dx, dy]`; NaN marks a missing point.
    ///
    /// # Errors
    /// [`HeightFieldError`] as for [`HeightField::new`], except that NaN is allowed; infinite
    /// heights are not.
    pub fn new(
        heights: Vec<f64>,
        shape: [usize; 2],
        spacing: [f64; 2],
    ) -> Result<Self, HeightFieldError> {
        check_grid(shape, spacing)?;
        let [ny, nx] = shape;
        if heights.len() != nx * ny {
            return Err(HeightFieldError::WrongCount {
                found: heights.len(),
                nx,
                ny,
            });
        }
        if let Some(i) = heights.iter().position(|h| h.is_infinite()) {
            return Err(HeightFieldError::NotFinite {
                ix: i % nx,
                iy: i / nx,
                value: heights[i],
            });
        }
        Ok(Self {
            heights,
            shape,
            spacing,
            spacing_is_known: true,
            unit: LengthUnit::Arbitrary,
            border: None,
            provenance: None,
        })
    }

    /// The same map, of a source that says nothing of its spacing, so that a caller may ask for it.
    #[must_use]
    pub fn with_assumed_spacing(self) -> Self {
        Self {
            spacing_is_known: false,
            ..self
        }
    }

    /// Whether the source says what its spacing is.
    #[must_use]
    pub const fn spacing_is_known(&self) -> bool {
        self.spacing_is_known
    }

    /// The same heights at another spacing `[dx, dy]`.
    ///
    /// # Errors
    /// [`HeightFieldError::BadSpacing`] unless both are positive and finite.
    pub fn with_spacing(self, spacing: [f64; 2]) -> Result<Self, HeightFieldError> {
        check_grid(self.shape, spacing)?;
        Ok(Self {
            spacing,
            spacing_is_known: true,
            ..self
        })
    }

    /// Number of missing points.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|h| h.is_nan()).count()
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// The surface; a source that says nothing of its border is taken as `default_border`.
    ///
    /// # Errors
    /// [`MissingError`] if points are missing and `policy` refuses them, none is left to fill from,
    /// or the filling does not settle.
    pub fn into_height_field(
        self,
        policy: MissingPolicy,
        default_border: Border,
    ) -> Result<HeightField, MissingError> {
        let total = self.heights.len();
        let missing = self.missing();
        let border = self.border.unwrap_or(default_border);
        let heights = match (missing, policy) {
            (0, _) => self.heights,
            (n, _) if n == total => return Err(MissingError::NothingLeft(total)),
            (_, MissingPolicy::Fill) => {
                let mut heights = self.heights;
                fill(&mut heights, self.shape, self.spacing, border)?;
                heights
            }
            (_, MissingPolicy::Refuse) => {
                let first = self.heights.iter().position(|h| h.is_nan()).unwrap_or(0);
                let nx = self.shape[1];
                return Err(MissingError::Refused {
                    missing,
                    total,
                    ix: first % nx,
                    iy: first / nx,
                });
            }
        };
        Ok(HeightField::new(heights, self.shape, self.spacing)?
            .with_unit(self.unit)
            .with_border(border)
            .with_provenance(self.provenance))
    }
}

/// Replaces NaN by the solution of Laplace's equation over each gap, in its five-point form on the
/// grid: each filled point is the mean of its neighbours, weighted by one over the spacing squared.
fn fill(
    heights: &mut [f64],
    [ny, nx]: [usize; 2],
    [dx, dy]: [f64; 2],
    border: Border,
) -> Result<(), MissingError> {
    // Number the missing points, and take heights relative to the mean of those that are there.
    let gaps: Vec<usize> = (0..heights.len())
        .filter(|&i| heights[i].is_nan())
        .collect();
    if u32::try_from(gaps.len()).is_err() {
        return Err(HeightFieldError::TooLarge { nx, ny }.into());
    }
    let (mut mean, mut count) = (0.0, 0.0);
    for h in heights.iter().filter(|h| !h.is_nan()) {
        count += 1.0;
        mean += (h - mean) / count;
    }

    let periodic = border == Border::Periodic;
    let before = |i: usize, n: usize| match i {
        0 => periodic.then_some(n - 1),
        _ => Some(i - 1),
    };
    let after = |i: usize, n: usize| match i + 1 {
        next if next < n => Some(next),
        _ => periodic.then_some(0),
    };
    // Only the ratio of the weights counts; this one has the product 1.
    let (weight_x, weight_y) = (dy / dx, dx / dy);

    let mut system = GraphLaplacian::with_capacity(gaps.len());
    let mut source = Vec::with_capacity(gaps.len());
    for &i in &gaps {
        let (ix, iy) = (i % nx, i / nx);
        let neighbours = [
            (before(ix, nx).map(|x| iy * nx + x), weight_x),
            (after(ix, nx).map(|x| iy * nx + x), weight_x),
            (before(iy, ny).map(|y| y * nx + ix), weight_y),
            (after(iy, ny).map(|y| y * nx + ix), weight_y),
        ];
        let mut from_rim = 0.0;
        system.begin_point([ix as u32, iy as u32]);
        for (neighbour, weight) in neighbours {
            let Some(j) = neighbour else { continue };
            if heights[j].is_nan() {
                if let Ok(number) = gaps.binary_search(&j) {
                    system.join(number as u32, weight);
                }
            } else {
                system.anchor(weight);
                from_rim += weight * (heights[j] - mean);
            }
        }
        source.push(from_rim);
    }
    let solution = solve(system, &source)?;
    for (&i, h) in gaps.iter().zip(solution) {
        heights[i] = mean + h;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of `f` at its samples, without the points for which `gone` holds.
    fn map(
        shape: [usize; 2],
        spacing: [f64; 2],
        f: impl Fn(f64, f64) -> f64,
        gone: impl Fn(usize, usize) -> bool,
    ) -> RawHeightMap {
        let [ny, nx] = shape;
        let heights = (0..nx * ny)
            .map(|i| {
                let (ix, iy) = (i % nx, i / nx);
                if gone(ix, iy) {
                    f64::NAN
                } else {
                    f(ix as f64 * spacing[0], iy as f64 * spacing[1])
                }
            })
            .collect();
        RawHeightMap::new(heights, shape, spacing).unwrap()
    }

    /// Largest distance from `f` once the map is filled.
    fn error(map: RawHeightMap, border: Border, f: impl Fn(f64, f64) -> f64) -> f64 {
        let [dx, dy] = map.spacing;
        let filled = map.into_height_field(MissingPolicy::Fill, border).unwrap();
        let mut worst = 0.0_f64;
        for iy in 0..filled.ny() {
            for ix in 0..filled.nx() {
                let expected = f(ix as f64 * dx, iy as f64 * dy);
                worst = worst.max((filled.height(ix, iy) - expected).abs());
            }
        }
        worst
    }

    /// A ramp and `x^2 - y^2` solve the five-point equation exactly, so what is left is the error at
    /// which the solver stops: 1e-11 of the rim's range in the energy norm, and a point of a gap can
    /// be off by some tens of that. The ranges are below 200 and 3000.
    #[test]
    fn harmonic_surface_is_restored() {
        for spacing in [[1.0, 1.0], [0.5, 2.0], [10.0, 0.1]] {
            let ramp = |x: f64, y: f64| 1e3 + 0.3 * x - 0.7 * y;
            let saddle = |x: f64, y: f64| 0.01 * (x * x - y * y) + 0.02 * x * y;
            for gone in [
                |ix: usize, iy: usize| (10..31).contains(&ix) && (5..37).contains(&iy),
                |ix: usize, iy: usize| ix.abs_diff(20).pow(2) + iy.abs_diff(22).pow(2) < 300,
                |ix: usize, iy: usize| ix % 9 == 4 && iy % 9 == 4,
                // Scattered points, and threads one point thick
                |ix: usize, iy: usize| {
                    (1..44).contains(&ix)
                        && (1..44).contains(&iy)
                        && (ix % 7 == 3 || (ix * iy) % 5 == 2)
                },
            ] {
                let worst = error(map([45, 45], spacing, ramp, gone), Border::Open, ramp);
                assert!(worst < 2e-7, "ramp, {spacing:?}: {worst}");
                let worst = error(map([45, 45], spacing, saddle, gone), Border::Open, saddle);
                assert!(worst < 3e-6, "saddle, {spacing:?}: {worst}");
            }
        }
    }

    #[test]
    fn single_point_is_the_weighted_mean_of_its_neighbours() {
        let nan = f64::NAN;
        let heights = vec![0.0, 4.0, 0.0, 1.0, nan, 3.0, 0.0, 8.0, 0.0];
        let raw = RawHeightMap::new(heights, [3, 3], [1.0, 2.0]).unwrap();
        let filled = raw
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .unwrap();
        // Weights 1 along x, 1/4 along y
        let expected = (1.0 + 3.0 + (4.0 + 8.0) / 4.0) / 2.5;
        assert!((filled.height(1, 1) - expected).abs() < 1e-14);
    }

    #[test]
    fn corner_uses_the_neighbours_it_has() {
        let heights = vec![f64::NAN, 4.0, 2.0, 7.0];
        let raw = RawHeightMap::new(heights, [2, 2], [1.0, 1.0]).unwrap();
        let filled = raw
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .unwrap();
        assert!((filled.height(0, 0) - 3.0).abs() < 1e-14);
    }

    /// A strip along the border of a map that varies along x only: level if the map ends there,
    /// across to the other side if it is periodic.
    #[test]
    fn gap_at_the_border_ends_level_or_wraps() {
        let raw = || map([6, 10], [1.0, 1.0], |x, _| x, |ix, _| ix >= 7);
        let level = raw()
            .into_height_field(MissingPolicy::Fill, Border::Mirrored)
            .unwrap();
        let wrapped = raw()
            .into_height_field(MissingPolicy::Fill, Border::Periodic)
            .unwrap();
        for iy in 0..6 {
            for ix in 7..10 {
                assert!((level.height(ix, iy) - 6.0).abs() < 1e-9);
                // From 6 at column 6 to 0 at column 10
                let expected = 6.0 * (10 - ix) as f64 / 4.0;
                assert!((wrapped.height(ix, iy) - expected).abs() < 1e-9);
            }
        }
    }

    /// Neither a huge offset nor a tiny scale spoils the filling: only the range of heights counts.
    #[test]
    fn offset_and_scale_do_not_matter() {
        for (scale, offset) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e9)] {
            let ramp = |x: f64, y: f64| offset + scale * (x - 2.0 * y);
            let hole = |ix: usize, iy: usize| (3..17).contains(&ix) && (3..17).contains(&iy);
            let worst = error(map([20, 20], [1.0, 1.0], ramp, hole), Border::Open, ramp);
            assert!(worst < 1e-7 * scale + 4e-16 * offset, "{worst}");
        }
    }

    #[test]
    fn large_gap_settles_quickly() {
        let ramp = |x: f64, y: f64| 0.01 * x + 0.02 * y;
        let hole = |ix: usize, iy: usize| (5..505).contains(&ix) && (5..505).contains(&iy);
        let raw = map([510, 510], [1.0, 1.0], ramp, hole);
        assert!(error(raw, Border::Open, ramp) < 1e-7);
    }

    #[test]
    fn refuses_by_default_and_when_nothing_is_left() {
        let raw = || map([4, 5], [1.0, 1.0], |x, _| x, |ix, iy| (ix, iy) == (3, 2));
        assert_eq!(raw().missing(), 1);
        let refused = raw()
            .into_height_field(MissingPolicy::default(), Border::Open)
            .unwrap_err();
        assert_eq!(
            refused,
            MissingError::Refused {
                missing: 1,
                total: 20,
                ix: 3,
                iy: 2
            }
        );
        let empty = || map([4, 5], [1.0, 1.0], |x, _| x, |_, _| true);
        for policy in [MissingPolicy::Refuse, MissingPolicy::Fill] {
            assert_eq!(
                empty().into_height_field(policy, Border::Open),
                Err(MissingError::NothingLeft(20))
            );
        }
        assert!("guess".parse::<MissingPolicy>().is_err());
        assert_eq!("fill".parse(), Ok(MissingPolicy::Fill));
    }
}
