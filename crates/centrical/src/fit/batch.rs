//! Least squares on the linear model, and Gauss-Newton on the exact one.
//!
//! Both work by orthogonal factorisation of the whitened design, never by normal equations.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector, Vector3};

use super::curvature;
use super::data::Data;
use super::estimates::{Fit, Termination};
use super::structure::{Hold, Structure};
use crate::linalg::least_squares::LeastSquares;
use crate::model::plateau::Design;
use crate::model::{FitError, Linearisation, Parameter};
use crate::progress::{OnProgress, advance, unwatched};

/// The null directions are released when the data keep every one of them to this part of the hold: it then informs by less
/// than 1 %.
const RELEASE_BELOW: f64 = 0.1;

/// A step ends the iteration if the next one would be shorter than this many standard uncertainties, all unknowns together. Steps shrink
/// by the ratio of the last two at least: the iteration converges quadratically where steps are short.
const CONVERGED: f64 = 1e-6;

/// The longest step that ends the iteration, in standard uncertainties: weights and covariance are those before it.
const LAST: f64 = 1e-3;

/// Steps along a curved valley are halved many times; the longest ways seen took 51.
const ITERATION_LIMIT: usize = 200;

/// Weights that follow the estimate can move it along held null directions without end. There a step below this many standard
/// uncertainties that no longer shrinks ends the iteration.
const SETTLED: f64 = 1e-2;

/// Halvings of a step before it is given up: `2^-30` of a Gauss-Newton step is negligible.
pub(super) const HALVING_LIMIT: u32 = 30;

/// The model that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FitMethod {
    /// The exact one, by Gauss-Newton.
    Exact,
    /// The linear one.
    Linear,
}

impl Structure {
    /// The fit of one of many data sets of the same plateaus.
    ///
    /// # Errors
    /// [`FitError`] when numbers overflow.
    pub fn fit(&self, method: FitMethod, data: &Data) -> Result<Fit, FitError> {
        let zero = vec![0.0; self.held.typical.len()];
        let design = self.assembly.design(data, &zero, &self.linearisations)?;
        Start { data, structure: self, design }.fit(method, &unwatched)
    }
}

/// The problem at `X = 0`: its structure and first linear equations.
pub(super) struct Start<'a> {
    pub data: &'a Data<'a>,
    pub structure: &'a Structure,
    /// The equations at `X = 0`.
    pub design: Design,
}

impl Start<'_> {
    /// The fit of a model.
    pub fn fit(self, method: FitMethod, progress: OnProgress<()>) -> Result<Fit, FitError> {
        match method {
            FitMethod::Exact => Search::from(self).run(progress),
            FitMethod::Linear => Ok(self.linear()),
        }
    }

    /// The linear fit: the residual of `Z - H X`.
    fn linear(self) -> Fit {
        let held = &self.structure.held;
        let equations = if held.holds(Hold::WEAK) {
            let zero = DVector::zeros(held.typical.len());
            Cow::Owned(held.equations(&self.design, &zero, Hold::NULL).0)
        } else {
            Cow::Borrowed(&self.structure.start)
        };
        let x = equations.solve(self.design.misfit.clone());
        let residuals = (self.data.observations().iter())
            .zip(&self.structure.linearisations)
            .map(|(o, l)| o.mean - l.reading - l.change(&x))
            .collect();
        let whitened = &self.design.misfit - &self.design.rows * &x;
        let chi_squared = whitened.norm_squared() + self.design.rest.powi(2);
        self.fitted(&x, equations.covariance(), chi_squared, residuals, &self.structure.linearisations)
    }

    /// The fit with these estimates, by the linearisations that gave them; all else as of a linear one.
    fn fitted(
        &self,
        x: &DVector<f64>,
        covariance: DMatrix<f64>,
        chi_squared: f64,
        residuals: Vec<Vector3<f64>>,
        linearisations: &[Linearisation],
    ) -> Fit {
        let (model, Structure { held, observability, of_data, .. }) = (self.data.model(), self.structure);
        let parameters = model.parameters().len();
        // An influence brings an equation and an unknown.
        let equations = 3 * self.data.observations().len() + model.priors().len();
        Fit {
            values: x.rows(0, parameters).as_slice().to_vec(),
            deviations: x.rows_range(parameters..).as_slice().to_vec(),
            point: x.as_slice().to_vec(),
            curved: DMatrix::zeros(covariance.nrows(), 0),
            covariance,
            chi_squared,
            degrees_of_freedom: equations.saturating_sub(observability.rank()),
            null_directions_held: held.holds(Hold::NULL),
            iterations: 1,
            termination: Termination::Linear,
            residuals,
            observation_covariances: self.data.covariances(linearisations),
            observability: observability.clone(),
            of_data: of_data.clone(),
            priors: model.priors().to_vec(),
        }
    }
}

