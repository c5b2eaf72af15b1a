//! Removal of the form on which a roughness rides: mean, plane or parabola.

use std::fmt;
use std::str::FromStr;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::height_field::mean_height;
use crate::{Border, HeightField, HeightFieldError};

/// The form to remove, by least squares over the samples of one tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// Nothing.
    None,
    /// The mean height.
    #[default]
    Mean,
    /// The plane `a + b x + c y`.
    Plane,
    /// The full polynomial of second order: the plane and `d x^2 + e x y + f y^2`.
    Parabola,
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Mean => "mean",
            Self::Plane => "plane",
            Self::Parabola => "parabola",
        })
    }
}

impl FromStr for Form {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "none" => Ok(Self::None),
            "mean" => Ok(Self::Mean),
            "plane" => Ok(Self::Plane),
            "parabola" => Ok(Self::Parabola),
            _ => Err(format!(
                "unknown form `{text}`; allowed are none, mean, plane and parabola"
            )),
        }
    }
}

impl Form {
    /// Form that is removed before spectra and distributions of heights are measured: the mean if the border is periodic, else also
    /// the tilt of the sample.
    #[must_use]
    pub const fn left_out_of_statistics(border: Border) -> Self {
        match border {
            Border::Periodic => Self::Mean,
            Border::Mirrored | Border::Open => Self::Plane,
        }
    }

    /// Removes this form, and any of lower order, from a surface.
    ///
    /// Grid, unit and border stay. The provenance stays if nothing or the mean is removed, and is
    /// dropped with a plane or parabola: the surface is then no longer the one that was drawn. A
    /// periodic surface without its plane or parabola has steps at its border.
    ///
    /// # Errors
    /// [`HeightFieldError`] if heights are so large that their sums overflow.
    ///
    /// # Source
    /// Products of the first three Gram (discrete Legendre) polynomials, which are orthogonal on an
    /// even grid, so each coefficient is a projection and no system of equations is solved.
    pub fn remove(self, field: HeightField) -> Result<HeightField, HeightFieldError> {
        let order = match self {
            Self::None => return Ok(field),
            Self::Mean => 0,
            Self::Plane => 1,
            Self::Parabola => 2,
        };
        let (shape, spacing) = (field.shape(), field.spacing());
        let (unit, border) = (field.unit(), field.border());
        let turned_cells = field.turned_cells().cloned();
        let provenance = match self {
            Self::None | Self::Mean => field.provenance().cloned(),
            Self::Plane | Self::Parabola => None,
        };

        let mean = mean_height(&field);
        let mut heights = field.into_heights();
        heights.par_iter_mut().for_each(|h| *h -= mean);
        // The second time removes what rounding left of a form far larger than the roughness.
        for _ in 0..2 {
            project_out(&mut heights, shape, order);
        }
        Ok(HeightField::new(heights, shape, spacing)?
            .with_unit(unit)
            .with_border(border)
            .with_provenance(provenance)
            .with_turned_cells(turned_cells))
    }
}

/// Subtracts the projections on all products `P_i(x) P_j(y)` with `i + j <= order`.
fn project_out(heights: &mut [f64], [ny, nx]: [usize; 2], order: usize) {
    let (basis_x, basis_y) = (Basis::new(nx), Basis::new(ny));

    // Projections of each row on the polynomials of x, then of those on the polynomials of y
    let rows: Vec<[f64; 3]> = heights
        .par_chunks_exact(nx)
        .map(|row| {
            row.iter().enumerate().fold([0.0; 3], |sum, (ix, h)| {
                let p = basis_x.at(ix);
                [sum[0] + h * p[0], sum[1] + h * p[1], sum[2] + h * p[2]]
            })
        })
        .collect();
    // coefficients[j][i] belongs to P_i(x) P_j(y)
    let mut coefficients = [[0.0; 3]; 3];
    for (iy, row) in rows.iter().enumerate() {
        let p = basis_y.at(iy);
        for j in 0..=order {
            for i in 0..=order - j {
                coefficients[j][i] += p[j] * row[i];
            }
        }
    }
    for (j, of_row) in coefficients.iter_mut().enumerate() {
        for (i, value) in of_row.iter_mut().enumerate() {
            *value *= basis_x.inverse_norms[i] * basis_y.inverse_norms[j];
        }
    }

    heights
        .par_chunks_exact_mut(nx)
        .enumerate()
        .for_each(|(iy, row)| {
            let p = basis_y.at(iy);
            let along_x: [f64; 3] =
                std::array::from_fn(|i| (0..3).map(|j| coefficients[j][i] * p[j]).sum());
            for (ix, h) in row.iter_mut().enumerate() {
                let p = basis_x.at(ix);
                *h -= along_x[0] * p[0] + along_x[1] * p[1] + along_x[2] * p[2];
            }
        });
}

/// The polynomials `1`, `u` and `u^2 - mean(u^2)`, orthogonal on `n` even steps of `u` from -1 to 1.
struct Basis {
    n: usize,
    mean_square: f64,
    /// One over the sum of squares of each; zero for the last if `n` is 2, where it vanishes.
    inverse_norms: [f64; 3],
}

impl Basis {
    fn new(n: usize) -> Self {
        let samples = n as f64;
        let mut basis = Self {
            n,
            mean_square: (samples + 1.0) / (3.0 * (samples - 1.0)),
            inverse_norms: [0.0; 3],
        };
        let mut norms = [0.0; 3];
        for i in 0..n {
            for (norm, p) in norms.iter_mut().zip(basis.at(i)) {
                *norm += p * p;
            }
        }
        basis.inverse_norms = [
            1.0 / norms[0],
            1.0 / norms[1],
            if n > 2 { 1.0 / norms[2] } else { 0.0 },
        ];
        basis
    }

