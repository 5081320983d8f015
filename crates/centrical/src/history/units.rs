//! Units of one type over time, with few sessions each: which of them drift, or scatter more than the others.

use super::line::{Curve, Line};
use super::series::Series;
use crate::statistics::{f_tail, t_tail};

/// One unit beside the others of its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitTrend {
    /// Slope per year.
    pub slope: f64,
    /// Its standard uncertainty, by the scatter of all units.
    pub standard_uncertainty: f64,
    /// Probability of so large a slope of a unit that does not drift.
    pub drift_probability: f64,
    /// Scatter about its line over that of the others, in squares.
    pub variance_ratio: f64,
    /// Probability of so large a ratio of a unit that scatters as the others do.
    pub scatter_probability: f64,
}

impl UnitTrend {
    /// The slope of each unit in one quantity, against the scatter about the lines of all units; `None` for a unit whose sessions do not
    /// determine a line, and for all where fewer than two can be compared.
    ///
    /// Every unit is weighted as its sessions state, with a component between sessions common to all. A unit that scatters more than
    /// the others by itself, at `level`, is left out of their scatter.
    pub fn of_all(units: &[Series], variance_between: f64, level: f64) -> Vec<Option<UnitTrend>> {
        let of = |series: &Series| {
            let line = Line::new(series.points(), Curve::Line, variance_between)?;
            let nu = series.points().len().checked_sub(2).filter(|nu| *nu > 0)?;
            Some((line, nu as f64))
        };
        let lines: Vec<Option<(Line, f64)>> = units.iter().map(of).collect();
        let sums = |lines: &mut dyn Iterator<Item = &(Line, f64)>| {
            lines.fold((0.0, 0.0), |(misfit, nu), (line, more)| (misfit + line.misfit, nu + more))
        };
        let all = sums(&mut lines.iter().flatten());
        let count = lines.iter().flatten().count() as f64;
        let scatter = |(line, nu): &(Line, f64), (misfit, freedom): (f64, f64)| {
            let (others, rest) = (misfit - line.misfit, freedom - nu);
            let ratio = (line.misfit / nu) / (others / rest);
            ratio.is_finite().then(|| (ratio, f_tail(ratio, *nu, rest)))
        };
        let is_sound =
            |line: &&(Line, f64)| scatter(line, all).is_none_or(|(_, probability)| count * probability > level);
        let (misfit, freedom) = sums(&mut lines.iter().flatten().filter(is_sound));
        let trend = |line: &(Line, f64)| {
            let (variance_ratio, scatter_probability) = scatter(line, all)?;
            let standard_uncertainty = (misfit / freedom / line.0.spread).sqrt();
            let drift_probability = t_tail(line.0.slope / standard_uncertainty, freedom);
            Some(UnitTrend {
                slope: line.0.slope,
                standard_uncertainty,
                drift_probability,
                variance_ratio,
                scatter_probability,
            })
        };
        lines.iter().map(|line| line.as_ref().and_then(trend)).collect()
    }
}
