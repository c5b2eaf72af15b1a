//! Model: a statistical scattering model, evaluated and sampled over arrays of directions.

use asperity_analysis::{
    BsdfModel, ScatteringModel, hemispherical_energy, sample_direction, sampling_density,
};
use asperity_studies::settings::Command;
use asperity_studies::{ModelConfig, single_model};
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::arguments::{Call, document_of};
use crate::errors::Failure;
use crate::watch::{Watched, watched};

/// A statistical scattering model of a rough surface.
#[pyclass(frozen, module = "asperity._core")]
pub(crate) struct Model {
    model: Box<dyn ScatteringModel>,
    notes: Vec<String>,
}

/// Directions as rows of three numbers.
type Directions<'py> = PyReadonlyArray2<'py, f64>;

fn directions(array: &Directions<'_>) -> PyResult<Vec<DVec3>> {
    let rows = array.as_array();
    if rows.ncols() != 3 {
        return Err(PyTypeError::new_err(
            "directions: must have three components",
        ));
    }
    let rows = rows.rows().into_iter();
    Ok(rows.map(|row| DVec3::new(row[0], row[1], row[2])).collect())
}

impl Model {
    fn density(&self) -> PyResult<&dyn BsdfModel> {
        self.model.density().ok_or_else(|| {
            let name = self.model.name();
            PyTypeError::new_err(format!(
                "the model {name} follows rays and has no value at single directions; models.evaluate has its values over bins"
            ))
        })
    }

    /// Values of `of` at pairs of directions.
    fn at_pairs<'py>(
        &self,
        py: Python<'py>,
        wi: &Directions<'_>,
        wo: &Directions<'_>,
        of: impl Fn(&dyn BsdfModel, DVec3, DVec3) -> f64 + Sync,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let density = self.density()?;
        let pairs = directions(wi)?.into_iter().zip(directions(wo)?);
        let pairs: Vec<_> = pairs.collect();
        let value = |(wi, wo): &(DVec3, DVec3)| match (*wi + *wo).is_nan() {
            true => f64::NAN,
            false => of(density, *wi, *wo),
        };
        let values = values(py, &pairs, FEW_PAIRS, value)?;
        Ok(PyArray1::from_vec(py, values))
    }
}

/// Pairs of directions that take less time than starting threads.
const FEW_PAIRS: usize = 2000;

/// Values at all of `points`, on all cores unless they are `few`. Signals are handled meanwhile.
fn values<P: Sync, V: Send>(
    py: Python<'_>,
    points: &[P],
    few: usize,
    value: impl Fn(&P) -> V + Sync,
) -> PyResult<Vec<V>> {
    if points.len() <= few {
        return Ok(py.detach(|| points.iter().map(&value).collect()));
    }
    let Watched { result, interrupt } = watched(py, None, None, |observer| {
        let value = |point| observer.stop().is_none().then(|| value(point));
        points.par_iter().map(value).collect::<Option<Vec<V>>>()
    })?;
    match (result, interrupt) {
        (Some(values), None) => Ok(values),
        (_, Some(interrupt)) => Err(interrupt),
        (None, None) => unreachable!("an interrupt alone stops it"),
    }
}

#[pymethods]
impl Model {
    #[new]
    fn new(call: Call) -> PyResult<Self> {
        let made = document_of(Command::Model, &call).and_then(|document| {
            let config: ModelConfig = document.read()?;
            Ok(single_model(&config)?)
        });
        let (model, notes) = made.map_err(|failure: Failure| failure.in_python(&call.flags))?;
        Ok(Self { model, notes })
    }

    /// Name.
    #[getter]
    fn name(&self) -> &'static str {
        self.model.name()
    }

    /// Light that the model describes, with its source.
    #[getter]
    fn description(&self) -> &'static str {
        self.model.description()
    }

    /// Surfaces that the model holds for.
    #[getter]
    fn valid_range(&self) -> &'static str {
        self.model.valid_range()
    }

    /// Notes on the slopes, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// BSDF in 1/sr at pairs of unit vectors, rows of `wi` and `wo`.
    fn eval<'py>(
        &self,
        py: Python<'py>,
        wi: Directions<'py>,
        wo: Directions<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.at_pairs(py, &wi, &wo, |model, wi, wo| model.bsdf(wi, wo))
    }

    /// Density of `sample` in 1/sr at pairs of unit vectors.
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        wi: Directions<'py>,
        wo: Directions<'py>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.at_pairs(py, &wi, &wo, |model, wi, wo| {
            sampling_density(model, wi, wo)
        })
    }

    /// Directions drawn for each of `wi`; rows of NaN where a facet sends the light to the wrong side.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wi: Directions<'py>,
        seed: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let density = self.density()?;
        let incident = directions(&wi)?;
        let numbered: Vec<(u64, DVec3)> = (0..).zip(incident).collect();
        // A random stream for each direction, whatever the threads
        let drawn = values(py, &numbered, FEW_PAIRS, |(number, wi)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(*number);
            let wo = (wi.z > 0.0).then(|| sample_direction(density, *wi, &mut rng));
            wo.flatten().unwrap_or(DVec3::NAN).to_array()
        })?;
        let drawn: Vec<f64> = drawn.into_iter().flatten().collect();
        PyArray1::from_vec(py, drawn).reshape([numbered.len(), 3])
    }

    /// Fractions of the flux that are reflected and transmitted, for each of `wi`.
    fn albedo<'py>(
        &self,
        py: Python<'py>,
        wi: Directions<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let density = self.density()?;
        let incident = directions(&wi)?;
        let energies = values(py, &incident, 1, |wi| match wi.z > 0.0 {
            true => {
                let energy = hemispherical_energy(density, *wi);
                [energy.reflected, energy.transmitted]
            }
            false => [f64::NAN; 2],
        })?;
        let found: Vec<f64> = energies.into_iter().flatten().collect();
        PyArray1::from_vec(py, found).reshape([incident.len(), 2])
    }
}
