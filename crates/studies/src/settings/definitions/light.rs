//! `[light]`, `[view]` and the light of a shadow: directions.

use asperity_surface::LengthUnit;

use super::choices::{AZIMUTH, DIRECTIONS, FROM, FROM_EITHER};
use super::commands::{
    ALBEDO, ATTENUATION, CONVERGE, DEGREES, GONIO, INSPECT, MAP, MODEL, RENDER, SWEEPS, TRACE,
    TRACING, VERIFY,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, basic, flags, setting, table};

const COMMANDS: Commands = TRACING.and(CONVERGE).and(ATTENUATION).and(MODEL);
const POLAR: Range = Range::FromBelow(0.0, 90.0);

/// Direction of the sun, of which the azimuth is that of a compass.
pub(super) const SUN_ELEVATION: Setting = setting("sun_elevation", Kind::Number)
    .help("Elevation of the sun above the horizon, in place of theta and phi")
    .unit(DEGREES)
    .range(Range::AboveTo(0.0, 90.0))
    .otherwise("not given");
pub(super) const SUN_AZIMUTH: Setting = setting("sun_azimuth", Kind::Number)
    .help("Compass azimuth of the sun, clockwise from north, the first row")
    .unit(DEGREES)
    .otherwise("not given");

/// Wavelength in vacuum.
pub(super) const WAVELENGTH: Setting = basic("wavelength", Kind::LengthIn(LengthUnit::Nanometre))
    .unit("nm")
    .range(Range::FromTo(1e-3, 1e12));

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
        setting("directions", DIRECTIONS)
            .help("Centres of parts of a hemisphere, in place of theta and phi")
            .commands(GONIO)
            .value_name("klems|THETAxPHI"),
        SUN_ELEVATION
            .commands(TRACE.and(GONIO))
            .arity(Arity::ListIn(GONIO)),
        SUN_AZIMUTH
            .commands(TRACE.and(GONIO))
            .arity(Arity::ListIn(GONIO)),
        setting("azimuth", AZIMUTH)
            .help("Azimuth of each ray")
            .commands(TRACING.and(CONVERGE))
            .flag(Flag::Named("light-azimuth"))
            .default_in(&[(TRACE, Some("fixed"))])
            .otherwise("random where surfaces are random and isotropic"),
        setting("from", FROM)
            .help("The side that light comes from")
            .commands(MAP.and(CONVERGE))
            .default("above"),
        setting("from", FROM_EITHER)
            .help("The side that light comes from")
            .commands(TRACE.and(VERIFY).and(GONIO))
            .default("above"),
        setting("spread", Kind::Spread)
            .help("Directions that light comes from about theta and phi")
            .commands(TRACE.and(VERIFY).and(GONIO))
            .flag(Flag::Named("light-spread"))
            .value_name("klems|CONE|THETAxPHI")
            .unit(DEGREES)
            .otherwise("one direction"),
        WAVELENGTH
            .help("Wavelength of named materials, and to judge lengths against")
            .commands(TRACING.and(ALBEDO).and(CONVERGE).and(MODEL).and(RENDER))
            .arity(Arity::ListIn(
                TRACING.and(ALBEDO).and(CONVERGE).and(MODEL).and(RENDER),
            ))
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
        SUN_ELEVATION.arity(Arity::ListIn(INSPECT)),
        SUN_AZIMUTH,
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
