//! Errors of the unit's readings on the plateaus, before and after compensation.

use std::collections::HashSet;

use centrical::uncertainty::{Compensated, Degrees};
use centrical_session::{CalibrationResult, PlateauSummary};
use nalgebra::{Matrix3, Vector3};

use super::expanded::expanded_of_independent;

/// Errors of the reading on one plateau, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ReadingError {
    /// Specific force at the fitted geometry.
    pub force: Vector3<f64>,
    /// Mean reading less specific force.
    pub before: Vector3<f64>,
    /// Compensated mean reading less specific force at the set speed; of a rest beside the arm along the force alone.
    pub after: Vector3<f64>,
    /// The same less what the plateau's own speed error explains.
    pub speed_free: Vector3<f64>,
    /// Standard uncertainty of `speed_free` from the noise of the mean.
    pub uncertainty: Vector3<f64>,
    /// Expanded uncertainty that the parameters leave in a compensated reading of this specific force.
    pub expanded_prediction: Vector3<f64>,
    /// Expanded uncertainty of `speed_free` from both.
    pub expanded: Vector3<f64>,
}

/// Errors on every plateau; `None` if a coefficient of the error model is not determined, or a covariance is not positive definite.
pub(crate) fn reading_errors(result: &CalibrationResult) -> Option<Vec<ReadingError>> {
    let compensated = compensated(result)?;
    let of_rests: HashSet<usize> = result.rests().map(|rest| rest.mounting).collect();
    let degrees = [1, 2, 3].map(|axis| fewest_degrees(result, axis));
    let error =
        |plateau: &PlateauSummary| reading_error(plateau, of_rests.contains(&plateau.mounting), &compensated, &degrees);
    result.plateaus.iter().map(error).collect()
}

/// Expanded uncertainty that the parameters leave along each axis in a compensated reading of a specific force along it of this size, the larger
/// of both senses [m/s^2]; `None` if a coefficient is not determined.
pub(crate) fn expanded_along_axes(result: &CalibrationResult, size: f64) -> Option<[f64; 3]> {
    let compensated = compensated(result)?;
    let along =
        |j: usize| compensated.curve(&Vector3::ith(j, 1.0), size, 2).iter().map(|end| end.along).fold(0.0, f64::max);
    Some([0, 1, 2].map(|j| expanded_of_independent(&[(along(j), fewest_degrees(result, j + 1))])))
}

/// Fewest effective degrees of freedom of the coefficients of a newtonometer, for all that they leave in a compensated reading: the result
/// has the share of a source in each coefficient, but not in their combination.
fn fewest_degrees(result: &CalibrationResult, axis: usize) -> Degrees {
    let own = result.model.error_model.iter().filter(|term| term.axis == axis);
    let fewest = own.filter_map(|term| result.degrees_of_freedom(&term.name)).reduce(f64::min);
    fewest.map_or(Degrees::Infinite, Degrees::Finite)
}

fn reading_error(
    plateau: &PlateauSummary,
    is_rest: bool,
    compensated: &Compensated,
    degrees: &[Degrees; 3],
) -> Option<ReadingError> {
    let force = Vector3::from(plateau.specific_force?);
    let residual = Vector3::from(plateau.residual);
    // A residual is small, so the inverse of the error model is that of its gain.
    let to_force = compensated.gain(&force).try_inverse()?;
    // Across the force a rest shows its attitude, by which it trembles and differs from what is stated.
    let along = force.normalize();
    let seen = if is_rest { along * along.transpose() } else { Matrix3::identity() };
    let of_speed = if is_rest { Vector3::zeros() } else { of_speed(plateau, &residual)? };
    let noise = seen * to_force * matrix(&plateau.covariance) * to_force.transpose() * seen;
    let uncertainty = noise.diagonal().map(f64::sqrt);
    let prediction = compensated.covariance(&force)?.diagonal().map(|variance| variance.max(0.0).sqrt());
    let of_parameters = |j: usize| (prediction[j], degrees[j]);
    let both = |j: usize| expanded_of_independent(&[of_parameters(j), (uncertainty[j], Degrees::Infinite)]);
    Some(ReadingError {
        force,
        before: Vector3::from(plateau.mean) - force,
        after: seen * to_force * residual,
        speed_free: seen * to_force * (residual - of_speed),
        uncertainty,
        expanded_prediction: Vector3::from_fn(|j, _| expanded_of_independent(&[of_parameters(j)])),
        expanded: Vector3::from_fn(|j, _| both(j)),
    })
}

/// The part of a residual that the plateau's speed error explains: its conditional mean given the residual.
///
/// The weight of the fit is `C + s s^T`, `s` being the effect of one standard deviation of the speed; the estimate is
/// `s s^T (C + s s^T)^-1 r`. `None` if that weight is not positive definite.
fn of_speed(plateau: &PlateauSummary, residual: &Vector3<f64>) -> Option<Vector3<f64>> {
    let total = matrix(&plateau.fit_covariance);
    let speed = total - matrix(&plateau.covariance);
    Some(speed * total.cholesky()?.solve(residual))
}

/// The compensation of the unit; `None` if a coefficient is not determined.
pub(crate) fn compensated(result: &CalibrationResult) -> Option<Compensated> {
    Compensated::new(result.error_terms().ok()?, result.covariance_of_coefficients())
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}
