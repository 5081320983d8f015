//! Following a session while the centrifuge turns.
//!
//! The linear model is off by some 20 ug, which a test of plateaus known to a few ug would take for a fault. So
//! a follower keeps a point of linearisation, and a new plateau moves it: all are linearised so close to it
//! that nothing is lost ([`Past`]), and the new one is tested and taken up or left. The point is the estimate
//! with every unknown held about zero by its typical magnitude, so that what is not
//! determined yet stays where units are. The hold places the point; no estimate, uncertainty or test knows of it.
//!
//! The equations are those of the unknowns that several plateaus contain ([`Global`](super::global::Global)): the attitude of a rest follows them.

use nalgebra::{DVector, Matrix3};

use super::batch::HALVING_LIMIT;
use super::data::Data;
use super::filter::innovation::Unexplained;
use super::global::{Attitude, PlateauEquations};
use super::linearised::Linearised;
use super::past::Past;
use super::structure::{Held, Hold};
use crate::linalg::least_squares::LeastSquares;
use crate::model::plateau::Design;
use crate::model::{FitError, Kind, MeasurementModel, Observation};
use crate::observability::Observability;
use crate::statistics::Test;

/// A point is close enough when the last step was below this many standard uncertainties: what the step after it would
/// change is of the square of it.
const CLOSE: f64 = 1e-3;

/// The largest remainder of the linearisation, in standard uncertainties of all unknowns together.
const REMAINDER: f64 = 1e-2;

/// What is put up with of a reference that is fresh: one that was set when the plateaus were fewer by less than [`GROWTH`]. A
/// direction that is hardly determined yet moves at every plateau; references at each would cost the square of the plateaus.
const FRESH_REMAINDER: f64 = 0.1;

/// Relative growth of the plateaus; below 50 of them every new one exceeds it.
const GROWTH: f64 = 0.02;

/// How the global unknowns of the point are held about zero, in typical magnitudes: as units are. What is determined is not held by it.
const HOLD: f64 = 1.0;

/// The same of the turns against the case: a fixture holds it within 10 deg. Nearer to zero the hold would turn all attitudes that are known.
const HOLD_OF_CASE: f64 = 100.0;

/// Steps towards a point, halved until they descend. They converge quadratically from the point before; a plateau that is
/// far off may not let them, and is found out by the test wherever the point is.
const STEP_LIMIT: usize = 10;

/// A session followed plateau by plateau on the exact model, in whatever order they come.
#[derive(Debug, Clone)]
pub struct Follower<'m> {
    data: Data<'m>,
    point: DVector<f64>,
    past: Past<'m>,
}

/// A plateau that has come and been tested, to be taken up ([`Follower::take`]) or left.
#[derive(Debug, Clone)]
pub struct Arrival<'m> {
    /// Its test against the plateaus before: by how much it raises the least sum of squares, at the point with it, and the rank.
    ///
    /// As in a fit, rank is decided on `H`, and what `H` does not see is held by [`Parameter::NULL_HOLD`] typical magnitudes: the exact
    /// model has second-order traces of it, which would pass for something new in every plateau.
    pub innovation: Test,
    observation: Observation,
    point: DVector<f64>,
    /// The plateaus before it, where they had to be linearised anew.
    past: Option<Past<'m>>,
}

/// What is known after some plateaus.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Rank so far, decided on `H` as in a fit.
    pub rank: usize,
    /// Estimate and standard uncertainty of each unknown, SI; `None` while it is not determined.
    pub estimates: Vec<Option<(f64, f64)>>,
}

impl<'m> Follower<'m> {
    /// Before the first plateau.
    pub fn new(model: &'m MeasurementModel) -> Self {
        let data = Data::none(model);
        let point = DVector::zeros(data.unknowns());
        Self { past: Past::new(model, point.clone()), data, point }
    }

