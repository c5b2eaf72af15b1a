//! Given surface: a height map, a triangle mesh or a plane, with its description and warnings.

use std::path::{Path, PathBuf};

use asperity_simulate::{Cells, Shape, smooth_shape};
use asperity_surface::{Border, HeightField, LengthUnit};
use asperity_synthesis::Provenance;
use asperity_tracer::{Geometry, MeshSurface};
use serde_json::{Value, json};

use super::error::{FileProblem, GivenError};
use crate::config::measured::MeasuredConfig;
use crate::surface_lengths::SurfaceLengths;

/// A given surface.
#[derive(Clone, Debug)]
pub struct GivenSurface {
    /// Its shape.
    pub shape: GivenShape,
    /// Its name, for titles.
    pub name: String,
    /// The file; `None` for the flat surface.
    pub file: Option<PathBuf>,
    /// Unit of its lengths.
    pub unit: LengthUnit,
    /// `true` if +y is its north, as of a mesh, and -y otherwise, as of a map whose first row is the northern one.
    pub y_is_north: bool,
    /// Missing points that were filled.
    pub filled: usize,
    /// Notes on how the file was read, one sentence each.
    pub notes: Vec<String>,
}

/// The shape of a given surface.
#[derive(Clone, Debug)]
pub enum GivenShape {
    /// Heights on a grid.
    Field(HeightField),
    /// Triangles.
    Mesh(MeshSurface),
}

/// Given surfaces: one, or several with lengths in the same unit, which are an ensemble.
#[derive(Clone, Debug)]
pub struct GivenSurfaces {
    /// The first.
    pub first: GivenSurface,
    /// All others.
    pub others: Vec<GivenSurface>,
}

impl GivenSurfaces {
    /// All of them, in the order in which they were given.
    pub fn iter(&self) -> impl Iterator<Item = &GivenSurface> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Their names, for titles.
    #[must_use]
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.iter().map(|one| one.name.as_str()).collect();
        names.join(", ")
    }

    /// Shortest lengths over all surfaces, to compare with the wavelength.
    pub(crate) fn lengths(&self) -> SurfaceLengths {
        let others = self.others.iter().map(GivenSurface::lengths);
        others.fold(self.first.lengths(), SurfaceLengths::shortest)
    }

    /// Notes on the surfaces, one sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let of_each: Vec<_> = self.iter().map(GivenSurface::warnings).collect();
        let mut warnings = Vec::new();
        for (surface, of_one) in self.iter().zip(&of_each) {
            for warning in of_one {
                let warning = match of_each.iter().all(|others| others.contains(warning)) {
                    true => warning.clone(),
                    false => format!("{}: {warning}", surface.name),
                };
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        warnings.push(match of_each.len() {
            1 => ONE_SURFACE.to_owned(),
            n => {
                let percent = 100.0 / (2.0 * (n as f64 - 1.0)).sqrt();
                format!("{n} surfaces: errors are those of their scatter, which so few tell within about {percent:.0} %")
            }
        });
        warnings
    }

    /// Their descriptions as summary.json and headers hold them: a list if there are several.
    pub(crate) fn described(&self, describe: impl Fn(&GivenSurface) -> Value) -> Value {
        match self.others.as_slice() {
            [] => describe(&self.first),
            _ => self.iter().map(describe).collect(),
        }
    }

    /// The shapes to simulate, with these `cells` between heights, each over `bottom` if there is one, that of layer number `lowest`.
    ///
    /// # Errors
    /// [`GivenError`] if smooth cells are requested of a mesh or exceed the memory, or surface and bottom are of two kinds.
    pub fn simulated(
        self,
        bottom: Option<GivenSurface>,
        lowest: usize,
        cells: Cells,
    ) -> Result<Vec<Shape>, GivenError> {
        let bottom = bottom.map(|bottom| bottom.simulated(cells)).transpose()?;
        let all = std::iter::once(self.first).chain(self.others);
        let shapes = all.map(|one| {
            let top = one.simulated(cells)?;
            match &bottom {
                None => Ok(top),
                Some(bottom) => top
                    .over(lowest, bottom.clone())
                    .ok_or(GivenError::OtherBottom),
            }
        });
        shapes.collect()
    }
}

impl GivenSurface {
    /// The shape to simulate, with these `cells` between heights.
    fn simulated(self, cells: Cells) -> Result<Shape, GivenError> {
        if cells == Cells::Smooth {
            return Ok(smooth_shape(self.height_map("--cells smooth")?)?);
        }
        Ok(match self.shape {
            GivenShape::Field(field) => Shape::height_field(field),
            GivenShape::Mesh(mesh) => Shape::triangle_mesh(mesh),
        })
    }

    /// The heights, for the setting of this `flag`, which a triangle mesh does not have.
    pub(crate) fn height_map(&self, flag: &'static str) -> Result<&HeightField, GivenError> {
        match &self.shape {
            GivenShape::Field(field) => Ok(field),
            GivenShape::Mesh(_) => {
                let path = self.file.as_deref().unwrap_or(Path::new(&self.name));
                Err(FileProblem::ForHeightMaps(flag).at(path))
            }
        }
    }

