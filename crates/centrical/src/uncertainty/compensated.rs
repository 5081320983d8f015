//! What the user of the unit gets: the uncertainty of a compensated reading as a function of the specific force.
//!
//! Compensation solves `f' = f + sum_t c_t m_t(f)` [K4.1] for `f`. Errors `dc` of the coefficients leave in it
//! `df = -(d f'/d f)^-1 sum_t dc_t m_t(f) e_axis(t)`, in instrument axes. The noise of the reading itself comes on top.

use nalgebra::{DMatrix, Matrix3, Matrix3xX, Vector3};

use crate::model::ErrorModel;

/// A calibrated error model.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensated {
    error_model: ErrorModel,
    coefficients: Vec<f64>,
    covariance: DMatrix<f64>,
}

/// Uncertainty at one specific force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Specific force along the curve's direction [m/s^2].
    pub force: f64,
    /// Standard uncertainties of the three components of the compensated reading [m/s^2].
    pub components: [f64; 3],
    /// Standard uncertainty along the direction of the force [m/s^2].
    pub along: f64,
}

impl Compensated {
    /// Error model with `coefficients` in the order of its terms and their `covariance`, SI; `None` unless there is one
    /// of each for every term.
    pub fn new(error_model: ErrorModel, coefficients: Vec<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        let count = error_model.terms.len();
        let fits = coefficients.len() == count && covariance.shape() == (count, count);
        fits.then_some(Self { error_model, coefficients, covariance })
    }

    /// Covariance of the compensated reading at the specific force `f_z` [m^2/s^4]; `None` where the error model cannot be
    /// inverted.
    pub fn covariance(&self, f_z: &Vector3<f64>) -> Option<Matrix3<f64>> {
        let gain = self.error_model.gain(&self.coefficients, f_z);
        let terms = &self.error_model.terms;
        let by_coefficient =
            Matrix3xX::from_fn(terms.len(), |i, t| if terms[t].axis == i { terms[t].monomial.value(f_z) } else { 0.0 });
        let df = gain.lu().solve(&by_coefficient)?;
        Some(&df * &self.covariance * df.transpose())
    }

    /// The curve along the unit vector `direction_z`, at `points` equal steps from `-range` to `+range` [m/s^2], both
    /// included.
    pub fn curve(&self, direction_z: &Vector3<f64>, range: f64, points: usize) -> Vec<CurvePoint> {
        let steps = points.max(2) - 1;
        let point = |n: usize| {
            let force = range * (2.0 * n as f64 / steps as f64 - 1.0);
            let covariance = self.covariance(&(direction_z * force))?;
            let along = (direction_z.transpose() * covariance * direction_z)[0].max(0.0).sqrt();
            Some(CurvePoint { force, components: covariance.diagonal().map(|v| v.max(0.0).sqrt()).into(), along })
        };
        (0..=steps).filter_map(point).collect()
    }
}