    /// Where a follower stood that had taken up some plateaus, from its [`Follower::point`] and [`Follower::reference`] with the
    /// number of plateaus [`Follower::referenced`] there; it goes on as if it had never stopped. Points of another length are
    /// taken for zeros.
    ///
    /// # Errors
    /// [`FitError`] when an observation is invalid.
    pub fn resume(
        model: &'m MeasurementModel,
        taken: Vec<Observation>,
        point: &[f64],
        (reference, referenced): (&[f64], usize),
    ) -> Result<Self, FitError> {
        let mut follower = Self::new(model);
        let unknowns = follower.point.len();
        let filled = |from: &[f64]| {
            let zeros = DVector::zeros(unknowns);
            if from.len() == unknowns { DVector::from_column_slice(from) } else { zeros }
        };
        let reference = filled(reference);
        (follower.point, follower.past) = (filled(point), Past::new(model, reference.clone()));
        for (come, observation) in taken.into_iter().enumerate() {
            if come > 0 && come == referenced {
                follower.past = follower.past.linearised_at(&reference)?;
            }
            follower.append(observation)?;
        }
        Ok(follower)
    }

    /// Plateaus taken up, in the order in which they came.
    pub fn taken(&self) -> &[Observation] {
        self.data.observations()
    }

    /// The point: parameters, SI, then influences in standard uncertainties.
    pub fn point(&self) -> &[f64] {
        self.point.as_slice()
    }

    /// Where the plateaus are linearised.
    pub fn reference(&self) -> &[f64] {
        self.past.reference().as_slice()
    }

    /// Plateaus that had come when they were linearised there.
    pub fn referenced(&self) -> usize {
        self.past.referenced()
    }

