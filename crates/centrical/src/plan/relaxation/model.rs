//! A quadratic model of the smooth criterion in the atoms that matter, and its optimum by exchange of time between pairs of
//! candidates.

use nalgebra::DMatrix;

use super::curvature::{add_curvature, add_norm, slope};
use super::point::{Objective, Point};
use super::polytope::Polytope;

/// Atoms in a quadratic model: those that are farthest from where they should be, and those nearest to their price.
const FARTHEST: usize = 150;
const NEAREST: usize = 60;

/// An inner problem is solved when no exchange gains this part of the distance to the bound any more.
const INNER: f64 = 0.03;

/// Fewer visits than this count as zero.
const NOTHING: f64 = 1e-9;

/// A quadratic model of the smooth criterion in the atoms that matter.
pub(super) struct Model<'a> {
    polytope: &'a Polytope,
    /// Their numbers, by candidate.
    active: Vec<usize>,
    /// Ranges of `active` of one candidate each.
    groups: Vec<std::ops::Range<usize>>,
    hessian: DMatrix<f64>,
    /// Fall of the model by each atom.
    benefit: Vec<f64>,
    w: Vec<f64>,
    spent: f64,
    /// Least gain of an exchange for a second of time.
    least: f64,
}

impl<'a> Model<'a> {
    /// The model at the point of the design `w`, which is `gap` above its bound.
    pub fn new(objective: &Objective<'a>, point: &Point, gap: f64, w: &[f64]) -> Self {
        let Objective { scenarios, polytope, exponent } = *objective;
        let atoms = polytope.atoms;
        let active = Worth { polytope, point, w }.chosen();
        let mut groups = Vec::new();
        let mut candidates = Vec::new();
        let mut first = 0;
        for same in active.chunk_by(|a, b| atoms.at(*a).candidate == atoms.at(*b).candidate) {
            groups.push(first..first + same.len());
            candidates.push(atoms.at(same[0]).candidate);
            first += same.len();
        }
        let n = active.len();
        let mut hessian = DMatrix::zeros(n, n);
        let mut slopes = DMatrix::zeros(n, point.scenarios.len());
        for (s, at) in point.scenarios.iter().enumerate().filter(|(_, at)| at.part > 1e-12) {
            add_curvature(&mut hessian, at, exponent, (&active, &groups, &candidates));
            if scenarios.is_worst() {
                slopes.set_column(s, &slope(at, &active, atoms));
            }
        }
        if scenarios.is_worst() {
            let parts: Vec<f64> = point.scenarios.iter().map(|at| at.part).collect();
            add_norm(&mut hessian, &slopes, &parts, exponent);
        }
        // A trace of a ridge makes parallel atoms no flat direction.
        let ridge = 1e-9 * hessian.diagonal().iter().copied().fold(0.0, f64::max);
        (0..n).for_each(|i| hessian[(i, i)] += ridge);
        let benefit = active.iter().map(|&x| point.sensitivity[x]).collect();
        let least = (INNER * gap / polytope.time).max(1e-9 * point.lambda);
        Self { polytope, active, groups, hessian, benefit, spent: polytope.spent(w), w: w.to_vec(), least }
    }

    /// The optimum of the model by exchange of time between the candidate that gains most by more of it and the one that
    /// loses least by less.
    pub fn optimum(mut self) -> Vec<f64> {
        let limit = 20 * self.active.len() + 200;
        for _ in 0..limit {
            let (up, down) = self.steepest();
            let Some(up) = up else { break };
            let slack = self.polytope.time - self.spent;
            let idle = slack > 1e-9 * self.polytope.time;
            let Some(down) = down.filter(|_| !idle) else {
                if up.rate <= 0.0 || !idle || !self.shift(&[(up, 1.0)], up.rate, slack) {
                    break;
                }
                continue;
            };
            let gain = up.rate - down.rate;
            if gain <= self.least || !self.shift(&[(up, 1.0), (down, -1.0)], gain, f64::INFINITY) {
                break;
            }
        }
        self.w
    }

    /// The conversions of part of a visit that gain most for a second more, and lose least for a second less.
    fn steepest(&self) -> (Option<Conversion>, Option<Conversion>) {
        let (mut up, mut down): (Option<Conversion>, Option<Conversion>) = (None, None);
        for group in &self.groups {
            let candidate = self.candidate(group.start);
            let all: f64 = self.polytope.atoms.of(candidate).map(|x| self.w[x]).sum();
            let can_leave = |i: usize| self.w[self.active[i]] - self.polytope.low[self.active[i]] > NOTHING;
            let can_enter = |i: usize| self.polytope.high[self.active[i]] - self.w[self.active[i]] > NOTHING;
            let idle = self.polytope.most[candidate] - all > NOTHING;
            let ends = || group.clone().map(Some).chain([None]);
            for from in ends().filter(|from| from.map_or(idle, can_leave)) {
                for to in ends().filter(|to| *to != from && to.is_none_or(can_enter)) {
                    let time = self.price(to) - self.price(from);
                    let conversion = Conversion { from, to, time, rate: (self.worth(to) - self.worth(from)) / time };
                    if time > 0.0 && up.is_none_or(|best| conversion.rate > best.rate) {
                        up = Some(conversion);
                    } else if time < 0.0 && down.is_none_or(|best| conversion.rate < best.rate) {
                        down = Some(conversion);
                    }
                }
            }
        }
        (up, down)
    }

    fn candidate(&self, i: usize) -> usize {
        self.polytope.atoms.at(self.active[i]).candidate
    }

