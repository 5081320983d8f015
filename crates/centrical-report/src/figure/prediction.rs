//! What the user of the unit gets: the uncertainty of a compensated reading over the range.

use centrical::STANDARD_GRAVITY;
use centrical_session::{CalibrationResult, MICRO_G};
use nalgebra::Vector3;

use super::drawing::{Figure, of_plot};
use crate::evaluation::{compensated, expanded_of_normal};
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// Points of a curve.
const POINTS: usize = 201;

/// Expanded uncertainty of a compensated reading against the specific force along each axis, to the highest of the
/// session; `None` if a parameter of the instrument is not determined.
pub(super) fn figure(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let compensated = compensated(result)?;
    let forces = result.plateaus.iter().filter_map(|plateau| plateau.specific_force).flatten();
    let range = forces.map(f64::abs).fold(0.0, f64::max);
    let axes = (Axis::linear(messages.force_axis), Axis::log(messages.prediction_axis));
    let mut plot = Plot::new(messages.prediction_title, axes.0, axes.1);
    for axis in 0..3 {
        let curve = compensated.curve(&Vector3::ith(axis, 1.0), range, POINTS);
        let points = curve
            .iter()
            .map(|point| Point::new(point.force / STANDARD_GRAVITY, expanded_of_normal(point.along) / MICRO_G));
        plot = plot.with(Series::line(format!("{} {}", messages.axis, axis + 1), points.collect()));
    }
    Some(of_plot("prediction", messages.prediction_caption, plot, language))
}
