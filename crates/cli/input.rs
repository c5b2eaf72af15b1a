//! Reading what commands work on.

use std::path::Path;

use asperity_io::{
    HeightMapFormat, MeshData, MeshFormat, WriteError, read_height_map, read_mesh, read_text,
    write_height_map,
};
use asperity_optics::{Incidence, Material};
use asperity_studies::{
    ConfigError, Count, Incident, LightConfig, MaterialConfig, MaterialKind, Number, OneOrMany,
    PerAxis, RunConfig, SurfaceConfig,
};
use asperity_surface::{
    Border, Form, HeightField, LengthUnit, MissingError, MissingPolicy, SynthesisError,
};
use asperity_tracer::{Geometry, MeshSurface, MeshSurfaceError};

use crate::args::{
    Common, Ensemble, FromArgument, Interface, Light, MaterialArgument, RandomSurfaces, Rays,
    Reading, Substance,
};
use crate::failure::Failure;

/// A surface read from a file, and how many of its points had to be filled.
pub(crate) struct Input {
    pub(crate) field: HeightField,
    pub(crate) filled: usize,
    /// What a reader of the results should know about how the file was read.
    pub(crate) notes: Vec<String>,
}

/// Reads a height map, fills or refuses missing points, and removes form.
pub(crate) fn read_surface(
    path: &Path,
    reading: &Reading,
    common: &Common,
) -> Result<Input, Failure> {
    if is_mesh(path) {
        return Err(Failure::usage(format!(
            "{} names a triangle mesh, where a height map is needed; `asperity trace` takes meshes",
            path.display()
        )));
    }
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut raw = read_height_map(path).map_err(Failure::failed)?;
    if !reading.spacing.is_empty() {
        let spacing = per_axis(&reading.spacing, "--spacing")?;
        raw = raw.with_spacing(spacing).map_err(Failure::usage)?;
    }
    raw.unit = reading.unit.unwrap_or(raw.unit);
    let mut notes = Vec::new();
    if !raw.spacing_is_known() {
        notes.push(
            "the file says nothing of its spacing: 1 was assumed; --spacing and --unit say otherwise"
                .to_owned(),
        );
    }
    let missing = raw.missing();
    let default_border =
        HeightMapFormat::from_path(path).map_or(Border::Periodic, HeightMapFormat::default_border);
    let field = raw
        .into_height_field(reading.missing, default_border)
        .map_err(|error| match error {
            MissingError::Refused { .. } => {
                Failure::failed(format!("{}: `--missing fill` fills them", named(&error)))
            }
            _ => Failure::failed(named(&error)),
        })?;
    let filled = if reading.missing == MissingPolicy::Fill {
        missing
    } else {
        0
    };
    let border = reading.border.unwrap_or(field.border());
    let field = reading
        .remove
        .remove(field)
        .map_err(|error| Failure::failed(named(&error)))?
        .with_border(border);
    common.say(|| {
        let [dx, dy] = field.spacing();
        format!(
            "{}: {} x {} samples, spacing {dx} x {dy} {}, {border} border, {filled} points filled",
            path.display(),
            field.nx(),
            field.ny(),
            field.unit(),
        )
    });
    if filled > 0 {
        notes.push(format!("{filled} missing points were filled"));
    }
    Ok(Input {
        field,
        filled,
        notes,
    })
}

/// Whether a file is named as a triangle mesh.
pub(crate) fn is_mesh(path: &Path) -> bool {
    MeshFormat::from_path(path).is_some()
}

