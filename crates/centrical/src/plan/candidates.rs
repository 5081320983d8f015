//! What can be measured, what it costs, and the schedule that is chosen from it.

use std::collections::VecDeque;

use nalgebra::Matrix3;

use super::atom::Atoms;
use super::criterion::Robustness;
use super::error::PlanError;
use crate::model::{Experiment, MeasurementModel, Mounting, SetPoint, Weight};

/// White noise down to a floor: the variance of the mean of a plateau of duration `T` is `density^2 / 2T + floor^2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Square root of the one-sided spectral density [m/s^2/sqrt(Hz)].
    pub density: f64,
    /// Limit of longer averaging [m/s^2].
    pub floor: f64,
}

impl Noise {
    /// Variance of the mean of a plateau of `duration` [s], each axis [m^2/s^4].
    pub fn variance(&self, duration: f64) -> f64 {
        self.density * self.density / (2.0 * duration) + self.floor * self.floor
    }

    /// The covariance with which the mean of a plateau of `duration` [s] will be known.
    pub fn weight(&self, set_point: usize, duration: f64) -> Weight {
        Weight { set_point, covariance: Matrix3::identity() * self.variance(duration) }
    }
}

/// One state of unit and noise that a plan must be good for.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// The unit's model. Its experiment has all candidate mountings, and the candidate plateaus as set points.
    pub model: MeasurementModel,
    /// Expected unknowns in the order of the model's parameters, about which the plan is linearised: zeros for a unit and
    /// seatings without errors.
    pub nominal: Vec<f64>,
    /// The expected noise.
    pub noise: Noise,
    /// Its weight among the scenarios. Weights are divided by their sum.
    pub weight: f64,
}

/// Times that the machine and its operators take [s].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Costs {
    /// Change of the position of the unit on the arm, its first mounting included: paid once for each position used.
    pub position: f64,
    /// Re-seating of the unit at another radius in the same position.
    pub seat: f64,
    /// Ramp to a speed and settling, once for each visit of a plateau while spinning.
    pub ramp: f64,
    /// Turn to an angle at rest, once for each visit.
    pub turn: f64,
    /// Run up from rest and back, once for each mounting.
    pub run_up: f64,
    /// Moving the unit from the arm to the table, once for all rests beside the arm.
    pub table: f64,
    /// Laying the unit down in another attitude, once for each rest beside the arm.
    pub attitude: f64,
}

/// All that can be chosen from. The scenarios share their experiment but not their unknowns; the first is the one that
/// predictions are made for.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidates {
    /// What the plan must be good for; at least one.
    pub scenarios: Vec<Scenario>,
    /// How their criteria are combined.
    pub robustness: Robustness,
    /// Durations of a plateau [s], rising.
    pub durations: Vec<f64>,
    /// How often one plateau on the arm may be visited: each visit has its own speed error. A rest beside the arm is visited once:
    /// laid down again, the unit has another attitude, which is a candidate of its own.
    pub repeats: usize,
    /// Times beside the durations.
    pub costs: Costs,
}

/// One stay at a set point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visit {
    /// Index of the candidate: of the set point in [`Candidates::experiment`].
    pub candidate: usize,
    /// Duration [s].
    pub duration: f64,
}

/// The visits that are chosen, in the order of the candidates' mountings: rests beside the arm last.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The visits.
    pub visits: Vec<Visit>,
    /// Time of the whole, set-ups included [s].
    pub time: f64,
}

