//! Capability of a process against limits: Cp and Cpk (ISO 22514-2).

use crate::statistics::chi_squared_quantiles;
use crate::uncertainty::Degrees;

/// How a parameter of many units lies between its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capability {
    /// Mean over the units.
    pub mean: f64,
    /// Standard deviation over the units.
    pub deviation: f64,
    /// `Cp = (upper - lower) / (6 s)`; `None` with one limit only.
    pub cp: Option<Index>,
    /// `Cpk`: distance of the mean from the nearer limit over `3 s`.
    pub cpk: Index,
}

/// An index and its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Index {
    /// Estimate.
    pub value: f64,
    /// Its interval: for Cp exact for normal values, by chi^2; for Cpk of A. F. Bissell (Applied Statistics 39, 1990).
    pub interval: [f64; 2],
}

impl Capability {
    /// Capability of `values` between `lower` and `upper`, each optional, with intervals of probability `coverage`.
    /// `None` below two values, without a limit, or without scatter.
    pub fn of(values: &[f64], lower: Option<f64>, upper: Option<f64>, coverage: f64) -> Option<Capability> {
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
            Index { value, interval: quantiles.map(|quantile| value * (quantile / nu).sqrt()) }
        });
        let doubt = (1.0 / (9.0 * n as f64) + nearer * nearer / (2.0 * nu)).sqrt();
        let half = Degrees::Infinite.coverage_factor(coverage) * doubt;
        Some(Capability { mean, deviation, cp, cpk: Index { value: nearer, interval: [nearer - half, nearer + half] } })
    }
}
