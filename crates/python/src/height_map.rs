//! Height map: heights that Python gives and takes without a second copy.
//!
//! The one module of the crate with unsafe code: an array lends the memory of a height map that it keeps alive.
#![allow(
    unsafe_code,
    reason = "an array over the memory of a height map, as the module's text says"
)]

use std::sync::OnceLock;

use asperity_io::{MemoryHeightMap, read_height_map, write_height_map};
use asperity_surface::{Border, MissingPolicy, RawHeightMap};
use numpy::ndarray::ArrayView2;
use numpy::{AllowTypeChange, Element, PyArray2, PyArrayLike2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::errors::Failure;

/// Heights on a regular grid, with spacing, unit and border; NaN marks a missing point.
#[pyclass(frozen, module = "asperity._core")]
pub(crate) struct HeightMap {
    pub(crate) map: RawHeightMap,
    file: OnceLock<MemoryHeightMap>,
}

impl From<RawHeightMap> for HeightMap {
    fn from(map: RawHeightMap) -> Self {
        Self {
            map,
            file: OnceLock::new(),
        }
    }
}

/// Value of a name in a configuration.
fn named<T: DeserializeOwned>(what: &str, name: &str, known: &str) -> PyResult<T> {
    serde_json::from_value(Value::from(name))
        .map_err(|_| PyValueError::new_err(format!("{what}={name}: must be one of {known}")))
}

/// The heights of an array in the order of its rows, and its shape.
fn rows<T: Copy>(array: ArrayView2<'_, T>, convert: impl Fn(T) -> f64) -> (Vec<f64>, [usize; 2]) {
    let heights = array.iter().map(|height| convert(*height));
    let (ny, nx) = array.dim();
    (heights.collect(), [ny, nx])
}

/// The heights of an array of this type, if it is one.
fn rows_of<T: Element + Copy + Into<f64>>(
    heights: &Bound<'_, PyAny>,
) -> Option<(Vec<f64>, [usize; 2])> {
    let array: PyReadonlyArray2<'_, T> = heights.extract().ok()?;
    Some(rows(array.as_array(), Into::into))
}

#[pymethods]
impl HeightMap {
    /// Heights as any array-like of two dimensions, copied once.
    #[new]
    #[pyo3(signature = (heights, spacing, unit, border, y_is_north))]
    fn new(
        heights: &Bound<'_, PyAny>,
        spacing: Option<[f64; 2]>,
        unit: &str,
        border: Option<&str>,
        y_is_north: bool,
    ) -> PyResult<Self> {
        let found = rows_of::<f64>(heights).or_else(|| rows_of::<f32>(heights));
        let (values, shape) = match found {
            Some(found) => found,
            None => {
                let array: PyArrayLike2<'_, f64, AllowTypeChange> =
                    heights.extract().map_err(|_| {
                        PyTypeError::new_err("heights: must be numbers in rows of equal lengths")
                    })?;
                rows(array.as_array(), |height| height)
            }
        };
        let is_known = spacing.is_some();
        let map = RawHeightMap::new(values, shape, spacing.unwrap_or([1.0; 2]));
        let mut map = map.map_err(|error| PyValueError::new_err(error.to_string()))?;
        if !is_known {
            map = map.with_assumed_spacing();
        }
        map.unit = named("unit", unit, "1, nm, um, mm, m and km")?;
        let border = border.map(|border| named("border", border, "periodic, mirrored and open"));
        map.border = border.transpose()?;
        map.y_is_north = y_is_north;
        Ok(map.into())
    }

    /// Reads a file of any format that `asperity` reads.
    #[staticmethod]
    fn read(py: Python<'_>, path: &str) -> PyResult<Self> {
        let map = py.detach(|| read_height_map(path));
        map.map(Self::from)
            .map_err(|error| Failure::from(error).in_python(&[]))
    }

    /// Writes a file; the ending chooses the format.
    fn write(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        let map = self.map.clone();
        py.detach(|| {
            let field = map.into_height_field(MissingPolicy::Refuse, Border::Mirrored);
            let field = field.map_err(Failure::value)?;
            write_height_map(path, &field).map_err(Failure::from)
        })
        .map_err(|failure: Failure| failure.in_python(&[]))
    }

    /// Heights, shape (ny, nx), without a copy and read-only.
    #[getter]
    fn heights<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let map = &this.get().map;
        let view = ArrayView2::from_shape(map.shape(), map.heights());
        let view = view.map_err(|error| PyValueError::new_err(error.to_string()))?;
        // SAFETY: the heights of a frozen object are never changed or moved, and the array keeps the object alive.
        let array = unsafe { PyArray2::borrow_from_array(&view, this.clone().into_any()) };
        array.readwrite().make_nonwriteable();
        Ok(array)
    }

    /// Distance between samples along x and y.
    #[getter]
    fn spacing(&self) -> [f64; 2] {
        self.map.spacing()
    }

    /// `True` if the source states the spacing.
    #[getter]
    fn spacing_is_known(&self) -> bool {
        self.map.spacing_is_known()
    }

    /// Unit of lengths: "1", "nm", "um", "mm", "m" or "km".
    #[getter]
    fn unit(&self) -> String {
        name_of(&self.map.unit)
    }

    /// Continuation beyond the border: "periodic", "mirrored" or "open"; `None` if it is not known.
    #[getter]
    fn border(&self) -> Option<String> {
        self.map.border.as_ref().map(name_of)
    }

    /// `True` if +y is the north of a map, and -y otherwise.
    #[getter]
    fn y_is_north(&self) -> bool {
        self.map.y_is_north
    }

    /// Number of missing points.
    #[getter]
    fn missing(&self) -> usize {
        self.map.missing()
    }

    /// Notes on how the file was read, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.map.notes.clone()
    }

    /// Name by which settings give this height map while it exists.
    #[getter]
    fn path(&self) -> String {
        let file = self
            .file
            .get_or_init(|| MemoryHeightMap::new(self.map.clone()));
        file.path().to_string_lossy().into_owned()
    }
}

/// The name of a value in a configuration.
fn name_of(value: &impl serde::Serialize) -> String {
    let value = serde_json::to_value(value).unwrap_or_default();
    value.as_str().unwrap_or("1").to_owned()
}
