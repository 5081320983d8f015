//! Units of one type beside each other: which of them drift, or scatter more than the others, with few sessions each; how they lie between limits;
//! whether their batches differ.

use super::line::{Curve, Line};
use super::series::Series;
use crate::statistics::{chi_squared_quantiles, f_tail, t_tail};
use crate::uncertainty::Degrees;

/// One unit beside the others of its type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitTrend {
    /// Slope per year.
    pub slope: f64,
    /// Its standard uncertainty, by the scatter of all units; by its own where it scatters more.
    pub standard_uncertainty: f64,
    /// Probability of so large a slope of a unit that does not drift.
    pub drift_probability: f64,
    /// Scatter about its line over that of the others, in squares.
    pub variance_ratio: f64,
    /// Probability of so large a ratio of a unit that scatters as the others do.
    pub scatter_probability: f64,
}

/// An index of how a parameter of many units lies between its limits (ISO 22514-2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capability {
    /// Estimate.
    pub value: f64,
    /// Its interval: for Cp exact for normal values, by chi^2; for Cpk of A. F. Bissell (Applied Statistics 39, 1990).
    pub interval: [f64; 2],
}

/// Welch's test of equal means of batches, whatever their scatters (B. L. Welch, Biometrika 38, 1951).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatchTest {
    /// Welch's F.
    pub variance_ratio: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: [f64; 2],
    /// Probability of so large an F if the means are equal.
    pub probability: f64,
}

impl UnitTrend {
    /// The slope of each unit in one quantity, against the scatter about the lines of all units; `None` for a unit whose sessions do not
    /// determine a line, and for all where fewer than two can be compared.
    ///
    /// Every unit is weighted as its sessions state, with a component between sessions common to all. A unit that scatters more than
    /// the others by itself, at `level`, is left out of their scatter, and its slope has its own.
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
        let of_sound = sums(&mut lines.iter().flatten().filter(is_sound));
        let trend = |line: &(Line, f64)| {
            let (variance_ratio, scatter_probability) = scatter(line, all)?;
            // By the scatter of the others a slope of one that merely scatters would count as drift.
            let (misfit, freedom) = if scatter_probability > level { of_sound } else { (line.0.misfit, line.1) };
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

impl Capability {
    /// Indices of `values` between `lower` and `upper`, each optional, with intervals of probability `coverage`:
    /// `Cp = (upper - lower) / (6 s)`, `None` with one limit only, and `Cpk`, the distance of the mean from the nearer limit over `3 s`.
    /// `None` below two values, without a limit, or without scatter.
    pub fn of(values: &[f64], lower: Option<f64>, upper: Option<f64>, coverage: f64) -> Option<(Option<Self>, Self)> {
        let n = values.len();
        let nu = n.checked_sub(1).filter(|nu| *nu > 0)? as f64;
        let mean = values.iter().sum::<f64>() / n as f64;
        let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / nu).sqrt();
        let below = lower.map(|lower| (mean - lower) / (3.0 * deviation));
        let above = upper.map(|upper| (upper - mean) / (3.0 * deviation));
        let nearer = [below, above].into_iter().flatten().min_by(f64::total_cmp).filter(|index| index.is_finite())?;
        let quantiles = chi_squared_quantiles(nu, coverage)?;
        let cp = lower.zip(upper).map(|(lower, upper)| {
            let value = (upper - lower) / (6.0 * deviation);
            Self { value, interval: quantiles.map(|quantile| value * (quantile / nu).sqrt()) }
        });
        let doubt = (1.0 / (9.0 * n as f64) + nearer * nearer / (2.0 * nu)).sqrt();
        let half = Degrees::Infinite.coverage_factor(coverage) * doubt;
        Some((cp, Self { value: nearer, interval: [nearer - half, nearer + half] }))
    }
}

impl BatchTest {
    /// The test of values in batches. Batches of one value or without scatter are left out; `None` unless two are left.
    pub fn of(batches: &[Vec<f64>]) -> Option<BatchTest> {
        let described = batches.iter().filter_map(|values| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
            (values.len() > 1 && variance > 0.0 && variance.is_finite()).then(|| (n, mean, n / variance))
        });
        let batches: Vec<(f64, f64, f64)> = described.collect();
        let k = batches.len() as f64;
        if k < 2.0 {
            return None;
        }
        let total: f64 = batches.iter().map(|(_, _, w)| w).sum();
        let grand = batches.iter().map(|(_, mean, w)| w * mean).sum::<f64>() / total;
        let between = batches.iter().map(|(_, mean, w)| w * (mean - grand).powi(2)).sum::<f64>() / (k - 1.0);
        let doubt: f64 = batches.iter().map(|(n, _, w)| (1.0 - w / total).powi(2) / (n - 1.0)).sum();
        let variance_ratio = between / (1.0 + 2.0 * (k - 2.0) / (k * k - 1.0) * doubt);
        let degrees_of_freedom = [k - 1.0, (k * k - 1.0) / (3.0 * doubt)];
        let probability = f_tail(variance_ratio, degrees_of_freedom[0], degrees_of_freedom[1]);
        Some(BatchTest { variance_ratio, degrees_of_freedom, probability })
    }
}
