//! How far the calibration of a session can be trusted: budget, validity, residual patterns, prediction.

use centrical::uncertainty::{Budget, Compensated, CurvePoint, Pattern, Validity};
use centrical::{Calibration, Data, Fit, FitError, MeasurementModel, Observation, OnProgress, linear};
use nalgebra::{DMatrix, Vector3};

use super::calibrate::Problem;
use crate::document::{Assessed, AssessmentReport};
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

/// How far a calibration can be trusted.
#[derive(Debug)]
pub struct Assessment {
    /// Title of the session.
    pub title: String,
    /// Whether the noise and the speed of the plateaus are scaled by the residuals.
    pub scaled_by_residuals: bool,
    /// The model.
    pub model: MeasurementModel,
    /// The fit of all plateaus.
    pub fit: Fit,
    /// If it was asked for, the fit without outlying plateaus, on which what follows rests then; and these, by set point, each
    /// with its probability at the time.
    pub cleaned: Option<(Fit, Vec<(usize, f64)>)>,
    /// What each source of uncertainty leaves.
    pub budget: Budget,
    /// Whether the residuals are those of a true model.
    pub validity: Validity,
    /// Patterns in the residuals.
    pub patterns: Vec<Pattern>,
    /// Uncertainty of a compensated reading along each instrument axis; `None` while a coefficient is not determined.
    pub prediction: Option<[Vec<CurvePoint>; 3]>,
}

/// Reads, reduces, fits and assesses a session. `progress` is called with the number of bytes read, from any thread; most
/// bytes are read twice.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn assess(session: &Session, request: &AssessmentRequest, progress: OnProgress) -> Result<Assessment, Error> {
    let problem = Problem::as_stated(session, progress)?;
    of_problem(problem, &session.title, request).map_err(|source| Error::fit(&session.file, source))
}

impl Assessment {
    /// The assessment as a document, expanded uncertainties for a probability of `coverage`.
    pub fn report(&self, coverage: f64) -> AssessmentReport {
        let assessed = Assessed {
            model: &self.model,
            fit: &self.fit,
            cleaned: self.cleaned.as_ref().map(|(fit, left_out)| (fit, left_out.as_slice())),
            budget: &self.budget,
            validity: &self.validity,
            patterns: &self.patterns,
            prediction: self.prediction.as_ref(),
        };
        AssessmentReport::of(&assessed, &self.title, coverage, self.scaled_by_residuals)
    }
}

fn of_problem(problem: Problem, title: &str, request: &AssessmentRequest) -> Result<Assessment, FitError> {
    let Problem { model, reduced } = problem;
    let all = Data::new(&model, reduced.observations())?;
    let whole = Calibration::exact(&all)?;
    let cleaned = request.without_outliers.map(|alpha| all.without_outliers(alpha)).transpose()?;
    let without = cleaned.as_ref().map(|cleaned| Calibration::exact(&cleaned.data)).transpose()?;
    let used = without.as_ref().unwrap_or(&whole);
    let mut budget = used.budget()?;
    if request.scale_by_residuals {
        budget = budget.scaled_by_residuals(used.fit());
    }
    let (validity, patterns) = (used.validity()?, used.patterns()?);
    let range = request.range.unwrap_or_else(|| highest(used.data()));
    let prediction = prediction(&model, used.fit(), &budget, range);
    let cleaned = cleaned.as_ref().zip(without.as_ref());
    let cleaned = cleaned.map(|(cleaned, without)| (without.fit().clone(), cleaned.left_out.clone()));
    let fit = whole.into_fit();
    let (title, scaled_by_residuals) = (title.to_owned(), request.scale_by_residuals);
    Ok(Assessment { title, scaled_by_residuals, model, fit, cleaned, budget, validity, patterns, prediction })
}

/// Highest nominal specific force of the plateaus [m/s^2].
fn highest(data: &Data) -> f64 {
    let experiment = data.model().experiment();
    let force = |o: &Observation| linear::nominal(experiment, &experiment.set_points[o.set_point]).amax();
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
