//! Presets: what `gonio --for FORMAT` measures, so that the format can hold it.

use super::entry::Entry;

/// Formats, and the flags of each.
const PRESETS: [(&str, &[(&str, &str)]); 9] = [
    ("netcdf", &[("bins", "36x72")]),
    (
        "klems",
        &[
            ("directions", "klems"),
            ("from", "both"),
            ("light-spread", "klems"),
            ("bins", "36x72"),
        ],
    ),
    ("rgl", &[("theta", DENSE), (AZIMUTH, "random")]),
    ("rgl-rgb", &[("theta", DENSE), (AZIMUTH, "random")]),
    (
        "tensor-tree",
        &[("theta", DENSE), ("from", "both"), (AZIMUTH, "random")],
    ),
    (
        "pbsdf",
        &[
            ("theta", DENSE),
            ("polarisation", "mueller"),
            (AZIMUTH, "random"),
        ],
    ),
    ("zemax", &[("theta", EVEN), (AZIMUTH, "random")]),
    ("fit", &[("theta", "0,15,30,45,60"), (AZIMUTH, "random")]),
    ("ssdd", &[("theta", EVEN), (AZIMUTH, "random")]),
];
/// Polar angles of readers that interpolate between them, up to grazing ones.
const DENSE: &str = "0,10,20,30,38,45,51,57,62,66,70,74,77,80,83,86,88";
const EVEN: &str = "0,10,20,30,40,50,60,70,80";
const AZIMUTH: &str = "light-azimuth";

/// Flags for a format that do not contradict the values given. The mean over azimuths is that of given surfaces: random ones
/// choose it where they have no direction of their own.
pub(super) fn flags_for(
    format: &str,
    given: &[Entry],
    has_given_surface: bool,
) -> Vec<(String, Vec<String>)> {
    let gives = |names: &[&str]| {
        given
            .iter()
            .any(|entry| names.iter().any(|name| entry.is(name)))
    };
    let sun = ["light.sun_elevation", "light.sun_azimuth"];
    let has_directions = gives(&["light.directions"]) || gives(&sun);
    let is_free = |flag: &str| match flag {
        "theta" => !has_directions,
        "directions" => !has_directions && !gives(&["light.theta", "light.phi"]),
        AZIMUTH => has_given_surface && !has_directions && !gives(&["light.phi"]),
        _ => true,
    };
    let preset = PRESETS.iter().find(|(name, _)| *name == format);
    let flags = preset.map_or(&[][..], |(_, flags)| flags).iter();
    let flags = flags.filter(|(flag, _)| is_free(flag));
    flags
        .map(|(flag, value)| ((*flag).to_owned(), vec![(*value).to_owned()]))
        .collect()
}
