//! Reading what commands work on.

use std::path::Path;

use asperity_io::{
    HeightMapFormat, MeshData, MeshFormat, WriteProblem, read_height_map, read_mesh,
    write_height_map,
};
use asperity_simulate::{SimulateError, counted, short};
use asperity_studies::settings::{Command, Document};
use asperity_studies::{
    ASSUMED_BORDER, FilteringError, MeasuredConfig, SurfaceConfig, SurfaceFileError, VerifyError,
    border_notes,
};
use asperity_surface::{
    Border, Form, HeightField, LengthUnit, MissingError, MissingPolicy, RefinementError,
    StructureError, SynthesisError,
};
use asperity_tracer::{Geometry, MeshSurface, MeshSurfaceError};

use crate::common::Common;
use crate::failure::Failure;

/// A surface read from a file, and how many of its points had to be filled.
pub(crate) struct Input {
    pub(crate) field: HeightField,
    pub(crate) filled: usize,
    /// What a reader of the results should know about how the file was read.
    pub(crate) notes: Vec<String>,
}

/// Reads a height map, fills or refuses missing points, filters it and removes form.
pub(crate) fn read_surface(
    path: &Path,
    reading: &MeasuredConfig,
    common: &Common,
) -> Result<Input, Failure> {
    if is_mesh(path) {
        return Err(Failure::usage(format!(
            "{} names a triangle mesh, where a height map is needed; `asperity trace` takes meshes",
            path.display()
        )));
    }
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let raw = read_height_map(path).map_err(Failure::failed)?;
    let mut raw = reading
        .scaled(raw)
        .map_err(|error| Failure::usage(named(&error)))?;
    let mut notes = std::mem::take(&mut raw.notes);
    if !raw.spacing_is_known() {
        notes.push(
            "the file has no spacing: 1 is assumed; set it with --spacing and --assume-unit"
                .to_owned(),
        );
    }
    let missing = raw.missing();
    raw.border = reading.border.or(raw.border);
    let is_border_known = raw.border.is_some();
    let field = raw
        .into_height_field(reading.missing, ASSUMED_BORDER)
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
    let field = reading.filtered(field).map_err(|error| match error {
        FilteringError::Form(_) => Failure::failed(named(&error)),
        _ => Failure::usage(named(&error)),
    })?;
    let border = field.border();
    notes.extend(border_notes(&field, is_border_known));
    common.say(|| {
        let [dx, dy] = field.spacing().map(short);
        format!(
            "{}: {} x {} samples, spacing {dx} x {dy}{}, {border} border, {filled} points filled",
            path.display(),
            field.nx(),
            field.ny(),
            field.unit().suffix(),
        )
    });
    if filled > 0 {
        let were = if filled == 1 { "was" } else { "were" };
        let points = counted(filled as u64, "missing point");
        notes.push(format!("{points} {were} filled"));
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

/// Reads a triangle mesh, and the unit of its lengths; an open patch unless a border is given.
pub(crate) fn read_mesh_surface(
    path: &Path,
    reading: &MeasuredConfig,
    common: &Common,
) -> Result<(MeshSurface, LengthUnit), Failure> {
    for (given, flag) in [
        (reading.spacing.is_some(), "--spacing"),
        (reading.flip, "--flip"),
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
        mut vertices,
        triangles,
    } = read_mesh(path).map_err(Failure::failed)?;
    // No format of meshes states a unit
    let own = reading
        .unit_of_file(LengthUnit::Arbitrary)
        .map_err(|error| Failure::usage(format!("{}: {error}", path.display())))?;
    let unit = reading.unit.unwrap_or(own);
    if let Some(convert) = own.conversion(unit) {
        for coordinate in vertices.as_flattened_mut() {
            *coordinate = convert(*coordinate);
        }
    }
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
            "{}: {} vertices, {} triangles, extent {x} x {y} x {z}{}, {border} border",
            path.display(),
            mesh.vertex_count(),
            mesh.facet_count(),
            unit.suffix(),
        )
    });
    Ok((mesh, unit))
}

/// The file of a given surface, which `command` needs.
pub(crate) fn required_file(measured: &MeasuredConfig, command: Command) -> Result<&Path, Failure> {
    let mut files = measured.files();
    files
        .next()
        .ok_or_else(|| Failure::usage(format!("{command} needs FILE, a height map")))
}

/// Samples along one axis as memory counts them.
pub(crate) fn samples(count: u64) -> Result<usize, Failure> {
    usize::try_from(count)
        .map_err(|_| Failure::usage(format!("{count} samples do not fit into memory")))
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
    write_height_map(path, field).map_err(|error| match error.problem {
        WriteProblem::NoUnit => Failure::usage(error),
        _ => Failure::failed(error),
    })?;
    let [dx, dy] = field.spacing();
    let plain = dx == 1.0 && dy == 1.0 && field.unit() == LengthUnit::Arbitrary;
    let bare = HeightMapFormat::from_path(path) == Some(HeightMapFormat::Npy);
    Ok(
        (bare && !(plain && field.border() == ASSUMED_BORDER)).then(|| {
            format!(
                "NPY holds heights alone: read them with --spacing {dx},{dy}{} --border {}",
                match field.unit() {
                    LengthUnit::Arbitrary => String::new(),
                    unit => format!(" --assume-unit {unit}"),
                },
                field.border()
            )
        }),
    )
}

/// Reads the files that random surfaces are described by, and returns what a reader should know of them. A name that stands for neither a
/// file nor a choice is wrong usage.
pub(crate) fn read_surface_files(surface: &mut SurfaceConfig) -> Result<Vec<String>, Failure> {
    surface.read_files().map_err(|error| match error {
        SurfaceFileError::Unknown { .. } => Failure::usage(error),
        _ => Failure::failed(error),
    })
}

/// The sentence for surfaces that are refused, with the flag that insists on them.
/// Lengths of random surfaces are in `unit`.
pub(crate) fn refuse_surface(unit: LengthUnit, error: SynthesisError) -> Failure {
    match error {
        SynthesisError::Unresolved { .. }
        | SynthesisError::UnresolvedWaves { .. }
        | SynthesisError::TooSmallTile { .. }
        | SynthesisError::Structure(StructureError::Unresolved { .. })
        | SynthesisError::Unreachable(_) => {
            let sentence = error.in_unit(unit);
            Failure::usage(format!("{sentence} with --insist"))
        }
        _ => Failure::usage(error),
    }
}

/// The sentence for a simulation that is refused or that failed, with the flag that it is about.
/// Lengths of random surfaces are in `unit`.
pub(crate) fn refuse_simulation(unit: LengthUnit, error: SimulateError) -> Failure {
    match error {
        SimulateError::Synthesis(error) => refuse_surface(unit, error),
        SimulateError::Refinement(RefinementError::Open) | SimulateError::SmoothRefinement => {
            Failure::usage(format!("--refine: {error}"))
        }
        error if error.is_usage() => Failure::usage(error),
        error => Failure::failed(error),
    }
}

/// The sentence for a verification that is refused.
pub(crate) fn refuse_verification(document: &Document, error: VerifyError) -> Failure {
    match error {
        VerifyError::Simulate(error) => refuse_simulation(document.own_unit(), error),
        error if error.is_usage() => refuse_config(document, &error),
        error => Failure::failed(error),
    }
}

/// The refusal of a configuration: by the name of its file, where no flag has changed it.
pub(crate) fn refuse_config(document: &Document, error: &dyn std::fmt::Display) -> Failure {
    match document.file_to_blame() {
        Some(file) => Failure::usage(format!("{file}: {error}")),
        None => Failure::usage(error),
    }
}
