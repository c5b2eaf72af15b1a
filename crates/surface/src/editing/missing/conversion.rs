//! Conversion of a height map: into another unit, and with its rows in reverse order.

use super::RawHeightMap;
use crate::{HeightFieldError, LengthUnit};

impl RawHeightMap {
    /// The same map with its lengths in `unit`; each number is rounded once.
    ///
    /// # Errors
    /// [`HeightFieldError::NoUnit`] if this unit or the other is arbitrary, and
    /// [`HeightFieldError`] as of [`RawHeightMap::new`] where numbers become too large or too small.
    pub fn in_unit(self, unit: LengthUnit) -> Result<Self, HeightFieldError> {
        if unit == self.unit {
            return Ok(self);
        }
        let convert = self.unit.conversion(unit).ok_or(HeightFieldError::NoUnit {
            from: self.unit,
            to: unit,
        })?;
        let heights = self.heights.into_iter().map(convert).collect();
        let map = Self::new(heights, self.shape, self.spacing.map(convert))?;
        Ok(Self {
            spacing_is_known: self.spacing_is_known,
            unit,
            border: self.border,
            notes: self.notes,
            provenance: self.provenance.map(|record| record.converted(&convert)),
            ..map
        })
    }

    /// The same map with its rows in reverse order: the last one becomes row 0, at y = 0.
    ///
    /// The surface is a mirror image of the original. How it was generated is forgotten, since drawing it
    /// again would give the original.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        let [ny, nx] = self.shape;
        for iy in 0..ny / 2 {
            let (above, below) = self.heights.split_at_mut((ny - 1 - iy) * nx);
            above[iy * nx..(iy + 1) * nx].swap_with_slice(&mut below[..nx]);
        }
        self.provenance = None;
        self
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
            assert_eq!(error, HeightFieldError::NoUnit { from, to });
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
}
