//! A design under study: a session, a plan or the normalised experiment, with the weights of its plateaus.

use nalgebra::DMatrix;

use crate::model::plateau::{whitened_rows, with_prior_rows};
use crate::model::prior;
use crate::model::{FitError, Linearisation, MeasurementModel, Prior, Weight};

use super::combination::Combination;
use super::rank::Observability;

/// Observability of a design: rank and undetermined combinations, with all that their causes and remedies follow from.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    model: MeasurementModel,
    weights: Vec<Weight>,
    linearisations: Vec<Linearisation>,
    observability: Observability,
    of_data: Option<Observability>,
}

impl Study {
    /// Studies the source's design `H` [K5.3], at `X = 0`, where the structure of the experiment is exact: what is
    /// lost there is lost for good, though second-order traces of it may show elsewhere.
    ///
    /// # Errors
    /// [`FitError`] when a weight names no plateau or is not a covariance, or when numbers overflow.
    pub fn at_zero(model: MeasurementModel, weights: Vec<Weight>) -> Result<Self, FitError> {
        check(&model, &weights)?;
        let set_points = &model.experiment().set_points;
        let linearisations = weights.iter().map(|w| model.linearise_at_zero(&set_points[w.set_point])).collect();
        Self::of(model, weights, linearisations)
    }

    fn of(model: MeasurementModel, weights: Vec<Weight>, linearisations: Vec<Linearisation>) -> Result<Self, FitError> {
        let rows = whitened_rows(&weights, &linearisations, model.parameters().len() + model.influences().len())?;
        if rows.iter().any(|entry| !entry.is_finite()) {
            return Err(FitError::Overflow);
        }
        let priors = model.priors();
        let of_data = (!priors.is_empty()).then(|| observability(&model, &weights, rows.clone(), &[]));
        let observability = observability(&model, &weights, rows, priors);
        Ok(Self { model, weights, linearisations, observability, of_data })
    }

    /// The model under study.
    pub fn model(&self) -> &MeasurementModel {
        &self.model
    }

    /// What is known of its plateaus.
    pub fn weights(&self) -> &[Weight] {
        &self.weights
    }

    /// The plateaus' linearisations, in the order of the weights.
    pub fn linearisations(&self) -> &[Linearisation] {
        &self.linearisations
    }

    /// What is seen, priors included.
    pub fn observability(&self) -> &Observability {
        &self.observability
    }

    /// What the data see without the priors.
    pub fn of_data(&self) -> &Observability {
        self.of_data.as_ref().unwrap_or(&self.observability)
    }

    /// Standard uncertainty to be expected of parameter `j`, in its unit, if it is determined.
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.observability.standard_uncertainty(&Combination::new([(j, 1.0)]))
    }

    /// Whether parameter `j` is determined only thanks to the priors.
    pub fn rests_on_prior(&self, j: usize) -> bool {
        self.observability.is_estimable(j) && !self.of_data().is_estimable(j)
    }

    /// Part of the variance of parameter `j` that comes from the priors, 0 to 1; `None` if it is not determined.
    pub fn prior_share(&self, j: usize) -> Option<f64> {
        let share = || prior::share(self.model.priors(), j, |i, j| self.observability.covariance(i, j));
        self.observability.is_estimable(j).then(share)
    }

    /// Each prior with the standard uncertainty after the data over that before: 1 when the value rests on the prior alone, near 0 when the data
    /// determine it.
    pub fn prior_uses(&self) -> Vec<(Prior, f64)> {
        prior::uses(self.model.priors(), |i, j| self.observability.covariance(i, j))
    }
}

/// What plateaus with the whitened `rows` determine, with `priors`.
fn observability(model: &MeasurementModel, weights: &[Weight], rows: DMatrix<f64>, priors: &[Prior]) -> Observability {
    let influences = model.influences().len();
    let rows = with_prior_rows(rows, priors, influences);
    let set_points: Vec<usize> = weights.iter().map(|weight| weight.set_point).collect();
    Observability::of(rows, &model.attitudes_of_single_rests(&set_points, priors), influences)
}

fn check(model: &MeasurementModel, weights: &[Weight]) -> Result<(), FitError> {
    let count = model.experiment().set_points.len();
    for weight in weights {
        let set_point = weight.set_point;
        if set_point >= count {
            return Err(FitError::Unknown { set_point, count });
        }
        if !weight.covariance.iter().all(|v| v.is_finite()) {
            return Err(FitError::NotFinite { set_point });
        }
    }
    if weights.is_empty() { Err(FitError::Empty) } else { Ok(()) }
}
