//! Why each plateau is there: what is lost without it.

use nalgebra::Matrix3;

use super::candidates::{Candidates, Schedule};
use super::criterion::{Criterion, Goal};
use super::error::PlanError;
use super::information::{Factor, Scene, sum_of};
use super::search::Problem;

/// What a part of a schedule is there for.
#[derive(Debug, Clone, PartialEq)]
pub struct Reason {
    /// The criterion without it over that with it, less 1 (variance units).
    pub rise: f64,
    /// Time that it takes [s], with the set-up that would fall away.
    pub time: f64,
    /// Parameter of the instrument whose uncertainty suffers most, in the first scenario.
    pub parameter: usize,
    /// Its uncertainty without it over that with it.
    pub factor: f64,
}

/// A schedule accounted for.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// By visit of the schedule.
    pub visits: Vec<Reason>,
    /// By mounting of the candidates: all its visits together; `None` for one that is not used.
    pub mountings: Vec<Option<Reason>>,
}

impl Account {
    /// Accounts for `schedule`, which was planned by `criterion`.
    ///
    /// # Errors
    /// As [`super::best_for_time`].
    pub fn of(candidates: &Candidates, criterion: &Criterion, schedule: &Schedule) -> Result<Self, PlanError> {
        let judges = Judges::new(candidates, criterion, schedule)?;
        let set_points = &candidates.experiment().set_points;
        let of_mounting = |m: usize| {
            let there = |n: usize| set_points[schedule.visits[n].plateau].mounting == m;
            let visits: Vec<usize> = (0..schedule.visits.len()).filter(|&n| there(n)).collect();
            (!visits.is_empty()).then(|| judges.without(&visits))
        };
        Ok(Self {
            visits: (0..schedule.visits.len()).map(|n| judges.without(&[n])).collect(),
            mountings: (0..candidates.experiment().mountings.len()).map(of_mounting).collect(),
        })
    }
}

/// The criterion, and every parameter of the instrument as a goal of its own.
struct Judges<'a> {
    candidates: &'a Candidates,
    schedule: &'a Schedule,
    by_criterion: Problem<'a>,
    by_parameter: Scene,
    parameters: Vec<usize>,
    value: f64,
    goals: Vec<f64>,
}

impl<'a> Judges<'a> {
    fn new(candidates: &'a Candidates, criterion: &Criterion, schedule: &'a Schedule) -> Result<Self, PlanError> {
        // The durations of the schedule, whatever those of the candidates are.
        let by_criterion = Problem::new(candidates, criterion)?;
        let model = &candidates.scenarios[0].model;
        let parameters: Vec<usize> =
            (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
        let goal = |&j: &usize| Goal::Parameter {
            name: model.parameters()[j].name.clone(),
            uncertainty: model.parameters()[j].typical,
        };
        let goals = Criterion::Worst(parameters.iter().map(goal).collect());
        let by_parameter = Scene::new(&candidates.scenarios[0], candidates, &goals, 1.0)?;
        let mut judges =
            Self { candidates, schedule, by_criterion, by_parameter, parameters, value: 0.0, goals: Vec::new() };
        (judges.value, judges.goals) = judges.judged(&[]);
        Ok(judges)
    }

    /// Logarithm of the criterion, and squares of the parameters' uncertainties, with some visits left out.
    fn judged(&self, left_out: &[usize]) -> (f64, Vec<f64>) {
        let factor = |scene: &Scene| scene.factor(&self.information(scene, left_out));
        let factors: Vec<Factor> = self.by_criterion.scenes.all.iter().map(factor).collect();
        (self.by_criterion.scenes.value(&factors), factor(&self.by_parameter).goals)
    }

    fn information(&self, scene: &Scene, left_out: &[usize]) -> Vec<(usize, Matrix3<f64>)> {
        let options = self.candidates.durations.len();
        let atom = |n: usize| {
            let visit = &self.schedule.visits[n];
            let option = self.candidates.durations.iter().position(|d| *d == visit.duration)?;
            Some((visit.plateau, visit.plateau * options + option))
        };
        let mut atoms: Vec<(usize, usize)> =
            (0..self.schedule.visits.len()).filter(|n| !left_out.contains(n)).filter_map(atom).collect();
        atoms.sort_unstable();
        let same = atoms.chunk_by(|a, b| a.0 == b.0);
        same.map(|visits| (visits[0].0, sum_of(visits.iter().map(|(_, x)| *scene.precision(*x))))).collect()
    }

    fn without(&self, visits: &[usize]) -> Reason {
        let (value, goals) = self.judged(visits);
        let factor = |n: usize| (goals[n] / self.goals[n]).sqrt();
        let most = (0..goals.len()).max_by(|&a, &b| factor(a).total_cmp(&factor(b)).then(b.cmp(&a))).unwrap_or(0);
        let kept = (0..self.schedule.visits.len()).filter(|n| !visits.contains(n)).map(|n| self.schedule.visits[n]);
        let kept: Vec<_> = kept.collect();
        Reason {
            rise: (value - self.value).exp() - 1.0,
            time: self.schedule.time - self.candidates.time_of(&kept),
            parameter: self.parameters[most],
            factor: factor(most),
        }
    }
}
