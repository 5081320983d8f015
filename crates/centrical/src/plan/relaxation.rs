//! The continuous design: visits in any parts, within bounds, for the time there is.
//!
//! With `w_x` visits of atom `x` at the price `tau_x`, the logarithm of every criterion here is convex on the polytope
//! `lo <= w <= hi`, a limited number of visits of each candidate, `sum tau w <= time`. Its normalised
//! sensitivities `g_x` (`sum w g + g_0 = 1`, `g_0` that of the priors) give the bound of the equivalence theorem (Kiefer
//! and Wolfowitz 1960; for bounded measures Wynn 1982): no design of the polytope has a criterion below
//!
//! `Phi / (g_0 + max over the polytope of sum g w)`,
//!
//! since `Phi` is homogeneous of degree -1 and convex in `M`. For linear criteria this follows from Cauchy and Schwarz,
//! for determinants from the tangent plane, for several scenarios from Jensen. The worst of several goals follows by
//! the linear criterion of their weights, the worst of several scenarios by their mean with any weights. The maximum is
//! a linear programme over a knapsack, bounded from above by any Lagrange multiplier.
//!
//! The optimum is sought by multiplicative steps, which gather the candidates that matter, and then by sequential quadratic
//! programming, whose inner problems are solved by exchange of time between pairs of candidates. Of many candidates a part is
//! searched, which grows by those that the bound over all of them asks for ([`part`]).

mod curvature;
mod model;
mod part;
mod point;
mod polytope;

use self::model::Model;
pub(super) use self::part::FEW;
use self::part::Part;
use self::point::{Objective, Point};
pub(super) use self::polytope::Polytope;
use super::information::Factor;
use super::scenarios::LinearisedScenarios;
use crate::progress::Watch;

/// Multiplicative steps at the start.
const MULTIPLICATIVE: usize = 15;

/// A start whose logarithm is farther than this from its bound is left for a new one.
const FAR: f64 = 1.0;

/// Limit of quadratic models for each exponent.
const MODELS: usize = 25;

/// Order of the last norm that stands for a maximum over goals or scenarios.
const LAST_NORM: f64 = 128.0;

/// Limit of the parts of many candidates that are searched one after the other.
const PARTS: usize = 8;

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
    /// Whether a design of this value suffices: its bound is known, or is enough, or cannot become enough and is nearly known.
    fn is_met(&self, value: f64, bound: f64) -> bool {
        let left = value - bound;
        bound >= self.enough || left <= self.tolerance || (value < self.enough && left <= self.loose)
    }

    /// To `tolerance`, whatever the optimum is.
    pub fn of(tolerance: f64) -> Self {
        Self { tolerance, loose: tolerance, enough: f64::INFINITY }
    }
}

/// A continuous design and how far it can be from the optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Visits by atom: candidate by candidate, with each of the durations.
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

    /// This design, or `visits` whose criterion has the logarithm `value` if that is lower: among thousands of candidates the
    /// search may end above a schedule in whole visits.
    pub(super) fn or_better(self, visits: Vec<f64>, value: f64) -> Self {
        if value < self.value { Self { visits, value, ..self } } else { self }
    }
}

/// Seeks the optimum of `polytope` from `start` until it is known as well as `precision` asks, or the search is stopped.
pub(super) fn relax(
    watch: &Watch,
    scenarios: &LinearisedScenarios,
    polytope: &Polytope,
    start: Option<&[f64]>,
    precision: Precision,
) -> Relaxed {
    match Part::first(polytope, start) {
        Some(part) => relax_by_parts(watch, scenarios, polytope, part, start, precision),
        None => relax_all(watch, scenarios, polytope, start, precision),
    }
}

