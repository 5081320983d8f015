//! A calibration result: its numbers as arrays, its verdict, its text, and compensation by it.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use centrical::uncertainty::{Compensated, ModelInAxes};
use centrical_report::{Language, UnitStatement, figures, objection, result_text};
use centrical_session::{self as session, Axes, Error, ObjectionName, OutputSummary};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;

use crate::arrays::{self, as_rows, as_rows_mut};
use crate::compensation::{self, Owned};
use crate::failure::{exception, guarded, wrong_content};
use crate::pool;

/// Rows from which on the interpreter lock is released.
const MANY: usize = 512;

/// Rows between two looks at signals: some hundredths of a second.
const BETWEEN_SIGNALS: usize = 1 << 16;

/// A figure: name, title, caption, drawings.
type Drawn = (&'static str, String, String, Vec<String>);

/// A calibration result.
#[pyclass(frozen, module = "centrical._native")]
pub struct CalibrationResult {
    /// What `result.json` holds.
    pub result: session::CalibrationResult,
    /// What the laboratory's limits say of the unit, where it was calibrated with some.
    pub unit: Option<UnitStatement>,
    /// Certified at its first use.
    compensation: OnceLock<Owned>,
}

impl From<session::CalibrationResult> for CalibrationResult {
    fn from(result: session::CalibrationResult) -> Self {
        Self { result, unit: None, compensation: OnceLock::new() }
    }
}

#[pymethods]
impl CalibrationResult {
    /// Reads the file of a result.
    #[staticmethod]
    fn read(py: Python, file: PathBuf) -> PyResult<Self> {
        guarded(|| {
            let result = py.detach(|| session::CalibrationResult::read(&file));
            result.map(Self::from).map_err(|error| exception(py, &error))
        })
    }

    /// The result that `text` holds as JSON.
    #[staticmethod]
    fn from_json(py: Python, text: &[u8]) -> PyResult<Self> {
        guarded(|| {
            let text = std::str::from_utf8(text)
                .map_err(|error| wrong_content(py, IN_MEMORY, &error.to_string(), "text in UTF-8"))?;
            let result = py.detach(|| session::CalibrationResult::parse(Path::new(IN_MEMORY), text));
            result.map(Self::from).map_err(|error| exception(py, &error))
        })
    }

    /// The text of `result.json`.
    fn to_json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        guarded(|| {
            let text = py.detach(|| self.result.to_json()).map_err(|error| exception(py, &error))?;
            Ok(PyBytes::new(py, text.as_bytes()))
        })
    }

    /// Writes `result.json`, whole or not at all.
    fn write(&self, py: Python, file: PathBuf) -> PyResult<()> {
        guarded(|| py.detach(|| self.result.write(&file)).map_err(|error| exception(py, &error)))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let make = py.get_type::<Self>().getattr("from_json")?;
        Ok((make, (self.to_json(py)?,)))
    }

    /// Names of the parameters in the order of the covariance.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.result.parameters.iter().map(|parameter| parameter.name.as_str()).collect()
    }

    /// Units of the parameters.
    #[getter]
    fn units(&self) -> Vec<&str> {
        self.result.parameters.iter().map(|parameter| parameter.unit.as_str()).collect()
    }

    /// Groups of the parameters.
    #[getter]
    fn groups(&self) -> Vec<&'static str> {
        self.result.parameters.iter().map(|parameter| parameter.group.name()).collect()
    }

    /// Estimates, NaN where the data do not determine them.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.result.parameters.iter().map(|parameter| parameter.value.unwrap_or(f64::NAN)))
    }

    /// Standard uncertainties, NaN where the data do not determine them.
    #[getter]
    fn uncertainties<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let uncertainties = self.result.parameters.iter().map(|p| p.standard_uncertainty.unwrap_or(f64::NAN));
        PyArray1::from_iter(py, uncertainties)
    }

    /// Covariance of the estimates, NaN where the data do not determine them.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |row: &Vec<Option<f64>>| row.iter().map(|c| c.unwrap_or(f64::NAN)).collect();
        let rows: Vec<Vec<f64>> = self.result.covariance.iter().map(row).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// The objections to the result: name and sentence of each.
    #[getter]
    fn objections(&self) -> PyResult<Vec<(&'static str, String)>> {
        guarded(|| {
            let objections = self.result.objections();
            let named = |reason| (ObjectionName::from(reason).word(), objection(reason, Language::English));
            Ok(objections.iter().map(named).collect())
        })
    }

    /// The verdict and the tables of the terminal, in lines of `width` characters.
    fn text(&self, width: usize) -> PyResult<String> {
        guarded(|| {
            let screen = result_text(&self.result, self.unit.as_ref(), None);
            Ok(session::harmless(&screen.text(width, usize::MAX)).into_owned())
        })
    }

    /// The figures of the report: name, title, caption and the drawings of each, SVG.
    fn figures(&self, py: Python) -> PyResult<Vec<Drawn>> {
        guarded(|| {
            let figures = py.detach(|| figures(&self.result, Language::English));
            Ok(figures.into_iter().map(|f| (f.name, f.title, f.caption, f.drawings)).collect())
        })
    }

    /// Largest specific force on each axis that compensation gives [m/s^2].
    #[getter]
    fn range(&self, py: Python) -> PyResult<f64> {
        guarded(|| Ok(self.compensation(py)?.certificate().range))
    }

    /// Whether the unit keeps the limits that it was calibrated with.
    #[getter]
    fn within_limits(&self) -> Option<bool> {
        self.unit.as_ref().map(UnitStatement::is_within)
    }

    /// Unit of the readings that compensation takes.
    #[getter]
    fn output_unit(&self) -> &str {
        self.result.output.as_ref().map_or("m/s^2", |output| &output.unit)
    }

    #[pyo3(signature = (readings, out=None))]
    /// Compensates readings `(n, 3)` in the unit of the calibration's records; the forces [m/s^2], and how many readings no force of the
    /// range gives.
    fn compensate<'py>(
        &self,
        readings: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, usize)> {
        guarded(|| {
            let py = readings.py();
            let compensation = self.compensation(py)?;
            let output = self.result.output.as_ref();
            let Some(given) = out else {
                let readings = arrays::rows("readings", readings, true)?;
                let forces = PyArray2::zeros(py, [readings.shape()[0], 3], false);
                let outside = between(py, compensation, output, &readings, &forces)?;
                return Ok((forces.into_bound_py_any(py)?, outside));
            };
            let forces = arrays::rows("out", given, false)?;
            let outside = if readings.is(given) {
                in_place(py, compensation, output, &forces)?
            } else {
                let readings = arrays::rows("readings", readings, true)?;
                between(py, compensation, output, &readings, &forces)?
            };
            Ok((given.clone(), outside))
        })
    }

    /// The result in other axes too.
    fn in_axes(&self, py: Python, axes: &str) -> PyResult<Self> {
        guarded(|| {
            let stated = Axes::from(axes).of(self.result.clone(), Path::new(IN_MEMORY));
            stated.map(Self::from).map_err(|error| exception(py, &error))
        })
    }

    /// Standard uncertainties `(n, 3)` of compensated readings at the specific forces `(n, 3)` [m/s^2].
    fn uncertainty<'py>(&self, forces: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        guarded(|| {
            let py = forces.py();
            let uncertain = self.uncertain(py)?;
            let forces = arrays::rows("forces", forces, true)?;
            let uncertainties = PyArray2::zeros(py, [forces.shape()[0], 3], false);
            let (read, mut write) = (arrays::to_read("forces", &forces)?, arrays::to_write("out", &uncertainties)?);
            let (Ok(from), Ok(to)) = (read.as_slice(), write.as_slice_mut()) else { return Ok(uncertainties.clone()) };
            let (from, to) = (as_rows(from), as_rows_mut(to));
            let set = |(f, u): (&[f64; 3], &mut [f64; 3])| *u = uncertain.at_force(*f);
            for (from, to) in from.chunks(BETWEEN_SIGNALS).zip(to.chunks_mut(BETWEEN_SIGNALS)) {
                py.check_signals()?;
                py.detach(|| {
                    if from.len() > MANY && pool::is_ours() {
                        from.par_iter().zip(to).for_each(set);
                    } else {
                        from.iter().zip(to).for_each(set);
                    }
                });
            }
            drop(write);
            Ok(uncertainties)
        })
    }
}

