//! Suggestion: the known name that an unknown one most likely stands for.

use strsim::osa_distance;

/// Names of other programs and of the literature, each line with the name here. The first name that is known where it is asked for counts.
const SYNONYMS: &[(&str, &str)] = &[
    // Commands
    ("trace", "run raytrace simulate"),
    ("render", "image picture show draw view"),
    (
        "inspect",
        "info stats statistics analyse analyze plot figure",
    ),
    ("generate", "create make new"),
    ("gonio", "brdf bsdf btdf scatter goniometer"),
    ("verify", "compare check validate test"),
    ("map", "sweep"),
    ("mesh", "convert export"),
    ("attenuation", "shadowing masking"),
    ("model", "eval"),
    // Flags, keys and sections
    ("eta", "n ior index refractive-index n2 int-ior"),
    ("kappa", "k extinction"),
    ("theta", "angle incidence aoi theta-i zenith polar"),
    ("sun-elevation", "elevation altitude solar-elevation"),
    ("sun-azimuth", "azimuth solar-azimuth"),
    ("samples", "spp"),
    ("phi", "phi-i azimuth"),
    ("rays", "n-rays nrays num-rays photons samples spp"),
    ("realisations", "surfaces ensemble repeats trials count"),
    ("smoothness", "s"),
    ("sigma", "rms sq rq rms-height height"),
    ("tau", "correlation-length corr-length cl acl"),
    ("size", "resolution res grid n nx pixels"),
    ("spacing", "dx pixel-size pitch cell-size"),
    ("wavelength", "lambda wl"),
    ("polarisation", "pol polarized polarised"),
    ("models", "model compare"),
    ("max-order", "bounces max-bounces depth max-depth order"),
    ("max-time", "time timeout time-limit"),
    ("mean-free-path", "mfp free-path sigma-t"),
    ("albedo", "ssa"),
    ("g", "asymmetry anisotropy"),
    ("reflectance", "rho diffuse reflectivity"),
    ("seed", "random-seed"),
    ("threads", "jobs cores cpus j workers"),
    ("engine", "device gpu cuda backend"),
    ("output", "out o outdir output-dir dir folder"),
    ("assume-unit", "units length-unit input-unit"),
    ("surface", "geometry heightmap height-map file input"),
    ("side", "hemisphere sides"),
    ("plot", "figure figures plots png"),
    ("no-plots", "figure figures plots plot png"),
    ("light", "source illumination incident"),
    ("material", "optics interface mat"),
    ("medium", "volume layer scattering"),
    ("run", "simulation sampling settings"),
    ("compare", "comparison models model"),
    // Values
    ("dielectric", "glass bk7 water"),
    ("conductor", "metal"),
    ("mirror", "specular perfect pec"),
    ("lambertian", "diffuse lambert matte"),
    // Models
    ("ggx", "trowbridge-reitz trowbridge smith-ggx ggx-smith gtr"),
    ("ggx-separable", "walter walter-ggx ggx-walter"),
    ("smith", "beckmann beckmann-smith smith-beckmann microfacet"),
    ("v-cavity", "cook-torrance torrance-sparrow v-groove"),
    ("heitz", "multiple-scattering random-walk smith-multiple"),
    ("oren-nayar", "diffuse lambert lambertian"),
];

/// Names of roughness in other programs, which is another quantity than any here.
const ROUGHNESS: [&str; 5] = ["alpha", "rough", "roughness", "alpha-x", "alpha-y"];

/// Sentence for who names roughness as other programs do.
#[must_use]
pub fn roughness_hint(given: &str) -> Option<String> {
    let is_roughness = ROUGHNESS.contains(&plain(given).as_str());
    let (smoothness, ggx) = match given.starts_with("--") {
        true => ("--smoothness", "--slopes ggx --ggx-alpha"),
        false => ("smoothness", "ggx_alpha with slopes = \"ggx\""),
    };
    is_roughness.then(|| {
        format!("; roughness is given as {smoothness}, s = 2 / alpha of Beckmann, or as {ggx}")
    })
}

/// A name without dashes in front, in small letters.
fn plain(name: &str) -> String {
    name.trim_start_matches('-')
        .to_lowercase()
        .replace('_', "-")
}

/// Fewest letters of a beginning that stands for a name.
const BEGINNING: usize = 3;

