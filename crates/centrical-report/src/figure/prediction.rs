//! What the user of the unit gets: the uncertainty of a compensated reading over the range.

use centrical::STANDARD_GRAVITY;
use centrical::uncertainty::Compensated;
use centrical_session::{CalibrationResult, MICRO_G};
use nalgebra::{DMatrix, Vector3};

use super::drawing::{Figure, of_plot};
use crate::evaluation::error_model;
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// Points of a curve.
const POINTS: usize = 201;

/// Standard uncertainty of a compensated reading against the specific force along each axis, to the highest of the
/// session; `None` if a parameter of the instrument is not determined.
pub(super) fn figure(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let (model, coefficients) = error_model(result)?;
    let place = |name: &str| result.parameters.iter().position(|parameter| parameter.name == name);
    let own: Vec<usize> = model.terms.iter().map(|term| place(&term.name)).collect::<Option<_>>()?;
    let entry = |a: usize, b: usize| result.covariance.get(own[a])?.get(own[b]).copied().flatten();
    let covariance = DMatrix::from_fn(own.len(), own.len(), |a, b| entry(a, b).unwrap_or(f64::NAN));
    let compensated = Compensated::new(model, coefficients, covariance)?;
    let forces = result.plateaus.iter().filter_map(|plateau| plateau.specific_force).flatten();
    let range = forces.map(f64::abs).fold(0.0, f64::max);
    let axes = (Axis::linear(messages.force_axis), Axis::log(messages.prediction_axis));
    let mut plot = Plot::new(messages.prediction_title, axes.0, axes.1);
    for axis in 0..3 {
        let curve = compensated.curve(&Vector3::ith(axis, 1.0), range, POINTS);
        let points = curve.iter().map(|point| Point::new(point.force / STANDARD_GRAVITY, point.along / MICRO_G));
        plot = plot.with(Series::line(format!("{} {}", messages.axis, axis + 1), points.collect()));
    }
    Some(of_plot("prediction", messages.prediction_caption, plot, language))
}
