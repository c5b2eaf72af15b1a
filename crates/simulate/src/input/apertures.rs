//! Apertures: windows of a case about the directions in which a flat sample would send its light.
//!
//! Of the side that reflects: a cone about the mirror direction, outside of which light counts as scattered (total integrated scatter, ISO 13696
//! and ASTM F1048), and the receptor of ISO 2813 at the angles of a glossmeter. Of the side that transmits: the cone of ASTM D1003, outside of
//! which light is haze, and a narrow one for clarity, about the direction of light that passes straight through.

use std::f64::consts::PI;

use asperity_numerics::elementary::{asin, sin};
use asperity_tally::{Aperture, ApertureShape, Apertures, Side};

use crate::input::case::Case;

/// Half angle of the cone of specular light, degrees.
pub const SPECULAR_DEG: f64 = 2.0;

/// Half angle of the cone of light that is no haze, degrees.
pub const STRAIGHT_DEG: f64 = 2.5;

/// Half angle of the cone of the centre for clarity, degrees.
pub const CLEAR_DEG: f64 = 0.5;

/// Angles of incidence of glossmeters, degrees, with the full angles of their receptors in the plane of incidence and across.
const GLOSS: [(f64, [f64; 2]); 3] = [
    (20.0, [1.80, 3.60]),
    (60.0, [4.40, 11.70]),
    (85.0, [4.00, 6.00]),
];

/// Full angles of the source of a glossmeter in the plane of incidence and across, degrees.
const GLOSS_SOURCE: [f64; 2] = [0.75, 2.5];

/// Largest difference of the index behind a sample from that in front of it where these are the same medium: products of quotients round.
const SAME_INDEX: f64 = 1e-9;

/// Largest difference from an angle of a glossmeter, degrees.
const ROUNDING_DEG: f64 = 1e-9;

/// Apertures of a case, by what they are for.
///
/// # Examples
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_simulate::{Case, CaseApertures, Light, SurfaceSource};
/// use asperity_surface::HeightField;
///
/// let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0])?;
/// let light = Light::from_above(Incidence::from_degrees(60.0, 0.0)?);
/// let case = Case::new(SurfaceSource::height_field(field), Material::Mirror, light);
/// let apertures = CaseApertures::of(&case);
/// assert!(apertures.gloss.is_some() && apertures.straight.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaseApertures {
    /// All light of each side, without a control variate: what the light of the others is a part of.
    pub all: [Aperture; 2],
    /// Cone about the mirror direction of the mean plane.
    pub specular: Aperture,
    /// Receptor of a glossmeter.
    pub gloss: Option<Aperture>,
    /// Cone about the direction of light that passes a flat sample; `None` where none does.
    pub straight: Option<Aperture>,
    /// Narrow cone about that direction.
    pub clear: Option<Aperture>,
}

impl CaseApertures {
    /// The apertures of a case.
    #[must_use]
    pub fn of(case: &Case) -> Self {
        let incidence = case.light.incidence;
        let gloss = |&(theta_deg, receptor): &(f64, [f64; 2])| {
            let is_at = (incidence.theta_deg() - theta_deg).abs() <= ROUNDING_DEG;
            let full = |i: usize| [GLOSS_SOURCE[i], receptor[i]].map(f64::to_radians);
            is_at.then_some(Aperture {
                side: Side::Reflected,
                theta: incidence.theta(),
                shape: ApertureShape::Receptor {
                    in_plane: full(0),
                    across: full(1),
                },
            })
        };
        let straight = straight_theta(case);
        let through = |half_angle_deg: f64| {
            Some(Aperture::cone(
                Side::Transmitted,
                straight?,
                half_angle_deg.to_radians(),
            ))
        };
        Self {
            all: Side::BOTH.map(Aperture::whole),
            specular: Aperture::cone(
                Side::Reflected,
                incidence.theta(),
                SPECULAR_DEG.to_radians(),
            ),
            gloss: GLOSS.iter().find_map(gloss),
            straight: through(STRAIGHT_DEG),
            clear: through(CLEAR_DEG),
        }
    }

