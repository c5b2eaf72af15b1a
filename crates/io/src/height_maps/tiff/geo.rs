//! Tags of GeoTIFF 1.1: spacing and units of a grid, in metres.
//!
//! The place on the map is ignored, as is the vertical datum. The first row is that of the north, in whichever order rows are stored; a grid
//! that is turned on the map is read as it is stored, with a note. A grid in degrees is refused, since its spacing is no length. Units are those that the keys state, else those of the coordinate systems that they name
//! by EPSG codes.

use std::io::{Read, Seek};

use asperity_numerics::elementary::{atan2, hypot};
use asperity_surface::LengthUnit;

use super::directory::{Directory, File, Tag};
use super::epsg;
use super::lengths::{HeightScale, Lengths};
use crate::error::ReadProblem;
use crate::text_lines::short;

/// Keys of the directory of GeoTIFF.
const MODEL_TYPE: u64 = 1024;
const PROJECTED_SYSTEM: u64 = 3072;
const LINEAR_UNIT: u64 = 3076;
/// Metres in a unit that has no code.
const LINEAR_UNIT_SIZE: u64 = 3077;
const VERTICAL_SYSTEM: u64 = 4096;
const VERTICAL_UNIT: u64 = 4099;

/// Values of [`MODEL_TYPE`] other than 1, a projected grid.
const GEOGRAPHIC: f64 = 2.0;
const GEOCENTRIC: f64 = 3.0;

/// Codes of what is not defined, or defined by other keys.
const NO_CODES: [u64; 2] = [0, 32767];

/// Largest cosine between the axes of a grid that counts as rectangular.
const MAX_SHEAR: f64 = 1e-6;

/// The lengths of a grid with a spacing; `metres`: those in the unit of heights, if GDAL's metadata state it.
pub(super) fn lengths<R: Read + Seek>(
    file: &mut File<R>,
    page: &Directory,
    metres: Option<f64>,
) -> Result<Option<Lengths>, ReadProblem> {
    let grid = grid(file, page)?;
    let keys = GeoKeys::read(file, page)?;
    let model = keys.value(MODEL_TYPE);
    if model == Some(GEOGRAPHIC) {
        return Err(ReadProblem::unsupported(
            "its grid is in degrees; bring it to a grid in metres first (gdalwarp -t_srs)",
        ));
    }
    if model == Some(GEOCENTRIC) {
        return Err(ReadProblem::unsupported(
            "its coordinates are geocentric, but a projected grid is needed",
        ));
    }
    let Some(axes) = grid else {
        return Ok(None);
    };
    let spacing = axes.spacing;
    let (system, vertical) = (keys.code(PROJECTED_SYSTEM), keys.code(VERTICAL_SYSTEM));
    if model.is_none() && system.is_none() && metres.is_none() {
        return Ok(Some(Lengths {
            spacing: Some(spacing),
            turned_back: axes.turned_back,
            notes: axes.note.into_iter().collect(),
            ..Lengths::default()
        }));
    }
    // A compound system in place of a projected one is of both kinds
    let vertical = vertical.or(system);
    let of_system = |kind, system: Option<u64>| epsg::metres_of(kind, system?);
    let size = keys.value(LINEAR_UNIT_SIZE).filter(|size| *size > 0.0);
    let grid = match keys.unit(LINEAR_UNIT)? {
        None => size.or_else(|| of_system("projected", system)),
        unit => unit,
    };
    let heights = match metres {
        None => keys.unit(VERTICAL_UNIT)?,
        metres => metres,
    };
    let heights = heights
        .or_else(|| of_system("vertical", vertical))
        .or_else(|| of_system("depth", vertical));

    let mut notes: Vec<String> = axes.note.into_iter().collect();
    let mut missing = Vec::new();
    let mut name = match (grid, system) {
        (None, None) => page.text(file, Tag::GeoAsciiParams)?,
        _ => None,
    };
    for (what, metres, system) in [
        ("its grid", grid, system),
        ("its heights", heights, keys.code(VERTICAL_SYSTEM)),
    ] {
        if metres.is_none() {
            let system = system.map(|code| format!(" (system EPSG:{code}, which is not known)"));
            let called = name
                .take()
                .map(|name| format!(" (called `{}`)", short(&name)));
            missing.push(format!("{what}{}", system.or(called).unwrap_or_default()));
        }
    }
    if !missing.is_empty() {
        let others = grid.filter(|grid| *grid != 1.0 && heights.is_none());
        let others = others.map(|grid| format!(", though its grid is in units of {grid:.4} m"));
        notes.push(format!(
            "the file states no unit for {}; metres are assumed{}",
            missing.join(" and "),
            others.unwrap_or_default()
        ));
    }
    if let Some(code) = vertical.filter(|code| epsg::metres_of("depth", *code).is_some()) {
        notes.push(format!(
            "the vertical system EPSG:{code} counts downwards, but heights are read as they are stored"
        ));
    }
    Ok(Some(Lengths {
        spacing: Some(spacing.map(|step| step * grid.unwrap_or(1.0))),
        unit: LengthUnit::Metre,
        heights: HeightScale {
            factor: heights.unwrap_or(1.0),
            ..HeightScale::default()
        },
        turned_back: axes.turned_back,
        notes,
    }))
}

