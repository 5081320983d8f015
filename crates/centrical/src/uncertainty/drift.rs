//! Drift of the readings: over each plateau, and over the session.

use nalgebra::Vector3;

use super::coverage::chi_squared_tail;
use super::pattern::Trend;
use crate::fit::{Calibration, Termination};
use crate::model::FitError;

/// Slope of the readings over one plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Slope [m/s^3].
    pub slope: Vector3<f64>,
    /// Its standard uncertainty [m/s^3].
    pub standard_uncertainty: Vector3<f64>,
}

/// The slopes of all plateaus together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateauDrift {
    /// Weighted mean of the slopes [m/s^3].
    pub mean: Slope,
    /// Sum of the squared slopes over their variances.
    pub chi_squared: f64,
    /// Number of slopes.
    pub degrees_of_freedom: usize,
    /// Probability of so large a chi^2 without any drift.
    pub probability: f64,
}

impl PlateauDrift {
    /// Drift of plateaus with these slopes.
    pub fn of(slopes: &[Slope]) -> Self {
        let (mut weights, mut sums, mut chi_squared) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for Slope { slope, standard_uncertainty } in slopes {
            let weight = standard_uncertainty.map(|u| 1.0 / (u * u));
            weights += weight;
            sums += weight.component_mul(slope);
            chi_squared += slope.component_div(standard_uncertainty).norm_squared();
        }
        let degrees_of_freedom = 3 * slopes.len();
        let mean = Slope {
            slope: sums.component_div(&weights),
            standard_uncertainty: weights.map(|weight| 1.0 / weight.sqrt()),
        };
        let probability = chi_squared_tail(chi_squared, degrees_of_freedom);
        Self { mean, chi_squared, degrees_of_freedom, probability }
    }
}

/// Change of one newtonometer's residuals over the session.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SessionDrift {
    /// Newtonometer, 0 to 2.
    pub axis: usize,
    /// Change from the first to the last plateau, as one more unknown of the fit [m/s^2].
    pub change: f64,
    /// Its standard uncertainty [m/s^2].
    pub standard_uncertainty: f64,
    /// Probability of so large a change by chance.
    pub probability: f64,
}

impl Calibration<'_> {
    /// Trends of the residuals with the order of the plateaus, by newtonometer. Empty where the unknowns follow them, and for
    /// a linear fit, which leaves its second-order terms in the residuals.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn drift_over_session(&self) -> Result<Vec<SessionDrift>, FitError> {
        if self.fit().termination == Termination::Linear {
            return Ok(Vec::new());
        }
        let patterns = self.patterns_of(&[Trend::Time])?;
        let mut trends: Vec<SessionDrift> = (patterns.iter())
            .map(|pattern| SessionDrift {
                axis: pattern.axis,
                // The pattern's largest entry is half of the way from the first plateau to the last.
                change: 2.0 * pattern.amplitude,
                standard_uncertainty: 2.0 * pattern.standard_uncertainty,
                probability: pattern.probability,
            })
            .collect();
        trends.sort_by_key(|trend| trend.axis);
        Ok(trends)
    }
}
