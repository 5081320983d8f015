//! The shortest schedule that meets every goal, from both sides: a schedule that meets them and is made shorter, and a time in
//! which no schedule does. A search for a time that ends without a schedule that meets the goals proves that none exists for
//! that time, nor for less: every branch of it has a bound above them.

use super::incumbent::Plan;
use super::problem::{Effort, Problem};
use super::set_up_bound::SetUpBound;
use super::tree::Tree;
use crate::plan::error::PlanError;

/// Limit of searches after the first schedule.
const SEARCHES: usize = 3;

/// The search for the shortest schedule.
pub(super) struct Shortest<'a> {
    problem: &'a Problem<'a>,
    resolution: f64,
    effort: Effort,
    /// Which sets of set-ups can meet the goals: the same in any time.
    set_up_bound: SetUpBound,
    /// No schedule is shorter than this [s].
    below: f64,
    /// Time of all candidates as often and as long as possible [s].
    everything: f64,
}

/// The answer of a search for a time.
enum Answer {
    /// A plan that meets the goals.
    Reached(Box<Plan>),
    /// There is no such plan.
    None,
    /// Neither is proved.
    Open,
}

impl<'a> Shortest<'a> {
    pub fn new(problem: &'a Problem<'a>, resolution: f64, effort: Effort) -> Result<Self, PlanError> {
        let everything = problem.everything();
        let out_of_reach = PlanError::OutOfReach { factor: (0.5 * everything.value).exp() };
        if everything.value > 0.0 {
            return Err(out_of_reach);
        }
        let mut set_up_bound = SetUpBound::default();
        let all = vec![true; problem.set_ups()];
        let none = vec![false; problem.set_ups()];
        // Everything meets the goals, so some set does; one that only just does so is left to `everything`.
        let set_up = set_up_bound.least(problem, &none, &all, f64::MIN_POSITIVE).unwrap_or(0.0);
        let below = problem.least_time().max(set_up);
        Ok(Self { problem, resolution, effort, set_up_bound, below, everything: everything.time })
    }

    pub fn run(mut self) -> Plan {
        let mut plan = self.first();
        let mut open = f64::INFINITY;
        let searches = if self.effort.nodes > Effort::FAIR.nodes { SEARCHES } else { 0 };
        for _ in 0..searches {
            let above = plan.schedule.time.min(open);
            // Near the least time just below the plan, which is to be proved the shortest; else half way.
            let is_near = above / self.below < 1.0 + 4.0 * self.resolution;
            let time = if is_near { above / (1.0 + self.resolution) } else { (self.below * above).sqrt() };
            if time <= self.below * (1.0 + 0.1 * self.resolution) {
                break;
            }
            match self.search(time, self.effort) {
                Answer::Reached(shorter) => (plan, open) = (self.shortened(*shorter), f64::INFINITY),
                Answer::None => self.below = time,
                Answer::Open => open = time,
            }
        }
        self.thorough(plan)
    }

    /// A first schedule, made short, in times that rise from the least there can be.
    fn first(&mut self) -> Plan {
        let (start, mut step) = (self.below, 2.0 * self.resolution);
        loop {
            let time = (start * (1.0 + step)).min(self.everything);
            match self.search(time, self.quick()) {
                Answer::Reached(plan) => return self.shortened(*plan),
                Answer::None => self.below = time,
                Answer::Open => {}
            }
            if time >= self.everything || self.problem.watch.is_stopped() {
                let visits = self.problem.everything().list(self.problem.candidates);
                let plan = self.tree(time, self.quick()).run();
                return Plan { schedule: self.problem.candidates.schedule(visits), ..plan };
            }
            step *= 2.0;
        }
    }

    /// Effort of the many searches on the way: set-ups exchanged, no branches.
    fn quick(&self) -> Effort {
        Effort { nodes: self.effort.nodes.min(Effort::FAIR.nodes), ..Effort::FAIR }
    }

    fn search(&self, time: f64, effort: Effort) -> Answer {
        match self.wanted(time, effort).run() {
            plan if plan.criterion <= 1.0 => Answer::Reached(Box::new(plan)),
            plan if plan.bound >= 1.0 => Answer::None,
            _ => Answer::Open,
        }
    }

    fn wanted(&self, time: f64, effort: Effort) -> Tree<'a> {
        Tree::for_goals(self.problem, time, effort, self.set_up_bound.clone())
    }

    fn tree(&self, time: f64, effort: Effort) -> Tree<'a> {
        Tree::new(self.problem, time, effort)
    }

    /// The shortest plan on the set-ups of one that meets the goals.
    fn shortened(&self, mut plan: Plan) -> Plan {
        let used = self.problem.candidates.set_ups_used(plan.schedule.visits.iter().map(|visit| visit.candidate));
        let mut low = self.below.max(self.problem.candidates.set_up_time(&used));
        while plan.schedule.time / low > 1.0 + 0.5 * self.resolution && !self.problem.watch.is_stopped() {
            let middle = (low * plan.schedule.time).sqrt();
            let shorter = self.wanted(middle, self.effort).run_on(used.clone(), &plan.continuous.visits);
            if shorter.criterion <= 1.0 { plan = shorter } else { low = middle }
        }
        plan
    }

    /// The best plan for the time of the shortest one, and its bound.
    fn thorough(&self, plan: Plan) -> Plan {
        let other = self.tree(plan.schedule.time, self.quick()).run();
        let bound = other.bound.min(plan.criterion);
        let better = if other.criterion < plan.criterion { other } else { plan };
        Plan { bound, least_time: Some(self.below.min(better.schedule.time)), ..better }
    }
}
