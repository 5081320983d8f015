//! The schedule in whole visits: rounding of a continuous design, filling of the remaining time, and exchange of the visits
//! that bring least for those that bring most.

use nalgebra::Matrix3;

use super::atom::Atom;
use super::candidates::{Candidates, Visit};
use super::information::{Factor, Insight, LinearisedScenario};
use super::scenarios::LinearisedScenarios;
use crate::progress::Watch;

/// Whole visits by atom, with their criterion and time.
#[derive(Debug, Clone)]
pub(super) struct IntegerSchedule {
    /// Visits of each atom.
    pub visits: Vec<u32>,
    /// Logarithm of the criterion.
    pub value: f64,
    /// Time with set-ups [s].
    pub time: f64,
    factors: Vec<Factor>,
}

/// The exchange of visits within a time, on some set-ups.
#[derive(Clone, Copy)]
pub(super) struct Exchange<'a> {
    pub candidates: &'a Candidates,
    pub scenarios: &'a LinearisedScenarios,
    /// Available time, set-ups included [s].
    pub time: f64,
    /// Set-ups that may be used.
    pub open: &'a [bool],
    /// Limit of exchanges that are tried.
    pub trials: usize,
    pub watch: &'a Watch<'a>,
}

/// One visit of a candidate turned from a duration, or none, to another, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Move {
    candidate: usize,
    from: Option<usize>,
    to: Option<usize>,
}

impl IntegerSchedule {
    /// Logarithm of the criterion in each scenario.
    pub fn by_scenario(&self) -> Vec<f64> {
        self.factors.iter().map(LinearisedScenario::value).collect()
    }

    /// The visits as a list.
    pub fn list(&self, candidates: &Candidates) -> Vec<Visit> {
        let visit = |x: usize| {
            let Atom { candidate, duration } = candidates.atoms().at(x);
            Visit { candidate, duration: candidates.durations[duration] }
        };
        (0..self.visits.len()).flat_map(|x| (0..self.visits[x]).map(move |_| visit(x))).collect()
    }

    /// Which set-ups are used.
    pub fn set_ups(&self, candidates: &Candidates) -> Vec<bool> {
        set_ups_of(candidates, &self.visits)
    }
}

fn set_ups_of(candidates: &Candidates, visits: &[u32]) -> Vec<bool> {
    let atoms = candidates.atoms();
    candidates.set_ups_used((0..visits.len()).filter(|&x| visits[x] > 0).map(|x| atoms.at(x).candidate))
}

