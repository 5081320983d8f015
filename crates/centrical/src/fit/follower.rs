//! Following a session while the centrifuge turns.
//!
//! The linear model is off by some 20 ug, which a test of plateaus known to a few ug would take for a fault. So
//! a follower keeps a point of linearisation, and a new plateau moves it: all are linearised so close to it
//! that nothing is lost ([`Past`]), and the new one is tested and taken up or left. The point is the estimate
//! with every unknown held about zero by its typical magnitude, so that what is not
//! determined yet stays where units are. The hold places the point; no estimate, uncertainty or test knows of it.

use nalgebra::{DVector, Matrix3};

use super::assembly::Assembly;
use super::batch::HALVING_LIMIT;
use super::data::Data;
use super::design::Design;
use super::filter::innovation::{Innovation, Unexplained};
use super::linearised::Linearised;
use super::past::Past;
use super::structure::Structure;
use crate::linalg::least_squares::LeastSquares;
use crate::model::{FitError, MeasurementModel, NULL_HOLD, Observation};

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

/// How the point is held about zero, in typical magnitudes: as units are. What is determined is not held by it.
const HOLD: f64 = 1.0;

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
    /// As in a fit, rank is decided on `H`, and what `H` does not see is held by [`NULL_HOLD`] typical magnitudes: the exact
    /// model has second-order traces of it, which would pass for something new in every plateau.
    pub innovation: Innovation,
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
        self.data.check(observation)?;
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

    /// What the plateaus taken up say.
    ///
    /// # Errors
    /// [`FitError::Empty`] before the first.
    pub fn progress(&self) -> Result<Progress, FitError> {
        if self.taken().is_empty() { Err(FitError::Empty) } else { self.progress_with(None) }
    }

    /// What they are expected to say with one plateau more, whose mean will have `covariance` [m^2/s^4].
    ///
    /// # Errors
    /// [`FitError`] when there can be no such plateau.
    pub fn expected(&self, set_point: usize, covariance: Matrix3<f64>) -> Result<Progress, FitError> {
        let set_points = &self.data.model().experiment().set_points;
        let unknown = FitError::Unknown { set_point, count: set_points.len() };
        let parameters = &self.point()[..self.data.model().parameters().len()];
        let mean = self.data.model().reading(set_points.get(set_point).ok_or(unknown)?, parameters);
        self.progress_with(Some(&Observation { set_point, mean, covariance }))
    }

    fn progress_with(&self, newcomer: Option<&Observation>) -> Result<Progress, FitError> {
        let (structure, equations, misfit, _) = self.equations(&self.past, newcomer, &self.point)?;
        let (step, covariance) = (equations.solve(misfit), equations.covariance());
        let known = |j: usize| (self.point[j] + step.x[j], covariance[(j, j)].sqrt());
        let estimates = (0..structure.observability.columns())
            .map(|j| structure.observability.is_estimable(j).then(|| known(j)))
            .collect();
        Ok(Progress { rank: structure.observability.rank(), estimates })
    }

    fn append(&mut self, observation: Observation) -> Result<(), FitError> {
        self.past.push(&observation)?;
        self.data.push(observation)
    }

    /// The point moved to the estimate with one plateau more, and the plateaus before where they had to be linearised anew.
    fn moved(&self, newcomer: &Observation) -> Result<(DVector<f64>, Option<Past<'m>>), FitError> {
        let typical = self.data.typical();
        let (mut point, mut moved) = (self.point.clone(), None);
        for _ in 0..STEP_LIMIT {
            let past = moved.as_ref().unwrap_or(&self.past);
            let newcomer = past.linearised(newcomer)?;
            let (equations, misfit) = held(&self.whole(past.design(Some(&newcomer), &point), &point), &point, &typical);
            let step = equations.solve(misfit);
            let x = &point + &step.x;
            let limit = if moved.is_none() && self.is_fresh() { FRESH_REMAINDER } else { REMAINDER };
            if step.whitened_length < CLOSE || past.remainder(&newcomer, &x) < limit {
                return Ok((x, moved));
            }
            let Some(next) = self.descend(past, &newcomer, &point, &step.x, &typical) else { break };
            moved = Some(past.linearised_at(&next)?);
            point = next;
        }
        Ok((point, moved))
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
        typical: &DVector<f64>,
    ) -> Option<DVector<f64>> {
        let objective = |x: &DVector<f64>| {
            let plateaus = past.squared(x) + newcomer.squared(self.data.model(), x);
            plateaus + self.data.squared_beforehand(x) + (x.component_div(typical) / HOLD).norm_squared()
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
        let (structure, equations, misfit, rest) = self.equations(past, newcomer, x)?;
        let left = equations.redundant(&misfit).norm_squared();
        Ok(Unexplained { squared: left + rest.powi(2), rank: structure.observability.rank() })
    }

    /// What some plateaus and perhaps one more determine, their equations at `x` with the misfit, and the norm of the part that
    /// no unknown can follow.
    fn equations(
        &self,
        past: &Past,
        newcomer: Option<&Observation>,
        x: &DVector<f64>,
    ) -> Result<(Structure, LeastSquares, DVector<f64>, f64), FitError> {
        let at_zero = self.whole(past.design_at_zero(newcomer)?, &DVector::zeros(x.len()));
        let structure = Structure::decided(Assembly::Filter, &self.data, Vec::new(), &at_zero);
        let newcomer = newcomer.map(|newcomer| past.linearised(newcomer)).transpose()?;
        let design = self.whole(past.design(newcomer.as_ref(), x), x);
        let (equations, misfit) = structure.equations(&design, x, 1.0 / NULL_HOLD);
        Ok((structure, equations, misfit, design.rest))
    }

    /// The equations of plateaus with those of what is known beforehand, at `x`.
    fn whole(&self, plateaus: Design, x: &DVector<f64>) -> Design {
        let model = self.data.model();
        plateaus.with_priors(model.priors(), model.influences().len(), x.as_slice())
    }
}

/// The equations at `x` and their misfit, with every unknown held about zero.
fn held(design: &Design, x: &DVector<f64>, typical: &DVector<f64>) -> (LeastSquares, DVector<f64>) {
    let (n, p) = design.rows.shape();
    let mut rows = design.rows.clone().resize_vertically(n + p, 0.0);
    rows.column_iter_mut().zip(typical.iter()).for_each(|(mut column, typical)| column *= *typical);
    rows.rows_mut(n, p).fill_diagonal(1.0 / HOLD);
    let mut misfit = design.misfit.clone().resize_vertically(n + p, 0.0);
    misfit.rows_mut(n, p).copy_from(&(x.component_div(typical) / -HOLD));
    (LeastSquares::new(rows, typical.clone()), misfit)
}
