//! What lies below a surface, on the command line.

use asperity_experiment::parse_number;
use asperity_optics::{
    Bottom, Layer, Material, ParticipatingMedium, PhaseFunction, PhaseFunctionError,
};
use clap::{Args, ValueEnum};

use crate::failure::Failure;

/// A medium below the surface, and what it ends on; nothing unless a flag is given.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "A medium below the surface")]
pub(crate) struct MediumArguments {
    /// Mean distance between interactions of light with the medium, length units of the surface
    #[arg(long, value_parser = parse_number, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) mean_free_path: Option<f64>,
    /// Share of these interactions that scatters light, 0 to 1; the rest absorbs it
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) albedo: Option<f64>,
    /// Absorption coefficient, 1 / length, in place of --mean-free-path and --albedo [default: 0 beside --scattering]
    #[arg(long, value_parser = parse_number, value_name = "COEFFICIENT", allow_negative_numbers = true)]
    pub(crate) absorption: Option<f64>,
    /// Scattering coefficient, 1 / length [default: 0 beside --absorption]
    #[arg(long, value_parser = parse_number, value_name = "COEFFICIENT", allow_negative_numbers = true)]
    pub(crate) scattering: Option<f64>,
    /// Mean cosine of scattering by Henyey and Greenstein, between -1 and 1; forwards above zero
    #[arg(long, value_parser = parse_number, allow_negative_numbers = true)]
    pub(crate) g: Option<f64>,
    /// Where the medium scatters light to [default: henyey-greenstein with --g, isotropic without]
    #[arg(long, value_enum)]
    pub(crate) phase: Option<PhaseArgument>,
    /// Depth of the medium below the mean plane, length units; without end unless given
    #[arg(long, value_parser = parse_number, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) thickness: Option<f64>,
    /// What a medium of that --thickness ends on [default: interface]
    #[arg(long, value_enum)]
    pub(crate) bottom: Option<BottomArgument>,
    /// Index n_beyond / n_layer of a bottom that is an interface [default: 1/eta, the same beyond as above]
    #[arg(long, value_parser = parse_number, value_name = "ETA", allow_negative_numbers = true)]
    pub(crate) bottom_eta: Option<f64>,
    /// Share of the light that a Lambertian bottom reflects, 0 to 1 [default: 1]
    #[arg(long, value_parser = parse_number, value_name = "SHARE", allow_negative_numbers = true)]
    pub(crate) bottom_reflectance: Option<f64>,
}

/// The phase functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PhaseArgument {
    /// Evenly into all directions
    Isotropic,
    /// By the mean cosine --g
    HenyeyGreenstein,
    /// By particles far smaller than the wavelength
    Rayleigh,
}

/// The ends of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BottomArgument {
    /// Light leaves undeviated: the medium ends, its index goes on
    Open,
    /// Reflects and refracts, by --bottom-eta
    Interface,
    /// Takes all light
    Absorbing,
    /// Reflects all light
    Mirror,
    /// Reflects light into all directions, by --bottom-reflectance
    Lambertian,
}

impl MediumArguments {
    /// What lies below a surface of `material`; `None` if no flag is given.
    pub(crate) fn layer(&self, material: Material) -> Result<Option<Layer>, Failure> {
        let Some(medium) = self.medium()? else {
            return Ok(None);
        };
        let Material::Dielectric { eta } = material else {
            return Err(refuse(
                "no light enters a medium below a conductor or a mirror: take a dielectric",
            ));
        };
        let bottom = self.bottom(eta)?;
        let Some(thickness) = self.thickness else {
            return match self.first_given_of_bottom() {
                Some(flag) => Err(refuse(&format!(
                    "{flag} says what a layer ends on: give its --thickness too"
                ))),
                None => Ok(Some(Layer::half_space(medium))),
            };
        };
        Layer::slab(medium, thickness, bottom)
            .map(Some)
            .map_err(Failure::usage)
    }