impl Exchange<'_> {
    /// A schedule near the continuous design `w`: the better one of two roundings, each filled with whatever brings most.
    pub fn round(&self, w: &[f64]) -> IntegerSchedule {
        let [by_size, in_order] = [self.rounded_by_size(w), self.rounded_in_order(w)];
        if in_order.value < by_size.value { in_order } else { by_size }
    }

    /// The shortest visit of each candidate while it fits, those of the most visits first: where time is short, what is seen at all
    /// counts for more than how well.
    pub fn rounded_short(&self, w: &[f64]) -> IntegerSchedule {
        let atoms = self.candidates.atoms();
        let all = |c: &usize| atoms.of(*c).map(|x| w[x]).sum::<f64>();
        let mut candidates: Vec<usize> = (0..atoms.candidates).filter(|c| all(c) > 1e-3).collect();
        candidates.sort_by(|a, b| all(b).total_cmp(&all(a)).then(a.cmp(b)));
        let mut visits = vec![0; w.len()];
        for x in candidates.into_iter().map(|c| atoms.of(c).start) {
            visits[x] = 1;
            if !self.is_within(&visits) {
                visits[x] = 0;
            }
        }
        self.fill(self.parted(visits))
    }

    /// Visits wherever the parts before and here add up to one: a visit that neighbouring speeds share goes to one of them, so
    /// that no mounting loses its purpose. Scaled down until it fits.
    fn rounded_in_order(&self, w: &[f64]) -> IntegerSchedule {
        let atoms = self.candidates.atoms();
        let rounded = |scale: f64| {
            let mut visits = vec![0; w.len()];
            let mut carried = 0.0;
            for c in 0..atoms.candidates {
                if c > 0 && self.set_up(c) != self.set_up(c - 1) {
                    carried = 0.0;
                }
                let mut room = self.candidates.most_visits(c) as f64;
                for x in atoms.of(c) {
                    carried += scale * w[x];
                    let whole = (carried + 0.5 + 1e-6).floor().clamp(0.0, room);
                    carried -= whole;
                    room -= whole;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                    let whole = whole as u32;
                    visits[x] = whole;
                }
            }
            visits
        };
        let fitting = (0..100).map(|n| rounded(1.0 - 0.01 * f64::from(n))).find(|visits| self.is_within(visits));
        self.fill(self.parted(fitting.unwrap_or_else(|| vec![0; w.len()])))
    }

    /// Whole parts of visits first, then halves and more while they fit.
    fn rounded_by_size(&self, w: &[f64]) -> IntegerSchedule {
        // Whole visits within rounding, then the rest by size.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let mut visits: Vec<u32> = w.iter().map(|w| (w + 1e-6).floor().max(0.0) as u32).collect();
        let mut parts: Vec<(f64, usize)> = (0..w.len()).map(|x| (w[x] - f64::from(visits[x]), x)).collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, x) in parts.into_iter().filter(|(part, _)| *part >= 0.5) {
            visits[x] += 1;
            if !self.is_within(&visits) {
                visits[x] -= 1;
            }
        }
        self.fill(self.parted(visits))
    }

    /// Exchanges until none of those tried gains.
    pub fn improve(&self, mut schedule: IntegerSchedule) -> IntegerSchedule {
        let mut trials = 0;
        'again: loop {
            let insights = self.insights(&schedule);
            let mut falls: Vec<(f64, Move)> = self
                .moves(&schedule)
                .filter(|m| self.price_of(m) < 0.0)
                .map(|m| ((self.value_after(&schedule, &insights, &m) - schedule.value) / -self.price_of(&m), m))
                .filter(|(loss, _)| loss.is_finite())
                .collect();
            falls.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (_, fall) in falls {
                if trials == self.trials || self.watch.is_stopped() {
                    break 'again;
                }
                trials += 1;
                let mut visits = schedule.visits.clone();
                self.apply(&mut visits, &fall);
                let filled = self.fill(self.parted(visits));
                if filled.value < schedule.value - 1e-9 {
                    schedule = filled;
                    continue 'again;
                }
            }
            break;
        }
        schedule
    }

    /// The schedule with the remaining time filled, best gain for a second first.
    pub fn fill(&self, mut schedule: IntegerSchedule) -> IntegerSchedule {
        loop {
            if self.watch.is_stopped() {
                return schedule;
            }
            let left = self.time - schedule.time;
            let prices = self.set_ups(&schedule);
            if !self.moves(&schedule).any(|m| (0.0..=left + 1e-9).contains(&self.price_with_set_up(&prices, &m))) {
                return schedule;
            }
            let insights = self.insights(&schedule);
            let mut best: Option<(f64, Move)> = None;
            for m in self.moves(&schedule) {
                let price = self.price_with_set_up(&prices, &m);
                if price <= 0.0 || price > left + 1e-9 {
                    continue;
                }
                let rate = (schedule.value - self.value_after(&schedule, &insights, &m)) / price;
                if rate > 0.0 && best.is_none_or(|(most, _)| rate > most) {
                    best = Some((rate, m));
                }
            }
            let Some((_, m)) = best else { return schedule };
            let mut visits = schedule.visits;
            self.apply(&mut visits, &m);
            if m.from.is_some() {
                schedule = self.schedule(visits);
                continue;
            }
            let scenarios = self.scenarios.all.iter().zip(&schedule.factors);
            let factors = scenarios
                .map(|(scenario, factor)| scenario.with(factor, &[(m.candidate, self.change(scenario, &m))]))
                .collect();
            schedule = self.with_factors(visits, factors);
        }
    }

    /// The schedule of these visits without those that no visit of another candidate parts, the shortest of them first.
    pub fn parted(&self, mut visits: Vec<u32>) -> IntegerSchedule {
        let atoms = self.candidates.atoms();
        let by_set_up = self.visits_by_set_up(&visits);
        for c in 0..atoms.candidates {
            let of_candidate = &mut visits[atoms.of(c)];
            let count: u32 = of_candidate.iter().sum();
            let mut extra = count.saturating_sub(1 + by_set_up[self.set_up(c)] - count);
            for n in of_candidate {
                let left_out = extra.min(*n);
                *n -= left_out;
                extra -= left_out;
            }
        }
        self.schedule(visits)
    }

    fn visits_by_set_up(&self, visits: &[u32]) -> Vec<u32> {
        let mut by_set_up = vec![0; self.candidates.set_ups()];
        (0..visits.len()).for_each(|x| by_set_up[self.candidates.set_up_of_atom(x)] += visits[x]);
        by_set_up
    }

    /// The schedule of these visits.
    pub fn schedule(&self, visits: Vec<u32>) -> IntegerSchedule {
        let factors = self.scenarios.all.iter().map(|scenario| scenario.factor(&self.information(scenario, &visits)));
        let factors = factors.collect();
        self.with_factors(visits, factors)
    }

    /// A schedule with more visits, of candidates that it has none of.
    pub fn with(&self, schedule: &IntegerSchedule, more: &[u32]) -> IntegerSchedule {
        let visits = schedule.visits.iter().zip(more).map(|(there, more)| there + more).collect();
        let scenarios = self.scenarios.all.iter().zip(&schedule.factors);
        let factors =
            scenarios.map(|(scenario, factor)| scenario.with(factor, &self.information(scenario, more))).collect();
        self.with_factors(visits, factors)
    }

    fn information(&self, scenario: &LinearisedScenario, visits: &[u32]) -> Vec<(usize, Matrix3<f64>)> {
        scenario.information(self.candidates.atoms(), |x| f64::from(visits[x]))
    }

    fn with_factors(&self, visits: Vec<u32>, factors: Vec<Factor>) -> IntegerSchedule {
        IntegerSchedule { value: self.scenarios.value(&factors), time: self.time_of(&visits), visits, factors }
    }

    fn insights(&self, schedule: &IntegerSchedule) -> Vec<Vec<Option<Insight>>> {
        let of_scenario = |(scenario, factor): (&LinearisedScenario, &Factor)| {
            let insight = |c: usize| self.open[self.set_up(c)].then(|| scenario.insight(factor, c));
            (0..self.candidates.len()).map(insight).collect()
        };
        self.scenarios.all.iter().zip(&schedule.factors).map(of_scenario).collect()
    }

    fn value_after(&self, schedule: &IntegerSchedule, insights: &[Vec<Option<Insight>>], m: &Move) -> f64 {
        type Of<'a> = ((&'a LinearisedScenario, &'a Factor), &'a Vec<Option<Insight>>);
        let of_scenario = |((scenario, factor), insights): Of| match &insights[m.candidate] {
            Some(insight) => scenario.value_after(factor, insight, &self.change(scenario, m)),
            None => f64::INFINITY,
        };
        self.scenarios.joint(self.scenarios.all.iter().zip(&schedule.factors).zip(insights).map(of_scenario))
    }

    fn change(&self, scenario: &LinearisedScenario, m: &Move) -> Matrix3<f64> {
        let of = |duration| self.atom(m, duration).map_or_else(Matrix3::zeros, |x| *scenario.precision(x));
        of(m.to) - of(m.from)
    }

    /// The atom of one end of a move.
    fn atom(&self, m: &Move, duration: Option<usize>) -> Option<usize> {
        duration.map(|duration| self.candidates.atoms().number(Atom { candidate: m.candidate, duration }))
    }

    fn set_up(&self, candidate: usize) -> usize {
        self.candidates.set_up_of(candidate)
    }

    /// All changes of one visit that the bounds allow.
    fn moves(&self, schedule: &IntegerSchedule) -> impl Iterator<Item = Move> {
        let atoms = self.candidates.atoms();
        let by_set_up = self.visits_by_set_up(&schedule.visits);
        let mut moves = Vec::new();
        for candidate in (0..atoms.candidates).filter(|&c| self.open[self.set_up(c)]) {
            let visits = &schedule.visits[atoms.of(candidate)];
            let count: u32 = visits.iter().sum();
            let is_parted = count <= by_set_up[self.set_up(candidate)] - count;
            let has_room = is_parted && self.has_room(candidate, visits, 1);
            let ends = || (0..atoms.durations).map(Some).chain([None]);
            for from in ends().filter(|from| from.map_or(has_room, |d| visits[d] > 0)) {
                moves.extend(ends().filter(|to| *to != from).map(|to| Move { candidate, from, to }));
            }
        }
        moves.into_iter()
    }

    /// Time that a move takes more [s], set-ups left out.
    fn price_of(&self, m: &Move) -> f64 {
        let of = |duration| self.atom(m, duration).map_or(0.0, |x| self.candidates.price(x));
        of(m.to) - of(m.from)
    }

    /// What each set-up would take more [s]; 0 where it is there already.
    fn set_ups(&self, schedule: &IntegerSchedule) -> Vec<f64> {
        let mut used = schedule.set_ups(self.candidates);
        let before = self.candidates.set_up_time(&used);
        let mut more = vec![0.0; used.len()];
        for m in 0..used.len() {
            if !std::mem::replace(&mut used[m], true) {
                more[m] = self.candidates.set_up_time(&used) - before;
                used[m] = false;
            }
        }
        more
    }

    fn price_with_set_up(&self, set_ups: &[f64], m: &Move) -> f64 {
        self.price_of(m) + if m.from.is_none() { set_ups[self.set_up(m.candidate)] } else { 0.0 }
    }

    fn apply(&self, visits: &mut [u32], m: &Move) {
        self.atom(m, m.from).into_iter().for_each(|x| visits[x] -= 1);
        self.atom(m, m.to).into_iter().for_each(|x| visits[x] += 1);
    }

    fn time_of(&self, visits: &[u32]) -> f64 {
        let of_atom = |x: usize| f64::from(visits[x]) * self.candidates.price(x);
        let set_up = self.candidates.set_up_time(&set_ups_of(self.candidates, visits));
        set_up + (0..visits.len()).map(of_atom).sum::<f64>()
    }

    fn is_within(&self, visits: &[u32]) -> bool {
        let durations = self.candidates.durations.len();
        visits.chunks(durations).enumerate().all(|(c, visits)| self.has_room(c, visits, 0))
            && self.time_of(visits) <= self.time + 1e-9
    }

    /// Whether a candidate may have these visits, and some `more`.
    fn has_room(&self, candidate: usize, visits: &[u32], more: usize) -> bool {
        visits.iter().map(|n| *n as usize).sum::<usize>() + more <= self.candidates.most_visits(candidate)
    }
}
