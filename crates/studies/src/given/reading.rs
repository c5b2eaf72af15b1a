//! Reading: given surfaces from files, in the requested unit, with missing points filled, without form, filtered and eroded.

use std::path::Path;

use asperity_io::{
    HeightMapFormat, MeshData, MeshFormat, SurfaceFormat, is_same_file, read_height_map, read_mesh,
    shown, shown_path,
};
use asperity_simulate::{Observer, counted, short};
use asperity_surface::{Border, Form, HeightField, LengthUnit, MissingPolicy};
use asperity_tracer::{Geometry, MeshSurface};

use super::border::{ASSUMED_BORDER, border_notes};
use super::error::{FileProblem, GivenError};
use super::surface::{GivenShape, GivenSurface, GivenSurfaces};
use crate::config::erosion::{ETCH, REPOSE};
use crate::config::filtering::{L_FILTER, S_FILTER};
use crate::config::measured::MeasuredConfig;
use crate::config::medium::MediumConfig;
use crate::settings::Document;

/// A height map that was read.
#[derive(Clone, Debug)]
pub struct ReadHeightMap {
    /// The heights.
    pub field: HeightField,
    /// `true` if +y is the north of a map, and -y otherwise.
    pub y_is_north: bool,
    /// Number of missing points that were filled.
    pub filled: usize,
    /// Notes for the user on how the file was read, one sentence each.
    pub notes: Vec<String>,
}

impl MeasuredConfig {
    /// The file of a height map, which the command of `document` needs.
    pub(crate) fn required_file(&self, document: &Document) -> Result<&Path, GivenError> {
        let no_file = GivenError::NoSurface {
            command: document.command(),
            needed: "FILE, a height map",
        };
        self.files().next().ok_or(no_file)
    }

    /// Reads the given surfaces that the command of `document` needs, and the bottom of the layer of `medium` if a file gives one.
    pub(crate) fn read_with_bottom(
        &self,
        medium: Option<&MediumConfig>,
        document: &Document,
        observer: &dyn Observer,
    ) -> Result<(GivenSurfaces, Option<GivenSurface>), GivenError> {
        let tops = self.read_surfaces(document.own_unit(), observer)?;
        let mut tops = tops.ok_or_else(|| GivenError::NoSurface {
            command: document.command(),
            needed: "a surface: FILE or --flat",
        })?;
        let bottom = medium.and_then(|medium| medium.bottom_surface.file());
        let bottom = bottom.map(|path| self.read_like(&tops.first, path, observer));
        let bottom = bottom.transpose()?;
        if let Some(bottom) = bottom.as_ref().filter(|_| tops.first.file.is_none()) {
            tops.first = tops.first.over(bottom);
        }
        Ok((tops, bottom))
    }

    /// Reads the given surfaces, if there are any. Lengths of the flat surface are in `unit`, those of all files in that of the first.
    /// Each file that is read is explained to `observer`.
    ///
    /// # Errors
    /// [`GivenError`] if a file cannot be read as requested, or two surfaces are the same.
    pub fn read_surfaces(
        &self,
        unit: LengthUnit,
        observer: &dyn Observer,
    ) -> Result<Option<GivenSurfaces>, GivenError> {
        let files: Vec<&Path> = self.files().collect();
        for (i, path) in files.iter().enumerate() {
            if files[..i].iter().any(|other| is_same_file(other, path)) {
                return Err(FileProblem::Twice.at(path));
            }
        }
        let (first, others) = match files.split_first() {
            Some((first, others)) => (self.read(first, observer)?, others),
            None if self.flat => (GivenSurface::flat(unit), &[][..]),
            None => return Ok(None),
        };
        let others = others.iter();
        let others = others.map(|path| self.read_like(&first, path, observer));
        let surfaces = GivenSurfaces {
            others: others.collect::<Result<_, _>>()?,
            first,
        };
        let all: Vec<&GivenSurface> = surfaces.iter().collect();
        for (i, one) in all.iter().enumerate() {
            if let Some(other) = all[..i].iter().find(|other| have_equal_heights(other, one)) {
                return Err(GivenError::SameHeights {
                    first: other.name.clone(),
                    second: one.name.clone(),
                });
            }
        }
        Ok(Some(surfaces))
    }

