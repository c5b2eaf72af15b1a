//! Raw height map: heights as instruments deliver them: with points missing.

use std::str::FromStr;
use std::sync::Arc;

use super::error::MissingError;
use super::fill::fill;
use crate::height_field::check_grid;
use crate::{
    Border, HeightField, HeightFieldError, LengthUnit, ProvenanceRecord, TurnedCells, short,
};

/// Treatment of points that have no height.
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "refuse" => Ok(Self::Refuse),
            "fill" => Ok(Self::Fill),
            _ => Err(format!(
                "unknown policy `{text}` for missing points; allowed are refuse and fill"
            )),
        }
    }
}

/// A height map whose points may be missing, marked by NaN.
#[derive(Clone, Debug)]
pub struct RawHeightMap {
    /// Shared by copies of the map.
    heights: Arc<Vec<f64>>,
    shape: [usize; 2],
    spacing: [f64; 2],
    spacing_is_known: bool,
    /// Unit of heights and spacings.
    pub unit: LengthUnit,
    /// `true` if y grows towards the north of a map, and `false` if its first row, at y = 0, is the northern one.
    pub y_is_north: bool,
    /// Border, if the source states it.
    pub border: Option<Border>,
    /// Record of how the surface was drawn, if the source has one.
    pub provenance: Option<Arc<dyn ProvenanceRecord>>,
    /// Cells of a structure that are split along their other diagonal, perhaps none; `None` of a surface without edges.
    pub turned_cells: Option<TurnedCells>,
    /// Notes for readers of results on how the source was read, one sentence each.
    pub notes: Vec<String>,
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
        // Without early exit, which would keep this from being compiled to vector instructions
        let any_infinite = heights.iter().fold(false, |any, h| any | h.is_infinite());
        if any_infinite && let Some(i) = heights.iter().position(|h| h.is_infinite()) {
            return Err(HeightFieldError::NotFinite {
                ix: i % nx,
                iy: i / nx,
                value: heights[i],
            });
        }
        Ok(Self {
            heights: Arc::new(heights),
            shape,
            spacing,
            spacing_is_known: true,
            unit: LengthUnit::Arbitrary,
            y_is_north: false,
            border: None,
            provenance: None,
            turned_cells: None,
            notes: Vec::new(),
        })
    }

    /// Returns the map with a spacing that is assumed because the source states none.
    #[must_use]
    pub fn with_assumed_spacing(self) -> Self {
        Self {
            spacing_is_known: false,
            ..self
        }
    }

    /// Note on a spacing that the source does not state.
    #[must_use]
    pub fn spacing_note(&self) -> Option<String> {
        let [dx, dy] = self.spacing.map(short);
        let assumed = if dx == dy { dx } else { format!("{dx} x {dy}") };
        (!self.spacing_is_known).then(|| format!("the file has no spacing: {assumed} is assumed"))
    }

    /// Returns `true` if the source states the spacing.
    #[must_use]
    pub const fn spacing_is_known(&self) -> bool {
        self.spacing_is_known
    }

    /// Returns the heights at the spacing `[dx, dy]`. The provenance is dropped if the spacing changes.
    ///
    /// # Errors
    /// [`HeightFieldError::BadSpacing`] unless both are positive and finite.
    pub fn with_spacing(self, spacing: [f64; 2]) -> Result<Self, HeightFieldError> {
        check_grid(self.shape, spacing)?;
        Ok(Self {
            provenance: self.provenance.filter(|_| self.spacing == spacing),
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

    /// Samples in row-major order; NaN marks a missing point.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// `[dx, dy]`, length units per sample.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// Returns the map with its lengths in `unit`; each number is rounded once.
    ///
    /// # Errors
    /// [`HeightFieldError::NoUnit`] if this unit or the other is arbitrary, and
    /// [`HeightFieldError`] as of [`RawHeightMap::new`] where numbers become too large or too small.
    pub fn in_unit(self, unit: LengthUnit) -> Result<Self, HeightFieldError> {
        if unit == self.unit {
            return Ok(self);
        }
        let convert = self.unit.conversion(unit).ok_or(HeightFieldError::NoUnit {
            from: self.unit.symbol(),
            to: unit.symbol(),
        })?;
        let heights: Vec<f64> = self.heights.iter().copied().map(convert).collect();
        let map = Self::new(heights, self.shape, self.spacing.map(convert))?;
        Ok(Self {
            spacing_is_known: self.spacing_is_known,
            unit,
            y_is_north: self.y_is_north,
            border: self.border,
            notes: self.notes,
            provenance: self.provenance.map(|record| record.converted(&convert)),
            turned_cells: self.turned_cells,
            ..map
        })
    }

    /// Returns the map with its rows in reverse order: the last one becomes row 0, at y = 0.
    ///
    /// The surface is a mirror image of the original. The provenance is dropped, since drawing the
    /// surface again would give the original.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        let [ny, nx] = self.shape;
        let heights = Arc::make_mut(&mut self.heights);
        for iy in 0..ny / 2 {
            let (above, below) = heights.split_at_mut((ny - 1 - iy) * nx);
            above[iy * nx..(iy + 1) * nx].swap_with_slice(&mut below[..nx]);
        }
        self.y_is_north = !self.y_is_north;
        self.provenance = None;
        self.turned_cells = self.turned_cells.map(|cells| cells.flipped());
        self
    }

    /// The surface; `default_border` applies if the source states none.
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
                fill(
                    Arc::make_mut(&mut heights).as_mut_slice(),
                    self.shape,
                    self.spacing,
                    border,
                )?;
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
        Ok(HeightField::of_shared(heights, self.shape, self.spacing)?
            .with_turned_cells(self.turned_cells.map(Arc::new))
            .with_unit(self.unit)
            .with_border(border)
            .with_provenance(self.provenance))
    }
}

