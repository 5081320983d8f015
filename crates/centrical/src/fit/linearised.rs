//! Plateaus that read alike, linearised together.

use nalgebra::{DVector, Matrix3, Vector3};

use crate::linalg::factor::Factor;
use crate::model::plateau::{Readings, Whitener};
use crate::model::{FitError, Linearisation, MeasurementModel, Observation};

/// Plateaus that read alike, linearised at a point of all unknowns.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    observations: Vec<Observation>,
    at: Linearisation,
    /// The triangle `T` of the three readings, and the misfit that it takes up: `sum |W_n (y_n - f)|^2 = |T (f - f_0) - t|^2 + rest`,
    /// where `W_n` whitens plateau `n` and `f_0` is the reading at the point.
    sum: Factor,
}

impl Linearised {
    /// One plateau, by the exact model.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when its covariance is not positive definite.
    pub fn new(model: &MeasurementModel, observation: &Observation, x: &DVector<f64>) -> Result<Self, FitError> {
        Self::together(model, std::slice::from_ref(observation), x)
    }

    /// Plateaus that read alike, at least one, by the exact model.
    ///
    /// # Errors
    /// As [`Linearised::new`].
    pub fn together(model: &MeasurementModel, alike: &[Observation], x: &DVector<f64>) -> Result<Self, FitError> {
        let set_point = &model.experiment().set_points[alike[0].set_point];
        let at = model.linearise(set_point, &x.as_slice()[..model.parameters().len()]);
        let at = at.with_influences(x.as_slice());
        let mut linearised = Self { observations: Vec::new(), at, sum: Factor::new(3) };
        alike.iter().try_for_each(|observation| linearised.push(observation))?;
        Ok(linearised)
    }

    /// Adds a plateau that reads like them.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when its covariance is not positive definite.
    pub fn push(&mut self, observation: &Observation) -> Result<(), FitError> {
        let whitener = Whitener::new(observation, &self.at)?;
        let columns = [0, 1, 2].map(|axis| (axis, whitener.apply(&Vector3::ith(axis, 1.0))));
        self.sum.update(&columns, &whitener.apply(&(observation.mean - self.at.reading)));
        self.observations.push(observation.clone());
        Ok(())
    }

    /// The plateaus.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// What every one of them reads at the point, and how it changes.
    pub fn at(&self) -> &Linearisation {
        &self.at
    }

    /// A set point that reads like them.
    pub fn set_point(&self) -> usize {
        self.observations[0].set_point
    }

    /// Columns of the triangle of their readings.
    pub fn whitening(&self) -> [(usize, Vector3<f64>); 3] {
        let (triangle, _) = triangle(&self.sum);
        [0, 1, 2].map(|axis| (axis, triangle.column(axis).into_owned()))
    }

    /// The triangle of their readings.
    pub fn sum(&self) -> &Factor {
        &self.sum
    }

    /// The whitened equations of the plateaus, three for all of them.
    pub fn readings(&self) -> Readings {
        let (triangle, misfit) = triangle(&self.sum);
        Readings {
            columns: self.at.by_unknowns().map(|(unknown, change)| (unknown, triangle * change)).collect(),
            magnitude: (triangle * self.at.reading).norm(),
            misfit,
        }
    }

    /// Sum of squares that no reading takes up: of the plateaus about their weighted mean.
    pub fn rest(&self) -> f64 {
        self.sum.rest()
    }

    /// Length of the change of the readings with the unknowns, by the linearisation, in their standard uncertainties.
    pub fn change(&self, dx: &DVector<f64>) -> f64 {
        (triangle(&self.sum).0 * self.at.change(dx)).norm()
    }

    /// Norm of the residual at `x` less that of the linearisation, from which `x` is `dx` away, whitened by the triangle of `sum`.
    pub fn remainder(&self, sum: &Factor, model: &MeasurementModel, dx: &DVector<f64>, x: &DVector<f64>) -> f64 {
        (triangle(sum).0 * (self.reading(model, x) - self.at.reading - self.at.change(dx))).norm()
    }

    /// Sum of squares of the whitened residuals of the exact model at `x`.
    pub fn squared(&self, model: &MeasurementModel, x: &DVector<f64>) -> f64 {
        let (triangle, misfit) = triangle(&self.sum);
        (misfit - triangle * (self.reading(model, x) - self.at.reading)).norm_squared() + self.rest()
    }

    fn reading(&self, model: &MeasurementModel, x: &DVector<f64>) -> Vector3<f64> {
        let set_point = &model.experiment().set_points[self.set_point()];
        model.reading_with_influences(set_point, x.as_slice())
    }
}

/// The triangle of three readings, and the misfit that it takes up.
fn triangle(sum: &Factor) -> (Matrix3<f64>, Vector3<f64>) {
    let row = |axis: usize| sum.row(axis);
    let element = |i: usize, j: usize| if j < i { 0.0 } else { row(i)[j - i] };
    (Matrix3::from_fn(element), Vector3::from_fn(|i, _| element(i, 3)))
}
