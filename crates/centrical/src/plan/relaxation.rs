//! The continuous design: visits in any parts, within bounds, for the time there is.
//!
//! With `w_x` visits of atom `x` (a plateau for a duration) at the price `tau_x`, the logarithm of every criterion here is
//! convex on the polytope `lo <= w <= hi`, at most so many visits a plateau, `sum tau w <= time`. Its normalised
//! sensitivities `g_x` (`sum w g + g_0 = 1`, `g_0` that of the priors) give the bound of the equivalence theorem (Kiefer
//! and Wolfowitz 1960; for bounded measures Wynn 1982): no design of the polytope has a criterion below
//!
//! `Phi / (g_0 + max over the polytope of sum g w)`,
//!
//! since `Phi` is homogeneous of degree -1 and convex in `M`: for linear criteria by Cauchy and Schwarz, for determinants by
//! the tangent plane, for the worst of several goals by the linear criterion of their weights, for several scenarios by
//! Jensen. The maximum is a linear programme over a knapsack, bounded from above by any Lagrange multiplier.
//!
//! The optimum is sought by multiplicative steps, which bring together the plateaus that matter, and then by sequential
//! quadratic programming whose inner problems are solved by exchange of time between pairs of plateaus.

use nalgebra::{DMatrix, Matrix3};

use super::information::{Factor, Scene, Smooth, sum_of, trace_of_product};

/// Weights below this are none.
const NOTHING: f64 = 1e-9;

/// Multiplicative steps at the start.
const MULTIPLICATIVE: usize = 15;

/// Halvings of a Lagrange multiplier: any is a bound, these make it tight to a part in a million.
const HALVINGS: usize = 36;

/// A start whose logarithm is farther than this from its bound is left for a new one.
const FAR: f64 = 1.0;

/// Atoms in a quadratic model: those that are farthest from where they should be, and those nearest to their price.
const FARTHEST: usize = 150;
const NEAREST: usize = 60;

/// An inner problem is solved when no exchange gains this part of the distance to the bound any more.
const INNER: f64 = 0.03;

/// Quadratic models made at most, for each exponent.
const MODELS: usize = 25;

/// The bounds within which a design is sought.
#[derive(Debug, Clone)]
pub(super) struct Polytope {
    /// Price of a visit of each atom [s].
    pub price: Vec<f64>,
    /// Time there is [s].
    pub time: f64,
    /// Least and most visits of each atom.
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    /// Durations to a plateau.
    pub options: usize,
    /// Most visits of a plateau.
    pub repeats: f64,
}

/// How well an optimum has to be known, in the logarithm of the criterion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Precision {
    /// Distance of a design from its bound that will do.
    pub tolerance: f64,
    /// Distance that will do where the optimum lies below `enough`.
    pub loose: f64,
    /// A bound that will do, however far the design is from it.
    pub enough: f64,
}

impl Precision {
    /// To `tolerance`, whatever the optimum is.
    pub fn of(tolerance: f64) -> Self {
        Self { tolerance, loose: tolerance, enough: f64::INFINITY }
    }
}

/// A continuous design and how far it can be from the optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Visits by atom: plateau times the number of durations, plus the duration.
    pub visits: Vec<f64>,
    /// Logarithm of the criterion (variance units).
    pub value: f64,
    /// No design within the bounds has a lower logarithm of the criterion.
    pub bound: f64,
    /// Quadratic models made.
    pub models: usize,
}

impl Relaxed {
    /// Part of the criterion (variance units) by which the design may be above the optimum.
    pub fn gap(&self) -> f64 {
        (self.value - self.bound).exp() - 1.0
    }
}

impl Polytope {
    fn plateaus(&self) -> usize {
        self.price.len() / self.options
    }

    fn atoms_of(&self, plateau: usize) -> std::ops::Range<usize> {
        plateau * self.options..(plateau + 1) * self.options
    }

    /// Time that a design takes [s].
    pub fn spent(&self, w: &[f64]) -> f64 {
        w.iter().zip(&self.price).map(|(w, price)| w * price).sum()
    }

    /// Whether there is a design at all.
    pub fn is_feasible(&self) -> bool {
        self.spent(&self.low) <= self.time * (1.0 + 1e-12)
            && (0..self.plateaus()).all(|c| self.low[self.atoms_of(c)].iter().sum::<f64>() <= self.repeats)
    }

