//! The measurement model: an experiment, the unit's error model, and the unknowns that follow from the two.

use nalgebra::{Matrix3, Vector3};

use super::error_model::ErrorModel;
use super::experiment::Experiment;
use super::frame::carousel;
use super::parameter::{Extension, Parameters};
use super::prior::{self, Prior, PriorError};

/// An experiment, the unit's error model, and the unknowns that follow from the two.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementModel {
    pub(super) experiment: Experiment,
    pub(super) error_model: ErrorModel,
    extensions: Vec<Extension>,
    pub(super) parameters: Parameters,
    priors: Vec<Prior>,
    /// Turns of the carousel over which a reading is averaged while spinning.
    pub(super) revolution: Vec<Matrix3<f64>>,
}

/// Reading of a plateau and its first derivatives at some `X`.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Mean reading `f'` [m/s^2].
    pub reading: Vector3<f64>,
    /// Change of `f'` by one standard uncertainty of the plateau's speed [m/s^2]: `sigma d f' / d ln Omega`. Zero at rest.
    pub speed_error: Vector3<f64>,
    /// Non-zero columns of the Jacobian: (index of the parameter, `d f' / d x`), each index once.
    pub columns: Vec<(usize, Vector3<f64>)>,
}

impl MeasurementModel {
    /// Model of `experiment` with the unknowns of [K5.4] and `extensions`.
    pub fn new(experiment: Experiment, error_model: ErrorModel, extensions: &[Extension]) -> Self {
        let parameters = Parameters::new(&experiment, &error_model, extensions);
        let revolution = revolution(&error_model);
        Self { experiment, error_model, extensions: extensions.to_vec(), parameters, priors: Vec::new(), revolution }
    }

    /// The same unit, extensions and priors in another experiment. A prior on a parameter that the other experiment
    /// does not have falls away.
    #[must_use]
    pub fn in_experiment(&self, experiment: Experiment) -> Self {
        let mut other = Self::new(experiment, self.error_model.clone(), &self.extensions);
        let renamed = |prior: &Prior| {
            let parameter = other.parameters.find(&self.parameters[prior.parameter].name)?;
            Some(Prior { parameter, ..*prior })
        };
        other.priors = self.priors.iter().filter_map(renamed).collect();
        other
    }

    /// The model with a prior of `standard_uncertainty` [the unit of the parameter] about zero on every parameter that
    /// `name` selects (see [`Parameters::select`]).
    ///
    /// # Errors
    /// [`PriorError`] when there is no such parameter, when the selected ones differ in unit, when one of them has a
    /// prior already, or when the uncertainty is not a positive number.
    pub fn with_prior(mut self, name: &str, standard_uncertainty: f64) -> Result<Self, PriorError> {
        let priors = prior::select(&self.parameters, &self.priors, name, standard_uncertainty)?;
        self.priors.extend(priors);
        Ok(self)
    }

    /// What is known beforehand.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// The unit's error model.
    pub fn error_model(&self) -> &ErrorModel {
        &self.error_model
    }

    /// The unknowns.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// What is known of the unknowns beforehand.
    pub fn priors(&self) -> &[Prior] {
        &self.priors
    }
}

/// Equal steps of the carousel over which the mean of every monomial is exact: one more than its degree.
fn revolution(error_model: &ErrorModel) -> Vec<Matrix3<f64>> {
    let degree = error_model.terms.iter().map(|t| t.monomial.degree()).max().unwrap_or(0).max(2);
    let steps = f64::from(degree) + 1.0;
    (0..=degree).map(|n| carousel(std::f64::consts::TAU * f64::from(n) / steps)).collect()
}