    /// All of them, as a tally keeps them.
    pub(crate) fn list(&self) -> Apertures {
        let [reflected, transmitted] = self.all;
        let of_reflected = [Some(reflected), Some(self.specular), self.gloss];
        let of_transmitted = [Some(transmitted), self.straight, self.clear];
        let all = of_reflected.into_iter().chain(of_transmitted);
        all.flatten().collect()
    }
}

impl Case {
    /// Index of the medium that light leaves into behind the sample, relative to that it comes from; `None` where none leaves.
    #[must_use]
    pub fn index_beyond(&self) -> Option<f64> {
        self.indices_behind()?.pop()
    }

    /// Returns `true` if light leaves behind the sample into a medium of the index that it comes from.
    #[must_use]
    pub fn passes_on(&self) -> bool {
        let index = self.index_beyond();
        index.is_some_and(|index| (index - 1.0).abs() < SAME_INDEX)
    }

    /// Indices of all media behind the first interface that the light meets, relative to that it comes from; `None` where it does not get to
    /// the last.
    fn indices_behind(&self) -> Option<Vec<f64>> {
        let (material, layers) = self.towards_light()?;
        let mut index = material.transmitting_index()?;
        let mut all = vec![index];
        for layer in &layers {
            if !layer.transmits() {
                return None;
            }
            if let Some(slab) = layer.end() {
                index *= slab.bottom.index_beyond()?;
                all.push(index);
            }
        }
        Some(all)
    }
}

/// Polar angle from +z of light that passes a flat sample, radians; `None` where it is totally reflected or stays inside.
fn straight_theta(case: &Case) -> Option<f64> {
    let sin_i = sin(case.light.incidence.theta());
    let indices = case.indices_behind()?;
    let index = *indices.last()?;
    let passes = indices.iter().all(|index| sin_i < *index);
    passes.then(|| {
        // The incident direction itself where the media are equal
        PI - match case.passes_on() {
            true => case.light.incidence.theta(),
            false => asin(sin_i / index),
        }
    })
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
    use asperity_surface::HeightField;

    use super::*;
    use crate::input::case::Light;
    use crate::input::surface_source::SurfaceSource;

    fn case(theta_deg: f64, eta: f64) -> Case {
        let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).unwrap();
        let light = Light::from_above(Incidence::from_degrees(theta_deg, 30.0).unwrap());
        let glass = Material::dielectric(eta).unwrap();
        Case::new(SurfaceSource::height_field(field), glass, light)
    }

    fn straight_deg(case: &Case) -> Option<f64> {
        let straight = CaseApertures::of(case).straight?;
        Some(180.0 - straight.theta.to_degrees())
    }

    #[test]
    fn light_passes_straight_through_a_slab_and_is_refracted_by_one_interface() {
        let near = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < 1e-9;
        assert!(near(
            straight_deg(&case(30.0, 1.5)),
            (1.0_f64 / 3.0).asin().to_degrees()
        ));
        assert!(near(straight_deg(&case(30.0, 1.0)), 30.0));
        assert_eq!(straight_deg(&case(60.0, 0.5)), None);
        let phase = PhaseFunction::Isotropic;
        let clear = ParticipatingMedium::from_coefficients(0.0, 0.0, phase).unwrap();
        for (bottom, expected) in [
            (Bottom::interface(1.0 / 1.5), Some(60.0)),
            (Bottom::MIRROR, None),
        ] {
            let layer = Layer::slab(clear, 3.0, bottom).unwrap();
            let slab = Case {
                layers: vec![layer],
                ..case(60.0, 1.5)
            };
            let found = straight_deg(&slab);
            assert_eq!(found.is_some(), expected.is_some());
            assert!(expected.is_none_or(|expected| near(found, expected)));
        }
    }

    #[test]
    fn gloss_is_kept_at_the_angles_of_glossmeters_alone() {
        for (theta, is_kept) in [(20.0, true), (60.0, true), (85.0, true), (60.1, false)] {
            let apertures = CaseApertures::of(&case(theta, 1.5));
            assert_eq!(apertures.gloss.is_some(), is_kept, "{theta}");
            assert_eq!(apertures.list().len(), 5 + usize::from(is_kept));
        }
    }
}
