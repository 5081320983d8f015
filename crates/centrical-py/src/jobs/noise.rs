//! `noise`: deviations of the Allan family, spectrum and noise terms of a record.

use std::path::PathBuf;

use centrical_report::write_noise;
use centrical_session::{ColumnName, Dimension, Estimator, NoiseRequest, noise_of};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words::{Amount, one_of, plateau, refused};

/// A column by its name, or by its number from 1.
#[derive(FromPyObject)]
pub enum Named {
    /// Its number.
    Number(usize),
    /// Its name.
    Name(String),
}

/// `centrical-noise/1`.
#[pyfunction]
pub fn noise(
    py: Python,
    file: PathBuf,
    plateau_name: Option<&str>,
    session: Option<PathBuf>,
    time: Named,
    rate: Option<Amount>,
    readings: Vec<Named>,
    unit: String,
    window: [f64; 2],
    estimators: Vec<String>,
    out: Option<PathBuf>,
    shown: Shown,
) -> PyResult<String> {
    let rate = Amount::optional(rate, "rate", Dimension::Frequency)?;
    if let Some(rate) = rate.filter(|rate| rate.is_nan() || *rate <= 0.0) {
        return Err(refused("rate", format!("found {rate}, expected a rate above zero")));
    }
    let request = NoiseRequest {
        file,
        plateau: plateau_name.map(|name| plateau("plateau", name)).transpose()?,
        session,
        time: column("time", time)?,
        rate,
        readings: readings.into_iter().map(|name| column("readings", name)).collect::<PyResult<_>>()?,
        unit,
        window,
        estimators: named(&estimators)?,
    };
    progress::run(py, &shown, |work| {
        let (analysis, _) = noise_of(&request, &|bytes| work.advance(bytes))?;
        if let Some(folder) = &out {
            write_noise(&analysis, folder)?;
        }
        Ok(analysis.to_json())
    })
}

fn column(argument: &str, name: Named) -> PyResult<ColumnName> {
    match name {
        Named::Number(0) => Err(refused(argument, "found 0, expected a number from 1 or a name")),
        Named::Number(number) => Ok(ColumnName::Number(number)),
        Named::Name(name) => Ok(ColumnName::Name(name)),
    }
}

fn named(names: &[String]) -> PyResult<Vec<Estimator>> {
    let words = Estimator::ALL.map(|estimator| (estimator.name(), estimator));
    let some = |name: &String| match name.as_str() {
        "all" => Ok(Estimator::ALL.to_vec()),
        name => one_of("estimators", name, &words).map(|estimator| vec![estimator]),
    };
    Ok(names.iter().map(some).collect::<PyResult<Vec<_>>>()?.concat())
}