    /// The medium, if there is any.
    fn medium(&self) -> Result<Option<ParticipatingMedium>, Failure> {
        let by_coefficients = self.absorption.is_some() || self.scattering.is_some();
        let by_path = self.mean_free_path.is_some() || self.albedo.is_some();
        if by_coefficients && by_path {
            return Err(refuse(
                "--absorption and --scattering stand for --mean-free-path and --albedo: give one pair or the other",
            ));
        }
        let phase = self.phase_function()?;
        if by_coefficients {
            let [absorption, scattering] =
                [self.absorption, self.scattering].map(|c| c.unwrap_or(0.0));
            return ParticipatingMedium::from_coefficients(absorption, scattering, phase)
                .map(Some)
                .map_err(Failure::usage);
        }
        match (self.mean_free_path, self.albedo) {
            (Some(path), Some(albedo)) => {
                ParticipatingMedium::from_mean_free_path(path, albedo, phase)
                    .map(Some)
                    .map_err(Failure::usage)
            }
            (Some(_), None) => Err(refuse(
                "--mean-free-path needs --albedo, the share of interactions that scatters light",
            )),
            (None, Some(_)) => Err(refuse(
                "--albedo needs --mean-free-path, the mean distance between interactions",
            )),
            (None, None) => match self.first_given_beside_medium() {
                Some(flag) => Err(refuse(&format!(
                    "{flag} belongs to a medium: give --mean-free-path and --albedo, or --absorption and --scattering, too"
                ))),
                None => Ok(None),
            },
        }
    }

    fn phase_function(&self) -> Result<PhaseFunction, Failure> {
        let henyey_greenstein = |g| {
            PhaseFunction::henyey_greenstein(g)
                .map_err(|error: PhaseFunctionError| Failure::usage(error))
        };
        match (self.phase, self.g) {
            (None | Some(PhaseArgument::Isotropic), None) => Ok(PhaseFunction::Isotropic),
            (None | Some(PhaseArgument::HenyeyGreenstein), Some(g)) => henyey_greenstein(g),
            (Some(PhaseArgument::Rayleigh), None) => Ok(PhaseFunction::Rayleigh),
            (Some(PhaseArgument::HenyeyGreenstein), None) => Err(refuse(
                "--phase henyey-greenstein needs --g, its mean cosine",
            )),
            (Some(PhaseArgument::Isotropic | PhaseArgument::Rayleigh), Some(_)) => Err(refuse(
                "--g is of --phase henyey-greenstein alone: leave out one of them",
            )),
        }
    }

    /// What a layer below a surface of index `eta` ends on.
    fn bottom(&self, eta: f64) -> Result<Bottom, Failure> {
        let kind = self.bottom.unwrap_or(BottomArgument::Interface);
        if self.bottom_eta.is_some() && kind != BottomArgument::Interface {
            return Err(refuse(
                "--bottom-eta is of --bottom interface alone: leave out one of them",
            ));
        }
        if self.bottom_reflectance.is_some() && kind != BottomArgument::Lambertian {
            return Err(refuse(
                "--bottom-reflectance is of --bottom lambertian alone: give that too",
            ));
        }
        Ok(match kind {
            BottomArgument::Open => Bottom::Open,
            BottomArgument::Interface => Bottom::Interface {
                eta: self.bottom_eta.unwrap_or(1.0 / eta),
            },
            BottomArgument::Absorbing => Bottom::Absorbing,
            BottomArgument::Mirror => Bottom::Mirror,
            BottomArgument::Lambertian => Bottom::Lambertian {
                reflectance: self.bottom_reflectance.unwrap_or(1.0),
            },
        })
    }

    /// The first flag given that means nothing without a medium.
    fn first_given_beside_medium(&self) -> Option<&'static str> {
        [
            (self.g.is_some(), "--g"),
            (self.phase.is_some(), "--phase"),
            (self.thickness.is_some(), "--thickness"),
        ]
        .into_iter()
        .find_map(|(given, flag)| given.then_some(flag))
        .or_else(|| self.first_given_of_bottom())
    }

    /// The first flag given that means nothing without a thickness.
    fn first_given_of_bottom(&self) -> Option<&'static str> {
        [
            (self.bottom.is_some(), "--bottom"),
            (self.bottom_eta.is_some(), "--bottom-eta"),
            (self.bottom_reflectance.is_some(), "--bottom-reflectance"),
        ]
        .into_iter()
        .find_map(|(given, flag)| given.then_some(flag))
    }
}