    /// An upper bound of `sum gain w` over the polytope, tight but for rounding, and its multiplier.
    fn most(&self, gain: &[f64]) -> (f64, f64) {
        let steepest = gain.iter().zip(&self.price).map(|(g, t)| g / t.max(1e-9)).fold(0.0, f64::max);
        let (mut below, mut above) = (0.0, steepest);
        let mut best = self.lagrangian(gain, 0.0).0.min(self.lagrangian(gain, steepest).0);
        let mut at = steepest;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (below + above);
            let (value, spent) = self.lagrangian(gain, middle);
            if value < best {
                (best, at) = (value, middle);
            }
            if spent > self.time { below = middle } else { above = middle }
        }
        (best, at)
    }

    /// `lambda time + max over the bounds without the time of sum (gain - lambda price) w`, and the time of the maximum.
    fn lagrangian(&self, gain: &[f64], lambda: f64) -> (f64, f64) {
        let (mut value, mut spent) = (lambda * self.time, 0.0);
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(self.options);
        for c in 0..self.plateaus() {
            let mut left = self.repeats;
            best.clear();
            for x in self.atoms_of(c) {
                let worth = gain[x] - lambda * self.price[x];
                value += worth * self.low[x];
                spent += self.price[x] * self.low[x];
                left -= self.low[x];
                if worth > 0.0 && self.high[x] > self.low[x] {
                    best.push((worth, x));
                }
            }
            best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            for &(worth, x) in &best {
                let part = left.min(self.high[x] - self.low[x]).max(0.0);
                value += worth * part;
                spent += self.price[x] * part;
                left -= part;
            }
        }
        (value, spent)
    }

    /// `w` brought within the bounds and the time: clipped, then what is above the least visits scaled down.
    fn within(&self, w: &[f64]) -> Vec<f64> {
        let mut w: Vec<f64> = (0..w.len()).map(|x| w[x].clamp(self.low[x], self.high[x])).collect();
        for c in 0..self.plateaus() {
            let atoms = self.atoms_of(c);
            let (sum, low): (f64, f64) = (w[atoms.clone()].iter().sum(), self.low[atoms.clone()].iter().sum());
            if sum > self.repeats {
                let part = ((self.repeats - low) / (sum - low)).max(0.0);
                atoms.for_each(|x| w[x] = self.low[x] + part * (w[x] - self.low[x]));
            }
        }
        let (spent, least) = (self.spent(&w), self.spent(&self.low));
        if spent > self.time {
            let part = ((self.time - least) / (spent - least)).max(0.0);
            (0..w.len()).for_each(|x| w[x] = self.low[x] + part * (w[x] - self.low[x]));
        }
        w
    }
}

/// The scenes at one design.
struct Point {
    factors: Vec<Factor>,
    smooth: Vec<Smooth>,
    /// Logarithm of the smooth criterion over all scenes.
    value: f64,
    /// By atom.
    sensitivity: Vec<f64>,
}

/// Seeks the optimum of `polytope` from `start` until it is known as well as `precision` asks.
pub(super) fn relax(scenes: &[Scene], polytope: &Polytope, start: Option<&[f64]>, precision: Precision) -> Relaxed {
    let mut search = Search { scenes, polytope, best: f64::NEG_INFINITY, models: 0, exponent: 1.0, precision };
    let has_goals = scenes.iter().any(|scene| scene.goals() > 1);
    let mut w = polytope.within(&start.map_or_else(|| search.spread(), <[f64]>::to_vec));
    search.exponent = if has_goals { 4.0 } else { 1.0 };
    if start.is_none_or(|_| search.is_far(&w)) {
        w = polytope.within(&search.spread());
        w = search.gather(w);
    }
    let exponents: &[f64] = if has_goals { &[8.0, 32.0, 128.0] } else { &[1.0] };
    for &exponent in exponents {
        search.exponent = exponent;
        w = search.refine(w);
    }
    let value = search.true_value(&w);
    Relaxed { visits: w, value, bound: search.best.min(value), models: search.models }
}

struct Search<'a> {
    scenes: &'a [Scene],
    polytope: &'a Polytope,
    /// Best lower bound so far.
    best: f64,
    models: usize,
    exponent: f64,
    precision: Precision,
}

