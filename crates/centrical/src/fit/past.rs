//! Plateaus that are behind, linearised once and rotated into triangles.
//!
//! A point of the unknowns that moves makes all linearisations anew, which costs as much as all plateaus so far. But what a
//! plateau adds to them is small. Let `r` be the whitened residuals of the exact model and `A` their derivatives at the
//! reference `x_0`. The triangle is off at `x` by the remainder `r(x) - (r(x_0) - A (x - x_0))`.
//! While its norm is below a hundredth of a standard uncertainty the triangle stands; beyond that the point becomes the
//! reference. As the unknowns become known they move less, and references become rare.

use std::sync::Arc;

use nalgebra::{DVector, Vector3};

use super::design::Design;
use super::filter::Readings;
use crate::linalg::factor::Factor;
use crate::model::whitening::Whitener;
use crate::model::{FitError, MeasurementModel, Observation};

/// The largest remainder, in standard uncertainties of all unknowns together.
pub(super) const REMAINDER: f64 = 1e-2;

/// Plateaus linearised at a reference, and at zero.
#[derive(Debug, Clone)]
pub(super) struct Past<'m> {
    model: &'m MeasurementModel,
    reference: DVector<f64>,
    plateaus: Vec<Arc<Linearised>>,
    at_reference: Factor,
    at_zero: Factor,
}

/// A plateau linearised at a point of all unknowns.
#[derive(Debug)]
pub(super) struct Linearised {
    observation: Observation,
    whitener: Whitener,
    pub readings: Readings,
}

impl Linearised {
    /// By the exact model.
    pub fn new(model: &MeasurementModel, observation: &Observation, x: &DVector<f64>) -> Result<Self, FitError> {
        let set_point = &model.experiment().set_points[observation.set_point];
        let linearisation = model.linearise(set_point, &x.as_slice()[..model.parameters().len()]);
        let linearisation = linearisation.with_influences(x.as_slice());
        Ok(Self {
            whitener: Whitener::new(&observation.into(), &linearisation)?,
            readings: Readings::new(observation, &linearisation)?,
            observation: observation.clone(),
        })
    }

    /// Norm of the whitened residual at `x` less that of the linearisation, from which `x` is `dx` away.
    pub fn remainder(&self, model: &MeasurementModel, dx: &DVector<f64>, x: &DVector<f64>) -> f64 {
        let change: Vector3<f64> = self.readings.columns.iter().map(|(j, column)| column * dx[*j]).sum();
        (self.residual(model, x) - (self.readings.misfit - change)).norm()
    }

    /// Whitened residual of the exact model at `x`.
    pub fn residual(&self, model: &MeasurementModel, x: &DVector<f64>) -> Vector3<f64> {
        let set_point = &model.experiment().set_points[self.observation.set_point];
        self.whitener.apply(&(self.observation.mean - model.reading_with_influences(set_point, x.as_slice())))
    }
}

impl<'m> Past<'m> {
    /// No plateau yet; the next ones will be linearised at the `reference`.
    pub fn new(model: &'m MeasurementModel, reference: DVector<f64>) -> Self {
        let none = || Factor::new(reference.len());
        Self { model, plateaus: Vec::new(), at_reference: none(), at_zero: none(), reference }
    }

    /// Where the plateaus are linearised.
    pub fn reference(&self) -> &DVector<f64> {
        &self.reference
    }

    /// Takes a plateau up.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when its covariance is not positive definite.
    pub fn push(&mut self, observation: &Observation) -> Result<(), FitError> {
        let at_zero = readings_at_zero(self.model, observation)?;
        self.at_zero.update(&at_zero.columns, &at_zero.misfit);
        self.push_at_reference(observation)
    }

    /// Makes `x` the reference.
    ///
    /// # Errors
    /// As [`Past::push`].
    pub fn linearise_at(&mut self, x: &DVector<f64>) -> Result<(), FitError> {
        let plateaus = std::mem::take(&mut self.plateaus);
        (self.reference, self.at_reference) = (x.clone(), Factor::new(x.len()));
        plateaus.iter().try_for_each(|plateau| self.push_at_reference(&plateau.observation))
    }

    /// Sum of squares of the whitened residuals of the exact model at `x`.
    pub fn squared(&self, x: &DVector<f64>) -> f64 {
        self.plateaus.iter().map(|plateau| plateau.residual(self.model, x).norm_squared()).sum()
    }

    /// Norm of the remainder at `x`.
    pub fn remainder(&self, x: &DVector<f64>) -> f64 {
        let dx = x - &self.reference;
        let plateaus = self.plateaus.iter();
        plateaus.map(|plateau| plateau.remainder(self.model, &dx, x).powi(2)).sum::<f64>().sqrt()
    }

    /// The equations of the reference as equations at `x`.
    pub fn design(&self, x: &DVector<f64>) -> Design {
        let mut design = design_of(&self.at_reference);
        design.misfit -= &design.rows * (x - &self.reference);
        design
    }

    /// The equations at zero, on which the rank is decided.
    pub fn design_at_zero(&self) -> Design {
        design_of(&self.at_zero)
    }

    fn push_at_reference(&mut self, observation: &Observation) -> Result<(), FitError> {
        let plateau = Linearised::new(self.model, observation, &self.reference)?;
        self.at_reference.update(&plateau.readings.columns, &plateau.readings.misfit);
        self.plateaus.push(Arc::new(plateau));
        Ok(())
    }
}

/// The equations of a triangle. A follower has no use for the magnitude of the readings.
fn design_of(factor: &Factor) -> Design {
    let (rows, misfit) = (factor.triangle(), factor.right_side());
    Design { rows, misfit, rest: factor.rest().sqrt(), magnitude: 0.0 }
}

/// The equations with those of one plateau more.
pub(super) fn with_readings(mut design: Design, readings: &Readings) -> Design {
    let n = design.rows.nrows();
    design.rows = design.rows.resize_vertically(n + 3, 0.0);
    design.misfit = design.misfit.resize_vertically(n + 3, 0.0);
    for (unknown, derivative) in &readings.columns {
        design.rows.fixed_view_mut::<3, 1>(n, *unknown).copy_from(derivative);
    }
    design.misfit.fixed_rows_mut::<3>(n).copy_from(&readings.misfit);
    design
}

/// A plateau by the linear model.
pub(super) fn readings_at_zero(model: &MeasurementModel, observation: &Observation) -> Result<Readings, FitError> {
    Readings::new(observation, &model.linearise_at_zero(&model.experiment().set_points[observation.set_point]))
}