    /// Moves the point with one plateau more, and tests it. Nothing is taken up yet.
    ///
    /// # Errors
    /// [`FitError`] when the observation is invalid.
    pub fn test(&self, observation: &Observation) -> Result<Arrival<'m>, FitError> {
        Data::check(self.data.model(), observation)?;
        let (point, past) = self.moved(observation)?;
        let behind = past.as_ref().unwrap_or(&self.past);
        let after = self.unexplained(behind, Some(observation), &point)?;
        let innovation = self.unexplained(behind, None, &point)?.innovation(&after);
        Ok(Arrival { innovation, observation: observation.clone(), point, past })
    }

    /// Takes up a plateau that this follower has tested.
    ///
    /// # Errors
    /// [`FitError`] when the observation is invalid.
    pub fn take(&mut self, arrival: Arrival<'m>) -> Result<(), FitError> {
        if let Some(past) = arrival.past {
            self.past = past;
        }
        self.point = arrival.point;
        self.append(arrival.observation)
    }

    /// What the plateaus taken up say; before the first, what the priors say.
    ///
    /// # Errors
    /// [`FitError`] when a covariance is not positive definite.
    pub fn progress(&self) -> Result<Progress, FitError> {
        self.progress_with(None)
    }

    /// What they are expected to say with one plateau more, whose mean will have `covariance` [m^2/s^4].
    ///
    /// # Errors
    /// [`FitError`] when such a plateau is impossible.
    pub fn expected(&self, set_point: usize, covariance: Matrix3<f64>) -> Result<Progress, FitError> {
        let set_points = &self.data.model().experiment().set_points;
        let unknown = FitError::Unknown { set_point, count: set_points.len() };
        let parameters = &self.point()[..self.data.model().parameters().len()];
        let mean = self.data.model().reading(set_points.get(set_point).ok_or(unknown)?, parameters);
        self.progress_with(Some(&Observation { set_point, mean, covariance }))
    }

    fn progress_with(&self, newcomer: Option<&Observation>) -> Result<Progress, FitError> {
        let known = self.known(&self.past, newcomer, &self.point)?;
        let (global, root) = (self.past.global(), known.equations.root());
        let dy = known.equations.solve(known.misfit);
        let x = self.past.completed(known.attitude.as_ref(), &(global.part(&self.point) + dy));
        let mut estimates = vec![None; x.len()];
        for prior in global.priors_of_attitudes() {
            estimates[prior.parameter] = Some((prior.mean, prior.standard_uncertainty));
        }
        for j in (0..known.observability.columns()).filter(|j| known.observability.is_estimable(*j)) {
            let column = global.columns()[j];
            estimates[column] = Some((x[column], root.row(j).norm()));
        }
        let null_basis = known.observability.null_basis().resize_vertically(global.len(), 0.0);
        let at_zero = self.past.at_zero().attitudes().iter().chain(&known.attitude_at_zero);
        for (attitude, at_zero) in self.past.attitudes().iter().chain(&known.attitude).zip(at_zero) {
            let (uncertainties, along) = (attitude.standard_uncertainties(&root), at_zero.followed(&null_basis));
            for ((&column, uncertainty), along) in attitude.columns.iter().zip(uncertainties).zip(along) {
                estimates[column] = (!known.observability.takes_part(along)).then_some((x[column], uncertainty));
            }
        }
        estimates.truncate(self.data.model().parameters().len());
        Ok(Progress { rank: known.rank, estimates })
    }

    fn append(&mut self, observation: Observation) -> Result<(), FitError> {
        self.past.push(&observation)?;
        self.data.push(observation)
    }

    /// The point moved to the estimate with one plateau more, and the plateaus before where they had to be linearised anew.
    fn moved(&self, newcomer: &Observation) -> Result<(DVector<f64>, Option<Past<'m>>), FitError> {
        let (global, held_to) = (self.past.global(), self.past.global().part(&self.held_to()));
        let (mut point, mut moved) = (self.point.clone(), None);
        for _ in 0..STEP_LIMIT {
            let past = moved.as_ref().unwrap_or(&self.past);
            let newcomer = past.linearised(newcomer)?;
            let (plateau, y) = (past.equations_of(&newcomer), global.part(&point));
            let (equations, misfit) = held(&global.with_priors(past.design(Some(&plateau), &y), &y), &y, &held_to);
            let (step, length) = equations.step(misfit);
            let x = past.completed(plateau.attitude.as_ref(), &(y + step));
            let dx = &x - &point;
            let limit = if moved.is_none() && self.is_fresh() { FRESH_REMAINDER } else { REMAINDER };
            // The attitude of a rest moves besides.
            let length = length.max(newcomer.change(&dx));
            if length < CLOSE || past.remainder(&newcomer, &x) < limit {
                return Ok((x, moved));
            }
            let Some(next) = self.descend(past, &newcomer, &point, &dx, &held_to) else { break };
            // Where a plateau that is far off leads to readings beyond all numbers, the point stays where it is.
            let Ok(linearised) = past.linearised_at(&next) else { break };
            (moved, point) = (Some(linearised), next);
        }
        Ok((point, moved))
    }

    /// Magnitudes to which unknowns of the point are held.
    fn held_to(&self) -> DVector<f64> {
        let mut held_to = self.data.typical() * HOLD;
        for (j, parameter) in self.data.model().parameters().iter().enumerate() {
            if matches!(parameter.kind, Kind::CaseTurn(_)) {
                held_to[j] = parameter.typical * HOLD_OF_CASE;
            }
        }
        held_to
    }

    /// Whether hardly a plateau has come since the reference was set.
    fn is_fresh(&self) -> bool {
        let come = self.taken().len();
        ((come - self.referenced()) as f64) < GROWTH * come as f64
    }

    /// The point one step on, halved until the sum of squares falls; none if it does not: the point stays where it is.
    fn descend(
        &self,
        past: &Past,
        newcomer: &Linearised,
        point: &DVector<f64>,
        dx: &DVector<f64>,
        held_to: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let objective = |x: &DVector<f64>| {
            let plateaus = past.squared(x) + newcomer.squared(self.data.model(), x);
            let held = self.past.global().part(x).component_div(held_to).norm_squared();
            plateaus + self.data.squared_beforehand(x) + held
        };
        let here = objective(point);
        let mut halved = (0..HALVING_LIMIT).map(|halvings| point + dx * 0.5_f64.powi(halvings.cast_signed()));
        halved.find(|x| objective(x) <= here)
    }

    /// Least sum of squares of some plateaus and perhaps one more, linearised close to `x`, and their rank.
    fn unexplained(
        &self,
        past: &Past,
        newcomer: Option<&Observation>,
        x: &DVector<f64>,
    ) -> Result<Unexplained, FitError> {
        let known = self.known(past, newcomer, x)?;
        let left = known.equations.redundant(&known.misfit).norm_squared();
        Ok(Unexplained { squared: left + known.rest.powi(2), rank: known.rank })
    }

    /// What some plateaus and perhaps one more determine, and their equations at `x`.
    fn known(&self, past: &Past, newcomer: Option<&Observation>, x: &DVector<f64>) -> Result<Known, FitError> {
        let global = past.global();
        let at_zero = newcomer.map(|newcomer| past.equations_at_zero(newcomer)).transpose()?;
        let observability = observability(past, at_zero.as_ref());
        let held = Held::new(&observability, Vec::new(), global.part(&self.data.typical()));
        let newcomer = newcomer.map(|newcomer| past.linearised(newcomer)).transpose()?;
        let (newcomer, y) = (newcomer.map(|newcomer| past.equations_of(&newcomer)), global.part(x));
        let design = global.with_priors(past.design(newcomer.as_ref(), &y), &y);
        let (equations, misfit) = held.equations(&design, &y, Hold::NULL);
        let attitude_at_zero = at_zero.and_then(|plateau| plateau.attitude);
        let attitudes = past.at_zero().attitudes().iter().chain(&attitude_at_zero);
        let of_attitudes: usize = attitudes.map(|attitude| attitude.unknown_before).sum();
        Ok(Known {
            rank: observability.rank() + global.priors_of_attitudes().count() + of_attitudes,
            observability,
            equations,
            misfit,
            rest: design.rest,
            attitude: newcomer.and_then(|newcomer| newcomer.attitude),
            attitude_at_zero,
        })
    }
}

