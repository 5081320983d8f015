//! How the uncertainties shrink as the session goes on: those of all unknowns after each plateau.
//!
//! Square-root information form: the triangular factor `R` of the whitened design starts from a standard deviation of
//! [`Parameter::NULL_HOLD`] typical magnitudes for every unknown and from the priors, and the plateaus of each stage add their whitened rows by a
//! QR factorisation. The uncertainties are the lengths of the rows of `R^-1`. The attitude of a rest is an unknown of that rest alone: it is
//! eliminated with it ([`Global`]), so that the time is linear in rests.

use nalgebra::DMatrix;

use super::calibration::Calibration;
use super::global::Global;
use crate::linalg::least_squares::LeastSquares;
use crate::model::plateau::Readings;
use crate::model::{FitError, Parameter};

/// The uncertainties at some stage of the session.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// Plateaus used so far.
    pub plateaus: usize,
    /// Standard uncertainty of every unknown, SI, in the order of the model's parameters; `None` of attitudes of single rests.
    pub standard_uncertainty: Vec<Option<f64>>,
}

impl Calibration<'_> {
    /// Standard uncertainties at no more than `most` evenly spread stages of the session; the last stage has all plateaus.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when a covariance is not positive definite at the estimate.
    pub fn convergence(&self, most: usize) -> Result<Vec<Checkpoint>, FitError> {
        let data = self.data();
        let (observations, x) = (data.observations(), self.fit().unknowns());
        let (global, parameters) = (Global::of(data.model()), data.model().parameters().len());
        let (count, sizes) = (global.len(), global.part(&data.typical()));
        let hold = |j: usize| if global.columns()[j] < parameters { Parameter::NULL_HOLD.powi(-2) } else { 1.0 };
        let of_priors = global.squared_lengths_of_priors().component_mul(&sizes).component_mul(&sizes);
        let mut triangle = DMatrix::from_diagonal(&of_priors.map_with_location(|j, _, prior| (prior + hold(j)).sqrt()));
        let (every, mut plateaus) = (observations.len().div_ceil(most.max(1)).max(1), 0);
        let mut checkpoints = Vec::new();
        let linearisations = data.linearised(x);
        for (observations, linearisations) in observations.chunks(every).zip(linearisations.chunks(every)) {
            let mut stack = DMatrix::zeros(count + 3 * observations.len(), count);
            for (n, (observation, linearisation)) in observations.iter().zip(linearisations).enumerate() {
                let readings = Readings::new(observation, linearisation)?;
                global.equations_of(observation.set_point, &readings, x).fill(&mut stack, count + 3 * n);
            }
            stack.column_iter_mut().zip(sizes.iter()).for_each(|(mut column, size)| column *= *size);
            stack.rows_mut(0, count).copy_from(&triangle);
            let equations = LeastSquares::new(stack, sizes.clone());
            triangle.copy_from(equations.triangle());
            plateaus += observations.len();
            let mut standard_uncertainty = vec![None; x.len()];
            for (column, uncertainty) in global.columns().iter().zip(equations.standard_uncertainties()) {
                standard_uncertainty[*column] = Some(uncertainty);
            }
            standard_uncertainty.truncate(parameters);
            checkpoints.push(Checkpoint { plateaus, standard_uncertainty });
        }
        Ok(checkpoints)
    }
}