impl Search<'_> {
    /// Every atom that may be visited for the same part of the time.
    fn spread(&self) -> Vec<f64> {
        let polytope = self.polytope;
        let room = |x: usize| (polytope.high[x] - polytope.low[x]).min(polytope.repeats);
        let all: f64 = (0..polytope.price.len()).map(|x| room(x) * polytope.price[x]).sum();
        let part = ((polytope.time - polytope.spent(&polytope.low)) / all).min(1.0);
        (0..polytope.price.len()).map(|x| polytope.low[x] + part * room(x)).collect()
    }

    fn factors(&self, w: &[f64]) -> Vec<Factor> {
        let options = self.polytope.options;
        let factor = |scene: &Scene| {
            let information = (0..w.len() / options).filter_map(|c| {
                let atoms = c * options..(c + 1) * options;
                let visited = || atoms.clone().filter(|&x| w[x] > NOTHING);
                visited().next()?;
                Some((c, sum_of(visited().map(|x| scene.precision(x) * w[x]))))
            });
            scene.factor(&information.collect::<Vec<_>>())
        };
        self.scenes.iter().map(factor).collect()
    }

    fn true_value(&self, w: &[f64]) -> f64 {
        let factors = self.factors(w);
        self.scenes.iter().zip(&factors).map(|(scene, factor)| scene.weight * Scene::value(factor)).sum()
    }

    fn value(&self, factors: &[Factor]) -> f64 {
        let of = |(scene, factor): (&Scene, &Factor)| scene.weight * scene.smooth(factor, self.exponent).value;
        self.scenes.iter().zip(factors).map(of).sum()
    }

    /// The sensitivities at `w`, and the bound that they give.
    fn look(&mut self, factors: Vec<Factor>) -> (Point, f64) {
        let options = self.polytope.options;
        let mut sensitivity = vec![0.0; self.polytope.price.len()];
        let (mut value, mut support, mut of_priors) = (0.0, 0.0, 0.0);
        let mut smooth = Vec::with_capacity(self.scenes.len());
        for (scene, factor) in self.scenes.iter().zip(&factors) {
            let here = scene.smooth(factor, self.exponent);
            for c in (0..self.polytope.plateaus()).filter(|&c| self.is_open(c)) {
                let g = Scene::weighed(&scene.response(factor, c), &here.columns);
                for x in c * options..(c + 1) * options {
                    sensitivity[x] += scene.weight * trace_of_product(scene.precision(x), &g);
                }
            }
            value += scene.weight * here.value;
            support += scene.weight * here.support;
            of_priors += scene.weight * scene.prior_part(factor, &here.columns);
            smooth.push(here);
        }
        let (most, lambda) = self.polytope.most(&sensitivity);
        self.best = self.best.max(support - (of_priors + most).ln());
        (Point { factors, smooth, value, sensitivity }, lambda)
    }

    fn is_open(&self, plateau: usize) -> bool {
        self.polytope.atoms_of(plateau).any(|x| self.polytope.high[x] > 0.0)
    }

    /// Whether a design is too far from the optimum for quadratic models of the logarithm, as one is that has just lost the only
    /// mounting that determines a parameter.
    fn is_far(&mut self, w: &[f64]) -> bool {
        let factors = self.factors(w);
        let (point, _) = self.look(factors);
        point.value - self.best > FAR && !self.is_done(point.value)
    }

    /// Whether more would tell nothing: the bound is known, or is enough, or cannot become enough and is nearly known.
    fn is_done(&self, value: f64) -> bool {
        let left = value - self.best;
        let Precision { tolerance, loose, enough } = self.precision;
        self.best >= enough || left <= tolerance || (value < enough && left <= loose)
    }

    /// Multiplicative steps `w_x (g_x / lambda tau_x)^e`, from a spread design.
    fn gather(&mut self, mut w: Vec<f64>) -> Vec<f64> {
        let power = if self.exponent > 1.0 { 0.25 } else { 0.7 };
        for _ in 0..MULTIPLICATIVE {
            let factors = self.factors(&w);
            let (point, lambda) = self.look(factors);
            if self.is_done(point.value) {
                break;
            }
            let lambda = lambda.max(1e-300);
            let grown: Vec<f64> = (0..w.len())
                .map(|x| w[x] * (point.sensitivity[x] / (lambda * self.polytope.price[x].max(1e-9))).powf(power))
                .map(|w| if w < 1e-5 { 0.0 } else { w })
                .collect();
            w = self.filled(&grown);
        }
        w
    }

    /// `w` times the factor that spends all the time, within the bounds.
    fn filled(&self, w: &[f64]) -> Vec<f64> {
        let scaled = |factor: f64| -> Vec<f64> { w.iter().map(|w| w * factor).collect() };
        let unbounded = Polytope { time: f64::INFINITY, ..self.polytope.clone() };
        let (mut below, mut above) = (0.0, 64.0);
        for _ in 0..40 {
            let middle = 0.5 * (below + above);
            let spent = self.polytope.spent(&unbounded.within(&scaled(middle)));
            if spent > self.polytope.time { above = middle } else { below = middle }
        }
        self.polytope.within(&unbounded.within(&scaled(below)))
    }

    /// Quadratic models and steps along their optima until nothing is gained.
    fn refine(&mut self, mut w: Vec<f64>) -> Vec<f64> {
        let mut factors = self.factors(&w);
        for _ in 0..MODELS {
            let (point, lambda) = self.look(factors);
            if self.is_done(point.value) {
                break;
            }
            self.models += 1;
            let target = Model::new(self, &point, lambda, &w).optimum();
            match self.descend(&w, &target, point.value) {
                Some((next, at)) => (w, factors) = (next, at),
                None => break,
            }
        }
        w
    }

    fn descend(&self, w: &[f64], target: &[f64], value: f64) -> Option<(Vec<f64>, Vec<Factor>)> {
        for halvings in 0..12 {
            let part = 0.5_f64.powi(halvings);
            let next: Vec<f64> = w.iter().zip(target).map(|(from, to)| from + part * (to - from)).collect();
            let factors = self.factors(&next);
            if self.value(&factors) < value - 1e-9 {
                return Some((next, factors));
            }
        }
        None
    }
}

