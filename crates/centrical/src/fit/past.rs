//! Plateaus that are behind, linearised once and rotated into triangles.
//!
//! A point of the unknowns that moves makes all linearisations anew, which costs as much as all plateaus so far. But what a
//! plateau adds to them is small. Let `r` be the whitened residuals of the exact model and `A` their derivatives at the
//! reference `x_0`. The triangle is off at `x` by the remainder `r(x) - (r(x_0) - A (x - x_0))`.
//! While its norm is below a hundredth of a standard uncertainty the triangle stands; beyond that the point becomes the
//! reference. As the unknowns become known they move less, and references become rare.
//!
//! Plateaus of one mounting at one speed read alike ([`MeasurementModel::alike`]): they are linearised together, so that a reference
//! costs as much as the different plateaus, however often a campaign repeats them.

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{DVector, Matrix3, Vector3};

use super::design::Design;
use super::filter::Readings;
use crate::linalg::factor::Factor;
use crate::model::whitening::Whitener;
use crate::model::{FitError, Linearisation, MeasurementModel, Observation};

/// The largest remainder, in standard uncertainties of all unknowns together.
pub(super) const REMAINDER: f64 = 1e-2;

/// Plateaus linearised at a reference, and at zero.
#[derive(Debug, Clone)]
pub(super) struct Past<'m> {
    model: &'m MeasurementModel,
    /// The first set point that reads as each.
    alike: Arc<[usize]>,
    reference: DVector<f64>,
    /// Plateaus that were behind when the reference was set.
    referenced: usize,
    groups: Vec<Arc<Linearised>>,
    /// The group of each set point that has come, by the first one that reads as it.
    group_of: HashMap<usize, usize>,
    at_reference: Factor,
    /// What no reading takes up of the plateaus that were behind when the reference was set.
    rest: f64,
    at_zero: Factor,
}

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
    /// By the exact model.
    pub fn new(model: &MeasurementModel, observation: &Observation, x: &DVector<f64>) -> Result<Self, FitError> {
        Self::together(model, std::slice::from_ref(observation), x)
    }

    /// Plateaus that read alike, at least one, by the exact model.
    fn together(model: &MeasurementModel, alike: &[Observation], x: &DVector<f64>) -> Result<Self, FitError> {
        let set_point = &model.experiment().set_points[alike[0].set_point];
        let at = model.linearise(set_point, &x.as_slice()[..model.parameters().len()]);
        let at = at.with_influences(x.as_slice());
        let mut linearised = Self { observations: Vec::new(), at, sum: Factor::new(3) };
        alike.iter().try_for_each(|observation| linearised.push(observation))?;
        Ok(linearised)
    }

    fn push(&mut self, observation: &Observation) -> Result<(), FitError> {
        let whitener = Whitener::new(&observation.into(), &self.at)?;
        let columns = [0, 1, 2].map(|axis| (axis, whitener.apply(&Vector3::ith(axis, 1.0))));
        self.sum.update(&columns, &whitener.apply(&(observation.mean - self.at.reading)));
        self.observations.push(observation.clone());
        Ok(())
    }

    /// The whitened equations of the plateaus, three for all of them.
    pub fn readings(&self) -> Readings {
        let (triangle, misfit) = self.triangle();
        Readings {
            columns: self.at.by_unknowns().map(|(unknown, change)| (unknown, triangle * change)).collect(),
            magnitude: (triangle * self.at.reading).norm(),
            misfit,
        }
    }

    /// Sum of squares that no reading takes up: of the plateaus about their weighted mean.
    fn rest(&self) -> f64 {
        self.sum.rest()
    }

    /// Norm of the whitened residual at `x` less that of the linearisation, from which `x` is `dx` away.
    pub fn remainder(&self, model: &MeasurementModel, dx: &DVector<f64>, x: &DVector<f64>) -> f64 {
        let linear: Vector3<f64> = self.at.by_unknowns().map(|(unknown, change)| change * dx[unknown]).sum();
        (self.triangle().0 * (self.reading(model, x) - self.at.reading - linear)).norm()
    }

    /// Sum of squares of the whitened residuals of the exact model at `x`.
    pub fn squared(&self, model: &MeasurementModel, x: &DVector<f64>) -> f64 {
        let (triangle, misfit) = self.triangle();
        (misfit - triangle * (self.reading(model, x) - self.at.reading)).norm_squared() + self.rest()
    }

    fn reading(&self, model: &MeasurementModel, x: &DVector<f64>) -> Vector3<f64> {
        let set_point = &model.experiment().set_points[self.observations[0].set_point];
        model.reading_with_influences(set_point, x.as_slice())
    }

    fn triangle(&self) -> (Matrix3<f64>, Vector3<f64>) {
        let row = |axis: usize| self.sum.row(axis);
        let element = |i: usize, j: usize| if j < i { 0.0 } else { row(i)[j - i] };
        (Matrix3::from_fn(element), Vector3::from_fn(|i, _| element(i, 3)))
    }
}

