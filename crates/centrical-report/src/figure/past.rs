//! Many calibrations as plots: a parameter of a unit over its calibrations, the units of a model, control charts, differences.

use centrical_session::{
    ChartKind, ChartReport, ComparisonReport, Date, ParameterLimits, PastSession, UnitHistoryReport, UnitParameter,
    UnitsParameter, customary,
};

use super::drawing::drawn;
use crate::language::Language;
use crate::plot::{Axis, Plot, Point, Series};

/// The value of each parameter over the sessions with its expanded uncertainty (k = 2), the forecast and the limits: name and plot.
pub fn unit_history_plots(report: &UnitHistoryReport, limits: &ParameterLimits) -> Vec<(String, Plot)> {
    report.parameters.iter().map(|p| (p.name.clone(), unit_parameter(report, p, limits))).collect()
}

fn unit_parameter(report: &UnitHistoryReport, p: &UnitParameter, limits: &ParameterLimits) -> Plot {
    let (factor, unit) = customary(&p.unit, p.group);
    let years = |date: Date| date.in_years();
    let point = |((session, value), u): ((&PastSession, &Option<f64>), &Option<f64>)| {
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
    match ends {
        Some(ends) => with_limits(plot, &p.name, limits, |limit| ends.map(|year| Point::new(year, factor * limit))),
        None => plot,
    }
}

/// The plot with the limits of the parameter of this name, each a line between its ends.
fn with_limits(plot: Plot, name: &str, limits: &ParameterLimits, ends: impl Fn(f64) -> [Point; 2]) -> Plot {
    let (low, high) = limits.get(name).copied().unwrap_or_default();
    [("lower limit", low), ("upper limit", high)].into_iter().fold(plot, |plot, (label, limit)| match limit {
        Some(limit) => plot.with(Series::line(label, ends(limit).to_vec())),
        None => plot,
    })
}

/// Points of a distribution: more would be drawn on one another.
const POINTS: usize = 200;

/// The fraction of units below each value, of each of the `groups` of units that are named, with the limits.
pub fn distribution_plot(p: &UnitsParameter, groups: &[(String, Vec<f64>)], limits: &ParameterLimits) -> Plot {
    let (factor, unit) = customary(&p.unit, p.group);
    let axes = (Axis::linear(format!("{}, {unit}", p.name)), Axis::linear("fraction of units").with_range(0.0, 1.0));
    let mut plot = Plot::new(format!("{}: distribution", p.name), axes.0, axes.1).as_panel();
    for (name, values) in groups {
        let scaled: Vec<f64> = values.iter().map(|value| factor * value).collect();
        plot = plot.with(Series::line(name.clone(), cumulated(scaled)));
    }
    with_limits(plot, &p.name, limits, |limit| [0.0, 1.0].map(|fraction| Point::new(factor * limit, fraction)))
}

/// The `k`-th of `n` values in order has the fraction `(k - 1/2) / n` below it.
fn cumulated(mut values: Vec<f64>) -> Vec<Point> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let shown = n.min(POINTS);
    let place = |k: usize| if shown < 2 { 0 } else { k * (n - 1) / (shown - 1) };
    (0..shown).map(place).map(|k| Point::new(values[k], (k as f64 + 0.5) / n as f64)).collect()
}

/// The mean of each batch with its expanded uncertainty (k = 2) by the scatter of its units.
pub fn batches_plot(p: &UnitsParameter) -> Plot {
    let (factor, unit) = customary(&p.unit, p.group);
    let axes = (Axis::linear("batch"), Axis::linear(format!("{}, {unit}", p.name)));
    let mut plot = Plot::new(format!("{}: batches", p.name), axes.0, axes.1).as_panel();
    for (n, batch) in p.batches.iter().enumerate() {
        let mean = Point::new((n + 1) as f64, factor * batch.mean);
        let half = batch.deviation.map(|deviation| 2.0 * (factor * deviation).abs() / (batch.units as f64).sqrt());
        let mean = half.map_or(mean, |half| mean.with_interval(mean.y - half, mean.y + half));
        plot = plot.with(Series::markers(batch.batch.clone(), vec![mean]));
    }
    plot
}

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