    /// One flat periodic cell, with lengths in `unit`.
    pub(super) fn flat(unit: LengthUnit) -> Self {
        let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]);
        let field = field.expect("a plane is a height field");
        Self {
            shape: GivenShape::Field(field.with_unit(unit)),
            name: "flat surface".to_owned(),
            file: None,
            unit,
            y_is_north: true,
            filled: 0,
            notes: Vec::new(),
        }
    }

    /// This flat surface, with the tile of `bottom`; as it is over a triangle mesh.
    pub(super) fn over(&self, bottom: &Self) -> Self {
        let shape = match &bottom.shape {
            GivenShape::Field(below) => {
                let level = vec![0.0; below.heights().len()];
                let field = HeightField::new(level, below.shape(), below.spacing());
                let field = field.expect("a plane is a height field");
                let field = field.with_border(below.border()).with_unit(bottom.unit);
                GivenShape::Field(field)
            }
            GivenShape::Mesh(_) => self.shape.clone(),
        };
        Self {
            shape,
            unit: bottom.unit,
            ..self.clone()
        }
    }

    /// Lengths of the tile along x and y.
    #[must_use]
    pub fn extent(&self) -> [f64; 2] {
        match &self.shape {
            GivenShape::Field(field) => field.extent(),
            GivenShape::Mesh(mesh) => {
                let [x, y, _] = mesh.size();
                [x, y]
            }
        }
    }

    /// Its lengths, to be compared with the wavelength.
    pub(crate) fn lengths(&self) -> SurfaceLengths {
        match &self.shape {
            GivenShape::Field(field) => SurfaceLengths::of_field(field),
            GivenShape::Mesh(mesh) => SurfaceLengths::of_mesh(mesh, self.unit),
        }
    }

    /// Notes on the surface, one sentence each.
    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.notes.clone();
        let border = match &self.shape {
            GivenShape::Field(field) => {
                warnings.extend(steepness_warning(field));
                field.border()
            }
            GivenShape::Mesh(mesh) => {
                warnings.extend(mesh_warnings(mesh));
                mesh.border()
            }
        };
        if border == Border::Open {
            warnings.push(OPEN_PATCH.to_owned());
        }
        warnings
    }

    /// The surface as summary.json holds it, as `reading` says that it was read.
    pub(crate) fn description(&self, reading: &MeasuredConfig) -> Value {
        match &self.shape {
            GivenShape::Field(field) => {
                let mut description = json!({
                    "file": self.file,
                    "shape": field.shape(),
                    "spacing": field.spacing(),
                    "unit": field.unit(),
                    "border": field.border(),
                    "points_filled": self.filled,
                    "generated": Provenance::of(field.provenance()),
                });
                reading.describe_filtering(&mut description);
                description
            }
            GivenShape::Mesh(mesh) => {
                let repairs = mesh.repairs();
                json!({
                    "file": self.file,
                    "vertices": mesh.vertex_count(),
                    "triangles": mesh.facet_count(),
                    "extent": mesh.size(),
                    "unit": self.unit,
                    "border": mesh.border(),
                    "triangles_dropped": repairs.dropped,
                    "turned_over": repairs.turned_over,
                })
            }
        }
    }
}

/// Slope above which the steepest facet is reported.
const STEEP: f64 = 50.0;

/// Warns of a facet that is too steep for heights and spacing in the same unit.
fn steepness_warning(field: &HeightField) -> Option<String> {
    let steepest = field.steeper_than(STEEP)?;
    Some(format!(
        "the steepest facet stands at {:.2} deg: are heights and spacing in the same unit?",
        steepest.angle_degrees
    ))
}

/// Warns of what was repaired, and of what lets light pass.
fn mesh_warnings(mesh: &MeshSurface) -> Vec<String> {
    let repairs = mesh.repairs();
    let mut warnings = Vec::new();
    if repairs.turned_over {
        warnings.push(
            "the mesh faced away from +z (or inwards, being closed) and was turned over".to_owned(),
        );
    }
    if repairs.dropped > 0 {
        warnings.push(format!(
            "{} triangles without area were left out",
            repairs.dropped
        ));
    }
    // Under other borders than an open one such meshes are refused.
    if repairs.closed {
        warnings.push(
            "the mesh is closed: paths below it hit nothing and count as truncated".to_owned(),
        );
    }
    if repairs.open_edges > 0 {
        warnings.push(format!(
            "{} edges inside the tile have one triangle only: paths that pass them count as truncated",
            repairs.open_edges
        ));
    }
    warnings
}

const ONE_SURFACE: &str =
    "one surface: errors hold for this surface, not for the ensemble it may come from";

const OPEN_PATCH: &str = "the patch is open, with nothing beyond its rim: light that goes up over the rim escapes, light that goes down past it counts as truncated, and grazing light sees the patch too bright";