    /// Reads a further surface, or the bottom of a layer, with lengths in the unit of `surface`.
    ///
    /// # Errors
    /// [`GivenError`] if the file cannot be read as requested, or `surface` has no unit and the file has one.
    pub fn read_like(
        &self,
        surface: &GivenSurface,
        path: &Path,
        observer: &dyn Observer,
    ) -> Result<GivenSurface, GivenError> {
        let physical = Some(surface.unit).filter(|unit| *unit != LengthUnit::Arbitrary);
        let reading = Self {
            file: None,
            unit: physical.or(self.unit),
            ..self.clone()
        };
        let read = reading.read(path, observer)?;
        if read.unit == surface.unit || surface.file.is_none() {
            return Ok(read);
        }
        let problem = FileProblem::OtherUnit {
            unit: read.unit,
            other: surface.name.clone(),
        };
        Err(problem.at(path))
    }

    /// Reads a height map, fills or refuses missing points, filters it, removes form and erodes it.
    ///
    /// # Errors
    /// [`GivenError`] if the file holds no height map or cannot be read as requested.
    pub fn read_height_map(
        &self,
        path: &Path,
        observer: &dyn Observer,
    ) -> Result<ReadHeightMap, GivenError> {
        if MeshFormat::from_path(path).is_some() {
            return Err(FileProblem::Mesh.at(path));
        }
        if self.up.is_some() {
            return Err(FileProblem::ForMeshes("--up").at(path));
        }
        let raw = self.scaled(read_height_map(path)?);
        let mut raw = raw.map_err(|error| FileProblem::from(error).at(path))?;
        let mut notes = std::mem::take(&mut raw.notes);
        let spacing = raw.spacing_note();
        notes
            .extend(spacing.map(|note| format!("{note}; set it with --spacing and --assume-unit")));
        let is_text = HeightMapFormat::from_path(path) == Some(HeightMapFormat::Text);
        if is_text && raw.spacing_is_known() && raw.unit == LengthUnit::Arbitrary {
            notes.push(
                "the file states no unit: x, y and heights are taken to be in one; name it with --assume-unit"
                    .to_owned(),
            );
        }
        let filled = match self.missing {
            MissingPolicy::Fill => raw.missing(),
            MissingPolicy::Refuse => 0,
        };
        raw.border = self.border.or(raw.border);
        let y_is_north = raw.y_is_north;
        let is_border_known = raw.border.is_some();
        let field = raw.into_height_field(self.missing, ASSUMED_BORDER);
        let field = field.map_err(|error| FileProblem::from(error).at(path))?;
        let field = self.filtered(field);
        let eroded = field.and_then(|field| self.erosion.eroded(field));
        let field = eroded.map_err(|error| FileProblem::from(error).at(path))?;
        notes.extend(border_notes(&field, is_border_known));
        notes.extend(self.filter_notes(&field));
        let [dx, dy] = field.spacing().map(short);
        observer.explain(&format!(
            "{}: {} x {} samples, spacing {dx} x {dy}{}, {} border, {filled} points filled",
            shown_path(path),
            field.nx(),
            field.ny(),
            field.unit().suffix(),
            field.border(),
        ));
        if filled > 0 {
            let were = if filled == 1 { "was" } else { "were" };
            let points = counted(filled as u64, "missing point");
            notes.push(format!("{points} {were} filled"));
        }
        notes.extend(self.erosion.shallow_note(field.spacing(), field.unit()));
        Ok(ReadHeightMap {
            field,
            y_is_north,
            filled,
            notes,
        })
    }

