//! Reading what commands work on.

use std::path::Path;

use asperity_experiment::{Incident, MaterialConfig, MaterialKind, Number, OneOrMany};
use asperity_io::{HeightMapFormat, read_height_map};
use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField, MissingPolicy};

use crate::args::{Common, FromArgument, Interface, Light, MaterialArgument, Reading};
use crate::failure::Failure;

/// A surface read from a file, and how many of its points had to be filled.
pub(crate) struct Input {
    pub(crate) field: HeightField,
    pub(crate) filled: usize,
}

/// Reads a height map, fills or refuses missing points, and removes form.
pub(crate) fn read_surface(
    path: &Path,
    reading: &Reading,
    common: &Common,
) -> Result<Input, Failure> {
    let raw = read_height_map(path).map_err(Failure::failed)?;
    let missing = raw.missing();
    let default_border =
        HeightMapFormat::from_path(path).map_or(Border::Periodic, HeightMapFormat::default_border);
    let field = raw
        .into_height_field(reading.missing, default_border)
        .map_err(|error| Failure::failed(format!("{}: {error}", path.display())))?;
    let filled = if reading.missing == MissingPolicy::Fill {
        missing
    } else {
        0
    };
    let border = reading.border.unwrap_or(field.border());
    let field = reading
        .remove
        .remove(field)
        .map_err(|error| Failure::failed(format!("{}: {error}", path.display())))?
        .with_border(border);
    common.say(|| {
        let [dx, dy] = field.spacing();
        format!(
            "{}: {} x {} samples, spacing {dx:e} x {dy:e} {}, {border} border, {filled} points filled",
            path.display(),
            field.nx(),
            field.ny(),
            field.unit(),
        )
    });
    Ok(Input { field, filled })
}

impl Interface {
    /// The material that the flags ask for.
    pub(crate) fn material(&self) -> Result<Material, Failure> {
        let config = MaterialConfig {
            kind: material_kind(self.material),
            eta: self.eta.map(|value| OneOrMany::One(Number(value))),
            kappa: self.kappa.map(Number),
        };
        config
            .materials()
            .map(|materials| materials[0])
            .map_err(Failure::usage)
    }
}

impl Light {
    /// The direction that the flags ask for.
    pub(crate) fn incidence(&self) -> Result<Incidence, Failure> {
        Incidence::from_degrees(self.theta, self.phi).map_err(Failure::usage)
    }
}

pub(crate) const fn material_kind(kind: MaterialArgument) -> MaterialKind {
    match kind {
        MaterialArgument::Dielectric => MaterialKind::Dielectric,
        MaterialArgument::Conductor => MaterialKind::Conductor,
        MaterialArgument::Mirror => MaterialKind::Mirror,
    }
}

pub(crate) const fn incident(from: FromArgument) -> Incident {
    match from {
        FromArgument::Above => Incident::Above,
        FromArgument::Below => Incident::Below,
    }
}

/// One value for both axes or one for each; more are refused.
pub(crate) fn per_axis<T: Copy>(values: &[T], flag: &str) -> Result<[T; 2], Failure> {
    match *values {
        [both] => Ok([both; 2]),
        [x, y] => Ok([x, y]),
        _ => Err(Failure::usage(format!(
            "{flag} got {} values; give one for both axes, or X,Y",
            values.len()
        ))),
    }
}

/// Samples along one axis as memory counts them.
pub(crate) fn samples(count: u64) -> Result<usize, Failure> {
    usize::try_from(count)
        .map_err(|_| Failure::usage(format!("{count} samples do not fit into memory")))
}

/// One value or several, as a configuration holds them.
pub(crate) fn one_or_many(values: &[f64]) -> OneOrMany<Number> {
    OneOrMany::Many(values.iter().map(|&value| Number(value)).collect())
}

/// The file's own name, for titles.
pub(crate) fn name_of(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}
