//! Estimation of the unknowns from plateau means.
//!
//! [`linear`] is the source's weighted least squares on `Z = H X + r` [K5.3]; [`exact`] goes on from there by
//! Gauss-Newton on the exact model. Both work by orthogonal factorisation of the whitened design, never by
//! normal equations. [`recursive`] gives the same estimates plateau by plateau.
//!
//! **Short rank.** What is estimable is decided on `H`, where the structure of the experiment is exact. Away
//! from zero the products of two unknowns let second-order traces of the lost combinations into the exact model:
//! too weak to give an honest value, too strong to be ignored in the others. The lost combinations therefore stay
//! free in the exact fit. They are kept from running away by a standard deviation of [`NULL_HOLD`] typical
//! magnitudes, which is let go as soon as the traces are seen to do it themselves; whatever doubt the
//! lost combinations leave in the estimable parameters is in the covariance of those.
//!
//! **Priors** of the model are rows of the design like any other; the fit says what rests on them.

mod gain;
/// The same estimates by a filter over plateaus, with the states that the order of the experiments asks for.
pub mod recursive;

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector, Dyn, Matrix3, QR, Vector3};

pub use self::gain::Gain;
use crate::design::{Design, Observation, Whitener, total_covariance};
use crate::error::FitError;
use crate::measurement::{Linearisation, MeasurementModel};
use crate::observability::Observability;
use crate::parameter::NULL_HOLD;
use crate::prior::{self, Prior, PriorUse};

/// The hold is let go when the data keep every lost combination to this part of it: it then informs by less than 1 %.
const LET_GO: f64 = 0.1;

/// A step of less than this many standard uncertainties, all unknowns together, ends the iteration: it converges
/// quadratically, so the step after it would be lost in rounding.
const CONVERGED: f64 = 1e-6;

const ITERATION_LIMIT: usize = 50;

/// Halvings of a step before it is given up: `2^-30` of a Gauss-Newton step is none.
const HALVING_LIMIT: u32 = 30;

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// One linear solution was asked for.
    Linear,
    /// The last step was below a millionth of a standard uncertainty, or of rounding size.
    Converged,
    /// No step along the Gauss-Newton direction lowers chi^2 any more.
    Stalled,
    /// The limit of iterations was reached.
    IterationLimit,
}

/// Estimates and all that is known about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Estimates in the order of the model's parameters, SI; those that are not estimable are of no meaning.
    values: Vec<f64>,
    covariance: DMatrix<f64>,
    observability: Observability,
    /// What the data see without the priors, when there are any.
    of_data: Option<Observability>,
    priors: Vec<Prior>,
    /// Sum of squared whitened residuals, of the priors too.
    pub chi_squared: f64,
    /// Whether the null directions, if any, had to be held to the end (see the module's text).
    pub null_directions_held: bool,
    /// `3 n` and the number of priors, less the rank; 0 when nothing is redundant.
    pub degrees_of_freedom: usize,
    /// Linearisations made.
    pub iterations: usize,
    /// How it ended.
    pub termination: Termination,
    /// Mean less model, per observation [m/s^2].
    pub residuals: Vec<Vector3<f64>>,
    /// Covariance of each observation with its speed term [m^2/s^4].
    pub observation_covariances: Vec<Matrix3<f64>>,
}

impl Fit {
    /// Estimate of parameter `j`, unless the data do not determine it.
    pub fn value(&self, j: usize) -> Option<f64> {
        self.observability.is_estimable(j).then(|| self.values[j])
    }

    /// Covariance of the estimates of parameters `i` and `j`, if both are determined.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        let both = self.observability.is_estimable(i) && self.observability.is_estimable(j);
        both.then(|| self.covariance[(i, j)])
    }

    /// Standard uncertainty of the estimate of parameter `j`, if it is determined.
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.covariance(j, j).map(f64::sqrt)
    }

    /// The point in parameter space at which the fit stands, lost combinations included: for prediction of
    /// readings, never as estimates.
    pub fn state(&self) -> &[f64] {
        &self.values
    }

    /// What the experiment sees.
    pub fn observability(&self) -> &Observability {
        &self.observability
    }

    /// What the data added to each prior that was given on an estimable parameter.
    pub fn prior_uses(&self) -> Vec<PriorUse> {
        prior::uses(&self.priors, |i, j| self.covariance[(i, j)])
    }

    /// Part of the variance of estimate `j` that comes from the priors, 0 to 1; `None` if it is not determined.
    pub fn prior_share(&self, j: usize) -> Option<f64> {
        let determined = self.observability.is_estimable(j);
        determined.then(|| prior::share(&self.priors, j, |i, j| self.covariance[(i, j)]))
    }

    /// Whether parameter `j` is determined only thanks to the priors.
    pub fn rests_on_prior(&self, j: usize) -> bool {
        self.observability.is_estimable(j) && self.of_data.as_ref().is_some_and(|data| !data.is_estimable(j))
    }

    /// chi^2 per degree of freedom; `None` without redundancy.
    pub fn reduced_chi_squared(&self) -> Option<f64> {
        (self.degrees_of_freedom > 0).then(|| self.chi_squared / self.degrees_of_freedom as f64)
    }
}

