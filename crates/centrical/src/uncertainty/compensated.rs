//! What the user of the unit gets: the uncertainty of a compensated reading as a function of the specific force.
//!
//! Compensation solves `f' = f + sum_t c_t m_t(f)` [K4.1] for `f`. Errors `dc` of the coefficients leave in it
//! `df = -(d f'/d f)^-1 sum_t dc_t m_t(f) e_axis(t)`, in instrument axes. The noise of the reading itself comes on top.

use centrical_compensate::{Term, gain};
use nalgebra::{DMatrix, Matrix3, Matrix3xX, Vector3};

/// A calibrated error model.
#[derive(Debug, Clone, PartialEq)]
pub struct Compensated {
    terms: Vec<Term>,
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
    /// Error model and the `covariance` of its coefficients, SI; `None` unless it has a row and a column for every term.
    pub fn new(terms: Vec<Term>, covariance: DMatrix<f64>) -> Option<Self> {
        (covariance.shape() == (terms.len(), terms.len())).then_some(Self { terms, covariance })
    }

    /// `d f' / d f` at the specific force `f_z` [m/s^2], dimensionless.
    pub fn gain(&self, f_z: &Vector3<f64>) -> Matrix3<f64> {
        let rows = gain(&self.terms, (*f_z).into());
        Matrix3::from_fn(|i, j| rows[i][j])
    }

    /// Change of the compensated reading by a change of each coefficient, `-(d f'/d f)^-1 m_t(f) e_axis(t)`, at the specific force
    /// `f_z` [m/s^2]; a column for each coefficient. `None` where the error model cannot be inverted.
    pub fn sensitivity(&self, f_z: &Vector3<f64>) -> Option<Matrix3xX<f64>> {
        let f = (*f_z).into();
        let monomial = |i: usize, term: &Term| if term.axis == i { -term.monomial.value(f) } else { 0.0 };
        let by_coefficient = Matrix3xX::from_fn(self.terms.len(), |i, t| monomial(i, &self.terms[t]));
        self.gain(f_z).lu().solve(&by_coefficient)
    }

    /// Covariance of the compensated reading at the specific force `f_z` [m^2/s^4]; `None` where the error model cannot be
    /// inverted.
    pub fn covariance(&self, f_z: &Vector3<f64>) -> Option<Matrix3<f64>> {
        let df = self.sensitivity(f_z)?;
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