impl<'m> Past<'m> {
    /// No plateau yet; the next ones will be linearised at the `reference`.
    pub fn new(model: &'m MeasurementModel, reference: DVector<f64>) -> Self {
        let none = || Factor::new(reference.len());
        let (alike, groups, group_of) = (model.alike().into(), Vec::new(), HashMap::new());
        let (at_reference, at_zero) = (none(), none());
        Self { model, alike, reference, referenced: 0, groups, group_of, at_reference, rest: 0.0, at_zero }
    }

    /// Where the plateaus are linearised.
    pub fn reference(&self) -> &DVector<f64> {
        &self.reference
    }

    /// Plateaus that were behind when the reference was set.
    pub fn referenced(&self) -> usize {
        self.referenced
    }

    /// Takes a plateau up.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when its covariance is not positive definite.
    pub fn push(&mut self, observation: &Observation) -> Result<(), FitError> {
        let at_zero = readings_at_zero(self.model, observation)?;
        self.at_zero.update(&at_zero.columns, &at_zero.misfit);
        let first = self.alike[observation.set_point];
        let at_reference = if let Some(&group) = self.group_of.get(&first) {
            let group = Arc::make_mut(&mut self.groups[group]);
            group.push(observation)?;
            Readings::new(observation, &group.at)?
        } else {
            let group = Linearised::new(self.model, observation, &self.reference)?;
            let readings = group.readings();
            self.group_of.insert(first, self.groups.len());
            self.groups.push(Arc::new(group));
            readings
        };
        self.at_reference.update(&at_reference.columns, &at_reference.misfit);
        Ok(())
    }

    /// Makes `x` the reference.
    ///
    /// # Errors
    /// As [`Past::push`].
    pub fn linearise_at(&mut self, x: &DVector<f64>) -> Result<(), FitError> {
        (self.reference, self.at_reference) = (x.clone(), Factor::new(x.len()));
        self.referenced = self.groups.iter().map(|group| group.observations.len()).sum();
        for group in &mut self.groups {
            let linearised = Linearised::together(self.model, &group.observations, x)?;
            let readings = linearised.readings();
            self.at_reference.update(&readings.columns, &readings.misfit);
            *group = Arc::new(linearised);
        }
        self.rest = self.groups.iter().map(|group| group.rest()).sum();
        Ok(())
    }

    /// Sum of squares of the whitened residuals of the exact model at `x`.
    pub fn squared(&self, x: &DVector<f64>) -> f64 {
        self.groups.iter().map(|group| group.squared(self.model, x)).sum()
    }

    /// Norm of the remainder at `x`.
    pub fn remainder(&self, x: &DVector<f64>) -> f64 {
        let dx = x - &self.reference;
        self.groups.iter().map(|group| group.remainder(self.model, &dx, x).powi(2)).sum::<f64>().sqrt()
    }

    /// The equations of the reference as equations at `x`.
    pub fn design(&self, x: &DVector<f64>) -> Design {
        let mut design = design_of(&self.at_reference);
        design.rest = design.rest.hypot(self.rest.sqrt());
        design.misfit -= &design.rows * (x - &self.reference);
        design
    }

    /// The equations at zero, on which the rank is decided.
    pub fn design_at_zero(&self) -> Design {
        design_of(&self.at_zero)
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
