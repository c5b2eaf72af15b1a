//! Functional parameters: heights and volumes of core, peaks and valleys.

use rayon::join;
use serde::Serialize;

use super::material_ratio::MaterialRatioCurve;
use crate::HeightField;

/// Material ratios, as fractions, that part peaks from core and core from valleys.
const PEAK: f64 = 0.1;
const VALLEY: f64 = 0.8;

/// Functional parameters, from the material ratio curve of the samples.
///
/// The equivalent straight line is that of least squares over the 40 % of the curve with the secant of least slope. Volumes
/// are per area of the mean plane, in the unit of heights.
///
/// # Source
/// ISO 25178-2:2021; the equivalent line as in ISO 13565-2:1996.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FunctionalParameters {
    /// Core height: fall of the equivalent straight line from 0 to 100 %.
    pub sk: f64,
    /// Reduced peak height: height of the triangle with the area of the peaks above the core.
    pub spk: f64,
    /// Reduced valley depth: height of the triangle with the area of the valleys below the core.
    pub svk: f64,
    /// Material ratio at the upper end of the core, percent.
    pub smr1: f64,
    /// Material ratio at the lower end of the core, percent.
    pub smr2: f64,
    /// Peak material volume, above the height at 10 %.
    pub vmp: f64,
    /// Core material volume, between the heights at 10 % and 80 %.
    pub vmc: f64,
    /// Core void volume, between the heights at 10 % and 80 %.
    pub vvc: f64,
    /// Valley void volume, below the height at 80 %.
    pub vvv: f64,
}

impl FunctionalParameters {
    /// Measures a surface.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let curve = MaterialRatioCurve::of(field);
        let line = curve.equivalent_line();

        // Triangles with the areas of what is above and below the core
        let smr1 = curve.first_ratio(line.top);
        let smr2 = curve.last_ratio(line.bottom);
        let triangle = |area: f64, base: f64| if base > 0.0 { 2.0 * area / base } else { 0.0 };

        // Volumes of material above and of void below the height at a ratio
        let material = |ratio: f64| {
            let level = curve.height(ratio);
            curve.integral([0.0, ratio], |_, height| height - level)
        };
        let void = |ratio: f64| {
            let level = curve.height(ratio);
            curve.integral([ratio, 1.0], |_, height| level - height)
        };
        let peaks = || curve.integral([0.0, smr1], |_, height| height - line.top);
        let valleys = || curve.integral([smr2, 1.0], |_, height| line.bottom - height);
        let ((peaks, valleys), ((vmp, vvv), (all_material, all_void))) = join(
            || join(peaks, valleys),
            || {
                join(
                    || join(|| material(PEAK), || void(VALLEY)),
                    || join(|| material(VALLEY), || void(PEAK)),
                )
            },
        );
        Self {
            sk: line.top - line.bottom,
            spk: triangle(peaks, smr1),
            svk: triangle(valleys, 1.0 - smr2),
            smr1: 100.0 * smr1,
            smr2: 100.0 * smr2,
            vmp,
            vmc: all_material - vmp,
            vvc: all_void - vvv,
            vvv,
        }
    }
}