/// A quadratic model of the smooth criterion in the atoms that matter.
struct Model<'a> {
    polytope: &'a Polytope,
    /// The atoms, by plateau.
    active: Vec<usize>,
    /// Ranges of `active` that are one plateau's.
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
    fn new(search: &Search<'a>, point: &Point, lambda: f64, w: &[f64]) -> Self {
        let polytope = search.polytope;
        let options = polytope.options;
        let worth = Worth { polytope, sensitivity: &point.sensitivity, lambda, w };
        let active = worth.chosen();
        let mut groups = Vec::new();
        let mut plateaus = Vec::new();
        let mut first = 0;
        for same in active.chunk_by(|a, b| a / options == b / options) {
            groups.push(first..first + same.len());
            plateaus.push(same[0] / options);
            first += same.len();
        }
        let n = active.len();
        let mut hessian = DMatrix::zeros(n, n);
        for ((scene, factor), smooth) in search.scenes.iter().zip(&point.factors).zip(&point.smooth) {
            add_curvature(&mut hessian, scene, factor, smooth, search.exponent, (&active, &groups, &plateaus));
        }
        // A trace of a ridge makes parallel atoms no flat direction.
        let ridge = 1e-9 * hessian.diagonal().iter().copied().fold(0.0, f64::max);
        (0..n).for_each(|i| hessian[(i, i)] += ridge);
        let benefit = active.iter().map(|&x| point.sensitivity[x]).collect();
        let gap = (point.value - search.best).max(0.0);
        let least = (INNER * gap / polytope.time).max(1e-9 * lambda);
        Self { polytope, active, groups, hessian, benefit, spent: polytope.spent(w), w: w.to_vec(), least }
    }

    /// The optimum of the model by exchange of time between the plateau that gains most by more of it and the one that loses
    /// least by less.
    fn optimum(mut self) -> Vec<f64> {
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
            let all: f64 =
                self.polytope.atoms_of(self.active[group.start] / self.polytope.options).map(|x| self.w[x]).sum();
            let can_leave = |i: usize| self.w[self.active[i]] - self.polytope.low[self.active[i]] > NOTHING;
            let can_enter = |i: usize| self.polytope.high[self.active[i]] - self.w[self.active[i]] > NOTHING;
            let idle = self.polytope.repeats - all > NOTHING;
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
            let inside = conversion.to.or(conversion.from).map_or(0, |i| self.active[i] / self.polytope.options);
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
            let all: f64 = self.polytope.atoms_of(c).map(|x| self.w[x]).sum();
            limit = limit.min((self.polytope.repeats - all) / rate);
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

/// What atoms are worth at a price of time.
struct Worth<'a> {
    polytope: &'a Polytope,
    sensitivity: &'a [f64],
    lambda: f64,
    w: &'a [f64],
}