/// What some plateaus and perhaps one more determine, and their equations at a point.
struct Known {
    /// Of all unknowns.
    rank: usize,
    /// Of the global parameters.
    observability: Observability,
    /// The equations of the global unknowns with the misfit, null directions held, and the norm of the part that no unknown can follow.
    equations: LeastSquares,
    misfit: DVector<f64>,
    rest: f64,
    /// The attitude of the one more, where it has its own.
    attitude: Option<Attitude>,
    attitude_at_zero: Option<Attitude>,
}

/// What the plateaus and the priors show of the global parameters, by the equations at zero.
fn observability(past: &Past, newcomer: Option<&PlateauEquations>) -> Observability {
    let global = past.global();
    let design = global.with_priors(past.at_zero().design(newcomer), &DVector::zeros(global.len()));
    let (rows, parameters) = (design.rows.nrows() - global.influences(), global.len() - global.influences());
    let squared_lengths = past.at_zero().squared_lengths(newcomer) + global.squared_lengths_of_priors();
    let lengths = squared_lengths.rows(0, parameters).map(|square| if square > 0.0 { square.sqrt() } else { 1.0 });
    Observability::left_of(design.rows.view((0, 0), (rows, parameters)).into_owned(), lengths)
}

/// The equations at `x` and their misfit, with every unknown held about zero, to `held_to`.
fn held(design: &Design, x: &DVector<f64>, held_to: &DVector<f64>) -> (LeastSquares, DVector<f64>) {
    let (n, p) = design.rows.shape();
    let mut rows = design.rows.clone().resize_vertically(n + p, 0.0);
    rows.column_iter_mut().zip(held_to.iter()).for_each(|(mut column, size)| column *= *size);
    rows.rows_mut(n, p).fill_diagonal(1.0);
    let mut misfit = design.misfit.clone().resize_vertically(n + p, 0.0);
    misfit.rows_mut(n, p).copy_from(&-x.component_div(held_to));
    (LeastSquares::new(rows, held_to.clone()), misfit)
}
