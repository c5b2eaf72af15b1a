//! Labelled results: the arrays of a result folder over named dimensions.

use std::path::PathBuf;

use asperity_io::{NetCdf, NetCdfValues};
use asperity_studies::labelled_results;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors::Failure;

/// Arrays of a result folder or file of `gonio`, `trace` or `verify`: dimensions, variables as (dimensions, values, attributes), and attributes.
#[pyfunction]
pub(crate) fn labelled<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyDict>> {
    let arrays = py.detach(|| labelled_results(&path));
    let NetCdf {
        dimensions,
        variables,
        attributes,
    } = arrays.map_err(|error| Failure::from(error).in_python(&[]))?;
    let lengths = dimensions
        .iter()
        .cloned()
        .collect::<std::collections::HashMap<_, _>>();
    let all = PyDict::new(py);
    for variable in variables {
        let shape: Vec<usize> = variable
            .dimensions
            .iter()
            .map(|name| lengths[name])
            .collect();
        let values = match variable.values {
            NetCdfValues::Numbers(values) => {
                PyArray1::from_vec(py, values).reshape(shape)?.into_any()
            }
            NetCdfValues::Texts(values) => py
                .import("numpy")?
                .call_method1("array", (values,))?
                .call_method1("reshape", (shape,))?,
        };
        let attributes = named(py, variable.attributes)?;
        let dimensions = PyTuple::new(py, variable.dimensions)?;
        all.set_item(variable.name, (dimensions, values, attributes))?;
    }
    let labelled = PyDict::new(py);
    labelled.set_item("variables", all)?;
    labelled.set_item("attributes", named(py, attributes)?)?;
    Ok(labelled)
}

fn named<'py>(
    py: Python<'py>,
    attributes: Vec<(&'static str, String)>,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, text) in attributes {
        all.set_item(name, text)?;
    }
    Ok(all)
}
