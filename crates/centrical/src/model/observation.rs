//! Plateau means as data, and how well they are known.

use nalgebra::{Matrix3, Vector3};

use super::error::FitError;

/// The mean reading of one plateau, as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// Mean reading [m/s^2].
    pub mean: Vector3<f64>,
    /// Covariance of the mean, noise alone [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

/// How well the mean of a plateau is known, or will be: an observation without its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// Index of the plateau in [`crate::Experiment::set_points`].
    pub set_point: usize,
    /// Covariance of the mean, noise alone [m^2/s^4].
    pub covariance: Matrix3<f64>,
}

impl Weight {
    /// The same white noise of standard deviation `sigma` [m/s^2] on the means of the first `count` plateaus.
    pub fn equal(count: usize, sigma: f64) -> Vec<Self> {
        let covariance = Matrix3::identity() * (sigma * sigma);
        (0..count).map(|set_point| Self { set_point, covariance }).collect()
    }
}

impl From<&Observation> for Weight {
    fn from(observation: &Observation) -> Self {
        Self { set_point: observation.set_point, covariance: observation.covariance }
    }
}

impl Observation {
    /// `L` of the covariance of the mean, `C = L L^T` [m/s^2].
    pub(crate) fn noise_factor(&self) -> Result<Matrix3<f64>, FitError> {
        let diagonal = self.covariance.diagonal().into();
        let error = FitError::Covariance { set_point: self.set_point, diagonal };
        self.covariance.cholesky().map(|factor| factor.l()).ok_or(error)
    }
}
