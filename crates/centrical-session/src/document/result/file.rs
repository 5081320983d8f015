//! The file `result.json`, written and read, and what is asked of it.

use std::path::Path;

use centrical::Source;
use centrical_table::write_whole;
use nalgebra::DMatrix;

use super::contradiction::contradiction;
use super::schema::{CalibrationResult, ParameterEstimate, PlateauSummary, SCHEMA};
use crate::error::{Error, Place};
use crate::settings::{from_json, read_result};

impl CalibrationResult {
    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Json`] when a value has no place in JSON, [`Error::Table`] when the folder does not take it.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        Ok(write_whole(path, self.to_json()?.as_bytes())?)
    }

    /// The plateaus that are rests in free attitudes.
    pub fn rests(&self) -> impl Iterator<Item = &PlateauSummary> {
        let is_free = |id: &str| self.model.positions.iter().any(|position| position.is_free && position.id == id);
        let free: Vec<bool> = self.mountings.iter().map(|mounting| is_free(&mounting.position)).collect();
        self.plateaus.iter().filter(move |p| p.mounting.checked_sub(1).and_then(|m| free.get(m)) == Some(&true))
    }

    /// The plateaus that are held out of the fit, as people name them.
    pub fn held_out(&self) -> Vec<String> {
        let held_out = self.plateaus.iter().filter(|plateau| plateau.held_out);
        held_out.map(|plateau| format!("{}:{}", plateau.mounting, plateau.index + 1)).collect()
    }

    /// The combinations that the data do not show, as people read them. Those of rests in free attitudes alone are without the attitudes, and
    /// without coefficients that change a reading at 1 g by less than a twentieth of the largest change. All others are as they are.
    pub fn null_directions_in_short(&self) -> Vec<serde_json::Map<String, serde_json::Value>> {
        const CHIEF: f64 = 0.05;
        if self.model.has_arm() {
            return self.observability.null_directions.clone();
        }
        let degree = |name: &str| {
            let term = self.model.error_model.iter().find(|term| term.name == name)?;
            Some(i32::from(term.monomial().ok()?.degree()))
        };
        let change = |(name, component): (&String, &serde_json::Value)| {
            Some((component.as_f64()? * self.model.gravity.powi(degree(name)?)).abs())
        };
        let chiefly = |direction: &serde_json::Map<String, serde_json::Value>| {
            let most = direction.iter().filter_map(change).fold(0.0, f64::max);
            let chief = direction.iter().filter(|&term| change(term).is_some_and(|size| size >= CHIEF * most));
            let first = chief.clone().next().and_then(|(_, component)| component.as_f64()).unwrap_or(1.0);
            let to_one = |(name, component): (&String, &serde_json::Value)| {
                (name.clone(), (component.as_f64().unwrap_or(0.0) / first).into())
            };
            chief.map(to_one).collect()
        };
        self.observability.null_directions.iter().map(chiefly).collect()
    }

    /// Whether a parameter is a coefficient of the error model.
    pub fn is_coefficient(&self, parameter: &ParameterEstimate) -> bool {
        self.model.error_model.iter().any(|term| term.name == parameter.name)
    }

    /// The covariance of the coefficients of the error model that the data determine, SI; NaN where the file has none.
    pub fn covariance_of_coefficients(&self) -> DMatrix<f64> {
        let place = |name: &str| self.parameters.iter().position(|p| p.name == name && p.value.is_some());
        let own: Vec<usize> = self.model.error_model.iter().filter_map(|term| place(&term.name)).collect();
        let covariance = |a: usize, b: usize| self.covariance.get(own[a])?.get(own[b]).copied().flatten();
        DMatrix::from_fn(own.len(), own.len(), |a, b| covariance(a, b).unwrap_or(f64::NAN))
    }

    /// A parameter by name.
    pub fn parameter(&self, name: &str) -> Option<&ParameterEstimate> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Effective degrees of freedom of the parameter of this name (Welch-Satterthwaite); nothing if they are infinite.
    pub fn degrees_of_freedom(&self, name: &str) -> Option<f64> {
        let place = self.parameters.iter().position(|p| p.name == name)?;
        self.budget.as_ref()?.degrees_of_freedom.get(place).copied().flatten()
    }

    /// Reads a result.
    ///
    /// # Errors
    /// [`Error`] when the file is not there or is not a result of this schema.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::parse(path, &read_result(path, "a result.json")?)
    }

    /// The result of a file with this `text`. Messages name `path`.
    ///
    /// # Errors
    /// As [`CalibrationResult::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, Error> {
        let result: Self = from_json(path, 1, text, &format!("a result of schema {SCHEMA:?}"))?;
        if result.schema != SCHEMA {
            let found = format!("schema {:?}", result.schema);
            return Err(Error::content(path, Place::Whole, found, format!("schema {SCHEMA:?}")));
        }
        if let Some(axes) = result.axes.as_ref().filter(|axes| !axes.is_turned()) {
            let found = format!("axes with the matrix {:?}", axes.matrix);
            return Err(Error::content(path, Place::Whole, found, "a rotation"));
        }
        if let Some((found, expected)) = contradiction(&result) {
            return Err(Error::content(path, Place::Whole, found, expected));
        }
        Ok(result)
    }

    /// Refuses the result of another unit than that of this `model` and `serial` number in `file`, and a file that is no result: nothing restores
    /// either. A result of the unit itself may be replaced.
    ///
    /// # Errors
    /// [`Error`] with the unit that was found, and the one that was expected.
    pub fn refuse_another_unit(file: &Path, model: &str, serial: &str) -> Result<(), Error> {
        if !file.exists() {
            return Ok(());
        }
        let of_unit = |model: &str, serial: &str| format!("the result of unit {model:?} {serial:?}");
        let there = Self::read(file).map_or("a file that is no result of this program".to_owned(), |result| {
            of_unit(&result.session.unit_model, &result.session.unit_serial)
        });
        let own = of_unit(model, serial);
        if there == own {
            return Ok(());
        }
        Err(Error::content(
            file,
            Place::Whole,
            there,
            format!("{own}, or no such file: give another folder, or remove it"),
        ))
    }

    /// The sources that the session states beyond what the fit weighs.
    pub fn stated_sources(&self) -> Vec<Source> {
        let sources = self.budget.iter().flat_map(|budget| &budget.sources);
        sources.filter(|source| !source.weighed_in_fit).map(|source| source.name).collect()
    }
}
