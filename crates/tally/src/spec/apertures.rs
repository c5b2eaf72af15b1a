//! Apertures: narrow windows about one direction, for what instruments near the specular direction collect.

use std::f64::consts::PI;

use asperity_numerics::elementary::{acos, cos};
use serde::{Deserialize, Serialize};

use crate::Side;

/// Window about a direction in the plane of incidence, on the side towards which the light travels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aperture {
    /// Side on which it takes light.
    pub side: Side,
    /// Polar angle of its centre from +z, radians.
    pub theta: f64,
    /// Shape about the centre.
    pub shape: ApertureShape,
}

/// Shape of an aperture, by full and half angles in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ApertureShape {
    /// Directions within an angle of the centre; within `pi` all of the side.
    Cone {
        /// Largest angle to the centre.
        half_angle: f64,
    },
    /// Receptor of a collimating instrument whose source is not a point, as of a glossmeter.
    ///
    /// The image of the source lies in the middle of the receptor where the sample is a mirror. Light that deviates from the mirror direction
    /// by an offset counts by the part of the image, moved by the offset, that the receptor takes: a trapezoid in each of two angles, which is
    /// the convolution of both rectangles. Approximation: all points of the source give the distribution of deviations that its middle gives.
    Receptor {
        /// Full angles of source and receptor in the plane of incidence: the offset is that of the polar angle of the direction projected into
        /// that plane.
        in_plane: [f64; 2],
        /// Full angles of source and receptor across: the offset is the angle to the plane.
        across: [f64; 2],
    },
}

impl Aperture {
    /// All light of a side.
    #[must_use]
    pub const fn whole(side: Side) -> Self {
        Self::cone(side, side.index() as f64 * PI, PI)
    }

    /// Cone about the polar angle `theta`.
    #[must_use]
    pub const fn cone(side: Side, theta: f64, half_angle: f64) -> Self {
        let shape = ApertureShape::Cone { half_angle };
        Self { side, theta, shape }
    }
}

impl ApertureShape {
    /// Largest angle between the centre and a direction that counts.
    pub(crate) fn reach(self) -> f64 {
        match self {
            Self::Cone { half_angle } => half_angle,
            Self::Receptor { in_plane, across } => {
                let [along, across] = [in_plane, across].map(|[a, b]| (0.5 * (a + b)).min(PI));
                acos(cos(along) * cos(across))
            }
        }
    }
}

/// Part of an interval of width `source` that lies in one of width `receptor`, whose middles are `offset` apart.
pub(crate) fn part_taken(offset: f64, [source, receptor]: [f64; 2]) -> f64 {
    let overlap = (0.5 * (source + receptor) - offset.abs()).min(receptor);
    (overlap / source).clamp(0.0, 1.0)
}

/// The apertures of a tally, at most [`Apertures::MAX`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Aperture>", into = "Vec<Aperture>")]
pub struct Apertures {
    list: [Option<Aperture>; Self::MAX],
    len: usize,
}

impl Apertures {
    /// Most apertures of a tally.
    pub const MAX: usize = 8;

    /// Number of apertures.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Returns `true` if the list is empty.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// All apertures in order.
    pub fn iter(&self) -> impl Iterator<Item = Aperture> + use<> {
        self.list.into_iter().flatten()
    }

    /// Number of an aperture; `None` if it is not kept.
    #[must_use]
    pub fn position(&self, aperture: Aperture) -> Option<usize> {
        self.iter().position(|kept| kept == aperture)
    }
}

/// # Panics
/// If there are more than [`Apertures::MAX`].
impl FromIterator<Aperture> for Apertures {
    fn from_iter<I: IntoIterator<Item = Aperture>>(apertures: I) -> Self {
        let mut found = Self::default();
        for aperture in apertures {
            found.list[found.len] = Some(aperture);
            found.len += 1;
        }
        found
    }
}

impl TryFrom<Vec<Aperture>> for Apertures {
    type Error = String;

    fn try_from(list: Vec<Aperture>) -> Result<Self, String> {
        let count = list.len();
        let fits = count <= Self::MAX;
        fits.then(|| list.into_iter().collect())
            .ok_or_else(|| format!("{count} apertures; a tally has at most {}", Self::MAX))
    }
}

impl From<Apertures> for Vec<Aperture> {
    fn from(apertures: Apertures) -> Self {
        apertures.iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a source aperture, moved by an offset, that fall into the receptor aperture, counted.
    #[test]
    fn the_weight_is_the_part_of_the_source_that_enters_the_receptor() {
        for widths in [[0.75, 1.8], [2.5, 11.7], [2.0, 2.0], [3.0, 1.0]] {
            let [source, receptor] = widths;
            for k in 0..40 {
                let offset = 0.2 * f64::from(k) - 4.0;
                let points = 100_000;
                let inside = (0..points).filter(|i| {
                    let at = source * ((f64::from(*i) + 0.5) / f64::from(points) - 0.5) + offset;
                    at.abs() <= 0.5 * receptor
                });
                let counted = inside.count() as f64 / f64::from(points);
                let weight = part_taken(offset, widths);
                assert!((weight - counted).abs() < 2e-5, "{widths:?} {offset}");
            }
        }
    }

    #[test]
    fn lists_are_read_as_they_were_written_and_no_longer_than_a_tally_keeps_them() {
        let receptor = ApertureShape::Receptor {
            in_plane: [0.01, 0.03],
            across: [0.04, 0.06],
        };
        let cone = Aperture::cone(Side::Transmitted, 3.0, 0.02);
        let list = [
            Aperture::whole(Side::Reflected),
            Aperture {
                shape: receptor,
                ..cone
            },
            cone,
        ];
        let apertures: Apertures = list.into_iter().collect();
        let json = serde_json::to_string(&apertures).unwrap();
        assert_eq!(serde_json::from_str::<Apertures>(&json).unwrap(), apertures);
        assert_eq!(apertures.position(cone), Some(2));
        let nine = serde_json::to_string(&vec![cone; 9]).unwrap();
        let error = serde_json::from_str::<Apertures>(&nine).unwrap_err();
        assert!(error.to_string().contains("at most 8"), "{error}");
    }
}
