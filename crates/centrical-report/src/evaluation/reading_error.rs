//! Errors of the unit's readings on the plateaus, before and after compensation.

use centrical::uncertainty::Compensated;
use centrical::{ErrorModel, Monomial, Term};
use centrical_session::{CalibrationResult, PlateauSummary};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Errors of the reading on one plateau, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ReadingError {
    /// Specific force at the fitted geometry.
    pub force: Vector3<f64>,
    /// Mean reading less specific force.
    pub before: Vector3<f64>,
    /// Compensated mean reading less specific force at the set speed.
    pub after: Vector3<f64>,
    /// The same less what the plateau's own speed error explains.
    pub speed_free: Vector3<f64>,
    /// Standard uncertainty of `speed_free` from the noise of the mean.
    pub uncertainty: Vector3<f64>,
    /// Standard uncertainty that the parameters leave in a compensated reading of this specific force.
    pub prediction: Vector3<f64>,
}

/// Errors on every plateau; `None` if a coefficient of the error model is not determined.
pub(crate) fn reading_errors(result: &CalibrationResult) -> Option<Vec<ReadingError>> {
    let (model, coefficients) = error_model(result)?;
    let covariance = covariance(result)?;
    let prediction = Compensated::new(model.clone(), coefficients.clone(), covariance)?;
    result.plateaus.iter().map(|plateau| reading_error(plateau, &model, &coefficients, &prediction)).collect()
}

fn reading_error(
    plateau: &PlateauSummary,
    model: &ErrorModel,
    coefficients: &[f64],
    prediction: &Compensated,
) -> Option<ReadingError> {
    let force = Vector3::from(plateau.specific_force?);
    let residual = Vector3::from(plateau.residual);
    // A residual is small, so the inverse of the error model is that of its gain.
    let to_force = model.gain(coefficients, &force).try_inverse()?;
    let noise = to_force * matrix(&plateau.covariance) * to_force.transpose();
    Some(ReadingError {
        force,
        before: Vector3::from(plateau.mean) - force,
        after: to_force * residual,
        speed_free: to_force * (residual - of_speed(plateau, &residual)),
        uncertainty: noise.diagonal().map(f64::sqrt),
        prediction: prediction.covariance(&force)?.diagonal().map(|variance| variance.max(0.0).sqrt()),
    })
}

/// The part of a residual that the plateau's speed error explains: its conditional mean given the residual.
///
/// The weight of the fit is `C + s s^T`, `s` being the effect of one standard deviation of the speed; the estimate is
/// `s s^T (C + s s^T)^-1 r`.
fn of_speed(plateau: &PlateauSummary, residual: &Vector3<f64>) -> Vector3<f64> {
    let total = matrix(&plateau.fit_covariance);
    let speed = total - matrix(&plateau.covariance);
    total.cholesky().map_or_else(Vector3::zeros, |factor| speed * factor.solve(residual))
}

/// The unit's error model with its coefficients; `None` if one is not determined.
pub(crate) fn error_model(result: &CalibrationResult) -> Option<(ErrorModel, Vec<f64>)> {
    let mut terms = Vec::new();
    let mut coefficients = Vec::new();
    for term in &result.model.error_model {
        let parameter = result.parameter(&term.name)?;
        coefficients.push(parameter.value?);
        let monomial = Monomial { powers: term.powers, sign_of: term.sign_of.and_then(|axis| axis.checked_sub(1)) };
        let axis = term.axis.checked_sub(1).filter(|axis| *axis < 3)?;
        terms.push(Term { name: term.name.clone(), group: parameter.group, axis, monomial });
    }
    Some((ErrorModel { terms }, coefficients))
}

/// Covariance of the coefficients, in the order of the terms.
fn covariance(result: &CalibrationResult) -> Option<DMatrix<f64>> {
    let place = |name: &str| result.parameters.iter().position(|parameter| parameter.name == name);
    let places: Vec<usize> = result.model.error_model.iter().map(|t| place(&t.name)).collect::<Option<_>>()?;
    let entry = |i: usize, j: usize| *result.covariance.get(i)?.get(j)?;
    let entries: Option<Vec<f64>> = places.iter().flat_map(|&i| places.iter().map(move |&j| entry(i, j))).collect();
    Some(DMatrix::from_row_slice(places.len(), places.len(), &entries?))
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}