/// Reads a triangle mesh; an open patch unless a border is given.
pub(crate) fn read_mesh_surface(
    path: &Path,
    reading: &Reading,
    common: &Common,
) -> Result<MeshSurface, Failure> {
    for (given, flag) in [
        (!reading.spacing.is_empty(), "--spacing"),
        (reading.unit.is_some(), "--unit"),
        (reading.missing != MissingPolicy::Refuse, "--missing"),
        (reading.remove != Form::None, "--remove"),
    ] {
        if given {
            return Err(Failure::usage(format!(
                "{flag} is for height maps, but {} names a triangle mesh, which is traced as it is",
                path.display()
            )));
        }
    }
    let MeshData {
        vertices,
        triangles,
    } = read_mesh(path).map_err(Failure::failed)?;
    let border = reading.border.unwrap_or(Border::Open);
    let mesh = MeshSurface::new(&vertices, triangles, border).map_err(|error| {
        let advice = match error {
            MeshSurfaceError::NotPeriodic { .. }
            | MeshSurfaceError::Gaps { .. }
            | MeshSurfaceError::NotOneGround { .. } => ": `--border open` takes it as a patch",
            _ => "",
        };
        Failure::failed(format!("{}: {error}{advice}", path.display()))
    })?;
    common.say(|| {
        let [x, y, z] = mesh.size();
        format!(
            "{}: {} vertices, {} triangles, extent {x} x {y} x {z}, {border} border",
            path.display(),
            mesh.vertex_count(),
            mesh.facet_count(),
        )
    });
    Ok(mesh)
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

/// Refuses an output file whose ending stands for no format that height maps are written in.
pub(crate) fn check_height_map_output(path: &Path) -> Result<(), Failure> {
    match HeightMapFormat::from_path(path) {
        Some(format) if format.can_write() => Ok(()),
        _ => Err(Failure::usage(format!(
            "{}: a height map is written as .exr, .npy, .gsf, .x3p or .png",
            path.display()
        ))),
    }
}

/// Writes a height map; returns a note if the format cannot hold all that the surface is.
pub(crate) fn write_surface(path: &Path, field: &HeightField) -> Result<Option<String>, Failure> {
    write_height_map(path, field).map_err(|error| match error {
        WriteError::NoUnit { .. } => Failure::usage(error),
        _ => Failure::failed(error),
    })?;
    let [dx, dy] = field.spacing();
    let plain = dx == 1.0 && dy == 1.0 && field.unit() == LengthUnit::Arbitrary;
    let bare = HeightMapFormat::from_path(path) == Some(HeightMapFormat::Npy);
    Ok(
        (bare && !(plain && field.border() == Border::Periodic)).then(|| {
            format!(
                "NPY holds heights alone: read them with --spacing {dx},{dy} --unit {} --border {}",
                field.unit(),
                field.border()
            )
        }),
    )
}

/// The sentence for surfaces that are refused, with the flag that insists on them.
pub(crate) fn refuse_surface(error: SynthesisError) -> Failure {
    match error {
        SynthesisError::Unresolved { .. } | SynthesisError::TooSmallTile { .. } => {
            Failure::usage(format!("{error} with --insist"))
        }
        _ => Failure::usage(error),
    }
}

/// The configuration in the file, or the default of everything; `command` is who asks.
pub(crate) fn read_config<T: Default>(
    path: Option<&Path>,
    command: &str,
    from_toml: fn(&str) -> Result<T, ConfigError>,
) -> Result<T, Failure> {
    let Some(path) = path else {
        return Ok(T::default());
    };
    if is_mesh(path) {
        return Err(Failure::usage(format!(
            "{} names a triangle mesh, but `asperity {command}` draws its own surfaces and takes a configuration; `asperity trace` takes meshes",
            path.display()
        )));
    }
    let text = read_text(path).map_err(Failure::failed)?;
    from_toml(&text).map_err(|error| Failure::usage(format!("{}: {error}", path.display())))
}

/// The refusal of a configuration: by the name of its file, if that is wrong by itself in the same way
/// (`alone`), and otherwise as what the flags made of it.
pub(crate) fn refuse_config(
    file: Option<&Path>,
    alone: Option<&str>,
    error: &dyn std::fmt::Display,
) -> Failure {
    match file {
        Some(path) if alone == Some(&error.to_string()) => {
            Failure::usage(format!("{}: {error}", path.display()))
        }
        _ => Failure::usage(error),
    }
}

/// Puts the values of flags in the place of those of a file.
pub(crate) fn override_ensemble(
    (surface, material, light): (&mut SurfaceConfig, &mut MaterialConfig, &mut LightConfig),
    flags: &Ensemble,
) -> Result<(), Failure> {
    override_surfaces(surface, &flags.surfaces)?;
    override_material(material, &flags.substance);
    if !flags.theta.is_empty() {
        light.theta = one_or_many(&flags.theta);
    }
    if let Some(phi) = flags.phi {
        light.phi = Number(phi);
    }
    light.azimuth = flags.light_azimuth.map(Into::into).or(light.azimuth);
    if let Some(from) = flags.from {
        light.from = incident(from);
    }
    Ok(())
}

/// The same of random surfaces alone.
pub(crate) fn override_surfaces(
    surface: &mut SurfaceConfig,
    flags: &RandomSurfaces,
) -> Result<(), Failure> {
    if let Some(tau) = flags.tau {
        surface.tau = Number(tau);
    }
    surface.tau_y = flags.tau_y.map(Number).or(surface.tau_y);
    surface.azimuth = flags.azimuth.map_or(surface.azimuth, Number);
    if !flags.smoothness.is_empty() {
        surface.smoothness = Some(one_or_many(&flags.smoothness));
        surface.sigma = None;
    }
    if !flags.sigma.is_empty() {
        surface.sigma = Some(one_or_many(&flags.sigma));
        surface.smoothness = None;
    }
    if !flags.size.is_empty() {
        surface.size = PerAxis::Each(per_axis(&flags.size, "--size")?.map(Count));
    }
    if !flags.spacing.is_empty() {
        surface.spacing = PerAxis::Each(per_axis(&flags.spacing, "--spacing")?.map(Number));
    }
    surface.insist |= flags.insist;
    Ok(())
}

/// The same of what they are made of.
pub(crate) fn override_material(material: &mut MaterialConfig, flags: &Substance) {
    if let Some(kind) = flags.material {
        material.kind = material_kind(kind);
        // Indices of another material do not carry over.
        if kind == MaterialArgument::Mirror {
            material.eta = None;
        }
        if material.kind != MaterialKind::Conductor {
            material.kappa = None;
        }
    }
    if !flags.eta.is_empty() {
        material.eta = Some(one_or_many(&flags.eta));
    }
    if let Some(kappa) = flags.kappa {
        material.kappa = Some(Number(kappa));
    }
}

/// The same of how rays are followed and recorded.
pub(crate) fn override_rays(run: &mut RunConfig, flags: &Rays) {
    run.seed = flags.seed.unwrap_or(run.seed);
    run.bins = flags.bins.unwrap_or(run.bins);
    run.in_plane_half_width = flags
        .in_plane_half_width
        .map_or(run.in_plane_half_width, Number);
    run.side = flags.side.unwrap_or(run.side);
    run.branching = flags.branching.map_or(run.branching, Into::into);
    run.roulette = flags.roulette.map_or(run.roulette, Number);
    run.max_order = flags.max_order.unwrap_or(run.max_order);
    run.accelerator = flags.accelerator.unwrap_or(run.accelerator);
    run.sampling = flags.sampling.unwrap_or(run.sampling);
}
