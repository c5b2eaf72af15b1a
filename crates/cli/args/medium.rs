//! What lies below a surface, on the command line.

use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;

use asperity_optics::{Layer, Material};
use asperity_simulate::BottomSurface;
use asperity_studies::{
    BottomKind, Count, MediumConfig, Number, OneOrMany, PhaseKind, parse_count, parse_number,
};
use clap::{Args, ValueEnum};

use crate::failure::Failure;

/// A medium below the surface, and what it ends on; nothing unless a flag is given.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "A medium below the surface")]
pub(crate) struct MediumArguments {
    /// Mean distance between interactions of light with the medium, length units of the surface
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) mean_free_path: Vec<f64>,
    /// Share of these interactions that scatters light, 0 to 1; the rest absorbs it
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) albedo: Vec<f64>,
    /// Absorption coefficient, 1 / length, in place of --mean-free-path and --albedo [default: 0 beside --scattering]
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "COEFFICIENT", allow_negative_numbers = true)]
    pub(crate) absorption: Vec<f64>,
    /// Scattering coefficient, 1 / length [default: 0 beside --absorption]
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "COEFFICIENT", allow_negative_numbers = true)]
    pub(crate) scattering: Vec<f64>,
    /// Mean cosine of scattering by Henyey and Greenstein, between -1 and 1; forwards above zero
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub(crate) g: Vec<f64>,
    /// Where the medium scatters light to [default: henyey-greenstein with --g, isotropic without]
    #[arg(long, value_enum)]
    pub(crate) phase: Option<PhaseArgument>,
    /// Depth of the medium below the mean plane, length units; without end unless given
    #[arg(long, value_parser = parse_number, value_delimiter = ',', num_args = 1, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) thickness: Vec<f64>,
    /// What a medium of that --thickness ends on [default: interface]
    #[arg(long, value_enum)]
    pub(crate) bottom: Option<BottomArgument>,
    /// Index n_beyond / n_layer of a bottom that is an interface [default: 1/eta, the same beyond as above]
    #[arg(long, value_parser = parse_number, value_name = "ETA", allow_negative_numbers = true)]
    pub(crate) bottom_eta: Option<f64>,
    /// Share of the light that a Lambertian bottom reflects, 0 to 1 [default: 1]
    #[arg(long, value_parser = parse_number, value_name = "SHARE", allow_negative_numbers = true)]
    pub(crate) bottom_reflectance: Option<f64>,
    /// Shape of the bottom: flat, same (the surface above, moved down), independent (another one of its kind, where surfaces are drawn), or a file [default: flat]
    #[arg(long, value_name = "SHAPE")]
    pub(crate) bottom_surface: Option<BottomShapeArgument>,
    /// Scatterings inside the medium after which a path is truncated [default: 100000]
    #[arg(long, value_parser = parse_count, value_name = "COUNT", allow_negative_numbers = true)]
    pub(crate) max_scatterings: Option<u64>,
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

/// The shape of a bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum BottomShapeArgument {
    /// One that follows from the surface above.
    Named(BottomSurface),
    /// That of a file.
    File(PathBuf),
}

impl FromStr for BottomShapeArgument {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.parse() {
            Ok(shape) => Self::Named(shape),
            Err(_) => Self::File(text.into()),
        })
    }
}

impl MediumArguments {
    /// Whether any flag is given.
    pub(crate) fn is_given(&self) -> bool {
        self.names_medium()
            || !self.g.is_empty()
            || !self.thickness.is_empty()
            || self.phase.is_some()
            || self.bottom.is_some()
            || self.bottom_eta.is_some()
            || self.bottom_reflectance.is_some()
            || self.bottom_surface.is_some()
            || self.max_scatterings.is_some()
    }

    fn names_medium(&self) -> bool {
        [
            &self.mean_free_path,
            &self.albedo,
            &self.absorption,
            &self.scattering,
        ]
        .iter()
        .any(|values| !values.is_empty())
    }

    /// The medium of `file` with what the flags say in its place; `None` if neither says anything.
    pub(crate) fn over(&self, file: Option<MediumConfig>) -> Result<Option<MediumConfig>, Failure> {
        if !self.is_given() {
            return Ok(file);
        }
        if file.is_none() && !self.names_medium() {
            return Err(Failure::usage(
                "this belongs to a medium below the surface: give --mean-free-path and --albedo, or --absorption and --scattering, too",
            ));
        }
        let mut config = file.unwrap_or_default();
        // Either pair of names takes the place of the other.
        if !self.mean_free_path.is_empty() || !self.albedo.is_empty() {
            (config.absorption, config.scattering) = (None, None);
        }
        if !self.absorption.is_empty() || !self.scattering.is_empty() {
            (config.mean_free_path, config.albedo) = (None, None);
        }
        let several = |flag: &[f64], value: &mut Option<OneOrMany<Number>>| match flag {
            [] => {}
            [one] => *value = Some(OneOrMany::One(Number(*one))),
            many => *value = Some(OneOrMany::Many(many.iter().copied().map(Number).collect())),
        };
        several(&self.mean_free_path, &mut config.mean_free_path);
        several(&self.albedo, &mut config.albedo);
        several(&self.absorption, &mut config.absorption);
        several(&self.scattering, &mut config.scattering);
        several(&self.g, &mut config.g);
        several(&self.thickness, &mut config.thickness);
        config.phase = self.phase.map(Into::into).or(config.phase);
        config.bottom = self.bottom.map(Into::into).or(config.bottom);
        config.bottom_eta = self.bottom_eta.map(Number).or(config.bottom_eta);
        config.bottom_reflectance = self
            .bottom_reflectance
            .map(Number)
            .or(config.bottom_reflectance);
        if let Some(BottomShapeArgument::Named(shape)) = self.bottom_surface {
            config.bottom_surface = shape;
        }
        config.max_scatterings = self.max_scatterings.map_or(config.max_scatterings, Count);
        Ok(Some(config))
    }