/// A point, and the linearisations there.
type Place = (DVector<f64>, Vec<Linearisation>);

/// The state of the Gauss-Newton iteration.
struct Search<'a> {
    start: Start<'a>,
    x: DVector<f64>,
    /// Once the search has ended: `x`, or one linear step on from it where weak directions are held, without their hold.
    estimates: DVector<f64>,
    linearisations: Vec<Linearisation>,
    /// Those at `x`, where the step to it has made them already.
    ahead: Option<Vec<Linearisation>>,
    design: Option<Design>,
    /// What is held; null directions are released when the data keep them.
    hold: Hold,
    iterations: usize,
    /// Length of the last step, in standard uncertainties.
    last_length: f64,
    termination: Option<Termination>,
    /// Of the last linearisation, once the search has ended.
    covariance: DMatrix<f64>,
    /// What the curvature of the model leaves in the estimates, column by column; see [`curvature`].
    curved: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn from(start: Start<'a>) -> Self {
        // Every fit of one experiment has the same equations at zero, and its own misfit.
        let (x, last_length) = start.structure.start.step(start.design.misfit.clone());
        Self {
            start,
            estimates: x.clone(),
            x,
            linearisations: Vec::new(),
            ahead: None,
            design: None,
            hold: Hold::ALL,
            iterations: 0,
            last_length,
            termination: None,
            covariance: DMatrix::zeros(0, 0),
            curved: DMatrix::zeros(0, 0),
        }
    }

    fn run(mut self, progress: OnProgress<()>) -> Result<Fit, FitError> {
        while self.is_running() {
            advance(progress, ())?;
            self.linearise()?;
            self.step()?;
        }
        self.into_fit()
    }

    fn is_running(&self) -> bool {
        self.termination.is_none()
    }

    fn linearise(&mut self) -> Result<(), FitError> {
        let ahead = self.ahead.take();
        let Start { data, structure, .. } = self.start;
        let x = self.x.as_slice();
        self.linearisations = ahead.unwrap_or_else(|| data.linearised(x));
        self.design = Some(structure.assembly.design(data, x, &self.linearisations)?);
        self.iterations += 1;
        Ok(())
    }

    /// One Gauss-Newton step, halved until chi^2 falls with the weights as they are.
    fn step(&mut self) -> Result<(), FitError> {
        let Some(design) = self.design.take() else { return Ok(()) };
        let (equations, misfit) = self.start.structure.held.equations(&design, &self.x, self.hold);
        let from = self.x.clone();
        let objective_norm = misfit.norm().hypot(design.rest);
        let (step, length) = equations.step(misfit);
        // Of a sum of squares of readings that are known to a few units of their last place.
        let rounding = 100.0 * f64::EPSILON * design.magnitude;
        let next = length * (length / self.last_length).min(1.0);
        let has_converged = next <= CONVERGED + rounding && length <= LAST + rounding;
        let has_settled =
            self.start.structure.held.holds(self.hold) && length < SETTLED && length >= 0.5 * self.last_length;
        self.last_length = length;
        if has_converged || has_settled {
            self.x += &step;
            self.termination = (!self.release_null_space(&equations)).then_some(Termination::Converged);
        } else if let Some((x, linearisations)) = self.descend(&step, (objective_norm + rounding).powi(2))? {
            (self.x, self.ahead) = (x, Some(linearisations));
            if self.iterations == ITERATION_LIMIT {
                self.termination = Some(Termination::IterationLimit);
            }
        } else {
            self.termination = Some(Termination::Stalled);
        }
        if self.termination.is_some() {
            self.estimate(&design, &equations, &from)?;
        }
        Ok(())
    }

    /// The estimates and their covariance by the last linearisation, that of `design` at the point `from`, with these equations.
    fn estimate(&mut self, design: &Design, held: &LeastSquares, from: &DVector<f64>) -> Result<(), FitError> {
        let Start { data, structure, .. } = self.start;
        self.curved = curvature::left_by(data, structure, self.hold, &self.x, &self.linearisations)?;
        let covariance = if structure.held.holds(Hold::WEAK) {
            let (equations, misfit) = structure.held.equations(design, from, self.hold.of_null());
            self.estimates = from + equations.solve(misfit);
            equations.covariance()
        } else {
            self.estimates = self.x.clone();
            held.covariance()
        };
        self.covariance = covariance + &self.curved * self.curved.transpose();
        Ok(())
    }

    /// Releases the null directions, once, if the data keep them well within the hold.
    fn release_null_space(&mut self, equations: &LeastSquares) -> bool {
        let held = &self.start.structure.held;
        let free = held.holds(self.hold.of_null())
            && held.null_basis.tr_mul(&equations.inverse()).norm() < RELEASE_BELOW * Parameter::NULL_HOLD;
        self.hold.null &= !free;
        free
    }

    /// The point one step on, halved until the objective falls, and the linearisations there; none if it does not.
    fn descend(&self, step: &DVector<f64>, objective: f64) -> Result<Option<Place>, FitError> {
        for halvings in 0..HALVING_LIMIT {
            let x = &self.x + step * 0.5_f64.powi(halvings.cast_signed());
            let linearisations = self.start.data.linearised(x.as_slice());
            if self.objective(&x, &linearisations)? <= objective {
                return Ok(Some((x, linearisations)));
            }
        }
        Ok(None)
    }

    /// chi^2 of the exact model at `x`, where it reads as in `there`, with the weights of the present linearisation; and
    /// the shares of the priors and of the hold.
    fn objective(&self, x: &DVector<f64>, there: &[Linearisation]) -> Result<f64, FitError> {
        let structure = self.start.structure;
        let held = structure.held.rows(self.hold) * x.component_div(&structure.held.typical);
        let residuals: Vec<_> =
            self.start.data.observations().iter().zip(there).map(|(o, l)| o.mean - l.reading).collect();
        Ok(self.chi_squared(&residuals, x)? + held.norm_squared())
    }

    fn chi_squared(&self, residuals: &[Vector3<f64>], x: &DVector<f64>) -> Result<f64, FitError> {
        self.start.data.chi_squared(&self.linearisations, residuals, x)
    }

    /// The residuals at the last point, with the weights and the covariance of the last linearisation: on convergence
    /// less than a thousandth of a standard uncertainty away. Beyond the point the model is linear.
    fn into_fit(self) -> Result<Fit, FitError> {
        let Start { data, structure, .. } = self.start;
        let mut residuals = data.residuals(self.x.as_slice());
        if structure.held.holds(Hold::WEAK) {
            let beyond = &self.estimates - &self.x;
            for (residual, linearisation) in residuals.iter_mut().zip(&self.linearisations) {
                *residual -= linearisation.change(&beyond);
            }
        }
        let (estimates, chi_squared) = (&self.estimates, self.chi_squared(&residuals, &self.estimates)?);
        Ok(Fit {
            point: self.x.as_slice().to_vec(),
            curved: self.curved,
            null_directions_held: structure.held.holds(self.hold.of_null()),
            iterations: self.iterations,
            termination: self.termination.unwrap_or(Termination::IterationLimit),
            ..self.start.fitted(estimates, self.covariance, chi_squared, residuals, &self.linearisations)
        })
    }
}
