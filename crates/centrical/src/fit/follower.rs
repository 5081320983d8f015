//! Following a session while the centrifuge turns.
//!
//! The linear model is off by some 20 ug, which a test of plateaus known to a few ug would take for a fault. So
//! a follower keeps a point of linearisation, and a new plateau moves it: all plateaus so far and the new one are
//! linearised there, the earlier ones filtered, and the new one tested and taken up. The point is the estimate
//! with every unknown held about zero by [`NULL_HOLD`] typical magnitudes, so that what is not
//! determined yet stays where units are. The hold places the point; no estimate, uncertainty or test knows of it.

use nalgebra::{DVector, Matrix3};

use super::assembly::Assembly;
use super::batch::HALVING_LIMIT;
use super::data::Data;
use super::design::Design;
use super::filter::innovation::{Innovation, Unexplained};
use super::structure::Structure;
use crate::linalg::least_squares::LeastSquares;
use crate::model::{FitError, Linearisation, MeasurementModel, NULL_HOLD, Observation};

/// A point is close enough when the last step was below this many standard uncertainties: what the step after it would
/// change is of the square of it.
const CLOSE: f64 = 1e-3;

/// Steps towards a point, halved until they descend. They converge quadratically from the point before; a plateau that is
/// far off may not let them, and is found out by the test wherever the point is.
const STEP_LIMIT: usize = 10;

/// A session followed plateau by plateau on the exact model, in whatever order they come.
#[derive(Debug, Clone)]
pub struct Follower<'m> {
    data: Data<'m>,
    point: DVector<f64>,
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
        Self { data, point }
    }

    /// Where a follower stood that had taken up some plateaus and reached [`Follower::point`]; it goes on as if it had never
    /// stopped. A point of another length is taken for zeros.
    ///
    /// # Errors
    /// [`FitError`] when an observation cannot be one.
    pub fn resume(model: &'m MeasurementModel, taken: Vec<Observation>, point: &[f64]) -> Result<Self, FitError> {
        let mut follower = Self::new(model);
        taken.into_iter().try_for_each(|observation| follower.data.push(observation))?;
        follower.point.iter_mut().zip(point).for_each(|(to, from)| *to = *from);
        Ok(follower)
    }

    /// Plateaus taken up, in the order in which they came.
    pub fn taken(&self) -> &[Observation] {
        self.data.observations()
    }

    /// Point of linearisation: parameters, SI, then influences in standard uncertainties.
    pub fn point(&self) -> &[f64] {
        self.point.as_slice()
    }

    /// Tests a plateau against those taken up, without taking it up: by how much it raises the least sum of squares
    /// at the point where it would be taken up, and the rank.
    ///
    /// As in a fit, rank is decided on `H`, and what `H` does not see is held by [`NULL_HOLD`] typical magnitudes: the exact
    /// model has second-order traces of it, which would pass for something new in every plateau.
    ///
    /// # Errors
    /// [`FitError`] when the observation cannot be one.
    pub fn test(&self, observation: &Observation) -> Result<Innovation, FitError> {
        let mut with = self.clone();
        with.take(observation.clone())?;
        let after = with.unexplained()?;
        with.data.pop();
        let before = with.unexplained()?;
        Ok(before.innovation(&after))
    }

    /// Takes a plateau up and moves the point.
    ///
    /// # Errors
    /// [`FitError`] when the observation cannot be one.
    pub fn take(&mut self, observation: Observation) -> Result<(), FitError> {
        self.data.push(observation)?;
        let typical = self.data.typical();
        for _ in 0..STEP_LIMIT {
            let linearisations = self.linearised();
            let design = self.design_of(&linearisations)?;
            let (equations, misfit) = self.held(&design, &typical);
            let step = equations.solve(misfit);
            if step.whitened_length < CLOSE {
                self.point += &step.x;
                break;
            }
            let Some(point) = self.descend(&step.x, &linearisations, &typical)? else { break };
            self.point = point;
        }
        Ok(())
    }

    /// The point one step on, halved until the sum of squares falls; none if it does not: the point stays where it is.
    fn descend(
        &self,
        dx: &DVector<f64>,
        linearisations: &[Linearisation],
        typical: &DVector<f64>,
    ) -> Result<Option<DVector<f64>>, FitError> {
        let objective = |x: &DVector<f64>| -> Result<f64, FitError> {
            let residuals = self.data.residuals(x.as_slice());
            let data = self.data.chi_squared(linearisations, &residuals, x)?;
            Ok(data + (x.component_div(typical) / NULL_HOLD).norm_squared())
        };
        let here = objective(&self.point)?;
        for halvings in 0..HALVING_LIMIT {
            let x = &self.point + dx * 0.5_f64.powi(halvings.cast_signed());
            if objective(&x)? <= here {
                return Ok(Some(x));
            }
        }
        Ok(None)
    }

    /// What the plateaus taken up say.
    ///
    /// # Errors
    /// [`FitError::Empty`] before the first.
    pub fn progress(&self) -> Result<Progress, FitError> {
        if self.taken().is_empty() {
            return Err(FitError::Empty);
        }
        let (structure, _) = Structure::by(Assembly::Filter, &self.data)?;
        let (equations, misfit) = structure.equations(&self.design()?, &self.point, 1.0 / NULL_HOLD);
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
        with.data.push(Observation { set_point, mean, covariance })?;
        with.progress()
    }

    /// Least sum of squares of the plateaus taken up, linearised at the point, and their rank.
    fn unexplained(&self) -> Result<Unexplained, FitError> {
        if self.taken().is_empty() {
            return Ok(Unexplained { squared: 0.0, rank: self.data.model().priors().len() });
        }
        let (structure, _) = Structure::by(Assembly::Filter, &self.data)?;
        let design = self.design()?;
        let (equations, misfit) = structure.equations(&design, &self.point, 1.0 / NULL_HOLD);
        let left = equations.redundant(&misfit).norm_squared();
        Ok(Unexplained { squared: left + design.rest.powi(2), rank: structure.observability.rank() })
    }

    fn linearised(&self) -> Vec<Linearisation> {
        self.data.linearised(self.point())
    }

    fn design(&self) -> Result<Design, FitError> {
        self.design_of(&self.linearised())
    }

    fn design_of(&self, linearisations: &[Linearisation]) -> Result<Design, FitError> {
        Assembly::Filter.design(&self.data, self.point(), linearisations)
    }

    /// The equations and their misfit, with every unknown held about zero.
    fn held(&self, design: &Design, typical: &DVector<f64>) -> (LeastSquares, DVector<f64>) {
        let (n, p) = design.rows.shape();
        let mut rows = design.rows.clone().resize_vertically(n + p, 0.0);
        rows.column_iter_mut().zip(typical.iter()).for_each(|(mut column, typical)| column *= *typical);
        rows.rows_mut(n, p).fill_diagonal(1.0 / NULL_HOLD);
        let mut misfit = design.misfit.clone().resize_vertically(n + p, 0.0);
        misfit.rows_mut(n, p).copy_from(&(self.point.component_div(typical) / -NULL_HOLD));
        (LeastSquares::new(rows, typical.clone()), misfit)
    }
}
