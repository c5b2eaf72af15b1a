//! Sun: the direction towards the light as maps state it, by elevation and compass azimuth.

use serde::{Deserialize, Serialize};

use crate::config::values::{Number, OneOrMany};

/// Directions towards the sun, in place of polar angles and azimuths. Both are given, or none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SunConfig {
    /// Angles above the horizon, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun_elevation: Option<OneOrMany<Number>>,
    /// Clockwise from north, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun_azimuth: Option<OneOrMany<Number>>,
}

impl SunConfig {
    /// Polar angles and azimuths of the sun, degrees, which are taken out; `None` if it is not given.
    ///
    /// East is along +x. North is along +y where `y_is_north`, and along -y otherwise.
    pub(crate) fn take(&mut self, y_is_north: bool) -> Option<[OneOrMany<Number>; 2]> {
        let Self {
            sun_elevation,
            sun_azimuth,
        } = std::mem::take(self);
        let phi = |compass: f64| match y_is_north {
            true => 90.0 - compass,
            false => compass - 90.0,
        };
        Some([
            sun_elevation?.map(|elevation| Number(90.0 - elevation.0)),
            sun_azimuth?.map(|compass| Number(phi(compass.0).rem_euclid(360.0))),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compass_directions_turn_clockwise_from_north() {
        let one = |value| Some(OneOrMany::One(Number(value)));
        let sun = |elevation, compass, y_is_north| {
            let mut config = SunConfig {
                sun_elevation: one(elevation),
                sun_azimuth: one(compass),
            };
            let [theta, phi] = config.take(y_is_north).unwrap();
            assert_eq!(config.take(y_is_north), None);
            [theta, phi].map(|angle| angle.as_slice()[0].0)
        };
        // North, east, south and west, where y points north and where rows go from north to south.
        for (compass, north_up, north_first) in [
            (0.0, 90.0, 270.0),
            (90.0, 0.0, 0.0),
            (180.0, 270.0, 90.0),
            (270.0, 180.0, 180.0),
        ] {
            assert_eq!(sun(30.0, compass, true), [60.0, north_up]);
            assert_eq!(sun(90.0, compass, false), [0.0, north_first]);
        }
        assert_eq!(SunConfig::default().take(true), None);
    }
}
