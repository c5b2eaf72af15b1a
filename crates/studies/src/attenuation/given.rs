//! Shadow on one given surface: which fraction of its points a light reaches.

use asperity_optics::Incidence;
use asperity_simulate::{Cells, Shape, Silent, SimulateError, check_shape, short};
use asperity_surface::{HeightField, SplineSurface};
use asperity_tally::Estimate;
use serde::Serialize;

use super::survey::Survey;
use crate::output::{Basis, EstimateWithLimit};

/// Seed of the points, two in each cell.
const SEED: u64 = 1;

/// Lit and shadowed fractions of a surface under one light, of its points spread evenly over the mean plane.
///
/// Errors are those of as many independent points, an upper bound: one point lies in each triangle of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShadowShares {
    /// Polar angle of the direction towards the light, degrees.
    pub theta_deg: f64,
    /// Its azimuth, degrees.
    pub phi_deg: f64,
    /// Points that the light reaches.
    pub(crate) lit: EstimateWithLimit,
    /// Points that face away from the light: local shadow.
    pub(crate) facing_away: EstimateWithLimit,
    /// Points that face the light and are hidden by other parts: distant shadow.
    pub(crate) hidden: EstimateWithLimit,
    /// Number of points.
    pub points: u64,
    /// Visibility rays lost to numerical failure; their points count as hidden.
    pub lost: u64,
}

impl ShadowShares {
    /// Shadow shares of a height map with these `cells` under each of `lights`.
    ///
    /// # Errors
    /// [`SimulateError`] if light is so grazing, or the surface so high, that rays cross too many tiles.
    pub fn of(
        field: &HeightField,
        cells: Cells,
        lights: &[Incidence],
    ) -> Result<Vec<Self>, SimulateError> {
        let shape = match cells {
            Cells::Flat => Shape::height_field(field.clone()),
            Cells::Smooth => Shape::smooth(SplineSurface::through(field)),
        };
        for light in lights {
            check_shape(&shape, *light)?;
        }
        let under = |light: &Incidence| {
            let survey = Survey {
                seed: SEED,
                lights: std::slice::from_ref(light),
                ..Survey::default()
            };
            let counts = survey.count(&shape, &Silent)?;
            let points = counts.points;
            let [facing, lit] = [counts.lights.facing[0], counts.lights.free[0]];
            Ok(Self {
                theta_deg: light.theta_deg(),
                phi_deg: light.phi_deg(),
                lit: fraction(lit, points, light),
                facing_away: fraction(points - facing, points, light),
                hidden: fraction(facing - lit, points, light),
                points,
                lost: counts.lost,
            })
        };
        lights.iter().map(under).collect()
    }

    /// One line for a report.
    #[must_use]
    pub fn text(&self) -> String {
        let [theta, phi] = [self.theta_deg, self.phi_deg].map(short);
        let [lit, away, hidden] = [self.lit, self.facing_away, self.hidden].map(|part| part.text());
        format!(
            "light from theta {theta} deg, phi {phi} deg: lit {lit}, facing away {away}, hidden {hidden} of the mean plane"
        )
    }
}

/// A fraction of independent points; under vertical light, where nothing is hidden, a proof.
fn fraction(of: u64, all: u64, light: &Incidence) -> EstimateWithLimit {
    let mean = of as f64 / all as f64;
    let se = Some((mean * (1.0 - mean) / all as f64).sqrt());
    let basis = match light.is_vertical() {
        true => Basis::Proven,
        false => Basis::Samples(all as f64),
    };
    EstimateWithLimit::new(Estimate { mean, se }, basis)
}

#[cfg(test)]
mod tests {
    use asperity_surface::Border;
    use asperity_synthesis::{Psd, Synthesis};

    use super::*;

    /// Ridges along y of height 1 and period 4, sloping both ways: towards the light and away from it.
    fn ridges() -> HeightField {
        let heights = (0..64).map(|k| [0.0, 0.5, 1.0, 0.5][k % 4]);
        let field = HeightField::new(heights.collect(), [8, 8], [1.0, 1.0]).unwrap();
        field.with_border(Border::Periodic)
    }

    fn light(theta: f64) -> Incidence {
        Incidence::from_degrees(theta, 0.0).unwrap()
    }

    #[test]
    fn ridges_have_the_shadow_of_geometry() {
        // Slopes of 1/2 are all lit at 45 degrees. At tan(theta) = 6 light rises by 1/6 per unit of length: slopes away from
        // it are dark, and so are points of the others below the line to the next crest. A point at the horizontal
        // distance u from the foot has the height u / 2 and the crest at 2 + u: it is lit if u / 2 + (2 + u) / 6 > 1, which is u > 1 of 2.
        let theta = 6_f64.atan().to_degrees();
        let found = ShadowShares::of(&ridges(), Cells::Flat, &[light(45.0), light(theta)]).unwrap();
        assert_eq!(found[0].lit.estimate().mean, 1.0);
        // 128 points of which none is in the shadow: less than 3 / 128 is.
        let text = found[0].text();
        assert!(
            text.contains("lit 1 (> 1 - 2.3e-2, 95 %)")
                && text.contains("hidden 0 (< 2.3e-2, 95 %)"),
            "{text}"
        );
        assert_eq!((found[1].points, found[1].lost), (128, 0));
        assert_eq!(found[1].facing_away.estimate().mean, 0.5);
        // 128 points scatter by 0.038 at most
        assert!(
            (found[1].hidden.estimate().mean - 0.25).abs() < 0.06,
            "{found:?}"
        );
        assert!(
            (found[1].lit.estimate().mean - 0.25).abs() < 0.06,
            "{found:?}"
        );
    }

    #[test]
    fn both_cells_see_what_smith_expects() {
        let psd = Psd::gaussian(8.0, 16.0).unwrap();
        let synthesis = Synthesis::new(psd, [512, 512], [1.0, 1.0], false).unwrap();
        let field = synthesis.draw(5, 0).unwrap();
        let [flat, smooth] = [Cells::Flat, Cells::Smooth]
            .map(|cells| ShadowShares::of(&field, cells, &[light(60.0)]).unwrap()[0]);
        assert!(
            (flat.lit.estimate().mean - smooth.lit.estimate().mean).abs() < 0.01,
            "{flat:?}, {smooth:?}"
        );
        let sum = flat.lit.estimate().mean
            + flat.facing_away.estimate().mean
            + flat.hidden.estimate().mean;
        assert!((sum - 1.0).abs() < 1e-12);
        // 1024 patches of a correlation length that are lit or not scatter by 0.016 at most. Facets are 0.2 % flatter than
        // smooth cells, and points scatter by 7e-4
        let slopes = asperity_analysis::SlopeCovariance::isotropic(2.0).unwrap();
        let smith = asperity_analysis::smith_lit(&slopes, light(60.0).wi());
        assert!(
            (flat.lit.estimate().mean - smith).abs() < 0.04,
            "{flat:?}, Smith {smith}"
        );
    }
}