    fn at(&self, i: usize) -> [f64; 3] {
        let last = (self.n - 1) as f64;
        let u = (2.0 * i as f64 - last) / last;
        [1.0, u, u * u - self.mean_square]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::height_field::RecordedLength;
    use crate::{Border, LengthUnit};
    use std::sync::Arc;

    fn field(shape: [usize; 2], f: impl Fn(f64, f64) -> f64) -> HeightField {
        let [ny, nx] = shape;
        let heights = (0..nx * ny)
            .map(|i| f((i % nx) as f64 * 0.5, (i / nx) as f64 * 2.0))
            .collect();
        HeightField::new(heights, shape, [0.5, 2.0]).unwrap()
    }

    fn largest(field: &HeightField) -> f64 {
        field.heights().iter().fold(0.0, |m, h| h.abs().max(m))
    }

    /// The remainder is the rounding of the heights themselves, half an ulp of the largest, and of
    /// the sums, of the same order.
    #[test]
    fn each_form_is_removed_to_rounding() {
        for shape in [[2, 2], [2, 5], [3, 3], [40, 31], [64, 200]] {
            for scale in [1e-9, 1.0, 1e9] {
                let parabola = field(shape, |x, y| {
                    scale * (1e3 + x - 3.0 * y + 0.1 * x * x + 0.3 * x * y - 0.02 * y * y)
                });
                let plane = field(shape, |x, y| scale * (-1e3 + x - 3.0 * y));
                let mean = field(shape, |_, _| scale * 1e3);
                for (form, surface) in [
                    (Form::Mean, mean),
                    (Form::Plane, plane),
                    (Form::Parabola, parabola),
                ] {
                    let peak = largest(&surface);
                    let left = largest(&form.remove(surface).unwrap());
                    assert!(left < 4e-16 * peak, "{form} {shape:?}: {left} of {peak}");
                }
            }
        }
    }

    /// A ripple orthogonal to every form is the roughness that must survive; a form is added whose
    /// rounding, `1e6 * 1e-16`, bounds the difference.
    #[test]
    fn roughness_survives() {
        let ripple = |x: f64, y: f64| (x * 2.0 * 1.3).sin() * (y / 2.0 * 0.9).cos();
        let bare = Form::Parabola.remove(field([50, 60], ripple)).unwrap();
        let tilted = field([50, 60], |x, y| {
            ripple(x, y) + 1e6 + 50.0 * x - 30.0 * y + 2.0 * x * x - x * y
        });
        let found = Form::Parabola.remove(tilted).unwrap();
        for (a, b) in found.heights().iter().zip(bare.heights()) {
            assert!((a - b).abs() < 2e-9, "{a} against {b}");
        }
    }

    /// The lowest terms that each form does not hold stay as they are, to rounding.
    #[test]
    fn terms_of_higher_order_survive() {
        // Centred coordinates; 3 x 3 samples of u have the mean square 2/3.
        let surface =
            |f: fn(f64, f64) -> f64| field([3, 3], |x, y| f(x / 0.5 - 1.0, y / 2.0 - 1.0));
        for (form, higher) in [
            (Form::Mean, surface(|u, _| u)),
            (Form::Mean, surface(|_, v| v)),
            (Form::Plane, surface(|u, v| u * v)),
            (Form::Plane, surface(|u, _| u * u - 2.0 / 3.0)),
            (Form::Plane, surface(|_, v| v * v - 2.0 / 3.0)),
            (Form::Parabola, surface(|u, v| (u * u - 2.0 / 3.0) * v)),
            (Form::Parabola, surface(|u, v| (v * v - 2.0 / 3.0) * u)),
        ] {
            let left = form.remove(higher.clone()).unwrap();
            for (a, b) in left.heights().iter().zip(higher.heights()) {
                assert!((a - b).abs() < 1e-15, "{form}: {a} against {b}");
            }
        }
    }

    /// Least squares means that what is left is orthogonal to all six terms.
    #[test]
    fn residual_is_orthogonal_to_the_form() {
        let surface = field([23, 38], |x, y| (x * y).sin() + (x + y * y).cos());
        let left = Form::Parabola.remove(surface).unwrap();
        for term in [
            |_: f64, _: f64| 1.0,
            |x: f64, _: f64| x,
            |_: f64, y: f64| y,
            |x: f64, _: f64| x * x,
            |x: f64, y: f64| x * y,
            |_: f64, y: f64| y * y,
        ] {
            let (mut dot, mut norm) = (0.0, 0.0);
            for (i, h) in left.heights().iter().enumerate() {
                let t = term((i % 38) as f64 / 37.0, (i / 38) as f64 / 22.0);
                dot += h * t;
                norm += (h * t).abs();
            }
            assert!(dot.abs() < 1e-13 * norm, "{dot} of {norm}");
        }
    }

    #[test]
    fn grid_unit_and_border_stay_and_provenance_goes_with_the_plane() {
        let surface = field([4, 5], |x, y| x * y)
            .with_unit(LengthUnit::Micrometre)
            .with_border(Border::Mirrored)
            .with_provenance(Some(Arc::new(RecordedLength(2.0))));
        for form in [Form::None, Form::Mean, Form::Plane, Form::Parabola] {
            let left = form.remove(surface.clone()).unwrap();
            assert_eq!(left.shape(), surface.shape());
            assert_eq!(left.spacing(), surface.spacing());
            assert_eq!(left.unit(), surface.unit());
            assert_eq!(left.border(), surface.border());
            let kept = matches!(form, Form::None | Form::Mean);
            assert_eq!(left.provenance().is_some(), kept, "{form}");
            assert_eq!(form.to_string().parse::<Form>().unwrap(), form);
        }
        assert!("line".parse::<Form>().is_err());
    }
}