impl Candidates {
    /// The experiment with all candidates. Mountings on the arm precede those of rests beside it.
    pub fn experiment(&self) -> &Experiment {
        self.scenarios[0].model.experiment()
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.experiment().set_points.len()
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Time of one visit [s], without the set-up of its mounting.
    pub fn visit_time(&self, visit: &Visit) -> f64 {
        self.overhead(visit.candidate) + visit.duration
    }

    /// Most visits of a candidate.
    pub fn most_visits(&self, candidate: usize) -> usize {
        if self.is_on_arm(candidate) { self.repeats } else { 1 }
    }

    /// Time of a list of visits with the set-ups that they need [s].
    pub fn time_of(&self, visits: &[Visit]) -> f64 {
        let used = self.set_ups_used(visits.iter().map(|visit| visit.candidate));
        self.set_up_time(&used) + visits.iter().map(|visit| self.visit_time(visit)).sum::<f64>()
    }

    /// A schedule of these visits: mounting by mounting, in each rest first and then rising speeds. Another visit lies between two
    /// of one candidate, so that the speed is set anew and has an error of its own; those that the others cannot part stand
    /// side by side.
    pub fn schedule(&self, mut visits: Vec<Visit>) -> Schedule {
        let set_points = &self.experiment().set_points;
        let speed = |visit: &Visit| set_points[visit.candidate].omega.abs();
        visits.sort_by(|a, b| {
            let by_speed = speed(a).total_cmp(&speed(b));
            by_speed.then(a.candidate.cmp(&b.candidate)).then(a.duration.total_cmp(&b.duration))
        });
        let time = self.time_of(&visits);
        let mut ordered = Vec::with_capacity(visits.len());
        for mounting in 0..self.experiment().mountings.len() {
            let there = visits.iter().filter(|visit| set_points[visit.candidate].mounting == mounting);
            ordered.extend(in_order(there.copied().collect(), speed));
        }
        Schedule { visits: ordered, time }
    }

    /// The atoms of these candidates.
    pub(super) fn atoms(&self) -> Atoms {
        Atoms { candidates: self.len(), durations: self.durations.len() }
    }

    /// Time of a visit of an atom [s], without the set-up of its mounting.
    pub(super) fn price(&self, atom: usize) -> f64 {
        let atom = self.atoms().at(atom);
        self.overhead(atom.candidate) + self.durations[atom.duration]
    }

    /// Number of set-ups: one for each mounting on the arm, and a last one for all rests beside it together.
    pub(super) fn set_ups(&self) -> usize {
        let on_arm = self.experiment().mountings_on_arm().count();
        on_arm + usize::from(on_arm < self.experiment().mountings.len())
    }

    /// The set-up that a candidate needs: its mounting on the arm, or that of the table.
    pub(super) fn set_up_of(&self, candidate: usize) -> usize {
        let experiment = self.experiment();
        let SetPoint { mounting, .. } = experiment.set_points[candidate];
        if experiment.is_on_arm(mounting) { mounting } else { experiment.mountings_on_arm().count() }
    }

    /// The set-up of an atom.
    pub(super) fn set_up_of_atom(&self, atom: usize) -> usize {
        self.set_up_of(self.atoms().at(atom).candidate)
    }

    /// The mounting of a set-up; `None` for the table.
    pub(super) fn mounting_of(&self, set_up: usize) -> Option<&Mounting> {
        self.experiment().mountings.get(set_up).filter(|_| self.experiment().is_on_arm(set_up))
    }

    /// Which set-ups some candidates need.
    pub(super) fn set_ups_used(&self, candidates: impl Iterator<Item = usize>) -> Vec<bool> {
        let mut used = vec![false; self.set_ups()];
        candidates.for_each(|candidate| used[self.set_up_of(candidate)] = true);
        used
    }

    /// Time of the set-ups in use [s]: `position` for each position, `seat` for each further mounting in it, and the
    /// run-up of each; `table` for the rests beside the arm.
    pub(super) fn set_up_time(&self, used: &[bool]) -> f64 {
        let mut positions = vec![false; self.experiment().positions.len()];
        let mut time = 0.0;
        for set_up in (0..used.len()).filter(|&set_up| used[set_up]) {
            let Some(mounting) = self.mounting_of(set_up) else {
                time += self.costs.table;
                continue;
            };
            let first = !std::mem::replace(&mut positions[mounting.position], true);
            time += self.costs.run_up + if first { self.costs.position } else { self.costs.seat };
        }
        time
    }

    /// Whether a candidate is on the arm, and not a rest beside it.
    fn is_on_arm(&self, candidate: usize) -> bool {
        self.experiment().is_on_arm(self.experiment().set_points[candidate].mounting)
    }

    /// Ramp, turn or laying down before a visit of a candidate [s].
    fn overhead(&self, candidate: usize) -> f64 {
        match (self.is_on_arm(candidate), self.experiment().set_points[candidate].is_rest()) {
            (false, _) => self.costs.attitude,
            (true, true) => self.costs.turn,
            (true, false) => self.costs.ramp,
        }
    }

    /// Refuses candidates from which no plan can be made.
    pub(super) fn check(&self) -> Result<(), PlanError> {
        let Some(first) = self.scenarios.first() else { return Err(PlanError::Nothing("scenarios")) };
        if first.model.experiment().set_points.is_empty() {
            return Err(PlanError::Nothing("candidate plateaus"));
        }
        if self.durations.is_empty() || self.repeats == 0 {
            return Err(PlanError::Nothing("durations or visits"));
        }
        let positive = |value: &f64| *value > 0.0 && value.is_finite();
        let costs = &self.costs;
        let times = [costs.position, costs.seat, costs.ramp, costs.turn, costs.run_up, costs.table, costs.attitude];
        if !self.durations.iter().all(positive) || times.iter().any(|time| !(*time >= 0.0 && time.is_finite())) {
            return Err(PlanError::Time);
        }
        if costs.seat > costs.position {
            return Err(PlanError::SeatAbovePosition);
        }
        if self.experiment().mountings_on_arm().enumerate().any(|(n, mounting)| n != mounting) {
            return Err(PlanError::RestsFirst);
        }
        if self.scenarios.iter().any(|s| s.nominal.len() != s.model.parameters().len()) {
            return Err(PlanError::Nominal);
        }
        let same = |s: &Scenario| s.model.experiment() == first.model.experiment();
        if self.scenarios.iter().all(same) { Ok(()) } else { Err(PlanError::Experiments) }
    }
}

/// Visits of one mounting in their order: each candidate once, rising, and further visits where the speed changes least on the way. No
/// visit precedes another of its candidate, unless there are not enough others to part them.
fn in_order(rising: Vec<Visit>, speed: impl Fn(&Visit) -> f64) -> Vec<Visit> {
    let mut order: Vec<Visit> = Vec::with_capacity(rising.len());
    let mut further = VecDeque::new();
    for visit in rising {
        let is_first = order.last().is_none_or(|last| last.candidate != visit.candidate);
        if is_first { order.push(visit) } else { further.push_back(visit) }
    }
    // Visits that found no place since the last one that did: others may make room.
    let mut passed = 0;
    while let Some(visit) = further.pop_front() {
        if let Some(place) = place_of(&visit, &order, &speed) {
            order.insert(place, visit);
            passed = 0;
        } else if passed < further.len() {
            further.push_back(visit);
            passed += 1;
        } else {
            order.push(visit);
        }
    }
    order
}

/// Where a visit makes the machine, which starts and ends at rest, change its speed least, away from visits of its candidate; of equal
/// places the last one.
fn place_of(visit: &Visit, order: &[Visit], speed: impl Fn(&Visit) -> f64) -> Option<usize> {
    let around = |place: usize| [place.checked_sub(1).and_then(|before| order.get(before)), order.get(place)];
    let detour = |place: usize| {
        let [before, after] = around(place).map(|other| other.map_or(0.0, &speed));
        (before - speed(visit)).abs() + (speed(visit) - after).abs() - (before - after).abs()
    };
    let is_free = |place: &usize| around(*place).iter().flatten().all(|other| other.candidate != visit.candidate);
    (0..=order.len()).rev().filter(is_free).min_by(|a, b| detour(*a).total_cmp(&detour(*b)))
}
