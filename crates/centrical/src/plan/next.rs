//! The best next plateau after some have been measured.

use nalgebra::Matrix3;

use super::criterion::Criterion;
use super::error::PlanError;
use super::information::{Factor, LinearisedScenario, precision};
use crate::model::{MeasurementModel, Weight};

/// How much the next plateau would improve the criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Benefit {
    /// The plateau, by its index in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// The criterion after it over that before, as an uncertainty: below 1.
    pub factor: f64,
}

/// What a next plateau would bring, kept up to date as plateaus are taken up. Unknowns that are not determined yet are held by
/// ten typical magnitudes, so that a plateau that determines a new one comes before one that repeats.
#[derive(Debug, Clone)]
pub struct NextPlateau<'m> {
    model: &'m MeasurementModel,
    nominal: Vec<f64>,
    scenario: LinearisedScenario,
    factor: Factor,
}

impl<'m> NextPlateau<'m> {
    /// Before the first plateau.
    ///
    /// # Errors
    /// [`PlanError`] when a goal names an unknown parameter.
    pub fn new(model: &'m MeasurementModel, criterion: &Criterion) -> Result<Self, PlanError> {
        let nominal = vec![0.0; model.parameters().len()];
        let scenario = LinearisedScenario::of(model, &nominal, criterion)?;
        let factor = scenario.factor(&[]);
        Ok(Self { model, nominal, scenario, factor })
    }

    /// Takes plateaus up.
    ///
    /// # Errors
    /// [`PlanError`] when a weight is invalid.
    pub fn take(&mut self, plateaus: &[Weight]) -> Result<(), PlanError> {
        let information = plateaus.iter().map(|weight| Ok((weight.set_point, self.precision(weight)?)));
        let information = information.collect::<Result<Vec<(usize, Matrix3<f64>)>, PlanError>>()?;
        self.factor = self.scenario.with(&self.factor, &information);
        Ok(())
    }

    /// The benefit of each of `candidates`, the best first.
    ///
    /// # Errors
    /// [`PlanError`] when a weight is invalid.
    pub fn benefits(&self, candidates: &[Weight]) -> Result<Vec<Benefit>, PlanError> {
        let before = LinearisedScenario::value(&self.factor);
        let benefit = |candidate: &Weight| {
            let insight = self.scenario.insight(&self.factor, candidate.set_point);
            let after = self.scenario.value_after(&self.factor, &insight, &self.precision(candidate)?);
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
