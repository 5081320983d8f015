//! Plots of the fit: reading errors, residuals, prediction, singular values, convergence.

use centrical::{Group, STANDARD_GRAVITY};
use centrical_session::{CalibrationResult, MICRO_G, PlateauSummary};
use nalgebra::{Matrix3, Vector3};

use super::drawing::{Figure, drawn, is_charted, of_plot};
use crate::evaluation::{ReadingError, compensated, expanded_of_normal, printed_combination, reading_errors};
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// Reading errors before and after compensation, residuals and normalised residuals.
pub(super) fn figures(result: &CalibrationResult, language: Language) -> Vec<Figure> {
    let errors = reading_errors(result).unwrap_or_default();
    let mut figures = Vec::new();
    if !errors.is_empty() {
        // Nominal values that the calibration found make the errors before it small.
        figures.extend((!result.model.nominal_found).then(|| before(&errors, language)));
        figures.push(after(&errors, result.model.has_arm(), language));
    }
    figures.push(residuals(result, language));
    figures.push(normalised(&result.plateaus, language));
    figures
}

fn before(errors: &[ReadingError], language: Language) -> Figure {
    let messages = language.messages();
    let drawings = panels(errors, messages.error_before_axis, language, |error, axis, load| {
        Point::new(load / STANDARD_GRAVITY, error.before[axis] / (1e3 * MICRO_G))
    });
    Figure::new("before", messages.before, messages.before_caption, drawings)
}

fn after(errors: &[ReadingError], has_arm: bool, language: Language) -> Figure {
    let messages = language.messages();
    let drawings = panels(errors, messages.error_after_axis, language, |error, axis, load| {
        let value = error.speed_free[axis] / MICRO_G;
        let bar = expanded_of_normal(error.uncertainty[axis]) / MICRO_G;
        Point::new(load / STANDARD_GRAVITY, value).with_interval(value - bar, value + bar)
    });
    let caption = if has_arm { messages.after_caption } else { messages.after_caption_of_rests };
    Figure::new("after", messages.after, caption, drawings)
}

/// A panel for the error of each newtonometer, against the specific force along the axis that is loaded most; a series
/// for each such axis.
fn panels(
    errors: &[ReadingError],
    error_axis: &str,
    language: Language,
    point: impl Fn(&ReadingError, usize, f64) -> Point,
) -> Vec<String> {
    let messages = language.messages();
    let panel = |axis: usize| {
        let title = format!("{} {}", messages.newtonometer, axis + 1);
        let plot = Plot::new(title, Axis::linear(messages.force_axis), Axis::linear(error_axis)).as_panel();
        let with_load = |plot: Plot, loaded: usize| {
            let along = errors.iter().filter(|error| error.force.iamax() == loaded);
            let points = along.map(|error| point(error, axis, error.force[loaded])).collect();
            plot.with(Series::markers(format!("{} {}", messages.axis, loaded + 1), points))
        };
        drawn((0..3).fold(plot, with_load), language)
    };
    (0..3).map(panel).collect()
}

fn residuals(result: &CalibrationResult, language: Language) -> Figure {
    let messages = language.messages();
    let numbered: Vec<(usize, &PlateauSummary)> = (1..).zip(&result.plateaus).collect();
    let point = |(n, plateau): &(usize, &PlateauSummary), axis: usize| {
        let value = plateau.residual[axis] / MICRO_G;
        let bar = expanded_of_normal(plateau.fit_covariance[axis][axis].sqrt()) / MICRO_G;
        Point::new(*n as f64, value).with_interval(value - bar, value + bar)
    };
    let axes = (Axis::linear(messages.plateau_axis), Axis::linear(messages.residual_axis));
    let plot = by_axis(Plot::new(messages.residuals_title, axes.0, axes.1), &numbered, language, point);
    let caption = if result.model.has_arm() { messages.residuals_caption } else { messages.residuals_caption_of_rests };
    of_plot("residuals", caption, plot, language)
}