/// Weighted least squares on the source's linear model [K5.3].
///
/// # Errors
/// [`FitError`] when an observation cannot be one.
pub fn linear(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    linear_with(&Structure::of(model, observations)?, model, observations)
}

/// [`linear`] with the structure of the design already known.
///
/// # Errors
/// As [`linear`].
pub fn linear_with(
    structure: &Structure,
    model: &MeasurementModel,
    observations: &[Observation],
) -> Result<Fit, FitError> {
    Ok(Start::new(structure, Design::at, model, observations)?.solve())
}

/// Gauss-Newton on the exact model to convergence, from the linear solution.
///
/// # Errors
/// [`FitError`] when an observation cannot be one.
pub fn exact(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    exact_with(&Structure::of(model, observations)?, model, observations)
}

/// [`exact`] with the structure of the design already known: for many fits of one experiment.
///
/// # Errors
/// As [`exact`].
pub fn exact_with(
    structure: &Structure,
    model: &MeasurementModel,
    observations: &[Observation],
) -> Result<Fit, FitError> {
    Search::from(Start::new(structure, Design::at, model, observations)?, model).run()
}

/// How the whitened equations of all plateaus, linearised at a point, are brought together: [`Design::at`], or by
/// way of a filter.
type Assemble = fn(&[f64], &MeasurementModel, &[Observation], &[Linearisation]) -> Result<Design, FitError>;

/// What a design sees and what it loses, decided on `H` at `X = 0`. It depends on the plateaus and their weights,
/// never on the readings, and holds for any number of fits of one experiment.
#[derive(Debug, Clone)]
pub struct Structure {
    observability: Observability,
    /// What the data see without the priors, when there are any.
    of_data: Option<Observability>,
    /// Orthonormal basis of the null space in typical units, `p x (p - rank)`.
    null_basis: DMatrix<f64>,
    typical: DVector<f64>,
    /// Of the observations at `X = 0`.
    linearisations: Vec<Linearisation>,
    /// The equations at `X = 0`, null directions held, factored when the first fit starts from them.
    start: OnceLock<QR<f64, Dyn, Dyn>>,
}

impl Structure {
    /// Structure of the design that `observations` of `model` make with their weights.
    ///
    /// # Errors
    /// [`FitError`] when an observation cannot be one.
    pub fn of(model: &MeasurementModel, observations: &[Observation]) -> Result<Self, FitError> {
        Self::by(Design::at, model, observations)
    }

    fn by(assemble: Assemble, model: &MeasurementModel, observations: &[Observation]) -> Result<Self, FitError> {
        check(model, observations)?;
        let linearisations = linearised_at_zero(model, observations);
        let columns = model.parameters().len();
        let design = assemble(&vec![0.0; columns], model, observations, &linearisations)?;
        let rows_of_data = design.rows.nrows() - model.priors().len();
        let of_data = || Observability::of(&design.rows.rows(0, rows_of_data).into_owned());
        let of_data = (!model.priors().is_empty()).then(of_data);
        let observability = Observability::of(&design.rows);
        let typical = DVector::from_iterator(columns, model.parameters().iter().map(|p| p.typical));
        let mut null_basis = observability.null_basis().clone();
        null_basis.row_iter_mut().zip(typical.iter()).for_each(|(mut row, typical)| row /= *typical);
        let (null_basis, start) = (orthonormal(null_basis), OnceLock::new());
        Ok(Self { observability, of_data, null_basis, typical, linearisations, start })
    }

    /// What the design sees.
    pub fn observability(&self) -> &Observability {
        &self.observability
    }

