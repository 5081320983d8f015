//! The best schedule so far, and the plan that it becomes.

use super::problem::Problem;
use crate::plan::candidates::Schedule;
use crate::plan::exchange::IntegerSchedule;
use crate::plan::relaxation::{Precision, Relaxed};

/// Known to this part of the criterion, nodes are not divided: where a plan that is nearly as good will do (0.25 % of an
/// uncertainty); and where goals are to be met, which a plan of less time may just miss.
const NEARLY: f64 = 5e-3;
const NEARLY_MET: f64 = 2e-3;

/// A plan, and how far it can be from the best one.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The schedule.
    pub schedule: Schedule,
    /// The criterion, in variance units: see [`crate::plan::Criterion`]; of several scenarios their mean or worst, as asked.
    pub criterion: f64,
    /// The criterion in each scenario.
    pub by_scenario: Vec<f64>,
    /// No schedule of these candidates in this time has a lower criterion.
    pub bound: f64,
    /// The continuous design on the plan's mountings, with the bound of the equivalence theorem.
    pub continuous: Relaxed,
    /// Nodes of the branch and bound.
    pub nodes: usize,
    /// Of a plan for goals: no schedule of these candidates that is shorter than this meets them [s].
    pub least_time: Option<f64>,
}

impl Plan {
    /// The optimality gap: part of the criterion by which the schedule may be above the best one.
    pub fn gap(&self) -> f64 {
        self.criterion / self.bound - 1.0
    }

    /// Part of the criterion that whole visits cost against the continuous design on the same mountings.
    pub fn rounding(&self) -> f64 {
        self.criterion / self.continuous.value.exp() - 1.0
    }

    /// The plan of a schedule; `bound` is a bound of all others (logarithms).
    pub(super) fn new(
        problem: &Problem,
        best: &IntegerSchedule,
        continuous: Relaxed,
        bound: f64,
        nodes: usize,
    ) -> Self {
        Self {
            schedule: problem.candidates.schedule(best.list(problem.candidates)),
            criterion: best.value.exp(),
            by_scenario: best.by_scenario().into_iter().map(f64::exp).collect(),
            bound: bound.min(best.value).exp(),
            continuous,
            nodes,
            least_time: None,
        }
    }
}

/// The best schedule so far, and what would be better.
pub(super) struct Incumbent {
    pub best: Option<IntegerSchedule>,
    /// Value that is to be reached and no more, if any.
    wanted: Option<f64>,
}

impl Incumbent {
    pub fn new(wanted: Option<f64>) -> Self {
        Self { best: None, wanted }
    }

    /// Logarithm of its criterion.
    pub fn value(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.value)
    }

    /// A schedule is of use if its value is below this.
    pub fn target(&self) -> f64 {
        self.value().min(self.wanted.unwrap_or(f64::INFINITY))
    }

    /// No branch is followed whose bound is not below this.
    pub fn threshold(&self) -> f64 {
        (self.value() - self.same()).min(self.wanted.unwrap_or(f64::INFINITY))
    }

    pub fn is_reached(&self) -> bool {
        self.wanted.is_some_and(|wanted| self.value() <= wanted)
    }

    /// The precision of a continuous design at the end of a branch, or `loose` where that will do.
    pub fn precision(&self, loose: Option<f64>) -> Precision {
        let tolerance = 0.5 * self.same();
        Precision { tolerance, loose: loose.unwrap_or(tolerance), enough: self.threshold() }
    }

    /// A bound as near to the best schedule as this is as good as the same.
    fn same(&self) -> f64 {
        if self.wanted.is_some() { NEARLY_MET } else { NEARLY }
    }
}