impl Worth<'_> {
    fn price(&self, x: usize) -> f64 {
        (self.lambda * self.polytope.price[x]).max(1e-300)
    }

    fn net(&self, x: usize) -> f64 {
        self.sensitivity[x] - self.price(x)
    }

    /// Visits of a plateau that are left.
    fn idle(&self, plateau: usize) -> f64 {
        self.polytope.repeats - self.polytope.atoms_of(plateau).map(|y| self.w[y]).sum::<f64>()
    }

    /// By how much the criterion would fall if the atom went where its worth and its bounds draw it.
    fn distance(&self, x: usize) -> f64 {
        let net = self.net(x);
        let plateau = x / self.polytope.options;
        // A better duration of the same plateau draws as well, however few visits are left.
        let dearest = self.polytope.atoms_of(plateau).filter(|&y| self.w[y] > NOTHING).map(|y| self.net(y));
        let displaced = dearest.fold(f64::INFINITY, f64::min);
        if net > 0.0 {
            let room = self.polytope.high[x] - self.w[x];
            let gain = net * room.min(self.idle(plateau).max(0.0));
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
            let plateau = x / self.polytope.options;
            let is_full = self.idle(plateau) < NOTHING;
            let is_displaced = move |y: usize| is_full && self.w[y] > self.polytope.low[y] + NOTHING;
            self.polytope.atoms_of(plateau).filter(move |y| *y == x || is_displaced(*y))
        };
        let mut chosen: Vec<usize> = far.into_iter().chain(near).flat_map(|(_, x)| with_displaced(x)).collect();
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }
}

/// Part of a visit of a plateau turned from one duration, or none, to another, or none.
#[derive(Debug, Clone, Copy)]
struct Conversion {
    from: Option<usize>,
    to: Option<usize>,
    /// Time that a whole visit would take more [s]; negative if less.
    time: f64,
    /// Fall of the criterion for a second.
    rate: f64,
}

/// Adds a scene's second derivatives: of a goal `2 tr(N A N' G')`, less `tr(N G N' G')` for a determinant, plus what the norm
/// over goals makes of the first derivatives, less the product of the sensitivities for the logarithm.
fn add_curvature(
    hessian: &mut DMatrix<f64>,
    scene: &Scene,
    factor: &Factor,
    smooth: &Smooth,
    exponent: f64,
    (active, groups, plateaus): (&[usize], &[std::ops::Range<usize>], &[usize]),
) {
    let views = scene.views(factor, plateaus);
    let a = views.transpose() * &views;
    let responses: Vec<_> = plateaus.iter().map(|&c| scene.response(factor, c)).collect();
    let m = smooth.columns.len();
    let mut roots = DMatrix::zeros(m, 3 * plateaus.len());
    for (n, response) in responses.iter().enumerate() {
        for (column, weight) in smooth.columns.iter().enumerate() {
            (0..3).for_each(|i| roots[(column, 3 * n + i)] = response[(i, column)] * weight.sqrt());
        }
    }
    let g = roots.transpose() * &roots;
    let by_goal = by_goal(scene, &responses, active, groups, factor);
    let block = |of: &DMatrix<f64>, i: usize, j: usize| of.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
    let s = m as f64;
    for i in 0..plateaus.len() {
        for j in 0..=i {
            let (a_ij, g_ij) = (block(&a, i, j), block(&g, i, j));
            let mixed = if scene.is_determinant() { 2.0 * a_ij - g_ij * s } else { 2.0 * a_ij };
            for k in groups[i].clone() {
                let left = scene.precision(active[k]) * mixed;
                for l in groups[j].clone().filter(|&l| l <= k) {
                    // tr(N_k X_ij N_l G_ji), G_ji = G_ij^T
                    let value = scene.weight * (left * scene.precision(active[l])).component_mul(&g_ij).sum();
                    hessian[(k, l)] += value;
                    if l != k {
                        hessian[(l, k)] += value;
                    }
                }
            }
        }
    }
    if !scene.is_determinant() {
        let total = &by_goal * nalgebra::DVector::from_column_slice(&smooth.parts);
        for (goal, part) in smooth.parts.iter().enumerate().filter(|(_, part)| **part > 1e-12) {
            let column = by_goal.column(goal);
            hessian.ger(scene.weight * (exponent - 1.0) * part, &column, &column, 1.0);
        }
        hessian.ger(-scene.weight * exponent, &total, &total, 1.0);
    }
}

/// `d ln r_j / d w_x` without its sign, active atoms by goals.
fn by_goal(
    scene: &Scene,
    responses: &[nalgebra::Matrix3xX<f64>],
    active: &[usize],
    groups: &[std::ops::Range<usize>],
    factor: &Factor,
) -> DMatrix<f64> {
    let mut by_goal = DMatrix::zeros(active.len(), scene.goals());
    if scene.is_determinant() {
        return by_goal;
    }
    for (group, response) in groups.iter().zip(responses) {
        let mut of_goal = vec![Matrix3::zeros(); scene.goals()];
        for (m, f) in response.column_iter().enumerate() {
            of_goal[scene.goal_of(m)] += f * f.transpose();
        }
        for k in group.clone() {
            for (goal, g) in of_goal.iter().enumerate() {
                by_goal[(k, goal)] = trace_of_product(scene.precision(active[k]), g) / factor.goals[goal];
            }
        }
    }
    by_goal
}