    /// The whitened equations in typical units, with one equation more for each null direction: its component
    /// is zero, with weight `hold`.
    fn equations(&self, design: &Design, x: &DVector<f64>, hold: f64) -> Equations<'_> {
        let (n, p, lost) = (design.rows.nrows(), design.rows.ncols(), self.null_basis.ncols());
        let mut rows = DMatrix::zeros(n + lost, p);
        rows.rows_mut(0, n).copy_from(&design.rows);
        rows.column_iter_mut().zip(self.typical.iter()).for_each(|(mut column, typical)| column *= *typical);
        let hold = self.null_basis.transpose() * hold;
        let mut misfit = DVector::zeros(n + lost);
        misfit.rows_mut(0, n).copy_from(&design.misfit);
        misfit.rows_mut(n, lost).copy_from(&(-&hold * x.component_div(&self.typical)));
        rows.rows_mut(n, lost).copy_from(&hold);
        Equations { rows, misfit, typical: &self.typical }
    }
}

/// The problem at `X = 0`: its structure and first linear equations.
struct Start<'a> {
    assemble: Assemble,
    model: &'a MeasurementModel,
    observations: &'a [Observation],
    structure: &'a Structure,
    design: Design,
    zero: DVector<f64>,
}

impl<'a> Start<'a> {
    fn new(
        structure: &'a Structure,
        assemble: Assemble,
        model: &'a MeasurementModel,
        observations: &'a [Observation],
    ) -> Result<Self, FitError> {
        check(model, observations)?;
        let zero = DVector::zeros(model.parameters().len());
        let design = assemble(zero.as_slice(), model, observations, &structure.linearisations)?;
        Ok(Self { assemble, model, observations, structure, design, zero })
    }

    /// The first step, from zero: every fit of one experiment has the same equations there, and its own misfit.
    fn step(&self) -> Step<'a> {
        let equations = || self.structure.equations(&self.design, &self.zero, 1.0 / NULL_HOLD);
        let factored = self.structure.start.get_or_init(|| equations().rows.qr());
        let lost = self.structure.null_basis.ncols();
        let misfit = self.design.misfit.clone().resize_vertically(self.design.misfit.len() + lost, 0.0);
        Step::of(factored, misfit, &self.structure.typical)
    }

    /// Degrees of freedom left by the estimable combinations.
    fn degrees_of_freedom(&self) -> usize {
        let rows = 3 * self.observations.len() + self.model.priors().len();
        rows.saturating_sub(self.structure.observability.rank())
    }

    /// The linear fit: the residual of `Z - H X`.
    fn solve(self) -> Fit {
        let step = self.step();
        let covariance = step.covariance();
        let residuals = self
            .observations
            .iter()
            .zip(&self.structure.linearisations)
            .map(|(o, l)| {
                let predicted: Vector3<f64> = l.columns.iter().map(|(j, column)| column * step.dx[*j]).sum();
                o.mean - l.reading - predicted
            })
            .collect();
        let whitened = &self.design.misfit - &self.design.rows * &step.dx;
        Fit {
            values: step.dx.as_slice().to_vec(),
            covariance,
            chi_squared: whitened.norm_squared() + self.design.rest.powi(2),
            degrees_of_freedom: self.degrees_of_freedom(),
            null_directions_held: self.structure.null_basis.ncols() > 0,
            iterations: 1,
            termination: Termination::Linear,
            residuals,
            observation_covariances: total_covariances(self.observations, &self.structure.linearisations),
            observability: self.structure.observability.clone(),
            of_data: self.structure.of_data.clone(),
            priors: self.model.priors().to_vec(),
        }
    }
}

/// A point, and the linearisations there.
type Place = (DVector<f64>, Vec<Linearisation>);

