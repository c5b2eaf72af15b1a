//! Python extension module `asperity._core`: commands by their settings, height maps, models and labelled results as NumPy arrays.
//!
//! The package around it, in `asperity/`, has what is nicer in Python. There is no physics here.

mod arguments;
mod command;
mod errors;
// Those of the program
#[path = "../../asperity/examples.rs"]
mod examples;
mod height_map;
mod labelled;
mod model;
mod watch;

/// Core of the package asperity, in Rust.
#[pyo3::pymodule]
mod _core {
    use std::ffi::OsString;

    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::arguments::settings;
    #[pymodule_export]
    use crate::command::{Output, run};
    #[pymodule_export]
    use crate::height_map::HeightMap;
    #[pymodule_export]
    use crate::labelled::labelled;
    #[pymodule_export]
    use crate::model::Model;

    /// Runs the program with these arguments, the first of which is its name, and returns its exit code.
    #[pyfunction]
    fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| asperity_cli::run(arguments, &crate::examples::EXAMPLES))
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let build = asperity_io::Build::current();
        module.add("__version__", build.version)?;
        module.add("commit", build.commit)?;
        module.add("results_epoch", build.results_epoch)
    }
}