    fn price(&self, end: Option<usize>) -> f64 {
        end.map_or(0.0, |i| self.polytope.price[self.active[i]])
    }

    fn worth(&self, end: Option<usize>) -> f64 {
        end.map_or(0.0, |i| self.benefit[i])
    }

    /// Moves time into the conversions (with +1 and -1) as far as the model falls and the bounds allow; whether it moved.
    fn shift(&mut self, conversions: &[(Conversion, f64)], gain: f64, most: f64) -> bool {
        let mut direction: Vec<(usize, f64)> = Vec::with_capacity(4);
        let mut add = |i: usize, part: f64| match direction.iter_mut().find(|(known, _)| *known == i) {
            Some((_, sum)) => *sum += part,
            None => direction.push((i, part)),
        };
        let mut idle: Vec<(usize, f64)> = Vec::with_capacity(2);
        for (conversion, sign) in conversions {
            // Visits for a second of time.
            let part = sign / conversion.time;
            conversion.to.into_iter().for_each(|i| add(i, part));
            conversion.from.into_iter().for_each(|i| add(i, -part));
            let inside = conversion.to.or(conversion.from).map_or(0, |i| self.candidate(i));
            let net =
                part * (f64::from(u8::from(conversion.to.is_some())) - f64::from(u8::from(conversion.from.is_some())));
            match idle.iter_mut().find(|(c, _)| *c == inside) {
                Some((_, sum)) => *sum += net,
                None => idle.push((inside, net)),
            }
        }
        let mut limit = most;
        for &(i, rate) in &direction {
            let x = self.active[i];
            let room = if rate > 0.0 { self.polytope.high[x] - self.w[x] } else { self.w[x] - self.polytope.low[x] };
            if rate != 0.0 {
                limit = limit.min(room / rate.abs());
            }
        }
        for (c, rate) in idle.into_iter().filter(|(_, rate)| *rate > 0.0) {
            let all: f64 = self.polytope.atoms.of(c).map(|x| self.w[x]).sum();
            limit = limit.min((self.polytope.most[c] - all) / rate);
        }
        let mut curvature = 0.0;
        for &(i, a) in &direction {
            curvature += direction.iter().map(|&(j, b)| a * b * self.hessian[(i, j)]).sum::<f64>();
        }
        let step = if curvature > 0.0 { (gain / curvature).min(limit) } else { limit };
        if !(step > 0.0 && step.is_finite()) {
            return false;
        }
        for &(i, rate) in &direction {
            self.w[self.active[i]] += step * rate;
            self.spent += step * rate * self.polytope.price[self.active[i]];
            for (benefit, h) in self.benefit.iter_mut().zip(self.hessian.column(i).iter()) {
                *benefit -= step * rate * h;
            }
        }
        true
    }
}

/// The worth of atoms at the price of time.
struct Worth<'a> {
    polytope: &'a Polytope,
    point: &'a Point<'a>,
    w: &'a [f64],
}

impl Worth<'_> {
    fn price(&self, x: usize) -> f64 {
        (self.point.lambda * self.polytope.price[x]).max(1e-300)
    }

    fn net(&self, x: usize) -> f64 {
        self.point.sensitivity[x] - self.price(x)
    }

    /// Visits of a candidate that are not used.
    fn idle(&self, candidate: usize) -> f64 {
        self.polytope.most[candidate] - self.polytope.atoms.of(candidate).map(|y| self.w[y]).sum::<f64>()
    }

    /// By how much the criterion would fall if the atom went where its worth and its bounds draw it.
    fn distance(&self, x: usize) -> f64 {
        let net = self.net(x);
        let candidate = self.polytope.atoms.at(x).candidate;
        // A better duration of the same candidate draws as well, however few visits are left.
        let dearest = self.polytope.atoms.of(candidate).filter(|&y| self.w[y] > NOTHING).map(|y| self.net(y));
        let displaced = dearest.fold(f64::INFINITY, f64::min);
        if net > 0.0 {
            let room = self.polytope.high[x] - self.w[x];
            let gain = net * room.min(self.idle(candidate).max(0.0));
            if displaced < net { gain.max((net - displaced) * room) } else { gain }
        } else {
            -net * (self.w[x] - self.polytope.low[x])
        }
    }

    /// The atoms of a model, rising.
    fn chosen(&self) -> Vec<usize> {
        let free = (0..self.w.len()).filter(|&x| self.polytope.high[x] > self.polytope.low[x]);
        let mut far: Vec<(f64, usize)> = free.map(|x| (self.distance(x), x)).collect();
        far.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut near = far.split_off(far.len().min(FARTHEST));
        for (order, x) in &mut near {
            *order = self.net(*x).abs() / self.price(*x);
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(NEAREST);
        // Visits of another duration that an atom would displace have to be free to go.
        let with_displaced = |x: usize| {
            let candidate = self.polytope.atoms.at(x).candidate;
            let is_full = self.idle(candidate) < NOTHING;
            let is_displaced = move |y: usize| is_full && self.w[y] > self.polytope.low[y] + NOTHING;
            self.polytope.atoms.of(candidate).filter(move |y| *y == x || is_displaced(*y))
        };
        let mut chosen: Vec<usize> = far.into_iter().chain(near).flat_map(|(_, x)| with_displaced(x)).collect();
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }
}

/// Part of a visit of a candidate turned from one duration, or none, to another, or none.
#[derive(Debug, Clone, Copy)]
struct Conversion {
    from: Option<usize>,
    to: Option<usize>,
    /// Time that a whole visit would take more [s]; negative if less.
    time: f64,
    /// Fall of the criterion for a second.
    rate: f64,
}
