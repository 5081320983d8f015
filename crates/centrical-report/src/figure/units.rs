//! Units of one model as plots: the distribution of a parameter between its limits, its means by batches.

use centrical_session::{ParameterLimits, UnitsParameter, customary};

use crate::plot::{Axis, Plot, Point, Series};

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
    let (low, high) = limits.get(&p.name).copied().unwrap_or_default();
    for (name, limit) in [("lower limit", low), ("upper limit", high)] {
        if let Some(limit) = limit {
            let ends = [0.0, 1.0].map(|fraction| Point::new(factor * limit, fraction));
            plot = plot.with(Series::line(name, ends.to_vec()));
        }
    }
    plot
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
