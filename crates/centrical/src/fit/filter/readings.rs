//! The whitened readings of one plateau.

use nalgebra::Vector3;

use crate::model::plateau::Whitener;
use crate::model::{FitError, Linearisation, Observation};

/// Three whitened readings of a plateau, linearised about a point of the unknowns: `rows (x - point) = misfit`.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// Non-zero columns: (index of the unknown, whitened derivative). Influences stand behind the parameters.
    pub columns: Vec<(usize, Vector3<f64>)>,
    /// Whitened reading less whitened model.
    pub misfit: Vector3<f64>,
    /// Norm of the whitened reading of the model.
    pub(in crate::fit) magnitude: f64,
}

impl Readings {
    /// Whitens a plateau by the covariance of its mean and the speed's rank-one term.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when the covariance is not positive definite.
    pub fn new(observation: &Observation, linearisation: &Linearisation) -> Result<Self, FitError> {
        let whitener = Whitener::new(observation, linearisation)?;
        Ok(Self {
            columns: linearisation.by_unknowns().map(|(column, d)| (column, whitener.apply(d))).collect(),
            misfit: whitener.apply(&(observation.mean - linearisation.reading)),
            magnitude: whitener.apply(&linearisation.reading).norm(),
        })
    }
}