/// The optimum of a part of the candidates, and again with those that the bound over all of them asks for.
fn relax_by_parts(
    watch: &Watch,
    scenarios: &LinearisedScenarios,
    polytope: &Polytope,
    mut part: Part,
    start: Option<&[f64]>,
    precision: Precision,
) -> Relaxed {
    let of_all = Objective { scenarios, polytope, exponent: if scenarios.has_norm() { LAST_NORM } else { 1.0 } };
    let atoms = polytope.atoms;
    let visits = start.map_or_else(|| polytope.spread(), <[f64]>::to_vec);
    let mut best = Relaxed { visits, value: f64::INFINITY, bound: f64::NEG_INFINITY, models: 0 };
    for _ in 0..PARTS {
        let start = part.of_atoms(&best.visits, atoms);
        let (of_scenarios, of_polytope) = (part.of_scenarios(scenarios, atoms), part.of_polytope(polytope));
        let found = relax_all(watch, &of_scenarios, &of_polytope, Some(&start), precision);
        let visits = part.among_all(&found.visits, atoms);
        let point = of_all.point(of_all.factors(&visits));
        let bound = best.bound.max(point.bound).min(found.value);
        best = Relaxed { visits, value: found.value, bound, models: best.models + found.models };
        if precision.is_met(best.value, bound) || watch.is_stopped() || !part.grow(polytope, &point) {
            break;
        }
    }
    best
}

/// The same among all candidates at once.
fn relax_all(
    watch: &Watch,
    scenarios: &LinearisedScenarios,
    polytope: &Polytope,
    start: Option<&[f64]>,
    precision: Precision,
) -> Relaxed {
    let has_norm = scenarios.has_norm();
    let objective = Objective { scenarios, polytope, exponent: if has_norm { 4.0 } else { 1.0 } };
    let mut search = Search { objective, best: f64::NEG_INFINITY, models: 0, precision, watch };
    let mut w = polytope.within(&start.map_or_else(|| polytope.spread(), <[f64]>::to_vec));
    if start.is_none_or(|_| search.is_far(&w)) {
        w = polytope.within(&polytope.spread());
        w = search.gather(w);
    }
    let exponents: &[f64] = if has_norm { &[8.0, 32.0, LAST_NORM] } else { &[1.0] };
    for &exponent in exponents {
        search.objective.exponent = exponent;
        w = search.refine(w);
    }
    let value = scenarios.value(&search.objective.factors(&w));
    Relaxed { visits: w, value, bound: search.best.min(value), models: search.models }
}

struct Search<'a> {
    objective: Objective<'a>,
    /// Best lower bound so far.
    best: f64,
    models: usize,
    precision: Precision,
    watch: &'a Watch<'a>,
}

impl<'a> Search<'a> {
    /// The point of a design, whose bound is kept if it is the best.
    fn look(&mut self, factors: Vec<Factor>) -> Point<'a> {
        let point = self.objective.point(factors);
        self.best = self.best.max(point.bound);
        point
    }

    /// Whether a design is too far from the optimum for quadratic models of the logarithm, like one that has just lost the only
    /// mounting that determines a parameter.
    fn is_far(&mut self, w: &[f64]) -> bool {
        let point = self.look(self.objective.factors(w));
        point.value - self.best > FAR && !self.is_done(point.value)
    }

    /// Whether to end: the design suffices, or the caller stops.
    fn is_done(&self, value: f64) -> bool {
        self.precision.is_met(value, self.best) || self.watch.is_stopped()
    }

    /// Multiplicative steps `w_x (g_x / lambda tau_x)^e`, from a spread design.
    fn gather(&mut self, mut w: Vec<f64>) -> Vec<f64> {
        let power = if self.objective.exponent > 1.0 { 0.25 } else { 0.7 };
        for _ in 0..MULTIPLICATIVE {
            let point = self.look(self.objective.factors(&w));
            if self.is_done(point.value) {
                break;
            }
            let lambda = point.lambda.max(1e-300);
            let polytope = self.objective.polytope;
            let grown: Vec<f64> = (0..w.len())
                .map(|x| w[x] * (point.sensitivity[x] / (lambda * polytope.price[x].max(1e-9))).powf(power))
                .map(|w| if w < 1e-5 { 0.0 } else { w })
                .collect();
            w = polytope.filled(&grown);
        }
        w
    }

    /// Quadratic models and steps along their optima until nothing is gained.
    fn refine(&mut self, mut w: Vec<f64>) -> Vec<f64> {
        let mut factors = self.objective.factors(&w);
        for _ in 0..MODELS {
            let point = self.look(factors);
            if self.is_done(point.value) {
                break;
            }
            self.models += 1;
            let gap = (point.value - self.best).max(0.0);
            let target = Model::new(&self.objective, &point, gap, &w).optimum();
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
            let factors = self.objective.factors(&next);
            if self.objective.value(&factors) < value - 1e-9 {
                return Some((next, factors));
            }
        }
        None
    }
}
