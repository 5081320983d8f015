//! Time against uncertainty.

use centrical_session::{CriterionName, FrontierRow, PlanReport};

use crate::evaluation::criterion_unit;
use crate::plot::{Axis, Plot, Point, Series};

/// Time against uncertainty as a plot.
pub fn frontier_plot(report: &PlanReport) -> String {
    let label = match report.criterion {
        CriterionName::I => "mean uncertainty of the compensated reading, ug",
        CriterionName::Worst => "worst uncertainty over its goal",
        CriterionName::A | CriterionName::D => "uncertainty in typical magnitudes",
    };
    let points = |value: &dyn Fn(&FrontierRow) -> Option<f64>| -> Vec<Point> {
        let point = |row: &FrontierRow| Some(Point::new(row.time / 3600.0, value(row)? / criterion_unit(report).0));
        report.frontier.iter().filter_map(point).collect()
    };
    let plot = Plot::new("Time against uncertainty", Axis::linear("time on the centrifuge, h"), Axis::log(label))
        .with(Series::line_and_markers("best plan", points(&|row| Some(row.best))))
        .with(Series::line("bound", points(&|row| Some(row.bound))))
        .with(Series::line_and_markers("uniform plan", points(&|row| row.uniform)))
        .with(Series::line_and_markers("[K5.5]", points(&|row| row.normalised)));
    plot.to_svg()
}
