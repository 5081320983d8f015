//! Priors: what is known of an unknown before any reading, as one more equation `(x_j - m_j) / sigma_j = 0 +- 1`.
//!
//! Unknowns are errors against nominal values, so the mean `m_j` of a prior is zero unless it was measured. A prior is never silent: an
//! estimate can be asked how much of its variance comes from priors ([`share`]), and a prior how much the data
//! have added to it ([`uses`]).

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::experiment::Experiment;
use super::parameter::Kind;
use super::parameters::Parameters;

/// Prior knowledge of one parameter: a mean with a standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Index of the parameter.
    pub parameter: usize,
    /// Mean, in the parameter's unit.
    pub mean: f64,
    /// Standard uncertainty, in the parameter's unit.
    pub standard_uncertainty: f64,
}

/// Why a prior is invalid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PriorError {
    /// The name stands for no parameter.
    #[error("prior {name:?}: found no such parameter or group, expected a name such as {example}")]
    Unknown {
        /// As given.
        name: String,
        /// A name that would do.
        example: String,
    },
    /// The name stands for parameters of different units.
    #[error("prior {name:?}: found parameters in {} and in {}, expected one unit", units[0], units[1])]
    MixedUnits {
        /// As given.
        name: String,
        /// Two of the units.
        units: [String; 2],
    },
    /// The mean is not a finite number.
    #[error("prior {name:?}: found a mean of {found}, expected a finite number")]
    Mean {
        /// As given.
        name: String,
        /// As given.
        found: f64,
    },
    /// The uncertainty is not a positive number.
    #[error("prior {name:?}: found a standard uncertainty of {found}, expected a positive number")]
    NotPositive {
        /// As given.
        name: String,
        /// As given.
        found: f64,
    },
    /// A parameter has a prior already.
    #[error("prior {name:?}: found a second prior on {parameter}, expected one")]
    Duplicate {
        /// As given.
        name: String,
        /// The parameter.
        parameter: String,
    },
}

/// The attitudes of rests that are known: `theta` is zero with the uncertainty of its position.
pub(crate) fn of_known_attitudes(experiment: &Experiment, parameters: &Parameters) -> Vec<Prior> {
    let known = parameters.iter().enumerate().filter_map(|(parameter, unknown)| {
        let Kind::Attitude { position, .. } = unknown.kind else { return None };
        let standard_uncertainty = experiment.positions[position].attitude_uncertainty?;
        Some(Prior { parameter, mean: 0.0, standard_uncertainty })
    });
    known.collect()
}

/// Priors on all parameters that `name` selects.
pub(crate) fn select(
    parameters: &Parameters,
    present: &[Prior],
    name: &str,
    mean: f64,
    standard_uncertainty: f64,
) -> Result<Vec<Prior>, PriorError> {
    let name = name.to_owned();
    if !(standard_uncertainty > 0.0 && standard_uncertainty.is_finite()) {
        return Err(PriorError::NotPositive { name, found: standard_uncertainty });
    }
    if !mean.is_finite() {
        return Err(PriorError::Mean { name, found: mean });
    }
    let selected = parameters.select(&name);
    let Some(first) = selected.first().map(|&j| &parameters[j]) else {
        return Err(PriorError::Unknown { name, example: parameters[0].name.clone() });
    };
    for &j in &selected {
        let parameter = &parameters[j];
        if parameter.unit != first.unit {
            return Err(PriorError::MixedUnits { name, units: [first.unit.clone(), parameter.unit.clone()] });
        }
        if present.iter().any(|prior| prior.parameter == j) {
            return Err(PriorError::Duplicate { name, parameter: parameter.name.clone() });
        }
    }
    Ok(selected.into_iter().map(|parameter| Prior { parameter, mean, standard_uncertainty }).collect())
}

/// Each prior with the standard uncertainty after the data over that before, from the covariance of the estimates with the priors in.
pub(crate) fn uses(priors: &[Prior], covariance: impl Fn(usize, usize) -> f64) -> Vec<(Prior, f64)> {
    let ratio = |p: &Prior| covariance(p.parameter, p.parameter).sqrt() / p.standard_uncertainty;
    priors.iter().map(|prior| (*prior, ratio(prior))).collect()
}

/// Part of the variance of estimate `j` that comes from the priors: `sum_k (C_jk / sigma_k)^2 / C_jj`, from 0 (data
/// alone) to 1 (priors alone).
///
/// The weighted least-squares estimate is `x = C A^T b` of independent unit-variance `b`; the row of prior `k` is
/// `e_k / sigma_k`, so its `b` contributes `(C_jk / sigma_k)^2` to `C_jj`.
pub(crate) fn share(priors: &[Prior], j: usize, covariance: impl Fn(usize, usize) -> f64) -> f64 {
    let from = |p: &Prior| (covariance(j, p.parameter) / p.standard_uncertainty).powi(2);
    // What curvature adds to the covariance belongs to the priors, and may exceed what they state.
    (priors.iter().map(from).sum::<f64>() / covariance(j, j)).min(1.0)
}

/// What the rows of the priors miss at `x`: `(m_j - x_j) / sigma_j`.
pub(crate) fn misfit(priors: &[Prior], x: &DVector<f64>) -> DVector<f64> {
    let missed = |prior: &Prior| (prior.mean - x[prior.parameter]) / prior.standard_uncertainty;
    DVector::from_iterator(priors.len(), priors.iter().map(missed))
}

/// The rows `e_j / sigma_j` of the priors.
pub(crate) fn rows(priors: &[Prior], columns: usize) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(priors.len(), columns);
    for (n, prior) in priors.iter().enumerate() {
        rows[(n, prior.parameter)] = 1.0 / prior.standard_uncertainty;
    }
    rows
}
