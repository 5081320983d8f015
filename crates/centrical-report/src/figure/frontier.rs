//! Time against uncertainty.

use centrical::STANDARD_GRAVITY;
use centrical_session::{FrontierRow, PlanReport};

use crate::plot::{Axis, Plot, Point, Series};

/// Time against uncertainty as a plot.
pub fn frontier_plot(report: &PlanReport) -> String {
    let label = match report.criterion {
        "I" => "mean uncertainty of the compensated reading, ug",
        "worst" => "worst uncertainty over its goal",
        _ => "uncertainty in typical magnitudes",
    };
    let points = |value: &dyn Fn(&FrontierRow) -> Option<f64>| -> Vec<Point> {
        let point = |row: &FrontierRow| Some(Point::new(row.time / 3600.0, value(row)? * scale(report)));
        report.frontier.iter().filter_map(point).collect()
    };
    let plot = Plot::new("Time against uncertainty", Axis::linear("time on the centrifuge, h"), Axis::log(label))
        .with(Series::line_and_markers("best plan", points(&|row| Some(row.best))))
        .with(Series::line("bound", points(&|row| Some(row.bound))))
        .with(Series::line_and_markers("uniform plan", points(&|row| row.uniform)))
        .with(Series::line_and_markers("[K5.5]", points(&|row| row.normalised)));
    plot.to_svg()
}

/// From a value of the criterion to what is shown.
pub(crate) fn scale(report: &PlanReport) -> f64 {
    if report.criterion == "I" { 1e6 / STANDARD_GRAVITY } else { 1.0 }
}
