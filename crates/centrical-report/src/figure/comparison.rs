//! Differences of calibrations over their uncertainties.

use centrical_session::ComparisonReport;

use super::drawing::drawn;
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// `E_n` of every coefficient of every pair as a plot; beyond the lines at -1 and 1 two results disagree.
pub fn comparison_plot(report: &ComparisonReport, language: Language) -> String {
    let messages = language.comparison();
    let most = report.comparisons.iter().map(|pair| pair.differences.len()).max().unwrap_or(0);
    let bound = |level: f64| vec![Point::new(0.5, level), Point::new(most as f64 + 0.5, level)];
    let mut plot = Plot::new(messages.plot, Axis::linear(messages.plot_axis), Axis::linear("E_n"))
        .with(Series::line("1", bound(1.0)))
        .with(Series::line("-1", bound(-1.0)));
    for pair in &report.comparisons {
        let points = pair.differences.iter().enumerate().map(|(n, d)| Point::new(n as f64 + 1.0, d.e_n)).collect();
        plot = plot.with(Series::markers((messages.plot_less)(pair.second + 1, pair.first + 1), points));
    }
    drawn(plot, language)
}
