//! How far the calibration of a session can be trusted: budget, validity, residual patterns, prediction.

use centrical::uncertainty::{Budget, Compensated, CurvePoint, Pattern, Validity};
use centrical::{Calibration, Data, Fit, FitError, MeasurementModel, Observation, OnProgress};
use nalgebra::{DMatrix, Vector3};

use super::calibrate::{Problem, as_result};
use crate::document::Assessment;
use crate::error::Error;
use crate::experiment::Session;

/// Points of a curve of the prediction.
const POINTS: usize = 21;

/// What an assessment is to use.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessmentRequest {
    /// Family-wise error at which outlying plateaus are left out; `None` leaves all in.
    pub without_outliers: Option<f64>,
    /// Whether the noise and the speed of the plateaus are scaled by the residuals.
    pub scale_by_residuals: bool,
    /// Range of the specific force of the prediction [m/s^2]; `None` for the highest of the session.
    pub range: Option<f64>,
}

/// Reads, reduces, fits and assesses a session. `progress` is called with the number of bytes read, from any thread; most
/// bytes are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn assess(session: &Session, request: &AssessmentRequest, progress: OnProgress) -> Result<Assessment, Error> {
    let Problem { session, model, mut reduced } = Problem::as_stated(session, progress)?;
    let failed = |source: FitError| Error::fit(&session.file, source);
    let all = Data::new(&model, reduced.observations()).map_err(failed)?;
    let whole = Calibration::exact(&all).map_err(failed)?;
    let cleaned = request.without_outliers.map(|alpha| all.without_outliers(alpha)).transpose().map_err(failed)?;
    let without = cleaned.as_ref().map(|(data, _)| Calibration::exact(data)).transpose().map_err(failed)?;
    let left_out = cleaned.as_ref().map_or(&[][..], |(_, left_out)| left_out);
    let used = without.as_ref().unwrap_or(&whole);
    reduced.held_out = left_out.iter().map(|(set_point, _)| *set_point).collect();
    let result = as_result(used, &session, &reduced, progress)?;
    let (budget, validity, patterns) = checks(used, request).map_err(failed)?;
    let range = request.range.unwrap_or_else(|| highest(used.data()));
    let prediction = prediction(&model, used.fit(), &budget, range);
    let cleaned = without.as_ref().map(|without| (without.fit().clone(), left_out.to_vec()));
    let fit = whole.into_fit();
    let scaled_by_residuals = request.scale_by_residuals;
    Ok(Assessment { scaled_by_residuals, model, fit, cleaned, budget, validity, patterns, prediction, result })
}

/// The budget of the fit that is assessed, whether its residuals are those of a true model, and their patterns.
fn checks(used: &Calibration, request: &AssessmentRequest) -> Result<(Budget, Validity, Vec<Pattern>), FitError> {
    let budget = used.budget()?;
    let budget = if request.scale_by_residuals { budget.scaled_by_residuals(used.fit()) } else { budget };
    Ok((budget, used.validity()?, used.patterns()?))
}

/// Highest nominal specific force of the plateaus [m/s^2].
fn highest(data: &Data) -> f64 {
    let experiment = data.model().experiment();
    let force = |o: &Observation| experiment.nominal(&experiment.set_points[o.set_point]).amax();
    data.observations().iter().map(force).fold(0.0, f64::max)
}

fn prediction(model: &MeasurementModel, fit: &Fit, budget: &Budget, range: f64) -> Option<[Vec<CurvePoint>; 3]> {
    let terms: Vec<usize> =
        (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
    let values: Option<Vec<f64>> = terms.iter().map(|&j| fit.value(j)).collect();
    let covariance = |a: usize, b: usize| budget.covariance(terms[a], terms[b]).unwrap_or(f64::NAN);
    let covariance = DMatrix::from_fn(terms.len(), terms.len(), covariance);
    let compensated = Compensated::new(model.error_model().with_coefficients(&values?), covariance)?;
    Some([0, 1, 2].map(|axis| compensated.curve(&Vector3::ith(axis, 1.0), range, POINTS)))
}