    /// The file of the bottom, if one is given.
    pub(crate) fn bottom_file(&self) -> Option<&PathBuf> {
        match &self.bottom_surface {
            Some(BottomShapeArgument::File(path)) => Some(path),
            _ => None,
        }
    }

    /// The one layer below a surface of `material`; `None` if no flag is given.
    pub(crate) fn layer(&self, material: Material) -> Result<Option<Layer>, Failure> {
        let Some(config) = self.over(None)? else {
            return Ok(None);
        };
        if self.bottom_file().is_some() && self.thickness.is_empty() {
            return Err(Failure::usage(
                "--bottom-surface says something of the end of a layer: give its --thickness too",
            ));
        }
        match config.layers(material).map_err(Failure::usage)?.as_slice() {
            [layer] => Ok(Some(*layer)),
            layers => Err(Failure::usage(format!(
                "the flags name {} media; give one value each",
                layers.len()
            ))),
        }
    }
}

impl From<PhaseArgument> for PhaseKind {
    fn from(phase: PhaseArgument) -> Self {
        match phase {
            PhaseArgument::Isotropic => Self::Isotropic,
            PhaseArgument::HenyeyGreenstein => Self::HenyeyGreenstein,
            PhaseArgument::Rayleigh => Self::Rayleigh,
        }
    }
}

impl From<BottomArgument> for BottomKind {
    fn from(bottom: BottomArgument) -> Self {
        match bottom {
            BottomArgument::Open => Self::Open,
            BottomArgument::Interface => Self::Interface,
            BottomArgument::Absorbing => Self::Absorbing,
            BottomArgument::Mirror => Self::Mirror,
            BottomArgument::Lambertian => Self::Lambertian,
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, PhaseFunction};
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Flags {
        #[command(flatten)]
        medium: MediumArguments,
    }

    const GLASS: Material = Material::Dielectric { eta: 1.5 };

    fn layer(flags: &str) -> Result<Option<Layer>, String> {
        let words = std::iter::once("asperity").chain(flags.split_whitespace());
        let flags = Flags::try_parse_from(words).map_err(|error| error.to_string())?;
        flags.medium.layer(GLASS).map_err(|failure| match failure {
            Failure::Usage(reason) | Failure::Failed(reason) => reason,
        })
    }

    #[test]
    fn no_flag_is_no_medium() {
        assert_eq!(layer(""), Ok(None));
        assert!(!MediumArguments::default().is_given());
        for flag in [
            "--albedo 0.9",
            "--scattering 1",
            "--g 0.1",
            "--bottom-reflectance 0.5",
        ] {
            let words = std::iter::once("asperity").chain(flag.split(' '));
            assert!(
                Flags::try_parse_from(words).unwrap().medium.is_given(),
                "{flag}"
            );
        }
    }

    #[test]
    fn both_ways_of_naming_a_medium_make_the_same() {
        let by_path = layer("--mean-free-path 0.5 --albedo 0.75 --g 0.3").unwrap();
        let coefficients = layer("--absorption 0.5 --scattering 1.5 --g 0.3").unwrap();
        assert_eq!(by_path, coefficients);
        assert_eq!(by_path.unwrap().end(), None);
        let absorbing = layer("--absorption 2").unwrap().unwrap().medium();
        assert_eq!((absorbing.extinction(), absorbing.albedo()), (2.0, 0.0));
    }

    #[test]
    fn flags_take_the_place_of_what_a_file_says() {
        let file = MediumConfig {
            absorption: Some(OneOrMany::One(Number(1.0))),
            g: Some(OneOrMany::One(Number(0.5))),
            ..MediumConfig::default()
        };
        let words = "asperity --mean-free-path 2,3 --albedo 0.5";
        let flags = Flags::try_parse_from(words.split_whitespace()).unwrap();
        let config = flags.medium.over(Some(file)).unwrap().unwrap();
        let layers = config.layers(GLASS).unwrap();
        let paths: Vec<f64> = layers.iter().map(|l| l.medium().mean_free_path()).collect();
        assert_eq!(paths, [2.0, 3.0]);
        let phase = PhaseFunction::HenyeyGreenstein { g: 0.5 };
        assert_eq!(layers[0].medium().phase(), phase);
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
        let grey = Bottom::Lambertian { reflectance: 0.2 };
        assert_eq!(bottom("--bottom lambertian --bottom-reflectance 0.2"), grey);
    }

    #[test]
    fn flags_that_mean_nothing_alone_are_refused() {
        for (flags, reason) in [
            ("--g 0.5", "belongs to a medium"),
            ("--thickness 1", "belongs to a medium"),
            ("--bottom open", "belongs to a medium"),
            ("--mean-free-path 1,2 --albedo 0.5", "name 2 media"),
            ("--scattering 1 --bottom-surface a.npy", "--thickness too"),
        ] {
            let refusal = layer(flags).unwrap_err();
            assert!(refusal.contains(reason), "{flags}: {refusal}");
        }
    }
}