/// A map without missing points, whose heights are shared.
impl From<HeightField> for RawHeightMap {
    fn from(field: HeightField) -> Self {
        Self {
            heights: field.shared_heights(),
            shape: field.shape(),
            spacing: field.spacing(),
            spacing_is_known: true,
            unit: field.unit(),
            y_is_north: false,
            border: Some(field.border()),
            provenance: field.provenance().cloned(),
            turned_cells: field.turned_cells().map(|cells| cells.as_ref().clone()),
            notes: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::height_field::RecordedLength;
    use crate::{Border, MissingPolicy};
    use std::sync::Arc;

    fn map(unit: LengthUnit) -> RawHeightMap {
        let heights = vec![1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN];
        let mut map = RawHeightMap::new(heights, [3, 2], [0.5, 2.0]).unwrap();
        map.unit = unit;
        map.border = Some(Border::Open);
        map.notes.push("read in a way".to_owned());
        map.provenance = Some(Arc::new(RecordedLength(0.25)));
        map
    }

    #[test]
    fn all_lengths_are_converted_together() {
        let nm = map(LengthUnit::Micrometre)
            .in_unit(LengthUnit::Nanometre)
            .unwrap();
        assert_eq!((nm.unit, nm.missing()), (LengthUnit::Nanometre, 1));
        assert_eq!(nm.border, Some(Border::Open));
        assert_eq!(nm.notes, ["read in a way"]);
        assert_eq!(nm.spacing, [500.0, 2000.0]);
        assert_eq!(&nm.heights[..2], [1000.0, 2000.0]);
        assert!(nm.provenance.unwrap().equals(&RecordedLength(250.0)));
        // Rounded once, so the way back is exact for such numbers.
        let km = map(LengthUnit::Metre)
            .in_unit(LengthUnit::Kilometre)
            .unwrap();
        assert_eq!(km.heights[0], 1e-3);
    }

    #[test]
    fn units_that_are_not_known_are_not_converted() {
        for (from, to) in [
            (LengthUnit::Arbitrary, LengthUnit::Metre),
            (LengthUnit::Metre, LengthUnit::Arbitrary),
        ] {
            let error = map(from).in_unit(to).unwrap_err();
            assert_eq!(
                error,
                HeightFieldError::NoUnit {
                    from: from.symbol(),
                    to: to.symbol()
                }
            );
        }
        let same = map(LengthUnit::Arbitrary).in_unit(LengthUnit::Arbitrary);
        assert_eq!(same.unwrap().heights[1], 2.0);
    }

    #[test]
    fn another_spacing_forgets_how_a_surface_was_generated() {
        let map = map(LengthUnit::Metre);
        let same = map.clone().with_spacing(map.spacing).unwrap();
        assert!(same.provenance.is_some());
        let other = map.with_spacing([0.5, 4.0]).unwrap();
        assert!(other.provenance.is_none());
    }

    #[test]
    fn rows_are_reversed() {
        let flipped = map(LengthUnit::Metre).flipped();
        assert!(flipped.heights[1].is_nan() && flipped.provenance.is_none());
        assert_eq!(&flipped.heights[2..], [3.0, 4.0, 1.0, 2.0]);
        let field = flipped.into_height_field(MissingPolicy::Fill, Border::Periodic);
        assert_eq!(field.unwrap().height(0, 0), 5.0);
    }

    /// Slopes of the facets, steepest along y first: the same with the other sign in a mirror image.
    #[test]
    fn facets_of_a_structure_are_mirrored_with_its_rows() {
        let slopes = |map: RawHeightMap, sign: f64| {
            let field = map.into_height_field(MissingPolicy::Fill, Border::Periodic);
            let field = field.unwrap();
            let facets = (0..6).flat_map(|cell| field.facet_slopes(cell % 2, cell / 2));
            let mut slopes: Vec<[f64; 2]> = facets.map(|[x, y]| [x, sign * y]).collect();
            slopes.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
            slopes
        };
        let mut map = map(LengthUnit::Metre);
        map.heights = vec![1.0, 2.0, 3.5, 4.0, 7.0, 5.5].into();
        for is_turned in [|_, _| false, |ix, iy| (ix, iy) == (1, 0)] {
            map.turned_cells = Some(TurnedCells::new([3, 2], is_turned));
            let plain = slopes(map.clone().with_spacing([1.0, 2.0]).unwrap(), 1.0);
            let nm = map.clone().with_spacing([1.0, 2.0]).unwrap().flipped();
            assert_eq!(slopes(nm, -1.0), plain);
        }
    }
}