fn normalised(plateaus: &[PlateauSummary], language: Language) -> Figure {
    let messages = language.messages();
    let numbered: Vec<(usize, Vector3<f64>)> =
        (1..).zip(plateaus).filter_map(|(n, plateau)| Some((n, whitened(plateau)?))).collect();
    let axes = (Axis::linear(messages.plateau_axis), Axis::linear(messages.normalised_axis));
    let plot = Plot::new(messages.normalised_title, axes.0, axes.1);
    let point = |(n, whitened): &(usize, Vector3<f64>), axis: usize| Point::new(*n as f64, whitened[axis]);
    // A point without a place breaks the line between the two limits.
    let end = plateaus.len() as f64 + 1.0;
    let limits = [(0.0, 2.0), (end, 2.0), (end, f64::NAN), (0.0, -2.0), (end, -2.0)];
    let limits = limits.into_iter().map(|(x, y)| Point::new(x, y)).collect();
    let plot = by_axis(plot, &numbered, language, point).with(Series::line("±2", limits));
    of_plot("normalised", messages.normalised_caption, plot, language)
}

/// `L^-1 r` with `L` the Cholesky factor of the weight's inverse.
fn whitened(plateau: &PlateauSummary) -> Option<Vector3<f64>> {
    let covariance = Matrix3::from_fn(|i, j| plateau.fit_covariance[i][j]);
    covariance.cholesky()?.l().solve_lower_triangular(&Vector3::from(plateau.residual))
}

/// The plot with one series of markers for each newtonometer.
fn by_axis<T>(plot: Plot, items: &[T], language: Language, point: impl Fn(&T, usize) -> Point) -> Plot {
    (0..3).fold(plot, |plot, axis| {
        let points = items.iter().map(|item| point(item, axis)).collect();
        plot.with(Series::markers(format!("{} {}", language.messages().axis, axis + 1), points))
    })
}

/// Expanded uncertainty of a compensated reading against the specific force along each axis, to the highest of the
/// session; `None` if a parameter of the instrument is not determined.
pub(super) fn prediction(result: &CalibrationResult, language: Language) -> Option<Figure> {
    /// Points of a curve.
    const POINTS: usize = 201;
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

/// Singular values, those of the null directions apart.
pub(super) fn singular_values(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let seen = &result.observability;
    let points: Vec<Point> = (1..).zip(&seen.singular_values).map(|(n, s)| Point::new(f64::from(n), *s)).collect();
    let largest = *seen.singular_values.first()?;
    let limit = largest * seen.tolerance;
    let (determined, lost) = points.split_at(seen.rank.min(points.len()));
    let ends = vec![Point::new(0.0, limit), Point::new(points.len() as f64 + 1.0, limit)];
    let axes = (Axis::linear(messages.order_axis), Axis::log(messages.singular_axis));
    let mut plot = Plot::new(messages.singular_title, axes.0, axes.1)
        .with(Series::markers(messages.determined, determined.to_vec()))
        .with(Series::line(messages.limit, ends));
    let caption = if lost.is_empty() { messages.singular_caption_full } else { messages.singular_caption_short };
    if !lost.is_empty() {
        // A singular value that is mere rounding may be zero, and zero has no logarithm.
        let floor = |p: &Point| Point::new(p.x, p.y.max(largest * f64::EPSILON));
        plot = plot.with(Series::markers(messages.lost, lost.iter().map(floor).collect()));
    }
    let figure = of_plot("singular-values", caption, plot, language);
    Some(Figure { combinations: result.null_directions_in_short().iter().map(printed_combination).collect(), ..figure })
}

/// The worst-known parameter of each group against its final uncertainty.
pub(super) fn convergence(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let history = result.convergence.as_ref()?;
    let last = history.standard_uncertainty.last()?;
    let axes = (Axis::linear(messages.plateaus_used_axis), Axis::log(messages.convergence_axis));
    let mut plot = Plot::new(messages.convergence_title, axes.0, axes.1);
    let mut groups: Vec<Group> = Vec::new();
    for parameter in result.parameters.iter().filter(|p| is_charted(p)) {
        if !groups.contains(&parameter.group) {
            groups.push(parameter.group);
        }
    }
    for group in groups {
        let members: Vec<usize> = (0..last.len())
            .filter(|&j| result.parameters.get(j).is_some_and(|p| p.estimable && p.group == group))
            .collect();
        let points = history.plateaus.iter().zip(&history.standard_uncertainty).map(|(n, sigma)| {
            let ratio = |j: usize| Some(sigma[j]? / last[j]?);
            Point::new(*n as f64, members.iter().filter_map(|&j| ratio(j)).fold(0.0, f64::max))
        });
        plot = plot.with(Series::line((messages.words.group)(group), points.collect()));
    }
    Some(of_plot("convergence", messages.convergence_caption, plot, language))
}