    /// Reads a triangle mesh, and the unit of its lengths; an open patch unless a border is given. Also returns notes.
    fn read_mesh(
        &self,
        path: &Path,
        observer: &dyn Observer,
    ) -> Result<(MeshSurface, LengthUnit, Vec<String>), GivenError> {
        for (given, flag) in [
            (self.spacing.is_some(), "--spacing"),
            (self.flip, "--flip"),
            (self.missing != MissingPolicy::Refuse, "--missing"),
            (self.remove != Form::None, "--remove"),
            (self.s_filter.is_some(), S_FILTER),
            (self.l_filter.is_some(), L_FILTER),
            (self.erosion.repose.is_some(), REPOSE),
            (self.erosion.etch.is_some(), ETCH),
        ] {
            if given {
                return Err(FileProblem::ForHeightMaps(flag).at(path));
            }
        }
        let MeshData {
            mut vertices,
            triangles,
        } = read_mesh(path)?;
        // No mesh format states a unit
        let own = self.unit_of_file(LengthUnit::Arbitrary);
        let own = own.map_err(|error| FileProblem::from(error).at(path))?;
        let unit = self.unit.unwrap_or(own);
        if let Some(convert) = own.conversion(unit) {
            for coordinate in vertices.as_flattened_mut() {
                *coordinate = convert(*coordinate);
            }
        }
        if let Some(up) = self.up {
            for vertex in &mut vertices {
                *vertex = up.turned(*vertex);
            }
        }
        let mut notes: Vec<String> = match self.up {
            None => edge_note(&vertices, &triangles).into_iter().collect(),
            Some(_) => Vec::new(),
        };
        let border = self.border.unwrap_or(Border::Open);
        let mesh = MeshSurface::new(&vertices, triangles, border);
        let checked = mesh.and_then(|mesh| Ok((mesh.check_overlaps()?, mesh)));
        let (behind, mesh) = checked.map_err(|error| FileProblem::from(error).at(path))?;
        if behind > FEW_BEHIND {
            notes.push(format!(
                "{} % of the mesh face the back of other parts, which cross them or lie over them like another sheet: light between them is taken for light on the other side",
                short(100.0 * behind)
            ));
        }
        let [x, y, z] = mesh.size();
        observer.explain(&format!(
            "{}: {} vertices, {} triangles, extent {x} x {y} x {z}{}, {border} border",
            shown_path(path),
            mesh.vertex_count(),
            mesh.facet_count(),
            unit.suffix(),
        ));
        Ok((mesh, unit, notes))
    }

    /// Reads a surface of either kind.
    fn read(&self, path: &Path, observer: &dyn Observer) -> Result<GivenSurface, GivenError> {
        let surface = |shape, unit| GivenSurface {
            shape,
            name: file_name(path),
            file: Some(path.to_owned()),
            unit,
            y_is_north: true,
            filled: 0,
            notes: Vec::new(),
        };
        Ok(match SurfaceFormat::from_path(path)? {
            SurfaceFormat::Mesh(_) => {
                let (mesh, unit, notes) = self.read_mesh(path, observer)?;
                GivenSurface {
                    notes,
                    ..surface(GivenShape::Mesh(mesh), unit)
                }
            }
            SurfaceFormat::HeightMap(_) => {
                let read = self.read_height_map(path, observer)?;
                let unit = read.field.unit();
                GivenSurface {
                    y_is_north: read.y_is_north,
                    filled: read.filled,
                    notes: read.notes,
                    ..surface(GivenShape::Field(read.field), unit)
                }
            }
        })
    }
}

/// Note on a mesh whose mean normal is not along z, but along x or y.
fn edge_note(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<String> {
    let (mut sum, mut area) = ([0.0_f64; 3], 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|k| vertices[k as usize]);
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
        let normal = [1, 2, 0]
            .map(|i| (i, (i + 1) % 3))
            .map(|(i, j)| u[i] * v[j] - u[j] * v[i]);
        area += normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (sum, x) in sum.iter_mut().zip(normal) {
            *sum += x;
        }
    }
    let [x, y, z] = sum.map(f64::abs);
    // That of a closed body is none
    let stands = x.max(y) > z.max(CLOSED * area);
    let axis = if x > y { 'x' } else { 'y' };
    stands.then(|| {
        format!(
            "the mesh stands on edge: the mean normal of its triangles is along {axis}, not z; --up {axis} lays it down, for files in which {axis} points up"
        )
    })
}

/// Fraction of a mesh that may face the back of other parts unsaid: it changes results less than that.
const FEW_BEHIND: f64 = 1e-3;

/// Mean normal over area below which a mesh faces no side.
const CLOSED: f64 = 1e-6;

/// The file's own name, for titles.
pub(crate) fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    shown(&name.to_string_lossy())
}

/// `true` of two height maps without scatter between them: they have the same heights.
fn have_equal_heights(a: &GivenSurface, b: &GivenSurface) -> bool {
    match (&a.shape, &b.shape) {
        (GivenShape::Field(a), GivenShape::Field(b)) => a.heights() == b.heights(),
        _ => false,
    }
}
