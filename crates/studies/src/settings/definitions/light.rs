//! `[light]`, `[view]` and the light of a shadow: directions.

use asperity_surface::LengthUnit;

use super::choices::{AZIMUTH, FROM};
use super::commands::{
    ATTENUATION, CONVERGE, DEGREES, GONIO, INSPECT, MAP, MODEL, RENDER, SWEEPS, TRACE, TRACING,
    VERIFY,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, flags, setting, table};

const COMMANDS: Commands = TRACING.and(CONVERGE).and(ATTENUATION).and(MODEL);
const POLAR: Range = Range::FromBelow(0.0, 90.0);
/// Range of elevations.
pub(super) const ELEVATION: Range = Range::AboveTo(0.0, 90.0);
/// Help on compass azimuths.
pub(super) const COMPASS: &str = "Compass azimuth of the sun, clockwise from north, the first row";

pub(super) const LIGHT: &[Setting] = &table(
    "light",
    COMMANDS,
    [
        basic("theta", Kind::Number)
            .help("Polar angle of the direction towards the light")
            .unit(DEGREES)
            .range(POLAR)
            .arity(Arity::ListIn(SWEEPS.and(ATTENUATION).and(MODEL)))
            .default("30")
            .default_in(&[
                (GONIO, Some("0,15,30,45,60,75")),
                (ATTENUATION, Some("0,15,30,45,60,75,85")),
            ]),
        setting("phi", Kind::Number)
            .help("Azimuth of the direction towards the light")
            .basic(
                TRACE
                    .and(MAP)
                    .and(GONIO)
                    .and(CONVERGE)
                    .and(ATTENUATION)
                    .and(MODEL),
            )
            .unit(DEGREES)
            .arity(Arity::ListIn(GONIO.and(MODEL)))
            .default("0"),
        setting("directions", Kind::Grid)
            .help("Centres of the bins of a hemisphere, in place of theta and phi")
            .commands(GONIO)
            .value_name("THETAxPHI"),
        setting("sun_elevation", Kind::Number)
            .help("Elevation of the sun above the horizon, in place of theta and phi")
            .commands(TRACE.and(GONIO))
            .unit(DEGREES)
            .range(ELEVATION)
            .arity(Arity::ListIn(GONIO))
            .otherwise("not given"),
        setting("sun_azimuth", Kind::Number)
            .help(COMPASS)
            .commands(TRACE.and(GONIO))
            .unit(DEGREES)
            .arity(Arity::ListIn(GONIO))
            .otherwise("not given"),
        setting("azimuth", AZIMUTH)
            .help("Azimuth of each ray")
            .commands(TRACING.and(CONVERGE))
            .flag(Flag::Named("light-azimuth"))
            .default_in(&[(TRACE, Some("fixed"))])
            .otherwise("random where surfaces are random and isotropic"),
        setting("from", FROM)
            .help("The side that light comes from")
            .commands(TRACING.and(CONVERGE))
            .default("above"),
        setting("wavelength", Kind::LengthIn(LengthUnit::Nanometre))
            .help("Wavelength against which the lengths of the surface are judged")
            .commands(TRACING)
            .unit("nm")
            .range(Range::FromTo(1e-3, 1e12))
            .otherwise("550 where the unit of the surface is known"),
        setting("stokes", Kind::Number)
            .help("Stokes vector of the incident light")
            .commands(TRACE.and(VERIFY).and(GONIO))
            .arity(Arity::Tuple(&["I", "Q", "U", "V"]))
            .otherwise("unpolarised"),
    ],
);

pub(super) const SHADOW: &[Setting] = &flags(
    "shadow",
    INSPECT,
    [
        basic("theta", Kind::Number)
            .help("Polar angle towards a light whose shadow is measured")
            .unit(DEGREES)
            .range(POLAR)
            .arity(Arity::ListIn(INSPECT))
            .otherwise("no shadow is measured"),
        basic("phi", Kind::Number)
            .help("Azimuth of the direction towards the light")
            .unit(DEGREES)
            .default("0"),
        setting("sun_elevation", Kind::Number)
            .help("Elevation of the sun above the horizon, in place of theta and phi")
            .unit(DEGREES)
            .range(ELEVATION)
            .arity(Arity::ListIn(INSPECT))
            .otherwise("not given"),
        setting("sun_azimuth", Kind::Number)
            .help(COMPASS)
            .unit(DEGREES)
            .otherwise("not given"),
    ],
);

pub(super) const VIEW: &[Setting] = &table(
    "view",
    COMMANDS,
    [
        basic("theta", Kind::Number)
            .help("Polar angle of the direction towards the viewer")
            .commands(ATTENUATION.and(RENDER))
            .flag(Flag::Named("view-theta"))
            .unit(DEGREES)
            .range(POLAR)
            .arity(Arity::ListIn(ATTENUATION))
            .default("0")
            .default_in(&[(RENDER, Some("50"))]),
        basic("phi", Kind::Number)
            .help("Azimuth of the direction towards the viewer")
            .commands(ATTENUATION.and(RENDER))
            .flag(Flag::Named("view-phi"))
            .unit(DEGREES)
            .default("0")
            .default_in(&[(RENDER, Some("270"))]),
    ],
);
