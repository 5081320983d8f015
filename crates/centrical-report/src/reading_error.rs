//! Errors of the unit's readings on the plateaus, before and after compensation.

use centrical::STANDARD_GRAVITY;
use centrical::uncertainty::Compensated;
use centrical_session::{CalibrationResult, PlateauSummary};
use nalgebra::{Matrix3, Vector3};

use crate::language::Language;

/// One microgram in m/s^2.
pub(crate) const MICRO_G: f64 = 1e-6 * STANDARD_GRAVITY;

/// Coverage factor of the uncertainty of compensation.
pub(crate) const COVERAGE: f64 = 2.0;

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

/// Errors on every plateau; none if the unit cannot be compensated because a parameter of it is not determined.
pub(crate) fn reading_errors(result: &CalibrationResult) -> Option<Vec<ReadingError>> {
    let compensated = compensated(result)?;
    result.plateaus.iter().map(|plateau| reading_error(plateau, &compensated)).collect()
}

fn reading_error(plateau: &PlateauSummary, compensated: &Compensated) -> Option<ReadingError> {
    let force = Vector3::from(plateau.specific_force?);
    let residual = Vector3::from(plateau.residual);
    // A residual is small, so the inverse of the error model is that of its gain.
    let to_force = compensated.gain(&force).try_inverse()?;
    let noise = to_force * matrix(&plateau.covariance) * to_force.transpose();
    Some(ReadingError {
        force,
        before: Vector3::from(plateau.mean) - force,
        after: to_force * residual,
        speed_free: to_force * (residual - of_speed(plateau, &residual)),
        uncertainty: noise.diagonal().map(f64::sqrt),
        prediction: compensated.covariance(&force)?.diagonal().map(|variance| variance.max(0.0).sqrt()),
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

/// The compensation of the unit; none if a coefficient is not determined.
pub(crate) fn compensated(result: &CalibrationResult) -> Option<Compensated> {
    Compensated::new(result.error_terms().ok()?, result.of_unit().covariance)
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// Before, after, after less the speed's error, and the expanded uncertainty of compensation: for each axis root mean
/// square and, in brackets, largest magnitude.
pub(crate) fn error_table(errors: &[ReadingError], language: Language) -> [(&'static str, [String; 3]); 4] {
    let messages = language.messages();
    let shown = |(rms, largest): (f64, f64)| {
        let (factor, unit) = if rms < 1e3 * MICRO_G { (1.0 / MICRO_G, "ug") } else { (1e-3 / MICRO_G, "mg") };
        let [rms, largest] = [rms, largest].map(|value| language.significant(value * factor, 3));
        format!("{rms} ({largest}) {}", language.unit(unit))
    };
    [
        (messages.before, size(errors, |e| e.before).map(shown)),
        (messages.after, size(errors, |e| e.after).map(shown)),
        (messages.after_speed_free, size(errors, |e| e.speed_free).map(shown)),
        (messages.compensation_uncertainty, size(errors, |e| COVERAGE * e.prediction).map(shown)),
    ]
}

/// Root mean square and largest magnitude along each axis.
fn size(errors: &[ReadingError], of: impl Fn(&ReadingError) -> Vector3<f64>) -> [(f64, f64); 3] {
    let count = errors.len().max(1) as f64;
    [0, 1, 2].map(|axis| {
        let values = || errors.iter().map(|error| of(error)[axis]);
        let square: f64 = values().map(|value| value * value).sum();
        ((square / count).sqrt(), values().map(f64::abs).fold(0.0, f64::max))
    })
}
