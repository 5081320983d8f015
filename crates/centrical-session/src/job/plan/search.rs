//! The search for a plan: goals are sought by what the stated type B leaves of them.

use centrical::plan::{Criterion, Effort, Goal, Plan, PlanError, Schedule, Visit, best_for_time, shortest_for_goals};
use centrical::uncertainty::TypeB;

use crate::document::GoalReport;
use crate::error::Error;
use crate::experiment::Planning;

/// Type B is reckoned with this much above that of the plan before, so that the next one keeps within it.
const MARGIN: f64 = 1.01;

impl Planning {
    /// The best plan for the time, or the shortest for the goals; `certify`: searched until its bound is within 0.25 % or all
    /// sets of mountings are done with.
    ///
    /// A plan that leaves combinations of unknowns open may keep its goals for a unit without errors and miss them for any other
    /// (see [`predict`]). One that does is planned again for a unit of typical errors, which `self` expects from then on.
    ///
    /// # Errors
    /// [`Error::Planning`] when there is none.
    pub fn plan(&mut self, certify: bool) -> Result<Plan, Error> {
        let effort = self.effort(certify);
        let expects_none = self.candidates.scenarios.iter().all(|s| s.nominal.iter().all(|value| *value == 0.0));
        if self.time.is_some() || !expects_none {
            return self.search(effort);
        }
        // A hasty plan shows mostly what a good one would.
        let hasty = self.search(Effort::QUICK)?;
        if self.keeps_goals(&hasty)? {
            let plan = self.search(effort)?;
            if self.keeps_goals(&plan)? {
                return Ok(plan);
            }
        }
        for scenario in &mut self.candidates.scenarios {
            scenario.nominal = scenario.model.parameters().typical_alternating();
        }
        self.search(effort)
    }

    fn effort(&self, certify: bool) -> Effort {
        let usual = Effort::usual(self.candidates.len());
        match (certify, self.time) {
            (true, _) => Effort::CERTIFIED,
            (false, Some(_)) => usual,
            // The shortest plan is sought by a search for each of some times.
            (false, None) => Effort { mounting_nodes: 2 + usual.mounting_nodes / 6, ..usual },
        }
    }

    /// Whether every goal is kept as predicted, type B included.
    fn keeps_goals(&self, plan: &Plan) -> Result<bool, Error> {
        let goals = self.goals_of(&self.predict(&plan.schedule)?);
        Ok(goals.iter().all(|goal| goal.combined.is_some_and(|u| u <= goal.wanted)))
    }

    fn search(&self, effort: Effort) -> Result<Plan, Error> {
        let Criterion::Worst(goals) = &self.criterion else { return self.best(&self.criterion, effort) };
        if self.type_b == TypeB::default() {
            return self.best(&self.criterion, effort);
        }
        // Type B hardly depends on the plan: what it leaves of the goals for type A settles in a few plans.
        let mut floors = self.floors(&self.everything())?;
        for (goal, floor) in goals.iter().zip(&floors).filter(|_| self.time.is_none()) {
            let (name, wanted) = named(goal);
            if *floor >= wanted {
                return Err(self.failed(PlanError::BelowTypeB { name: name.to_owned(), factor: floor / wanted }));
            }
        }
        for now in [Effort::QUICK, Effort::QUICK, Effort::QUICK, effort, effort] {
            let plan = self.best(&Criterion::Worst(for_type_a(goals, &floors)), now)?;
            let there = self.floors(&plan.schedule)?;
            let is_settled = there.iter().zip(&floors).all(|(there, floor)| there <= floor);
            floors.iter_mut().zip(there).for_each(|(floor, there)| *floor = floor.max(MARGIN * there));
            // A shortest plan that keeps the goals is one, whatever it was reckoned with.
            let is_kept = self.time.is_none() && self.keeps_goals(&plan)?;
            if (is_settled || is_kept) && now == effort {
                return Ok(plan);
            }
        }
        self.best(&Criterion::Worst(for_type_a(goals, &floors)), effort)
    }

    fn best(&self, criterion: &Criterion, effort: Effort) -> Result<Plan, Error> {
        let plan = match self.time {
            Some(time) => best_for_time(&self.candidates, criterion, time, effort),
            None => shortest_for_goals(&self.candidates, criterion, 0.01, effort),
        };
        plan.map_err(|source| self.failed(source))
    }

    /// Every plateau as often and as long as may be.
    fn everything(&self) -> Schedule {
        let candidates = &self.candidates;
        let longest = candidates.durations.last().copied().unwrap_or(0.0);
        let visit = |n: usize| Visit { plateau: n % candidates.len(), duration: longest };
        candidates.schedule((0..candidates.len() * candidates.repeats).map(visit).collect())
    }

    /// What the stated type B leaves of each goal with a schedule, none where it is lost altogether.
    fn floors(&self, schedule: &Schedule) -> Result<Vec<f64>, Error> {
        let floor = |goal: &GoalReport| goal.type_b.unwrap_or(0.0);
        Ok(self.goals_of(&self.predict(schedule)?).iter().map(floor).collect())
    }
}

/// Name and wanted standard uncertainty of a goal.
fn named(goal: &Goal) -> (&str, f64) {
    match goal {
        Goal::Parameter { name, uncertainty } => (name, *uncertainty),
        Goal::Reading { uncertainty, .. } => ("reading", *uncertainty),
    }
}

/// What is left of goals for type A, `sqrt(wanted^2 - floor^2)`; a goal that type B alone misses is sought as it stands.
fn for_type_a(goals: &[Goal], floors: &[f64]) -> Vec<Goal> {
    let left = |(goal, floor): (&Goal, &f64)| {
        let (_, wanted) = named(goal);
        let rest = (wanted - floor) * (wanted + floor);
        let uncertainty = if rest > 0.0 { rest.sqrt() } else { wanted };
        match goal {
            Goal::Parameter { name, .. } => Goal::Parameter { name: name.clone(), uncertainty },
            Goal::Reading { range, .. } => Goal::Reading { range: *range, uncertainty },
        }
    };
    goals.iter().zip(floors).map(left).collect()
}
