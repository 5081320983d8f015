//! The best next plateau after some have been done.

use nalgebra::Matrix3;

use super::criterion::Criterion;
use super::error::PlanError;
use super::information::{Factor, Scene, precision};
use crate::model::{MeasurementModel, Weight};

/// What a plateau would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// The plateau, by its index in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// The criterion after it over that before, as an uncertainty: below 1.
    pub factor: f64,
}

/// What each of `candidates` would bring after the plateaus `taken`, the best first. What is not determined yet is held by
/// ten typical magnitudes, so that a plateau that determines something new comes before one that repeats.
///
/// # Errors
/// [`PlanError`] when a weight cannot be one, or a goal names no parameter.
pub fn next_best(
    model: &MeasurementModel,
    criterion: &Criterion,
    taken: &[Weight],
    candidates: &[Weight],
) -> Result<Vec<Gain>, PlanError> {
    let none = vec![0.0; model.parameters().len()];
    let scene = Scene::of(model, &none, criterion)?;
    let factor = factor_of(&scene, (model, &none), taken)?;
    let before = Scene::value(&factor);
    let mut gains = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let dn = precision(model, &none, candidate)?;
        let after = scene.value_after(&factor, &scene.insight(&factor, candidate.set_point), &dn);
        gains.push(Gain { set_point: candidate.set_point, factor: (0.5 * (after - before)).exp() });
    }
    gains.sort_by(|a, b| a.factor.total_cmp(&b.factor).then(a.set_point.cmp(&b.set_point)));
    Ok(gains)
}

fn factor_of(scene: &Scene, (model, none): (&MeasurementModel, &[f64]), taken: &[Weight]) -> Result<Factor, PlanError> {
    let information = taken.iter().map(|weight| Ok((weight.set_point, precision(model, none, weight)?)));
    Ok(scene.factor(&information.collect::<Result<Vec<(usize, Matrix3<f64>)>, PlanError>>()?))
}
