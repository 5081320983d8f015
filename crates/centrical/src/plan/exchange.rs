//! The schedule in whole visits: rounding of a continuous design, filling of the time left, and exchange of what brings
//! least for what brings most.

use nalgebra::Matrix3;

use super::candidates::{Candidates, Visit};
use super::information::{Factor, Insight, Scene, sum_of};
use super::robustness::Scenes;

/// Visits by atom within a set of mountings, and what they are worth.
#[derive(Debug, Clone)]
pub(super) struct Whole {
    /// Visits of each atom.
    pub counts: Vec<u32>,
    /// Logarithm of the criterion.
    pub value: f64,
    /// Time with set-ups [s].
    pub time: f64,
    factors: Vec<Factor>,
}

/// What exchange works on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exchange<'a> {
    pub candidates: &'a Candidates,
    pub scenes: &'a Scenes,
    /// Time there is, set-ups included [s].
    pub time: f64,
    /// Mountings that may be used.
    pub open: &'a [bool],
    /// Exchanges tried at most.
    pub trials: usize,
}

/// One visit turned from a duration, or none, to another, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Move {
    plateau: usize,
    from: Option<usize>,
    to: Option<usize>,
}

impl Whole {
    /// Logarithm of the criterion in each scenario.
    pub fn by_scenario(&self) -> Vec<f64> {
        self.factors.iter().map(Scene::value).collect()
    }

    /// The visits as a list.
    pub fn visits(&self, candidates: &Candidates) -> Vec<Visit> {
        let options = candidates.durations.len();
        let visit = |x: usize| Visit { plateau: x / options, duration: candidates.durations[x % options] };
        (0..self.counts.len()).flat_map(|x| (0..self.counts[x]).map(move |_| visit(x))).collect()
    }
}

