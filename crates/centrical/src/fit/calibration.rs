//! A fit with the data it was made of.

use std::sync::OnceLock;

use nalgebra::{Matrix3, Vector3};

use super::batch::{FitMethod, Start};
use super::data::Data;
use super::estimates::Fit;
use super::gain::Gain;
use super::structure::{Assembly, Structure};
use crate::model::plateau::total_covariance;
use crate::model::{FitError, SetPoint};
use crate::progress::{OnProgress, unwatched};

/// The data, the structure of their design, and the fit: all that a budget, checks and residual patterns ask for.
#[derive(Debug, Clone)]
pub struct Calibration<'d> {
    data: &'d Data<'d>,
    structure: Structure,
    fit: Fit,
    gain: OnceLock<Gain>,
}

impl<'d> Calibration<'d> {
    /// Gauss-Newton on the exact model to convergence, from the linear solution.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn exact(data: &'d Data<'d>) -> Result<Self, FitError> {
        Self::exact_watched(data, &unwatched)
    }

    /// [`Calibration::exact`], which calls `progress` before every iteration.
    ///
    /// # Errors
    /// As [`Calibration::exact`]; [`FitError::Stopped`].
    pub fn exact_watched(data: &'d Data<'d>, progress: OnProgress<()>) -> Result<Self, FitError> {
        Self::by(Assembly::Batch, FitMethod::Exact, data, progress)
    }

    /// Weighted least squares on the source's linear model [K5.3].
    ///
    /// # Errors
    /// As [`Calibration::exact`].
    pub fn linear(data: &'d Data<'d>) -> Result<Self, FitError> {
        Self::by(Assembly::Batch, FitMethod::Linear, data, &unwatched)
    }

    /// [`Calibration::exact`] by the iterated filter, in the order of the observations.
    ///
    /// # Errors
    /// As [`Calibration::exact`].
    pub fn recursive(data: &'d Data<'d>) -> Result<Self, FitError> {
        Self::by(Assembly::Filter, FitMethod::Exact, data, &unwatched)
    }

    /// [`Calibration::linear`] by one pass of the filter, in the order of the observations.
    ///
    /// # Errors
    /// As [`Calibration::exact`].
    pub fn recursive_linear(data: &'d Data<'d>) -> Result<Self, FitError> {
        Self::by(Assembly::Filter, FitMethod::Linear, data, &unwatched)
    }

    /// [`Calibration::exact`] with the structure of the design already known.
    ///
    /// # Errors
    /// As [`Calibration::exact`].
    pub(crate) fn with_structure(structure: Structure, data: &'d Data<'d>) -> Result<Self, FitError> {
        let fit = structure.fit(FitMethod::Exact, data)?;
        Ok(Self { data, structure, fit, gain: OnceLock::new() })
    }

    fn by(
        assembly: Assembly,
        method: FitMethod,
        data: &'d Data<'d>,
        progress: OnProgress<()>,
    ) -> Result<Self, FitError> {
        let (structure, design) = Structure::by(assembly, data)?;
        let fit = Start { data, structure: &structure, design }.fit(method, progress)?;
        Ok(Self { data, structure, fit, gain: OnceLock::new() })
    }

    /// The data.
    pub fn data(&self) -> &'d Data<'d> {
        self.data
    }

    /// The structure of the design.
    pub(crate) fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The fit.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// What the fit expects of a plateau that has no part in it: the covariance of its mean, whose noise has `covariance`, with
    /// the errors of its setting and rounding [m^2/s^4], and its reading [m/s^2].
    pub fn expected(&self, set_point: &SetPoint, covariance: &Matrix3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
        let at_parameters = self.data.model().linearise(set_point, self.fit.state());
        let there = at_parameters.with_influences(self.fit.unknowns());
        (total_covariance(covariance, &there), there.reading)
    }

    /// Whether the equations went through the filter.
    pub fn is_recursive(&self) -> bool {
        self.structure.assembly == Assembly::Filter
    }

    /// The fit alone.
    pub fn into_fit(self) -> Fit {
        self.fit
    }

    /// Estimate of the parameter of that name, if it exists and the data determine it.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.fit.value(self.data.model().parameters().find(name)?)
    }

    /// How the estimates answer to changes of the readings, factored when first asked for.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub(crate) fn gain(&self) -> Result<&Gain, FitError> {
        if let Some(gain) = self.gain.get() {
            return Ok(gain);
        }
        let gain = Gain::of(self.data, &self.structure, &self.fit)?;
        Ok(self.gain.get_or_init(|| gain))
    }
}
