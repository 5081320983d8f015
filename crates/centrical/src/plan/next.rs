//! The best next plateau after some have been measured.

use nalgebra::{DMatrix, Matrix3};

use super::criterion::Criterion;
use super::error::PlanError;
use super::information::{LinearisedScenario, precision};
use crate::model::{MeasurementModel, Weight};

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

    /// Set point of each of `candidates`, with its benefit: the criterion after it over that before, as an uncertainty, below 1. The best first.
    ///
    /// # Errors
    /// [`PlanError`] when a weight is invalid.
    pub fn benefits(&self, candidates: &[Weight]) -> Result<Vec<(usize, f64)>, PlanError> {
        let factor = self.scenario.factor_of(self.triangle.clone());
        let before = LinearisedScenario::value(&factor);
        let benefit = |candidate: &Weight| {
            let insight = self.scenario.insight(&factor, candidate.set_point);
            let after = self.scenario.value_after(&factor, &insight, &self.precision(candidate)?);
            Ok((candidate.set_point, (0.5 * (after - before)).exp()))
        };
        let mut benefits = candidates.iter().map(benefit).collect::<Result<Vec<_>, PlanError>>()?;
        benefits.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        Ok(benefits)
    }

    fn precision(&self, weight: &Weight) -> Result<Matrix3<f64>, PlanError> {
        precision(self.model, &self.nominal, weight)
    }
}