impl Exchange<'_> {
    /// A schedule near the continuous design `w`: the better one of two roundings, each filled with whatever brings most.
    pub fn round(&self, w: &[f64]) -> Whole {
        let [by_size, in_order] = [self.rounded_by_size(w), self.rounded_in_order(w)];
        if in_order.value < by_size.value { in_order } else { by_size }
    }

    /// Visits wherever the parts before and here add up to one: what neighbouring speeds share becomes a visit of one of them,
    /// and no mounting loses what it is there for. Scaled down until it fits.
    fn rounded_in_order(&self, w: &[f64]) -> Whole {
        let options = self.options();
        let set_points = &self.candidates.experiment().set_points;
        let rounded = |scale: f64| {
            let mut counts = vec![0; w.len()];
            let mut carried = 0.0;
            for c in 0..self.candidates.len() {
                if c > 0 && set_points[c].mounting != set_points[c - 1].mounting {
                    carried = 0.0;
                }
                let mut room = self.candidates.repeats as f64;
                for x in c * options..(c + 1) * options {
                    carried += scale * w[x];
                    let visits = (carried + 0.5 + 1e-6).floor().clamp(0.0, room);
                    carried -= visits;
                    room -= visits;
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                    let visits = visits as u32;
                    counts[x] = visits;
                }
            }
            counts
        };
        let fitting = (0..100).map(|n| rounded(1.0 - 0.01 * f64::from(n))).find(|counts| self.is_within(counts));
        self.fill(self.whole(fitting.unwrap_or_else(|| vec![0; w.len()])))
    }

    /// Whole parts of visits first, then halves and more while they fit.
    fn rounded_by_size(&self, w: &[f64]) -> Whole {
        // Whole visits within rounding, then the rest by size.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let mut counts: Vec<u32> = w.iter().map(|w| (w + 1e-6).floor().max(0.0) as u32).collect();
        let mut parts: Vec<(f64, usize)> = (0..w.len()).map(|x| (w[x] - f64::from(counts[x]), x)).collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, x) in parts.into_iter().filter(|(part, _)| *part >= 0.5) {
            counts[x] += 1;
            if !self.is_within(&counts) {
                counts[x] -= 1;
            }
        }
        let whole = self.whole(counts);
        self.fill(whole)
    }

    /// Exchanges until none of those tried gains.
    pub fn improve(&self, mut whole: Whole) -> Whole {
        let mut trials = 0;
        'again: loop {
            let insights = self.insights(&whole);
            let mut falls: Vec<(f64, Move)> = self
                .moves(&whole)
                .filter(|m| self.price_of(m) < 0.0)
                .map(|m| ((self.value_after(&whole, &insights, &m) - whole.value) / -self.price_of(&m), m))
                .filter(|(loss, _)| loss.is_finite())
                .collect();
            falls.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (_, fall) in falls {
                if trials == self.trials {
                    break 'again;
                }
                trials += 1;
                let mut counts = whole.counts.clone();
                self.apply(&mut counts, &fall);
                let filled = self.fill(self.whole(counts));
                if filled.value < whole.value - 1e-9 {
                    whole = filled;
                    continue 'again;
                }
            }
            break;
        }
        whole
    }

    /// The schedule with the time left filled, best gain for a second first.
    pub fn fill(&self, mut whole: Whole) -> Whole {
        loop {
            let left = self.time - whole.time;
            let prices = self.set_ups(&whole);
            if !self.moves(&whole).any(|m| (0.0..=left + 1e-9).contains(&self.price_with_set_up(&prices, &m))) {
                return whole;
            }
            let insights = self.insights(&whole);
            let mut best: Option<(f64, Move)> = None;
            for m in self.moves(&whole) {
                let price = self.price_with_set_up(&prices, &m);
                if price <= 0.0 || price > left + 1e-9 {
                    continue;
                }
                let rate = (whole.value - self.value_after(&whole, &insights, &m)) / price;
                if rate > 0.0 && best.is_none_or(|(most, _)| rate > most) {
                    best = Some((rate, m));
                }
            }
            let Some((_, m)) = best else { return whole };
            let mut counts = whole.counts;
            self.apply(&mut counts, &m);
            let factors = self.scenes.all.iter().zip(&whole.factors).map(|(scene, factor)| {
                if m.from.is_none() {
                    scene.with(factor, &[(m.plateau, self.change(scene, &m))])
                } else {
                    scene.factor(&self.information(scene, &counts))
                }
            });
            let factors: Vec<Factor> = factors.collect();
            whole = self.with_factors(counts, factors);
        }
    }

    /// The schedule of these counts.
    pub fn whole(&self, counts: Vec<u32>) -> Whole {
        let factors = self.scenes.all.iter().map(|scene| scene.factor(&self.information(scene, &counts))).collect();
        self.with_factors(counts, factors)
    }

    /// A schedule with more visits, of plateaus that it has none of.
    pub fn with(&self, whole: &Whole, more: &[u32]) -> Whole {
        let counts = whole.counts.iter().zip(more).map(|(there, more)| there + more).collect();
        let scenes = self.scenes.all.iter().zip(&whole.factors);
        let factors = scenes.map(|(scene, factor)| scene.with(factor, &self.information(scene, more))).collect();
        self.with_factors(counts, factors)
    }

    fn with_factors(&self, counts: Vec<u32>, factors: Vec<Factor>) -> Whole {
        Whole { value: self.scenes.value(&factors), time: self.time_of(&counts), counts, factors }
    }

    fn options(&self) -> usize {
        self.candidates.durations.len()
    }

    fn information(&self, scene: &Scene, counts: &[u32]) -> Vec<(usize, Matrix3<f64>)> {
        let options = self.options();
        let of_plateau = |c: usize| {
            let visited = || (c * options..(c + 1) * options).filter(|&x| counts[x] > 0);
            visited().next()?;
            Some((c, sum_of(visited().map(|x| scene.precision(x) * f64::from(counts[x])))))
        };
        (0..counts.len() / options).filter_map(of_plateau).collect()
    }

    fn insights(&self, whole: &Whole) -> Vec<Vec<Option<Insight>>> {
        let of_scene = |(scene, factor): (&Scene, &Factor)| {
            let insight = |c: usize| self.is_open(c).then(|| scene.insight(factor, c));
            (0..self.candidates.len()).map(insight).collect()
        };
        self.scenes.all.iter().zip(&whole.factors).map(of_scene).collect()
    }

    fn value_after(&self, whole: &Whole, insights: &[Vec<Option<Insight>>], m: &Move) -> f64 {
        let of_scene =
            |((scene, factor), insights): ((&Scene, &Factor), &Vec<Option<Insight>>)| match &insights[m.plateau] {
                Some(insight) => scene.value_after(factor, insight, &self.change(scene, m)),
                None => f64::INFINITY,
            };
        self.scenes.joint(self.scenes.all.iter().zip(&whole.factors).zip(insights).map(of_scene))
    }

    fn change(&self, scene: &Scene, m: &Move) -> Matrix3<f64> {
        let of = |option: Option<usize>| {
            option.map_or_else(Matrix3::zeros, |t| *scene.precision(m.plateau * self.options() + t))
        };
        of(m.to) - of(m.from)
    }

    fn is_open(&self, plateau: usize) -> bool {
        self.open[self.candidates.experiment().set_points[plateau].mounting]
    }

    /// All changes of one visit that the bounds allow.
    fn moves(&self, whole: &Whole) -> impl Iterator<Item = Move> {
        let options = self.options();
        let repeats = self.candidates.repeats;
        let mut moves = Vec::new();
        for plateau in (0..self.candidates.len()).filter(|&c| self.is_open(c)) {
            let counts = &whole.counts[plateau * options..(plateau + 1) * options];
            let has_room = counts.iter().map(|n| *n as usize).sum::<usize>() < repeats;
            let ends = || (0..options).map(Some).chain([None]);
            for from in ends().filter(|from| from.map_or(has_room, |t| counts[t] > 0)) {
                moves.extend(ends().filter(|to| *to != from).map(|to| Move { plateau, from, to }));
            }
        }
        moves.into_iter()
    }

    /// Time that a move takes more [s], set-ups left out.
    fn price_of(&self, m: &Move) -> f64 {
        let of = |option: Option<usize>| {
            option.map_or(0.0, |t| self.candidates.overhead(m.plateau) + self.candidates.durations[t])
        };
        of(m.to) - of(m.from)
    }

    /// What the set-up of each mounting would take more [s]; 0 where it is there already.
    fn set_ups(&self, whole: &Whole) -> Vec<f64> {
        let mut used = self.used(&whole.counts);
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
        let mounting = self.candidates.experiment().set_points[m.plateau].mounting;
        self.price_of(m) + if m.from.is_none() { set_ups[mounting] } else { 0.0 }
    }

    fn apply(&self, counts: &mut [u32], m: &Move) {
        let options = self.options();
        m.from.into_iter().for_each(|t| counts[m.plateau * options + t] -= 1);
        m.to.into_iter().for_each(|t| counts[m.plateau * options + t] += 1);
    }

    fn used(&self, counts: &[u32]) -> Vec<bool> {
        let experiment = self.candidates.experiment();
        let mut used = vec![false; experiment.mountings.len()];
        let visited = (0..counts.len()).filter(|&x| counts[x] > 0);
        visited.for_each(|x| used[experiment.set_points[x / self.options()].mounting] = true);
        used
    }

    fn time_of(&self, counts: &[u32]) -> f64 {
        let options = self.options();
        let of_atom = |x: usize| {
            f64::from(counts[x]) * (self.candidates.overhead(x / options) + self.candidates.durations[x % options])
        };
        self.candidates.set_up_time(&self.used(counts)) + (0..counts.len()).map(of_atom).sum::<f64>()
    }

    fn is_within(&self, counts: &[u32]) -> bool {
        let options = self.options();
        let few = |c: &[u32]| c.iter().map(|n| *n as usize).sum::<usize>() <= self.candidates.repeats;
        counts.chunks(options).all(few) && self.time_of(counts) <= self.time + 1e-9
    }
}