/// Axes of a grid on the map.
struct Axes {
    /// `[dx, dy]`.
    spacing: [f64; 2],
    /// Rows and columns that run north and west.
    turned_back: [bool; 2],
    /// Note on a grid that is turned.
    note: Option<String>,
}

/// Axes from the scale of pixels, whose rows run south, or from the matrix that brings pixels to the map.
fn grid<R: Read + Seek>(file: &mut File<R>, page: &Directory) -> Result<Option<Axes>, ReadProblem> {
    if let Some(scale) = page.numbers(file, Tag::ModelPixelScale)? {
        let [dx, dy, ..] = scale[..] else {
            return Err(ReadProblem::malformed("its scale of pixels lacks numbers"));
        };
        return Ok(Some(Axes {
            spacing: [dx.abs(), dy.abs()],
            turned_back: [false; 2],
            note: None,
        }));
    }
    let Some(matrix) = page.numbers(file, Tag::ModelTransformation)? else {
        return Ok(None);
    };
    let [x_column, x_row, _, _, y_column, y_row, ..] = matrix[..] else {
        return Err(ReadProblem::malformed("its transformation lacks numbers"));
    };
    let [dx, dy] = [hypot(x_column, y_column), hypot(x_row, y_row)];
    let area = dx * dy;
    if (x_column * x_row + y_column * y_row).abs() > MAX_SHEAR * area {
        return Err(ReadProblem::unsupported(
            "the axes of its grid are not at right angles",
        ));
    }
    let is_along = y_column.abs() <= MAX_SHEAR * dx;
    // A mirrored map is put right by the order of its rows
    let is_mirrored = x_column * y_row > x_row * y_column;
    let turned_back = match is_along {
        true => [y_row > 0.0, x_column < 0.0],
        false => [is_mirrored, false],
    };
    let turn = atan2(y_column, x_column).to_degrees();
    Ok(Some(Axes {
        spacing: [dx, dy],
        turned_back,
        note: (!is_along).then(|| {
            format!("its rows run {turn:.1} deg counter-clockwise from east on the map, but azimuths count from the grid: north is its first row")
        }),
    }))
}

/// The directory of keys: four numbers each, key, location, count and value.
struct GeoKeys {
    entries: Vec<f64>,
    doubles: Vec<f64>,
}

impl GeoKeys {
    fn read<R: Read + Seek>(file: &mut File<R>, page: &Directory) -> Result<Self, ReadProblem> {
        let mut numbers = |tag| page.numbers(file, tag);
        Ok(Self {
            entries: numbers(Tag::GeoKeyDirectory)?.unwrap_or_default(),
            doubles: numbers(Tag::GeoDoubleParams)?.unwrap_or_default(),
        })
    }

    /// The number of a key: stated in place, location 0, or among those of double precision.
    fn value(&self, key: u64) -> Option<f64> {
        let (entries, _) = self.entries.as_chunks::<4>();
        // The first entry is the version
        let mut entries = entries.iter().skip(1);
        let [_, location, _, value] = entries.find(|[id, ..]| *id == key as f64)?;
        match *location as u64 {
            0 => Some(*value),
            at if at == Tag::GeoDoubleParams as u64 => self.doubles.get(*value as usize).copied(),
            _ => None,
        }
    }

    /// The code of a key, if it is one of EPSG's.
    fn code(&self, key: u64) -> Option<u64> {
        let code = self.value(key).map(|code| code as u64);
        code.filter(|code| !NO_CODES.contains(code))
    }

    /// Metres in the unit whose code a key states.
    fn unit(&self, key: u64) -> Result<Option<f64>, ReadProblem> {
        let known = |code| {
            epsg::metres_in(code).ok_or_else(|| {
                ReadProblem::unsupported(format_args!(
                    "its unit of length has the code {code}, but EPSG has no unit of length with it"
                ))
            })
        };
        self.code(key).map(known).transpose()
    }
}
