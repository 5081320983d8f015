//! Candidates and criterion made ready for the search.

use crate::plan::candidates::{Candidates, Schedule};
use crate::plan::criterion::Criterion;
use crate::plan::error::PlanError;
use crate::plan::exchange::{Exchange, Whole};
use crate::plan::information::Scene;
use crate::plan::robustness::Scenes;

/// Candidates and criterion made ready.
pub(in crate::plan) struct Problem<'a> {
    pub candidates: &'a Candidates,
    pub scenes: Scenes,
}

impl<'a> Problem<'a> {
    pub fn new(candidates: &'a Candidates, criterion: &Criterion) -> Result<Self, PlanError> {
        candidates.check()?;
        let total: f64 = candidates.scenarios.iter().map(|s| s.weight).sum();
        let scene = |scenario| Scene::new(scenario, candidates, criterion, total);
        let all = candidates.scenarios.iter().map(scene).collect::<Result<_, _>>()?;
        Ok(Self { candidates, scenes: Scenes { all, robustness: candidates.robustness } })
    }

    pub fn mountings(&self) -> usize {
        self.candidates.experiment().mountings.len()
    }

    /// Which mountings a schedule uses.
    pub fn mountings_of(&self, schedule: &Schedule) -> Vec<bool> {
        let mut used = vec![false; self.mountings()];
        for visit in &schedule.visits {
            used[self.candidates.experiment().set_points[visit.plateau].mounting] = true;
        }
        used
    }

    pub fn mounting_of(&self, atom: usize) -> usize {
        self.candidates.experiment().set_points[atom / self.candidates.durations.len()].mounting
    }

    pub fn price(&self, atom: usize) -> f64 {
        let options = self.candidates.durations.len();
        self.candidates.overhead(atom / options) + self.candidates.durations[atom % options]
    }

    pub fn atoms(&self) -> usize {
        self.candidates.len() * self.candidates.durations.len()
    }

    /// Time of the cheapest mounting with its shortest plateau [s].
    pub fn least_time(&self) -> f64 {
        let of_atom = |x: usize| {
            let mut used = vec![false; self.mountings()];
            used[self.mounting_of(x)] = true;
            self.candidates.set_up_time(&used) + self.price(x)
        };
        (0..self.atoms()).map(of_atom).fold(f64::INFINITY, f64::min)
    }

    pub fn check_time(&self, time: f64) -> Result<(), PlanError> {
        let least = self.least_time();
        if time.is_finite() && time >= least { Ok(()) } else { Err(PlanError::TooShort { found: time, least }) }
    }

    pub fn exchange<'b>(&'b self, time: f64, open: &'b [bool], trials: usize) -> Exchange<'b> {
        Exchange { candidates: self.candidates, scenes: &self.scenes, time, open, trials }
    }

    /// Every plateau as often and as long as may be.
    pub fn everything(&self) -> Whole {
        self.everything_on(&vec![true; self.mountings()])
    }

    /// Every plateau of a set of mountings as often and as long as may be.
    pub fn everything_on(&self, set: &[bool]) -> Whole {
        self.exchange(f64::INFINITY, set, 0).whole(self.most_visits(set))
    }

    /// A schedule and everything on one mounting more.
    pub fn with_everything_on(&self, whole: &Whole, mounting: usize) -> Whole {
        let mut set = vec![false; self.mountings()];
        set[mounting] = true;
        self.exchange(f64::INFINITY, &set, 0).with(whole, &self.most_visits(&set))
    }

    fn most_visits(&self, set: &[bool]) -> Vec<u32> {
        let options = self.candidates.durations.len();
        let repeats = u32::try_from(self.candidates.repeats).unwrap_or(u32::MAX);
        let is_longest = |x: usize| x % options == options - 1 && set[self.mounting_of(x)];
        (0..self.atoms()).map(|x| if is_longest(x) { repeats } else { 0 }).collect()
    }
}
