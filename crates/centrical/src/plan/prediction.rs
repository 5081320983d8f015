//! Uncertainties before anything spins: type A from the planned noise, type B as stated.
//!
//! The budget of a fit of perfect readings, with the covariances that the plateaus are expected to have: the same computation
//! that a calibration makes of its data, so that what is predicted is what will be stated.
//!
//! **With a short rank** a unit without errors is not a point to predict at. Products of two unknowns couple a lost
//! combination to the others where these are not zero; their estimation errors alone suffice. At zero, calibrations of [K5.5]
//! as printed scatter by 1.12 times the prediction in `delta_2[3]`, and as much with a hundredth of the noise. Away from zero
//! the two agree. So such a plan is predicted for a unit with typical errors of alternating sign, as `montecarlo` draws it.
//!
//! A plan of full rank is predicted for a unit without errors. Where the speeds' errors outweigh the noise this matters: they act along
//! one known direction in each plateau, and turns and misalignments of a real unit, some 1e-4 rad, mix that direction into
//! the other axes. A unit of 0.3 typical magnitudes is stated 0.81 to 1.31 times what is predicted at none.

use nalgebra::{DMatrix, Vector3};

use super::candidates::{Candidates, Schedule, Visit};
use crate::fit::{Calibration, Data, Structure};
use crate::model::{Experiment, FitError, MeasurementModel, Mounting, Observation, Weight};
use crate::progress::unwatched;
use crate::uncertainty::{Budget, Compensated, CurvePoint, Rivals, Unseen};

/// The uncertainties that are expected of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    model: MeasurementModel,
    weights: Vec<Weight>,
    /// The unknowns that it is for.
    truth: Vec<f64>,
    budget: Budget,
    /// By parameter: whether the null space affects it.
    affected: Vec<bool>,
}

impl Prediction {
    /// Predicts the budget of a calibration of `model` with the plateaus' `weights`, for the unknowns `truth` (in the order of the
    /// model's parameters; all zero for a plan, which is predicted for typical ones where its rank is short).
    ///
    /// # Errors
    /// [`FitError`] when a weight is invalid.
    pub fn of(model: &MeasurementModel, weights: &[Weight], truth: &[f64]) -> Result<Prediction, FitError> {
        let (truth, structure) = unit_with_structure(model, weights, truth)?;
        let perfect = Data::new(model, readings(model, weights, &truth))?;
        let calibration = Calibration::with_structure(structure, &perfect)?;
        let budget = calibration.budget()?;
        let affected = (0..truth.len()).map(|j| budget.is_affected_by_null_space(calibration.fit(), j)).collect();
        Ok(Prediction { model: model.clone(), weights: weights.to_vec(), truth, budget, affected })
    }
}

impl Prediction {
    /// The unknowns that a plan is predicted for, and its calibrations are drawn for: those expected; or, without any and with
    /// a short rank, typical ones of alternating sign.
    ///
    /// # Errors
    /// As [`predict`].
    pub fn unit_of(model: &MeasurementModel, weights: &[Weight], expected: &[f64]) -> Result<Vec<f64>, FitError> {
        unit_with_structure(model, weights, expected).map(|(unit, _)| unit)
    }
}

fn unit_with_structure(
    model: &MeasurementModel,
    weights: &[Weight],
    expected: &[f64],
) -> Result<(Vec<f64>, Structure), FitError> {
    let structure = Structure::of(&Data::new(model, readings(model, weights, expected))?)?;
    let is_short = structure.observability().rank() < expected.len();
    let expects_none = expected.iter().all(|value| *value == 0.0);
    let unit = if expects_none && is_short { model.parameters().typical_alternating() } else { expected.to_vec() };
    Ok((unit, structure))
}

/// Perfect readings of a unit.
fn readings(model: &MeasurementModel, weights: &[Weight], truth: &[f64]) -> Vec<Observation> {
    let reading = |set_point: usize| {
        let set_point = model.experiment().set_points.get(set_point);
        set_point.map_or_else(Vector3::zeros, |set_point| model.reading(set_point, truth))
    };
    let of = |w: &Weight| Observation { set_point: w.set_point, mean: reading(w.set_point), covariance: w.covariance };
    weights.iter().map(of).collect()
}

impl Prediction {
    /// The model it is for.
    pub fn model(&self) -> &MeasurementModel {
        &self.model
    }

