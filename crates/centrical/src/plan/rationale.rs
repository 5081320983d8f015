//! The rationale of a schedule: what is lost without each of its visits and set-ups.

use super::atom::Atom;
use super::candidates::{Candidates, Schedule};
use super::criterion::{Criterion, Goal};
use super::error::PlanError;
use super::information::LinearisedScenario;
use super::search::Problem;
use crate::progress::{OnProgress, advance};

/// Why a schedule has a visit or a set-up.
#[derive(Debug, Clone, PartialEq)]
pub struct Rationale {
    /// The criterion without it over that with it, less 1 (variance units).
    pub rise: f64,
    /// Time that it takes [s], with the set-up that would fall away.
    pub time: f64,
    /// Parameter of the instrument whose uncertainty suffers most, in the first scenario.
    pub parameter: usize,
    /// Its uncertainty without it over that with it.
    pub factor: f64,
}

impl Rationale {
    /// The rationale of each visit of a `schedule` that was planned by `criterion`; then of each set-up, all its visits together: the mountings
    /// of the candidates on the arm, then all rests beside it; `None` for one that is not used. `progress` is asked at each part.
    ///
    /// # Errors
    /// As [`super::best_for_time`].
    pub fn of(
        candidates: &Candidates,
        criterion: &Criterion,
        schedule: &Schedule,
        progress: OnProgress<()>,
    ) -> Result<(Vec<Rationale>, Vec<Option<Rationale>>), PlanError> {
        let reference = Reference::new(candidates, criterion, schedule, progress)?;
        let without = |visits: &[usize]| {
            advance(progress, ())?;
            Ok(reference.without(visits))
        };
        let of_set_up = |set_up: usize| {
            let there = |n: usize| candidates.set_up_of(schedule.visits[n].candidate) == set_up;
            let visits: Vec<usize> = (0..schedule.visits.len()).filter(|&n| there(n)).collect();
            (!visits.is_empty()).then(|| without(&visits)).transpose()
        };
        let visits = (0..schedule.visits.len()).map(|n| without(&[n])).collect::<Result<_, PlanError>>()?;
        Ok((visits, (0..candidates.set_ups()).map(of_set_up).collect::<Result<_, PlanError>>()?))
    }
}

/// The whole schedule, with which its parts are compared: its criterion, and the uncertainty of every parameter of the
/// instrument.
struct Reference<'a> {
    schedule: &'a Schedule,
    problem: Problem<'a>,
    /// Every parameter of the instrument as a goal of its own.
    by_parameter: LinearisedScenario,
    parameters: Vec<usize>,
    value: f64,
    goals: Vec<f64>,
}

impl<'a> Reference<'a> {
    fn new(
        candidates: &'a Candidates,
        criterion: &Criterion,
        schedule: &'a Schedule,
        progress: OnProgress<'a, ()>,
    ) -> Result<Self, PlanError> {
        let problem = Problem::new(candidates, criterion, progress)?;
        let model = &candidates.scenarios[0].model;
        let parameters: Vec<usize> =
            (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
        let goal = |&j: &usize| Goal::Parameter {
            name: model.parameters()[j].name.clone(),
            uncertainty: model.parameters()[j].typical,
        };
        let goals = Criterion::Worst(parameters.iter().map(goal).collect());
        let by_parameter = LinearisedScenario::new(&candidates.scenarios[0], candidates, &goals, 1.0)?;
        let mut reference = Self { schedule, problem, by_parameter, parameters, value: 0.0, goals: Vec::new() };
        (reference.value, reference.goals) = reference.judged(&[]);
        Ok(reference)
    }

    /// Logarithm of the criterion, and squares of the parameters' uncertainties, with some visits left out.
    fn judged(&self, left_out: &[usize]) -> (f64, Vec<f64>) {
        let visits = self.visits(left_out);
        let information = self.by_parameter.information(self.problem.candidates.atoms(), |x| f64::from(visits[x]));
        let goals = self.by_parameter.factor(&information).goals;
        (self.problem.schedule(visits).value, goals)
    }

    /// Visits by atom, some left out.
    fn visits(&self, left_out: &[usize]) -> Vec<u32> {
        let candidates = self.problem.candidates;
        let atoms = candidates.atoms();
        let mut visits = vec![0; atoms.count()];
        for (_, visit) in self.schedule.visits.iter().enumerate().filter(|(n, _)| !left_out.contains(n)) {
            if let Some(duration) = candidates.durations.iter().position(|d| *d == visit.duration) {
                visits[atoms.number(Atom { candidate: visit.candidate, duration })] += 1;
            }
        }
        visits
    }

    fn without(&self, visits: &[usize]) -> Rationale {
        let (value, goals) = self.judged(visits);
        let factor = |n: usize| (goals[n] / self.goals[n]).sqrt();
        let most = (0..goals.len()).max_by(|&a, &b| factor(a).total_cmp(&factor(b)).then(b.cmp(&a))).unwrap_or(0);
        let kept = (0..self.schedule.visits.len()).filter(|n| !visits.contains(n)).map(|n| self.schedule.visits[n]);
        let kept: Vec<_> = kept.collect();
        Rationale {
            rise: (value - self.value).exp() - 1.0,
            time: self.schedule.time - self.problem.candidates.time_of(&kept),
            parameter: self.parameters[most],
            factor: factor(most),
        }
    }
}
