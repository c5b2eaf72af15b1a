//! `[light]` and `[view]`: directions.

use asperity_surface::LengthUnit;

use super::choices::{AZIMUTH, FROM};
use super::{
    ATTENUATION, CONVERGE, DEGREES, GONIO, INSPECT, MODEL, RENDER, SWEEPS, TRACE, TRACING, VERIFY,
};
use crate::settings::command::Commands;
use crate::settings::kind::Kind;
use crate::settings::range::Range;
use crate::settings::setting::{Arity, Flag, Setting, setting};

const COMMANDS: Commands = TRACING.and(CONVERGE).and(ATTENUATION).and(MODEL);
const POLAR: Range = Range::FromBelow(0.0, 90.0);

pub(super) const LIGHT: &[Setting] = &[
    setting(
        "light",
        "theta",
        Kind::Number,
        COMMANDS,
        "Polar angle of the direction towards the light",
    )
    .unit(DEGREES)
    .range(POLAR)
    .arity(Arity::ListIn(SWEEPS.and(ATTENUATION)))
    .default("30")
    .default_in(&[
        (GONIO, Some("0,15,30,45,60,75")),
        (ATTENUATION, Some("0,15,30,45,60,75,85")),
    ])
    .default_yields()
    .excludes(&["light.directions"])
    .clears(&["output.over_sigma_at_theta"]),
    setting(
        "light",
        "phi",
        Kind::Number,
        COMMANDS,
        "Azimuth of the direction towards the light",
    )
    .unit(DEGREES)
    .arity(Arity::ListIn(GONIO))
    .default("0")
    .default_yields()
    .excludes(&["light.directions"]),
    setting(
        "light",
        "theta",
        Kind::Number,
        INSPECT,
        "Polar angle towards a light whose shadow is measured",
    )
    .unit(DEGREES)
    .range(POLAR)
    .arity(Arity::ListIn(INSPECT))
    .otherwise("no shadow is measured")
    .flag_only(),
    setting(
        "light",
        "phi",
        Kind::Number,
        INSPECT,
        "Azimuth of the direction towards the light",
    )
    .unit(DEGREES)
    .default("0")
    .flag_only(),
    setting(
        "light",
        "directions",
        Kind::Grid,
        GONIO,
        "Centres of the bins of a hemisphere, in place of theta and phi",
    )
    .value_name("THETAxPHI")
    .excludes(&["light.theta", "light.phi"]),
    setting(
        "light",
        "azimuth",
        AZIMUTH,
        TRACING.and(CONVERGE),
        "Azimuth of each ray",
    )
    .flag(Flag::Named("light-azimuth"))
    .default_in(&[(TRACE, Some("fixed"))])
    .otherwise("random where surfaces are random and isotropic"),
    setting(
        "light",
        "from",
        FROM,
        TRACING.and(CONVERGE),
        "The side that light comes from",
    )
    .default("above"),
    setting(
        "light",
        "wavelength",
        Kind::LengthIn(LengthUnit::Nanometre),
        TRACE.and(VERIFY).and(GONIO),
        "Wavelength against which the lengths of the surface are judged",
    )
    .unit("nm")
    .range(Range::FromTo(1e-3, 1e12))
    .otherwise("550 where the unit of the surface is known"),
    setting(
        "light",
        "stokes",
        Kind::Number,
        TRACE,
        "Stokes vector of the incident light",
    )
    .arity(Arity::ListIn(TRACE))
    .value_name("I,Q,U,V")
    .otherwise("unpolarised"),
];

pub(super) const VIEW: &[Setting] = &[
    setting(
        "view",
        "theta",
        Kind::Number,
        ATTENUATION.and(RENDER),
        "Polar angle of the direction towards the viewer",
    )
    .flag(Flag::Named("view-theta"))
    .unit(DEGREES)
    .range(POLAR)
    .arity(Arity::ListIn(ATTENUATION))
    .default("0")
    .default_in(&[(RENDER, Some("50"))]),
    setting(
        "view",
        "phi",
        Kind::Number,
        ATTENUATION.and(RENDER),
        "Azimuth of the direction towards the viewer",
    )
    .flag(Flag::Named("view-phi"))
    .unit(DEGREES)
    .default("0")
    .default_in(&[(RENDER, Some("270"))]),
];