    /// The effects whose absence the calibration will rest on, the worst first.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn rests_on(&self) -> Result<Vec<Unseen>, FitError> {
        let perfect = Data::new(&self.model, readings(&self.model, &self.weights, &self.truth))?;
        Rivals::of(&Calibration::exact(&perfect)?, &unwatched)?.rests_on(&unwatched)
    }

    /// The budget by source.
    pub fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Combined standard uncertainty of parameter `j`, if it is determined and informative
    /// ([`crate::Parameter::is_informative`]) [its unit].
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.budget.standard_uncertainty(j).filter(|u| self.model.parameters()[j].is_informative(*u))
    }

    /// Whether lost combinations leave doubt in parameter `j` that is not in its uncertainty: see [`Budget::is_affected_by_null_space`].
    pub fn is_affected_by_null_space(&self, j: usize) -> bool {
        self.affected[j]
    }

    /// Standard uncertainty of parameter `j` by what the fit weighs alone, noise, speeds and priors, if it is determined
    /// [its unit].
    pub fn type_a(&self, j: usize) -> Option<f64> {
        let weighed = self.budget.contributions().iter().filter(|c| c.source.is_weighed());
        let variance: f64 = weighed.map(|c| c.standard_uncertainty(j).powi(2)).sum();
        self.standard_uncertainty(j).map(|_| variance.sqrt())
    }

    /// Root of the mean variance of the compensated reading over forces up to `range` [m/s^2], by what the fit weighs and by all sources
    /// [m/s^2]; `None` if a coefficient is not determined.
    pub fn reading(&self, range: f64) -> Option<[f64; 2]> {
        let all = self.covariance()?;
        let weighed = self.budget.contributions().iter().filter(|c| c.source.is_weighed());
        let p = self.model.parameters().len();
        let sum = weighed.fold(DMatrix::zeros(p, p), |sum, c| sum + c.covariance());
        let (first, count) = (self.model.parameters().first_term(), all.nrows());
        let weighed = sum.view((first, first), (count, count)).into_owned();
        Some([weighed, all].map(|covariance| self.model.reading_uncertainty(range, &covariance)))
    }

    /// Uncertainty of the compensated reading along each instrument axis from `-range` to `range` [m/s^2]; `None` if a
    /// coefficient is not determined.
    pub fn curves(&self, range: f64, points: usize) -> Option<[Vec<CurvePoint>; 3]> {
        let covariance = self.covariance()?;
        let nominal = self.model.error_model().with_coefficients(&vec![0.0; covariance.nrows()]);
        let compensated = Compensated::new(nominal, covariance)?;
        Some([0, 1, 2].map(|axis| compensated.curve(&Vector3::ith(axis, 1.0), range, points)))
    }

    /// Combined covariance of the coefficients in the order of the terms.
    fn covariance(&self) -> Option<DMatrix<f64>> {
        let (first, count) = (self.model.parameters().first_term(), self.model.error_model().terms.len());
        let mut covariance = DMatrix::zeros(count, count);
        for i in 0..count {
            self.standard_uncertainty(first + i)?;
            for j in 0..count {
                covariance[(i, j)] = self.budget.covariance(first + i, first + j)?;
            }
        }
        Some(covariance)
    }
}

impl Candidates {
    /// The experiment that a schedule makes: the positions and mountings it uses, its visits as set points; and for each
    /// visit its weight in the first scenario.
    pub fn experiment_of(&self, schedule: &Schedule) -> (Experiment, Vec<Weight>) {
        let all = self.experiment();
        let used: Vec<usize> = (0..all.mountings.len())
            .filter(|&m| schedule.visits.iter().any(|v| all.set_points[v.candidate].mounting == m))
            .collect();
        let kept: Vec<usize> =
            (0..all.positions.len()).filter(|&k| used.iter().any(|&m| all.mountings[m].position == k)).collect();
        let place = |list: &[usize], index: usize| list.iter().position(|i| *i == index).unwrap_or(0);
        let mounting = |m: &usize| {
            let Mounting { position, arm_y } = all.mountings[*m];
            Mounting { position: place(&kept, position), arm_y }
        };
        let set_point = |visit: &Visit| {
            let mut set_point = all.set_points[visit.candidate];
            set_point.mounting = place(&used, set_point.mounting);
            set_point
        };
        let experiment = Experiment {
            positions: kept.iter().map(|&k| all.positions[k].clone()).collect(),
            mountings: used.iter().map(mounting).collect(),
            set_points: schedule.visits.iter().map(set_point).collect(),
            ..all.clone()
        };
        let weight = |(n, visit): (usize, &Visit)| self.scenarios[0].noise.weight(n, visit.duration);
        (experiment, schedule.visits.iter().enumerate().map(weight).collect())
    }
}
