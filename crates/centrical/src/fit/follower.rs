//! Following a session while the centrifuge turns.
//!
//! The linear model is off by some 20 ug, which a test of plateaus known to a few ug would take for a fault. So
//! a follower keeps a point of linearisation, and a new plateau moves it: the new one is linearised there, the earlier
//! ones so close to it that nothing is lost ([`Past`]), and the new one is tested and taken up. The point is the estimate
//! with every unknown held about zero by its typical magnitude, so that what is not
//! determined yet stays where units are. The hold places the point; no estimate, uncertainty or test knows of it.

use nalgebra::{DVector, Matrix3};

use super::assembly::Assembly;
use super::batch::HALVING_LIMIT;
use super::data::Data;
use super::design::Design;
use super::filter::Readings;
use super::filter::innovation::{Innovation, Unexplained};
use super::past::{Linearised, Past, REMAINDER, readings_at_zero, with_readings};
use super::structure::Structure;
use crate::linalg::least_squares::LeastSquares;
use crate::model::{FitError, MeasurementModel, NULL_HOLD, Observation};

/// A point is close enough when the last step was below this many standard uncertainties: what the step after it would
/// change is of the square of it.
const CLOSE: f64 = 1e-3;

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
    /// All plateaus but the last.
    past: Past<'m>,
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
        for (behind, observation) in taken.into_iter().enumerate() {
            follower.append(observation)?;
            if behind > 0 && behind == referenced {
                follower.past.linearise_at(&reference)?;
            }
        }
        Ok(follower)
    }

    /// Plateaus taken up, in the order in which they came.
    pub fn taken(&self) -> &[Observation] {
        self.data.observations()
    }

    /// Point of linearisation of the last plateau: parameters, SI, then influences in standard uncertainties.
    pub fn point(&self) -> &[f64] {
        self.point.as_slice()
    }

    /// Point of linearisation of the plateaus before the last.
    pub fn reference(&self) -> &[f64] {
        self.past.reference().as_slice()
    }

    /// Plateaus that were behind when they were linearised there.
    pub fn referenced(&self) -> usize {
        self.past.referenced()
    }

    /// The follower with one plateau more, its point moved.
    ///
    /// # Errors
    /// [`FitError`] when the observation is invalid.
    pub fn with(&self, observation: &Observation) -> Result<Self, FitError> {
        let mut with = self.clone();
        with.append(observation.clone())?;
        with.move_point()?;
        Ok(with)
    }

    /// Tests the last plateau against those before: by how much it raises the least sum of squares, at the point with it, and
    /// the rank.
    ///
    /// As in a fit, rank is decided on `H`, and what `H` does not see is held by [`NULL_HOLD`] typical magnitudes: the exact
    /// model has second-order traces of it, which would pass for something new in every plateau.
    ///
    /// # Errors
    /// [`FitError::Empty`] before the first plateau.
    pub fn innovation(&self) -> Result<Innovation, FitError> {
        let after = self.unexplained(Some(self.last()?))?;
        Ok(self.unexplained(None)?.innovation(&after))
    }

    /// What the plateaus taken up say.
    ///
    /// # Errors
    /// [`FitError::Empty`] before the first.
    pub fn progress(&self) -> Result<Progress, FitError> {
        let last = self.last()?;
        let (structure, design) = (self.structure(Some(last))?, self.design(Some(&self.linearised(last)?)));
        let (equations, misfit) = structure.equations(&design, &self.point, 1.0 / NULL_HOLD);
        let (step, covariance) = (equations.solve(misfit), equations.covariance());
        let known = |j: usize| (self.point[j] + step.x[j], covariance[(j, j)].sqrt());
        let estimates = (0..structure.observability.columns())
            .map(|j| structure.observability.is_estimable(j).then(|| known(j)))
            .collect();
        Ok(Progress { rank: structure.observability.rank(), estimates })
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
        let mut with = self.clone();
        with.append(Observation { set_point, mean, covariance })?;
        with.progress()
    }

    /// Adds a plateau where the point is.
    fn append(&mut self, observation: Observation) -> Result<(), FitError> {
        if let Some(last) = self.data.observations().last() {
            self.past.push(last)?;
        }
        self.data.push(observation)
    }

    /// Moves the point to the estimate.
    fn move_point(&mut self) -> Result<(), FitError> {
        let typical = self.data.typical();
        for _ in 0..STEP_LIMIT {
            let last = self.linearised(self.last()?)?;
            let (equations, misfit) = self.held(&self.design(Some(&last)), &typical);
            let step = equations.solve(misfit);
            let x = &self.point + &step.x;
            let remainder = last.remainder(self.data.model(), &step.x, &x).hypot(self.past.remainder(&x));
            if step.whitened_length < CLOSE || remainder < REMAINDER {
                self.point = x;
                return Ok(());
            }
            let Some(point) = self.descend(&last, &step.x, &typical) else { break };
            self.point = point;
            self.past.linearise_at(&self.point)?;
        }
        Ok(())
    }

    /// The point one step on, halved until the sum of squares falls; none if it does not: the point stays where it is.
    fn descend(&self, last: &Linearised, dx: &DVector<f64>, typical: &DVector<f64>) -> Option<DVector<f64>> {
        let objective = |x: &DVector<f64>| {
            let plateaus = self.past.squared(x) + last.squared(self.data.model(), x);
            plateaus + self.data.squared_beforehand(x) + (x.component_div(typical) / HOLD).norm_squared()
        };
        let here = objective(&self.point);
        let mut halved = (0..HALVING_LIMIT).map(|halvings| &self.point + dx * 0.5_f64.powi(halvings.cast_signed()));
        halved.find(|x| objective(x) <= here)
    }

    /// Least sum of squares of the plateaus behind and perhaps the last, linearised at the point, and their rank.
    fn unexplained(&self, last: Option<&Observation>) -> Result<Unexplained, FitError> {
        let at_point = last.map(|last| self.linearised(last)).transpose()?;
        let (structure, design) = (self.structure(last)?, self.design(at_point.as_ref()));
        let (equations, misfit) = structure.equations(&design, &self.point, 1.0 / NULL_HOLD);
        let left = equations.redundant(&misfit).norm_squared();
        Ok(Unexplained { squared: left + design.rest.powi(2), rank: structure.observability.rank() })
    }

    /// What the plateaus behind and perhaps the last determine.
    fn structure(&self, last: Option<&Observation>) -> Result<Structure, FitError> {
        let at_zero = last.map(|last| readings_at_zero(self.data.model(), last)).transpose()?;
        let design = self.whole(self.past.design_at_zero(), at_zero.as_ref(), &DVector::zeros(self.point.len()));
        Ok(Structure::decided(Assembly::Filter, &self.data, Vec::new(), &design))
    }

    /// The equations of the plateaus behind and perhaps the last, at the point.
    fn design(&self, last: Option<&Linearised>) -> Design {
        self.whole(self.past.design(&self.point), last.map(Linearised::readings).as_ref(), &self.point)
    }

    /// A plateau at the point.
    fn linearised(&self, observation: &Observation) -> Result<Linearised, FitError> {
        Linearised::new(self.data.model(), observation, &self.point)
    }

    /// The equations of `past`, of some `readings` more, and of what is known beforehand, at `x`.
    fn whole(&self, past: Design, readings: Option<&Readings>, x: &DVector<f64>) -> Design {
        let model = self.data.model();
        let plateaus = match readings {
            Some(readings) => with_readings(past, readings),
            None => past,
        };
        plateaus.with_priors(model.priors(), model.influences().len(), x.as_slice())
    }

    fn last(&self) -> Result<&Observation, FitError> {
        self.taken().last().ok_or(FitError::Empty)
    }

    /// The equations and their misfit, with every unknown held about zero.
    fn held(&self, design: &Design, typical: &DVector<f64>) -> (LeastSquares, DVector<f64>) {
        let (n, p) = design.rows.shape();
        let mut rows = design.rows.clone().resize_vertically(n + p, 0.0);
        rows.column_iter_mut().zip(typical.iter()).for_each(|(mut column, typical)| column *= *typical);
        rows.rows_mut(n, p).fill_diagonal(1.0 / HOLD);
        let mut misfit = design.misfit.clone().resize_vertically(n + p, 0.0);
        misfit.rows_mut(n, p).copy_from(&(self.point.component_div(typical) / -HOLD));
        (LeastSquares::new(rows, typical.clone()), misfit)
    }
}
