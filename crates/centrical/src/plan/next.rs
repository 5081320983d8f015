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

/// The benefit of each of `candidates` after the plateaus `taken`, the best first. Unknowns that are not determined yet are held
/// by ten typical magnitudes, so that a plateau that determines a new one comes before one that repeats.
///
/// # Errors
/// [`PlanError`] when a weight is invalid, or a goal names an unknown parameter.
pub fn next_best(
    model: &MeasurementModel,
    criterion: &Criterion,
    taken: &[Weight],
    candidates: &[Weight],
) -> Result<Vec<Benefit>, PlanError> {
    let none = vec![0.0; model.parameters().len()];
    let scenario = LinearisedScenario::of(model, &none, criterion)?;
    let factor = factor_of(&scenario, (model, &none), taken)?;
    let before = LinearisedScenario::value(&factor);
    let mut benefits = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let dn = precision(model, &none, candidate)?;
        let after = scenario.value_after(&factor, &scenario.insight(&factor, candidate.set_point), &dn);
        benefits.push(Benefit { set_point: candidate.set_point, factor: (0.5 * (after - before)).exp() });
    }
    benefits.sort_by(|a, b| a.factor.total_cmp(&b.factor).then(a.set_point.cmp(&b.set_point)));
    Ok(benefits)
}

fn factor_of(
    scenario: &LinearisedScenario,
    (model, none): (&MeasurementModel, &[f64]),
    taken: &[Weight],
) -> Result<Factor, PlanError> {
    let information = taken.iter().map(|weight| Ok((weight.set_point, precision(model, none, weight)?)));
    Ok(scenario.factor(&information.collect::<Result<Vec<(usize, Matrix3<f64>)>, PlanError>>()?))
}