impl CalibrationResult {
    fn compensation(&self, py: Python) -> PyResult<&Owned> {
        if let Some(compensation) = self.compensation.get() {
            return Ok(compensation);
        }
        let compensation =
            self.result.compensation(Path::new(IN_MEMORY), None).map_err(|error| exception(py, &error))?;
        Ok(self.compensation.get_or_init(|| compensation))
    }

    fn uncertain(&self, py: Python) -> PyResult<Uncertain> {
        let failed = |source| Error::ErrorModel { file: Path::new(IN_MEMORY).to_owned(), source };
        if let Some(axes) = &self.result.axes {
            let model = axes.model(&self.result).map_err(|source| exception(py, &failed(source)))?;
            return Ok(Uncertain::InAxes(model));
        }
        let terms = self.result.error_terms().map_err(|source| exception(py, &failed(source)))?;
        let expected = "a covariance of all coefficients of the error model";
        Compensated::new(terms, self.result.covariance_of_coefficients())
            .map(Uncertain::OfInstrument)
            .ok_or_else(|| wrong_content(py, "covariance", "another shape", expected))
    }
}

/// What messages call a result that was read from no file.
const IN_MEMORY: &str = "result";

fn between(
    py: Python,
    compensation: &Owned,
    output: Option<&OutputSummary>,
    readings: &arrays::Rows,
    forces: &arrays::Rows,
) -> PyResult<usize> {
    let (from, to) = (readings.shape()[0], forces.shape()[0]);
    if from != to {
        let message = format!("out: found shape ({to}, 3), expected ({from}, 3) as of the readings");
        return Err(pyo3::exceptions::PyValueError::new_err(message));
    }
    if from == 0 {
        return Ok(0);
    }
    let (read, mut write) = (arrays::to_read("readings", readings)?, arrays::to_write("out", forces)?);
    let (from, to) = (as_rows(read.as_slice()?), as_rows_mut(write.as_slice_mut()?));
    if from.len() < MANY {
        return Ok(compensation::rows_to(compensation, output, from, to, false));
    }
    let is_parallel = pool::is_ours();
    Ok(py.detach(|| compensation::rows_to(compensation, output, from, to, is_parallel)))
}