/// The one of `names` that `given` most likely stands for: the same but for case and underscores, that of another program, the one with few
/// letters changed, the one that it begins, the one that has it for a word, or the one that is its first word.
#[must_use]
pub fn suggestion<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    let given = plain(given);
    let length = given.chars().count();
    let named = |wanted: &str| names.iter().copied().find(|name| plain(name) == wanted);
    let synonym = || {
        let mut synonyms = SYNONYMS.iter();
        let is_given = |other: &str| other == given;
        synonyms.find_map(|(name, others)| named(name).filter(|_| others.split(' ').any(is_given)))
    };
    // A third of the letters, and one of two or three
    let most = (length / 3).clamp(1, 3);
    let near = || {
        let distances = names
            .iter()
            .map(|name| (osa_distance(&plain(name), &given), *name));
        let nearest = distances.filter(|(distance, _)| *distance <= most && length > 1);
        nearest
            .min_by_key(|(distance, _)| *distance)
            .map(|(_, name)| name)
    };
    let begun = || {
        let mut names = names.iter().copied();
        names.find(|name| length >= BEGINNING && plain(name).starts_with(&given))
    };
    let has_word = || {
        let mut names = names.iter().copied();
        names.find(|name| plain(name).split('-').any(|word| word == given))
    };
    // Words of two names in one, as of a model and its slopes: `heitz-beckmann`
    let first_word = || named(given.split_once('-')?.0);
    named(&given)
        .or_else(synonym)
        .or_else(near)
        .or_else(begun)
        .or_else(has_word)
        .or_else(first_word)
}

/// End of a sentence with the suggestion and all names: `; did you mean trace? The commands are ...`. `list` begins with a small letter.
#[must_use]
pub fn known_names(given: &str, names: &[&str], list: &str) -> String {
    let all = names.join(", ");
    match suggestion(given, names) {
        None => format!("; {list} {all}"),
        Some(name) => {
            let (first, rest) = list.split_at(1);
            format!(
                "; did you mean {name}? {}{rest} {all}",
                first.to_uppercase()
            )
        }
    }
}

/// End of a sentence with the suggestion: `; did you mean trace?`, or nothing.
pub(super) fn did_you_mean(given: &str, names: &[&str]) -> String {
    suggestion(given, names).map_or_else(String::new, |name| format!("; did you mean {name}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_by_synonym_distance_and_beginning() {
        let flags = [
            "eta",
            "kappa",
            "theta",
            "phi",
            "nu",
            "unit",
            "albedo",
            "arrangement",
            "max-order",
        ];
        for (given, expected) in [
            ("--n", Some("eta")),
            ("ior", Some("eta")),
            ("--angle", Some("theta")),
            ("tehta", Some("theta")),
            ("Max_Order", Some("max-order")),
            ("max-bounces", Some("max-order")),
            ("arr", Some("arrangement")),
            ("order", Some("max-order")),
            ("albedo-of-grains", Some("albedo")),
            ("q", None),
            ("frobnicate", None),
            ("", None),
        ] {
            assert_eq!(suggestion(given, &flags), expected, "{given}");
        }
        assert_eq!(
            did_you_mean("trce", &["render", "trace"]),
            "; did you mean trace?"
        );
        let materials = ["dielectric", "conductor"];
        assert_eq!(
            known_names("metal", &materials, "the materials are"),
            "; did you mean conductor? The materials are dielectric, conductor"
        );
        assert_eq!(
            known_names("x", &materials, "the materials are"),
            "; the materials are dielectric, conductor"
        );
    }

    /// A synonym of nothing known would never be found.
    #[test]
    fn synonyms_stand_for_names_that_exist() {
        use super::super::{Command, SECTIONS, settings_of};
        use asperity_analysis::MODEL_NAMES;
        let mut known: Vec<String> = MODEL_NAMES.iter().map(|&name| name.to_owned()).collect();
        known.extend(SECTIONS.iter().map(|section| section.name.to_owned()));
        for command in Command::ALL {
            known.push(command.name().to_owned());
            for setting in settings_of(command) {
                known.extend(setting.flag_name());
                known.extend(setting.kind.choices().iter().map(|c| c.name.to_owned()));
            }
        }
        for (name, _) in SYNONYMS {
            assert!(known.iter().any(|known| known == name), "{name}");
        }
    }
}
