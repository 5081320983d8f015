//! Candidates and criterion prepared for the search, and how much of a search there is.

use crate::plan::candidates::Candidates;
use crate::plan::criterion::Criterion;
use crate::plan::error::PlanError;
use crate::plan::exchange::{Exchange, IntegerSchedule};
use crate::plan::information::LinearisedScenario;
use crate::plan::relaxation::FEW;
use crate::plan::scenarios::LinearisedScenarios;
use crate::progress::{OnProgress, Watch};

/// Limits of a search. The outcome depends on them, never on the clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Nodes of the branch and bound over mountings.
    pub nodes: usize,
    /// Exchanges tried in each schedule.
    pub trials: usize,
}

impl Effort {
    /// Some seconds' worth: fewer nodes where there are more candidates in more set-ups.
    pub fn usual(candidates: &Candidates) -> Self {
        let size = candidates.len().min(FEW) * candidates.set_ups();
        Self { nodes: (3_600_000 / size.max(1)).clamp(20, 1000), ..Self::CERTIFIED }
    }

    /// Until every set of mountings is decided on. The gap that remains is a matter of whole visits.
    pub const CERTIFIED: Self = Self { nodes: 1 << 20, trials: 120 };

    /// One schedule, with no exchange of mountings and no bound over sets of them.
    pub const QUICK: Self = Self { nodes: 1, trials: 60 };

    /// Mountings exchanged, and the bound of the first continuous design.
    pub const FAIR: Self = Self { nodes: 2, ..Self::QUICK };
}

/// Candidates and criterion prepared for the search.
pub(in crate::plan) struct Problem<'a> {
    pub candidates: &'a Candidates,
    pub scenarios: LinearisedScenarios,
    pub watch: Watch<'a>,
}

impl<'a> Problem<'a> {
    pub fn new(
        candidates: &'a Candidates,
        criterion: &Criterion,
        progress: OnProgress<'a, ()>,
    ) -> Result<Self, PlanError> {
        candidates.check()?;
        let total: f64 = candidates.scenarios.iter().map(|s| s.weight).sum();
        let linearised = |scenario| LinearisedScenario::new(scenario, candidates, criterion, total);
        let all = candidates.scenarios.iter().map(linearised).collect::<Result<_, _>>()?;
        let scenarios = LinearisedScenarios { all, robustness: candidates.robustness };
        Ok(Self { candidates, scenarios, watch: Watch::new(progress) })
    }

    /// Number of set-ups.
    pub fn set_ups(&self) -> usize {
        self.candidates.set_ups()
    }

    /// Time of the cheapest set-up with its shortest visit [s].
    pub fn least_time(&self) -> f64 {
        let of_atom = |x: usize| {
            let mut used = vec![false; self.set_ups()];
            used[self.candidates.set_up_of_atom(x)] = true;
            self.candidates.set_up_time(&used) + self.candidates.price(x)
        };
        (0..self.candidates.atoms().count()).map(of_atom).fold(f64::INFINITY, f64::min)
    }

    pub fn check_time(&self, time: f64) -> Result<(), PlanError> {
        let least = self.least_time();
        if time.is_finite() && time >= least { Ok(()) } else { Err(PlanError::TooShort { found: time, least }) }
    }

    /// The exchange of visits within a time, on the set-ups that are `open`.
    pub fn exchange<'b>(&'b self, time: f64, open: &'b [bool], trials: usize) -> Exchange<'b> {
        Exchange { candidates: self.candidates, scenarios: &self.scenarios, time, open, trials, watch: &self.watch }
    }

    /// The schedule of these visits, whatever time it takes.
    pub fn schedule(&self, visits: Vec<u32>) -> IntegerSchedule {
        self.exchange(f64::INFINITY, &[], 0).schedule(visits)
    }

    /// Every candidate as often and as long as possible.
    pub fn everything(&self) -> IntegerSchedule {
        self.everything_on(&vec![true; self.set_ups()])
    }

    /// Every candidate of some set-ups as often and as long as possible.
    pub fn everything_on(&self, set: &[bool]) -> IntegerSchedule {
        self.exchange(f64::INFINITY, &[], 0).parted(self.most_visits(set))
    }

    /// A schedule with everything on one set-up more.
    pub fn with_everything_on(&self, schedule: &IntegerSchedule, set_up: usize) -> IntegerSchedule {
        let mut set = vec![false; self.set_ups()];
        set[set_up] = true;
        self.exchange(f64::INFINITY, &set, 0).with(schedule, &self.most_visits(&set))
    }

    fn most_visits(&self, set: &[bool]) -> Vec<u32> {
        let atoms = self.candidates.atoms();
        let most = |c: usize| u32::try_from(self.candidates.most_visits(c)).unwrap_or(u32::MAX);
        let is_meant = |x: usize| atoms.at(x).duration + 1 == atoms.durations && set[self.candidates.set_up_of_atom(x)];
        let visits = |x: usize| if is_meant(x) { most(atoms.at(x).candidate) } else { 0 };
        (0..atoms.count()).map(visits).collect()
    }
}