fn in_place(
    py: Python,
    compensation: &Owned,
    output: Option<&OutputSummary>,
    forces: &arrays::Rows,
) -> PyResult<usize> {
    let mut write = arrays::to_write("out", forces)?;
    let f = as_rows_mut(write.as_slice_mut()?);
    let is_parallel = pool::is_ours();
    if f.len() < MANY {
        return Ok(compensation::rows(compensation, output, f, false));
    }
    Ok(py.detach(|| compensation::rows(compensation, output, f, is_parallel)))
}

/// What the coefficients leave in a compensated reading.
enum Uncertain {
    /// In the axes of the newtonometers.
    OfInstrument(Compensated),
    /// In the axes that the result is stated in.
    InAxes(ModelInAxes),
}

impl Uncertain {
    /// Standard uncertainties at the specific force `f` [m/s^2].
    fn at_force(&self, f: [f64; 3]) -> [f64; 3] {
        if f.iter().any(|f| !f.is_finite()) {
            return [f64::NAN; 3];
        }
        let f = Vector3::from(f);
        let covariance = match self {
            Self::OfInstrument(compensated) => compensated.covariance(&f),
            Self::InAxes(model) => model.covariance_at(&f),
        };
        covariance.map_or([f64::NAN; 3], |covariance| covariance.diagonal().map(|v| v.max(0.0).sqrt()).into())
    }
}
