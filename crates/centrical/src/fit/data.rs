//! Plateau means together with the model of them.

use nalgebra::{DVector, Matrix3, Vector3};

use crate::model::plateau::{Whitener, total_covariance};
use crate::model::{FitError, Linearisation, MeasurementModel, Observation, SetPoint, Weight};

/// What is fitted: the plateau means and the model of them, checked once.
#[derive(Debug, Clone, PartialEq)]
pub struct Data<'m> {
    model: &'m MeasurementModel,
    observations: Vec<Observation>,
}

impl<'m> Data<'m> {
    /// Plateau means of `model`.
    ///
    /// # Errors
    /// [`FitError`] when an observation is invalid, or without any.
    pub fn new(model: &'m MeasurementModel, observations: Vec<Observation>) -> Result<Self, FitError> {
        observations.iter().try_for_each(|observation| Self::check(model, observation))?;
        if observations.is_empty() { Err(FitError::Empty) } else { Ok(Self { model, observations }) }
    }

    /// No plateau yet.
    pub(super) fn none(model: &'m MeasurementModel) -> Self {
        Self { model, observations: Vec::new() }
    }

    /// The model.
    pub fn model(&self) -> &'m MeasurementModel {
        self.model
    }

    /// The plateau means.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// Adds a plateau.
    pub(super) fn push(&mut self, observation: Observation) -> Result<(), FitError> {
        Self::check(self.model, &observation)?;
        self.observations.push(observation);
        Ok(())
    }

    /// The data without observation `n`, unless it is the only one.
    pub(crate) fn without(&self, n: usize) -> Result<Self, FitError> {
        let mut observations = self.observations.clone();
        observations.remove(n);
        Self::new(self.model, observations)
    }

    /// The source's linear model of each plateau.
    pub(super) fn linearised_at_zero(&self) -> Vec<Linearisation> {
        self.set_points().map(|set_point| self.model.linearise_at_zero(set_point)).collect()
    }

    /// Number of unknowns of a fit: parameters, then influences in their standard uncertainties.
    pub(super) fn unknowns(&self) -> usize {
        self.model.parameters().len() + self.model.influences().len()
    }

    /// Sizes of the unknowns of a fit: typical magnitudes of the parameters, 1 for the influences.
    pub(super) fn typical(&self) -> DVector<f64> {
        let parameters = self.model.parameters().iter().map(|p| p.typical);
        let influences = self.model.influences().iter().map(|_| 1.0);
        DVector::from_iterator(self.unknowns(), parameters.chain(influences))
    }

    /// The exact model of each plateau, linearised at the unknowns `x` of a fit.
    pub(super) fn linearised(&self, x: &[f64]) -> Vec<Linearisation> {
        let parameters = &x[..self.model.parameters().len()];
        self.set_points().map(|set_point| self.model.linearise(set_point, parameters).with_influences(x)).collect()
    }

    /// Readings less those of the exact model at the unknowns `x` of a fit [m/s^2].
    pub(super) fn residuals(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let pairs = self.observations.iter().zip(self.set_points());
        let residual = |(o, set_point): (&Observation, _)| o.mean - self.model.reading_with_influences(set_point, x);
        pairs.map(residual).collect()
    }

    /// Sum of squares of `residuals`, which are those at `x`, with the weights of the linearisations; and the priors' share.
    pub(super) fn chi_squared(
        &self,
        linearisations: &[Linearisation],
        residuals: &[Vector3<f64>],
        x: &DVector<f64>,
    ) -> Result<f64, FitError> {
        let mut sum = self.squared_beforehand(x);
        for ((observation, linearisation), residual) in self.observations.iter().zip(linearisations).zip(residuals) {
            sum += Whitener::new(observation, linearisation)?.apply(residual).norm_squared();
        }
        Ok(sum)
    }

    /// The share of the priors and the influences in the sum of squares at `x`.
    pub(super) fn squared_beforehand(&self, x: &DVector<f64>) -> f64 {
        let priors = self.model.priors().iter();
        let sum: f64 = priors.map(|p| ((x[p.parameter] - p.mean) / p.standard_uncertainty).powi(2)).sum();
        sum + x.rows_range(self.model.parameters().len()..).norm_squared()
    }

    /// Covariance of each plateau with the errors of it alone [m^2/s^4].
    pub(super) fn covariances(&self, linearisations: &[Linearisation]) -> Vec<Matrix3<f64>> {
        let pairs = self.observations.iter().zip(linearisations);
        pairs.map(|(o, l)| total_covariance(&o.covariance, l)).collect()
    }

    fn set_points(&self) -> impl Iterator<Item = &'m SetPoint> {
        let set_points = &self.model.experiment().set_points;
        self.observations.iter().map(|observation| &set_points[observation.set_point])
    }

    /// Whether an observation can be one of the model.
    pub(super) fn check(model: &MeasurementModel, observation: &Observation) -> Result<(), FitError> {
        let count = model.experiment().set_points.len();
        let set_point = observation.set_point;
        if set_point >= count {
            return Err(FitError::Unknown { set_point, count });
        }
        if !observation.mean.iter().chain(observation.covariance.iter()).all(|v| v.is_finite()) {
            return Err(FitError::NotFinite { set_point });
        }
        Weight::from(observation).factor(observation.covariance).map(|_| ())
    }
}
