//! The best next plateau after some have been measured.

use nalgebra::{DMatrix, Matrix3};

use super::criterion::Criterion;
use super::error::PlanError;
use super::information::{LinearisedScenario, precision};
use crate::model::{MeasurementModel, Weight};

/// How much the next plateau would improve the criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Benefit {
    /// The plateau, by its index in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// The criterion after it over that before, as an uncertainty: below 1.
    pub factor: f64,
}

/// What a next plateau would bring after those that have been taken up. Unknowns that are not determined yet are held by
/// ten typical magnitudes, so that a plateau that determines a new one comes before one that repeats.
#[derive(Debug, Clone)]
pub struct NextPlateau<'m> {
    model: &'m MeasurementModel,
    nominal: Vec<f64>,
    scenario: LinearisedScenario,
    /// `R` of the information so far: it is brought up to date with the square of the unknowns, what is made of it with their cube.
    triangle: DMatrix<f64>,
}

impl<'m> NextPlateau<'m> {
    /// Before the first plateau.
    ///
    /// # Errors
    /// [`PlanError`] when a goal names an unknown parameter.
    pub fn new(model: &'m MeasurementModel, criterion: &Criterion) -> Result<Self, PlanError> {
        let nominal = vec![0.0; model.parameters().len()];
        let scenario = LinearisedScenario::of(model, &nominal, criterion)?;
        let triangle = scenario.held();
        Ok(Self { model, nominal, scenario, triangle })
    }

    /// Takes plateaus up.
    ///
    /// # Errors
    /// [`PlanError`] when a weight is invalid.
    pub fn take(&mut self, plateaus: &[Weight]) -> Result<(), PlanError> {
        let information = plateaus.iter().map(|weight| Ok((weight.set_point, self.precision(weight)?)));
        let information = information.collect::<Result<Vec<(usize, Matrix3<f64>)>, PlanError>>()?;
        self.triangle = self.scenario.stacked(std::mem::take(&mut self.triangle), &information);
        Ok(())
    }

    /// The benefit of each of `candidates`, the best first.
    ///
    /// # Errors
    /// [`PlanError`] when a weight is invalid.
    pub fn benefits(&self, candidates: &[Weight]) -> Result<Vec<Benefit>, PlanError> {
        let factor = self.scenario.factor_of(self.triangle.clone());
        let before = LinearisedScenario::value(&factor);
        let benefit = |candidate: &Weight| {
            let insight = self.scenario.insight(&factor, candidate.set_point);
            let after = self.scenario.value_after(&factor, &insight, &self.precision(candidate)?);
            Ok(Benefit { set_point: candidate.set_point, factor: (0.5 * (after - before)).exp() })
        };
        let mut benefits = candidates.iter().map(benefit).collect::<Result<Vec<_>, PlanError>>()?;
        benefits.sort_by(|a, b| a.factor.total_cmp(&b.factor).then(a.set_point.cmp(&b.set_point)));
        Ok(benefits)
    }

    fn precision(&self, weight: &Weight) -> Result<Matrix3<f64>, PlanError> {
        precision(self.model, &self.nominal, weight)
    }
}