/// The state of the Gauss-Newton iteration.
struct Search<'a> {
    start: Start<'a>,
    model: &'a MeasurementModel,
    x: DVector<f64>,
    linearisations: Vec<Linearisation>,
    /// Those at `x`, where the step to it has made them already.
    ahead: Option<Vec<Linearisation>>,
    design: Option<Design>,
    /// Weight with which null directions are held: one over [`NULL_HOLD`], then 0 when let go.
    hold: f64,
    iterations: usize,
    termination: Option<Termination>,
    /// Of the last linearisation, once the search has ended.
    covariance: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn from(start: Start<'a>, model: &'a MeasurementModel) -> Self {
        let hold = if start.structure.null_basis.ncols() > 0 { 1.0 / NULL_HOLD } else { 0.0 };
        let x = start.step().dx;
        Self {
            start,
            model,
            x,
            linearisations: Vec::new(),
            ahead: None,
            design: None,
            hold,
            iterations: 0,
            termination: None,
            covariance: DMatrix::zeros(0, 0),
        }
    }

    fn run(mut self) -> Result<Fit, FitError> {
        while self.is_running() {
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
        let (start, x) = (&self.start, self.x.as_slice());
        self.linearisations = ahead.unwrap_or_else(|| linearised(self.model, start.observations, x));
        let assembled = (start.assemble)(x, self.model, start.observations, &self.linearisations);
        self.design = Some(assembled?);
        self.iterations += 1;
        Ok(())
    }

    /// One Gauss-Newton step, halved until chi^2 falls with the weights as they are.
    fn step(&mut self) -> Result<(), FitError> {
        let Some(design) = self.design.take() else { return Ok(()) };
        let equations = self.start.structure.equations(&design, &self.x, self.hold);
        let objective_norm = equations.misfit.norm().hypot(design.rest);
        let step = equations.solve();
        // Of a sum of squares of readings that are known to a few units of their last place.
        let rounding = 100.0 * f64::EPSILON * design.magnitude;
        if step.whitened_length <= CONVERGED + rounding {
            self.x += &step.dx;
            self.termination = (!self.let_go(&step)).then_some(Termination::Converged);
        } else if let Some((x, linearisations)) = self.descend(&step, (objective_norm + rounding).powi(2))? {
            (self.x, self.ahead) = (x, Some(linearisations));
            if self.iterations == ITERATION_LIMIT {
                self.termination = Some(Termination::IterationLimit);
            }
        } else {
            self.termination = Some(Termination::Stalled);
        }
        if self.termination.is_some() {
            self.covariance = step.covariance();
        }
        Ok(())
    }

    /// Lets the null directions go, once, if the data keep them well within the hold.
    fn let_go(&mut self, step: &Step<'_>) -> bool {
        let null_basis = &self.start.structure.null_basis;
        let free = self.hold > 0.0 && (null_basis.transpose() * step.inverse()).norm() < LET_GO * NULL_HOLD;
        if free {
            self.hold = 0.0;
        }
        free
    }

    /// The point one step on, halved until the objective falls, and the linearisations there; none if it does not.
    fn descend(&self, step: &Step, objective: f64) -> Result<Option<Place>, FitError> {
        for halvings in 0..HALVING_LIMIT {
            let x = &self.x + &step.dx * 0.5_f64.powi(halvings.cast_signed());
            let linearisations = linearised(self.model, self.start.observations, x.as_slice());
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
        let held = structure.null_basis.transpose() * x.component_div(&structure.typical) * self.hold;
        let residuals: Vec<_> = self.start.observations.iter().zip(there).map(|(o, l)| o.mean - l.reading).collect();
        Ok(self.chi_squared(&residuals, x)? + held.norm_squared())
    }

    fn chi_squared(&self, residuals: &[Vector3<f64>], x: &DVector<f64>) -> Result<f64, FitError> {
        chi_squared(self.model.priors(), self.start.observations, &self.linearisations, residuals, x)
    }

    /// The residuals at the last point, with the weights and the covariance of the last linearisation: on convergence
    /// less than a millionth of a standard uncertainty away.
    fn into_fit(self) -> Result<Fit, FitError> {
        let residuals = residuals(self.model, self.start.observations, &self.x);
        Ok(Fit {
            values: self.x.as_slice().to_vec(),
            chi_squared: self.chi_squared(&residuals, &self.x)?,
            covariance: self.covariance,
            degrees_of_freedom: self.start.degrees_of_freedom(),
            null_directions_held: self.hold > 0.0,
            iterations: self.iterations,
            termination: self.termination.unwrap_or(Termination::IterationLimit),
            residuals,
            observation_covariances: total_covariances(self.start.observations, &self.linearisations),
            observability: self.start.structure.observability.clone(),
            of_data: self.start.structure.of_data.clone(),
            priors: self.model.priors().to_vec(),
        })
    }
}

/// Whitened equations of full rank in typical units.
struct Equations<'a> {
    rows: DMatrix<f64>,
    misfit: DVector<f64>,
    typical: &'a DVector<f64>,
}

impl<'a> Equations<'a> {
    /// Householder QR and back substitution.
    fn solve(self) -> Step<'a> {
        Step::of(&self.rows.qr(), self.misfit, self.typical)
    }
}

