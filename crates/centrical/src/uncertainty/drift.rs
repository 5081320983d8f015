//! Drift of the readings: over each plateau, and over the session.

use nalgebra::Vector3;

use super::pattern::{Pattern, Trend};
use crate::fit::{Calibration, Termination};
use crate::model::FitError;
use crate::statistics::Test;

/// Slope of the readings over one plateau.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Slope [m/s^3].
    pub slope: Vector3<f64>,
    /// Its standard uncertainty [m/s^3].
    pub standard_uncertainty: Vector3<f64>,
    /// Direction of the force, of length 1, for a rest in a free attitude: across it a slope is one of the attitude, and no drift.
    pub along: Option<Vector3<f64>>,
}

impl Slope {
    /// What of it may be a drift: on each newtonometer, or along the force: size, standard uncertainty and direction.
    fn parts(&self) -> Vec<(f64, f64, Vector3<f64>)> {
        let part = |direction: Vector3<f64>| {
            let [size, u] = self.in_direction(&direction);
            (size, u, direction)
        };
        let axes = || (0..3).map(|axis| Vector3::ith(axis, 1.0)).collect();
        self.along.map_or_else(axes, |along| vec![along]).into_iter().map(part).collect()
    }

    /// The part in a direction of length 1, and its standard uncertainty [m/s^3].
    pub(super) fn in_direction(&self, direction: &Vector3<f64>) -> [f64; 2] {
        [direction.dot(&self.slope), direction.component_mul(&self.standard_uncertainty).norm()]
    }

    /// The slope that a speed does not explain which runs over the plateau by `relative_slope`, with a standard uncertainty [1/s];
    /// `by_log_speed` is the derivative of the reading by the logarithm of the speed [m/s^2].
    #[must_use]
    pub fn beyond_speed(&self, by_log_speed: &Vector3<f64>, [relative_slope, u]: [f64; 2]) -> Self {
        Self {
            slope: self.slope - by_log_speed * relative_slope,
            standard_uncertainty: self
                .standard_uncertainty
                .zip_map(by_log_speed, |own, by_speed| own.hypot(by_speed * u)),
            along: self.along,
        }
    }

    /// Relative slope of the speed over a plateau of a duration [s], and its standard uncertainty [1/s]: the speed may run from the middle to
    /// either end by its relative standard uncertainty, unless its `measured` slope says better (the posterior of both).
    pub fn of_speed(uncertainty: f64, duration: f64, measured: Option<[f64; 2]>) -> [f64; 2] {
        let stated = 2.0 * uncertainty / duration;
        let Some([slope, u]) = measured.filter(|_| stated > 0.0) else { return [0.0, stated] };
        let whole = stated.hypot(u);
        [slope * (stated / whole).powi(2), stated * u / whole]
    }

    /// Weighted mean of the slopes of all plateaus, and the test of their squares over their variances: whether anything drifts.
    pub fn together(slopes: &[Slope]) -> (Slope, Test) {
        let (mut weights, mut sums, mut chi_squared) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let mut degrees_of_freedom = 0;
        for (slope, u, direction) in slopes.iter().flat_map(Slope::parts) {
            // Directions of rests are spread: what one newtonometer adds to another's mean is left out.
            weights += direction.component_mul(&direction) / (u * u);
            sums += direction * (slope / (u * u));
            chi_squared += (slope / u).powi(2);
            degrees_of_freedom += 1;
        }
        let slope = sums.component_div(&weights);
        let mean = Slope { slope, standard_uncertainty: weights.map(|weight| 1.0 / weight.sqrt()), along: None };
        (mean, Test::chi_squared(chi_squared, degrees_of_freedom))
    }
}

impl Calibration<'_> {
    /// Trends of the residuals with the order of the plateaus, by newtonometer: amplitudes over half of the way from the first plateau to the
    /// last. Empty where the unknowns follow them, and for a linear fit, which leaves its second-order terms in the residuals.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn drift_over_session(&self) -> Result<Vec<Pattern>, FitError> {
        if self.fit().termination == Termination::Linear {
            return Ok(Vec::new());
        }
        let mut patterns = self.patterns_of(&[Trend::Time])?;
        patterns.sort_by_key(|pattern| pattern.axis);
        Ok(patterns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slope of the readings by the speed is explained where the speed is measured, excused as far as it is stated to run, and neither
    /// where the speed is exact.
    #[test]
    fn the_slope_of_the_speed_is_measured_or_stated() {
        let by_log_speed = Vector3::new(2e3, 0.0, 0.0);
        let slope = Slope { slope: by_log_speed * 1e-6, standard_uncertainty: Vector3::repeat(1e-4), along: None };
        let left = |speed| Slope::together(&[slope.beyond_speed(&by_log_speed, speed)]).1.statistic;
        let [exact, stated, measured] = [(0.0, Some([1e-6, 1e-9])), (1e-5, None), (1e-5, Some([1e-6, 1e-9]))]
            .map(|(u, m)| Slope::of_speed(u, 10.0, m));
        assert!(exact == [0.0, 0.0] && stated[0] == 0.0 && (stated[1] - 2e-6).abs() < 1e-18, "{stated:?}");
        assert!((left(exact) - 400.0).abs() < 1e-9 && (0.2..0.3).contains(&left(stated)) && left(measured) < 1e-6);
        // A poor measurement says no more than the statement.
        let [slope, uncertainty] = Slope::of_speed(1e-5, 10.0, Some([1e-3, 1.0]));
        assert!(slope < 1e-8 && (uncertainty - 2e-6).abs() < 1e-12);
    }
}