fn refuse(reason: &str) -> Failure {
    Failure::usage(reason)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Flags {
        #[command(flatten)]
        medium: MediumArguments,
    }

    const GLASS: Material = Material::Dielectric { eta: 1.5 };

    fn layer(flags: &str) -> Result<Option<Layer>, String> {
        layer_below(GLASS, flags)
    }

    fn layer_below(material: Material, flags: &str) -> Result<Option<Layer>, String> {
        let words = std::iter::once("asperity").chain(flags.split_whitespace());
        let flags = Flags::try_parse_from(words).map_err(|error| error.to_string())?;
        flags
            .medium
            .layer(material)
            .map_err(|failure| match failure {
                Failure::Usage(reason) | Failure::Failed(reason) => reason,
            })
    }

    #[test]
    fn no_flag_is_no_medium() {
        assert_eq!(layer(""), Ok(None));
    }

    #[test]
    fn both_ways_of_naming_a_medium_make_the_same() {
        let by_path = layer("--mean-free-path 0.5 --albedo 0.75 --g 0.3").unwrap();
        assert_eq!(
            by_path,
            layer("--absorption 0.5 --scattering 1.5 --g 0.3").unwrap()
        );
        assert_eq!(by_path.unwrap().end(), None);
        let absorbing = layer("--absorption 2").unwrap().unwrap().medium();
        assert_eq!((absorbing.extinction(), absorbing.albedo()), (2.0, 0.0));
    }

    #[test]
    fn phase_functions_go_by_their_name_or_by_g() {
        let phase = |flags: &str| {
            let layer = layer(&format!("--scattering 1 {flags}")).unwrap().unwrap();
            layer.medium().phase()
        };
        assert_eq!(phase(""), PhaseFunction::Isotropic);
        assert_eq!(phase("--phase rayleigh"), PhaseFunction::Rayleigh);
        let forwards = PhaseFunction::HenyeyGreenstein { g: 0.5 };
        assert_eq!(phase("--g 0.5"), forwards);
        assert_eq!(phase("--g 0.5 --phase henyey-greenstein"), forwards);
    }

    #[test]
    fn a_layer_ends_on_an_interface_to_what_is_above_unless_told_otherwise() {
        let bottom = |flags: &str| {
            let layer = layer(&format!("--scattering 1 --thickness 2 {flags}"));
            let slab = layer.unwrap().unwrap().end().unwrap();
            assert_eq!(slab.thickness, 2.0);
            slab.bottom
        };
        assert_eq!(bottom(""), Bottom::Interface { eta: 1.0 / 1.5 });
        assert_eq!(bottom("--bottom-eta 1.2"), Bottom::Interface { eta: 1.2 });
        assert_eq!(bottom("--bottom open"), Bottom::Open);
        assert_eq!(bottom("--bottom absorbing"), Bottom::Absorbing);
        assert_eq!(bottom("--bottom mirror"), Bottom::Mirror);
        let white = Bottom::Lambertian { reflectance: 1.0 };
        assert_eq!(bottom("--bottom lambertian"), white);
        let grey = Bottom::Lambertian { reflectance: 0.2 };
        assert_eq!(bottom("--bottom lambertian --bottom-reflectance 0.2"), grey);
    }

    #[test]
    fn contradictions_are_refused_in_one_sentence() {
        let path = "--mean-free-path 1 --albedo 0.9";
        for (flags, reason) in [
            ("--mean-free-path 1", "needs --albedo"),
            ("--albedo 0.9", "needs --mean-free-path"),
            (&format!("{path} --absorption 1"), "one pair or the other"),
            ("--mean-free-path -1 --albedo 0.9", "mean free path is -1"),
            ("--mean-free-path 1 --albedo 1.1", "albedo is 1.1"),
            ("--absorption -1", "absorption coefficient is -1"),
            ("--scattering -1", "scattering coefficient is -1"),
            (&format!("{path} --g 1"), "g is 1"),
            (
                &format!("{path} --g 0.5 --phase rayleigh"),
                "henyey-greenstein alone",
            ),
            (&format!("{path} --phase henyey-greenstein"), "needs --g"),
            ("--g 0.5", "--g belongs to a medium"),
            ("--phase rayleigh", "--phase belongs to a medium"),
            ("--thickness 1", "--thickness belongs to a medium"),
            ("--bottom open", "--bottom belongs to a medium"),
            (&format!("{path} --bottom open"), "give its --thickness"),
            (&format!("{path} --bottom-eta 1.2"), "give its --thickness"),
            (&format!("{path} --thickness 0"), "thickness is 0"),
            (
                &format!("{path} --thickness 1 --bottom-eta -1"),
                "eta is -1",
            ),
            (
                &format!("{path} --thickness 1 --bottom open --bottom-eta 1.2"),
                "interface alone",
            ),
            (
                &format!("{path} --thickness 1 --bottom-reflectance 0.2"),
                "lambertian alone",
            ),
            (
                &format!("{path} --thickness 1 --bottom lambertian --bottom-reflectance 2"),
                "reflectance is 2",
            ),
        ] {
            let refusal = layer(flags).unwrap_err();
            assert!(refusal.contains(reason), "{flags}: {refusal}");
        }
        assert!(
            layer_below(Material::Mirror, path)
                .unwrap_err()
                .contains("no light enters")
        );
    }
}