/// A solution of the linearised equations.
struct Step<'a> {
    dx: DVector<f64>,
    /// Length of the step in standard uncertainties, all unknowns together.
    whitened_length: f64,
    /// `R` of the equations in typical units.
    r: DMatrix<f64>,
    typical: &'a DVector<f64>,
}

impl<'a> Step<'a> {
    /// Back substitution of `misfit` in the factored equations.
    fn of(factored: &QR<f64, Dyn, Dyn>, mut misfit: DVector<f64>, typical: &'a DVector<f64>) -> Self {
        factored.q_tr_mul(&mut misfit);
        let head = misfit.rows(0, typical.len()).into_owned();
        let (r, whitened_length, mut dx) = (factored.r(), head.norm(), head);
        // Held null directions leave no zero on the diagonal.
        let solved = r.solve_upper_triangular_mut(&mut dx);
        debug_assert!(solved, "the held equations are of full rank");
        dx.component_mul_assign(typical);
        Step { dx, whitened_length, r, typical }
    }

    /// `R^-1`, in typical units.
    fn inverse(&self) -> DMatrix<f64> {
        let mut inverse = DMatrix::identity(self.typical.len(), self.typical.len());
        self.r.solve_upper_triangular_mut(&mut inverse);
        inverse
    }

    /// `R^-1 R^-T`, in physical units.
    fn covariance(&self) -> DMatrix<f64> {
        let mut inverse = self.inverse();
        inverse.row_iter_mut().zip(self.typical.iter()).for_each(|(mut row, typical)| row *= *typical);
        &inverse * inverse.transpose()
    }
}

fn check(model: &MeasurementModel, observations: &[Observation]) -> Result<(), FitError> {
    let count = model.experiment().set_points.len();
    for observation in observations {
        let set_point = observation.set_point;
        if set_point >= count {
            return Err(FitError::Unknown { set_point, count });
        }
        if !observation.mean.iter().chain(observation.covariance.iter()).all(|v| v.is_finite()) {
            return Err(FitError::NotFinite { set_point });
        }
        if observation.covariance.cholesky().is_none() {
            let diagonal = observation.covariance.diagonal().into();
            return Err(FitError::Covariance { set_point, diagonal });
        }
    }
    if observations.is_empty() { Err(FitError::Empty) } else { Ok(()) }
}

fn linearised_at_zero(model: &MeasurementModel, observations: &[Observation]) -> Vec<Linearisation> {
    let set_points = &model.experiment().set_points;
    observations.iter().map(|o| model.linearise_at_zero(&set_points[o.set_point])).collect()
}

/// The exact model at `x`.
fn linearised(model: &MeasurementModel, observations: &[Observation], x: &[f64]) -> Vec<Linearisation> {
    let set_points = &model.experiment().set_points;
    observations.iter().map(|o| model.linearise(&set_points[o.set_point], x)).collect()
}

/// Readings less those of the exact model at `x` [m/s^2].
fn residuals(model: &MeasurementModel, observations: &[Observation], x: &DVector<f64>) -> Vec<Vector3<f64>> {
    let set_points = &model.experiment().set_points;
    let residual = |o: &Observation| o.mean - model.reading(&set_points[o.set_point], x.as_slice());
    observations.iter().map(residual).collect()
}

/// Sum of squares of `residuals`, which are those at `x`, with the weights of the linearisations; and the priors' share.
fn chi_squared(
    priors: &[Prior],
    observations: &[Observation],
    linearisations: &[Linearisation],
    residuals: &[Vector3<f64>],
    x: &DVector<f64>,
) -> Result<f64, FitError> {
    let of_prior = |p: &Prior| (x[p.parameter] / p.standard_uncertainty).powi(2);
    let mut sum: f64 = priors.iter().map(of_prior).sum();
    for ((o, l), residual) in observations.iter().zip(linearisations).zip(residuals) {
        sum += Whitener::new(&o.into(), &l.speed_error)?.apply(residual).norm_squared();
    }
    Ok(sum)
}

fn total_covariances(observations: &[Observation], linearisations: &[Linearisation]) -> Vec<Matrix3<f64>> {
    let pairs = observations.iter().zip(linearisations);
    pairs.map(|(o, l)| total_covariance(&o.covariance, &l.speed_error)).collect()
}

/// Orthonormal basis of the span of the columns, which are independent.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    if columns.ncols() == 0 { columns } else { columns.qr().q() }
}
