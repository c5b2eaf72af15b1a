//! Spline surface: a height field whose cells are bicubic and join smoothly.

use std::sync::Arc;

use super::{interpolation, padding};
use crate::{Border, HeightField, LengthUnit, ProvenanceRecord};

/// A single-valued surface `z = h(x, y)` of uniform bicubic B-spline patches, one per cell.
///
/// In cell `(ix, iy)`, with `u = x / dx - ix` and `v = y / dy - iy` from 0 to 1,
/// `h = sum_{j,i=0..3} B_j(v) B_i(u) c[iy + j][ix + i]` with the basis
/// `B_0 = (1 - u)^3 / 6`, `B_1 = (3 u^3 - 6 u^2 + 4) / 6`, `B_2(u) = B_1(1 - u)`, `B_3 = u^3 / 6`.
/// Height, slope and curvature are continuous across the edges of cells, and across the border where it
/// is periodic. Across a mirrored border height and curvature are, and the slope along its normal is zero.
///
/// # Examples
/// ```
/// use std::f64::consts::TAU;
///
/// use asperity_surface::{HeightField, SplineSurface};
///
/// // A periodic sine of amplitude 1, 16 samples per period
/// let sine = |x: f64| (TAU * x / 16.0).sin();
/// let heights: Vec<f64> = (0..4 * 16).map(|i| sine(f64::from(i % 16))).collect();
/// let field = HeightField::new(heights, [4, 16], [1.0, 1.0])?;
/// let surface = SplineSurface::through(&field);
///
/// assert!((surface.height(3.0, 1.0) - sine(3.0)).abs() < 1e-15);
/// assert!((surface.height(3.5, 1.2) - sine(3.5)).abs() < 1e-4);
/// # Ok::<(), asperity_surface::HeightFieldError>(())
/// ```
///
/// # Source
/// C. de Boor, *A Practical Guide to Splines*, Springer 1978; M. Unser, A. Aldroubi, M. Eden, *B-spline
/// signal processing*, IEEE Trans. Signal Process. 41 (1993) 821.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineSurface {
    /// Rows of [`SplineSurface::stride`] numbers.
    pub(super) coefficients: Vec<f64>,
    pub(super) cells: [usize; 2],
    pub(super) spacing: [f64; 2],
    pub(super) unit: LengthUnit,
    pub(super) border: Border,
    pub(super) provenance: Option<Arc<dyn ProvenanceRecord>>,
}

impl SplineSurface {
    /// The spline through all samples of `field`, whose spacing, unit, border and provenance it takes over.
    ///
    /// A periodic field is continued periodically, a mirrored one evenly about its first and last samples,
    /// so its slope along the normal of the border is zero there. At an open border the curvature along its
    /// normal is zero: the natural spline, of all that pass through the samples the one of least mean
    /// square curvature, which needs nothing beyond the border and keeps planes.
    ///
    /// At the samples, heights agree to some `1e-16` of the largest height. Between them the distance from
    /// a smooth surface falls with the fourth power of the spacing, but near an open border whose
    /// curvature is not zero, or a mirrored one whose slope is not zero, with the second or first only.
    /// It holds the heights twice while it computes; the cost is linear in their number.
    #[must_use]
    pub fn through(field: &HeightField) -> Self {
        let coefficients = interpolation::coefficients(field);
        Self::of_coefficients(coefficients, field.shape(), field.spacing(), field.border())
            .with_unit(field.unit())
            .with_provenance(field.provenance().cloned())
    }

    /// The spline with one coefficient per grid point, row-major with shape `[ny, nx]`, as for the samples
    /// of a [`HeightField`], in arbitrary units. Their memory is used if it has room for the padding.
    #[must_use]
    pub fn of_coefficients(
        coefficients: Vec<f64>,
        shape: [usize; 2],
        spacing: [f64; 2],
        border: Border,
    ) -> Self {
        let [ny, nx] = shape;
        Self {
            coefficients: padding::padded(coefficients, shape, border),
            cells: border.cells([nx, ny]),
            spacing,
            unit: LengthUnit::Arbitrary,
            border,
            provenance: None,
        }
    }

    /// Returns the surface in another unit of length; numbers are not converted.
    #[must_use]
    pub fn with_unit(mut self, unit: LengthUnit) -> Self {
        self.unit = unit;
        self
    }

    /// Returns the surface with a record of how it was drawn.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Option<Arc<dyn ProvenanceRecord>>) -> Self {
        self.provenance = provenance;
        self
    }

    /// The surface whose heights are those of this one times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let coefficients = self.coefficients.iter();
        Self {
            coefficients: coefficients.map(|c| c * factor).collect(),
            ..self.clone()
        }
    }

    /// Coefficients in length units, row-major: `cy + 3` rows of [`SplineSurface::stride`] numbers.
    ///
    /// Entry `[iy + 1][ix + 1]` belongs to grid point `(ix, iy)`. Those around the grid points continue
    /// them as the border does, so a patch reads its 4 x 4 coefficients from `[iy][ix]` on without wrapping.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Consumes the surface and returns its coefficients, for reuse of their memory.
    #[must_use]
    pub fn into_coefficients(self) -> Vec<f64> {
        self.coefficients
    }

    /// Numbers per row of coefficients: `cx + 3`.
    #[must_use]
    pub const fn stride(&self) -> usize {
        self.cells[0] + 3
    }

    /// Number of cells `[columns, rows]` of one tile, each at least 1.
    #[must_use]
    pub const fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Sides `[dx, dy]` of a cell, length units.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Extent `[x, y]` of one tile in length units.
    #[must_use]
    pub const fn extent(&self) -> [f64; 2] {
        let [cx, cy] = self.cells;
        [cx as f64 * self.spacing[0], cy as f64 * self.spacing[1]]
    }

    /// Unit of coefficients and spacings.
    #[must_use]
    pub const fn unit(&self) -> LengthUnit {
        self.unit
    }

    /// Border of the surface.
    #[must_use]
    pub const fn border(&self) -> Border {
        self.border
    }

    /// Record of how the surface was drawn, if it has one.
    #[must_use]
    pub const fn provenance(&self) -> Option<&Arc<dyn ProvenanceRecord>> {
        self.provenance.as_ref()
    }
}
