//! Histories as plots: a parameter of a unit over its calibrations, control charts.

use centrical_session::{ChartKind, ChartReport, ParameterLimits, UnitHistoryReport, UnitParameter, customary};

use crate::plot::{Axis, Plot, Point, Series};

/// The value of each parameter over the sessions with its expanded uncertainty (k = 2), the forecast and the limits: name and plot.
pub fn unit_history_plots(report: &UnitHistoryReport, limits: &ParameterLimits) -> Vec<(String, Plot)> {
    report.parameters.iter().map(|p| (p.name.clone(), unit_parameter(report, p, limits))).collect()
}

fn unit_parameter(report: &UnitHistoryReport, p: &UnitParameter, limits: &ParameterLimits) -> Plot {
    let (factor, unit) = customary(&p.unit, p.group);
    let years = |date: centrical_session::Date| date.in_years();
    let point = |((session, value), u): ((&centrical_session::PastSession, &Option<f64>), &Option<f64>)| {
        let (value, u) = value.zip(*u)?;
        let ends = (factor * value - 2.0 * factor.abs() * u, factor * value + 2.0 * factor.abs() * u);
        Some(Point::new(years(session.date), factor * value).with_interval(ends.0, ends.1))
    };
    let points = report.sessions.iter().zip(&p.values).zip(&p.standard_uncertainties).filter_map(point).collect();
    let mut plot = Plot::new(p.name.clone(), Axis::linear("year"), Axis::linear(format!("{}, {unit}", p.name)))
        .with(Series::markers("calibrations, k = 2", points));
    if let Some([low, high]) = p.forecast {
        let (low, high) = (factor * low, factor * high);
        let at = Point::new(years(report.until), 0.5 * (low + high)).with_interval(low.min(high), low.max(high));
        plot = plot.with(Series::markers(format!("forecast, {} %", (1e8 * report.coverage).round() / 1e6), vec![at]));
    }
    let ends = report.sessions.first().map(|session| [years(session.date), years(report.until)]);
    let (low, high) = limits.get(&p.name).copied().unwrap_or_default();
    for (name, limit) in [("lower limit", low), ("upper limit", high)] {
        if let Some((ends, limit)) = ends.zip(limit) {
            plot = plot.with(Series::line(name, ends.map(|year| Point::new(year, factor * limit)).to_vec()));
        }
    }
    plot
}

/// Individuals, moving ranges, weighted means and cumulative sums, each a plot with its limits.
pub fn chart_plots(report: &ChartReport) -> Vec<(&'static str, Plot)> {
    let (factor, unit) = customary(&report.unit, report.group);
    let charts = Charts { report, factor, unit };
    vec![
        ("individuals", charts.individuals()),
        ("moving-ranges", charts.moving_ranges()),
        ("ewma", charts.weighted_means()),
        ("cusum", charts.cumulative_sums()),
    ]
}

/// The charts of a report in its customary unit.
struct Charts<'r> {
    report: &'r ChartReport,
    factor: f64,
    unit: &'r str,
}

impl Charts<'_> {
    fn individuals(&self) -> Plot {
        let (report, factor) = (self.report, self.factor);
        self.plot("individuals", self.axis(&report.name))
            .with(Series::line_and_markers("values", numbered(&report.values, 1, factor)))
            .with(self.level("centre", factor * report.centre))
            .with(self.level("lower limit", factor * report.limits[0]))
            .with(self.level("upper limit", factor * report.limits[1]))
            .with(self.signals(ChartKind::Individuals, &report.values, 1, factor))
    }

    fn moving_ranges(&self) -> Plot {
        let (report, factor) = (self.report, self.factor.abs());
        self.plot("moving ranges", self.axis("moving range"))
            .with(Series::line_and_markers("ranges", numbered(&report.ranges, 2, factor)))
            .with(self.level("upper limit", factor * report.range_limit))
            .with(self.signals(ChartKind::MovingRange, &report.ranges, 2, factor))
    }

    fn weighted_means(&self) -> Plot {
        let (report, factor) = (self.report, self.factor);
        let limit = |sign: f64| {
            let ends = report.ewma_half_widths.iter().map(|half| report.centre + sign * half);
            numbered(&ends.collect::<Vec<f64>>(), 1, factor)
        };
        self.plot("weighted means (EWMA)", self.axis(&report.name))
            .with(Series::line_and_markers("means", numbered(&report.ewma, 1, factor)))
            .with(Series::line("lower limit", limit(-1.0)))
            .with(Series::line("upper limit", limit(1.0)))
            .with(self.signals(ChartKind::Ewma, &report.ewma, 1, factor))
    }

    fn cumulative_sums(&self) -> Plot {
        let report = self.report;
        let pairs = report.cusum_upper.iter().zip(&report.cusum_lower);
        let larger: Vec<f64> = pairs.map(|(upper, lower)| upper.max(*lower)).collect();
        self.plot("cumulative sums", Axis::linear("standard deviations"))
            .with(Series::line_and_markers("upwards", numbered(&report.cusum_upper, 1, 1.0)))
            .with(Series::line_and_markers("downwards", numbered(&report.cusum_lower, 1, 1.0)))
            .with(self.level("limit", report.cusum_limit))
            .with(self.signals(ChartKind::Cusum, &larger, 1, 1.0))
    }

    fn plot(&self, title: &str, y: Axis) -> Plot {
        Plot::new(format!("{}: {title}", self.report.name), Axis::linear("session, in the order of time"), y)
    }

    fn axis(&self, what: &str) -> Axis {
        Axis::linear(format!("{what}, {}", self.unit))
    }

    fn level(&self, label: &str, value: f64) -> Series {
        let count = self.report.values.len() as f64;
        Series::line(label, vec![Point::new(1.0, value), Point::new(count, value)])
    }

    /// The `values` that give a signal; the first of all belongs to session `first`.
    fn signals(&self, kind: ChartKind, values: &[f64], first: usize, factor: f64) -> Series {
        let of = self.report.signals.iter().filter(|signal| signal.rule.kind() == kind);
        let at = of.filter_map(|signal| Some((signal.session, values.get((signal.session + 1).checked_sub(first)?)?)));
        Series::markers("signals", at.map(|(n, value)| Point::new((n + 1) as f64, factor * value)).collect())
    }
}

/// Values over the sessions from `first` on.
fn numbered(values: &[f64], first: usize, factor: f64) -> Vec<Point> {
    values.iter().enumerate().map(|(n, value)| Point::new((n + first) as f64, factor * value)).collect()
}
