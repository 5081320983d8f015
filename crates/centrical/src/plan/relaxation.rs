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
//! Jensen, the worst of them by their mean with any weights. The maximum is a linear programme over a knapsack, bounded from above by any Lagrange multiplier.
//!
//! The optimum is sought by multiplicative steps, which bring together the plateaus that matter, and then by sequential
//! quadratic programming whose inner problems are solved by exchange of time between pairs of plateaus.

mod curvature;
mod model;
mod polytope;

use self::model::Model;
pub(super) use self::polytope::Polytope;
use super::information::{Factor, Scene, Smooth, sum_of, trace_of_product};
use super::robustness::Scenes;

/// Weights below this are none.
const NOTHING: f64 = 1e-9;

/// Multiplicative steps at the start.
const MULTIPLICATIVE: usize = 15;

/// A start whose logarithm is farther than this from its bound is left for a new one.
const FAR: f64 = 1.0;

/// Quadratic models made at most, for each exponent.
const MODELS: usize = 25;

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

/// The scenes at one design.
struct Point {
    factors: Vec<Factor>,
    smooth: Vec<Smooth>,
    /// Parts of the scenes, which sum to 1.
    parts: Vec<f64>,
    /// Logarithm of the smooth criterion over all scenes.
    value: f64,
    /// By atom.
    sensitivity: Vec<f64>,
}

/// Seeks the optimum of `polytope` from `start` until it is known as well as `precision` asks.
pub(super) fn relax(scenes: &Scenes, polytope: &Polytope, start: Option<&[f64]>, precision: Precision) -> Relaxed {
    let mut search = Search { scenes, polytope, best: f64::NEG_INFINITY, models: 0, exponent: 1.0, precision };
    let has_norm = scenes.has_norm();
    let mut w = polytope.within(&start.map_or_else(|| search.spread(), <[f64]>::to_vec));
    search.exponent = if has_norm { 4.0 } else { 1.0 };
    if start.is_none_or(|_| search.is_far(&w)) {
        w = polytope.within(&search.spread());
        w = search.gather(w);
    }
    let exponents: &[f64] = if has_norm { &[8.0, 32.0, 128.0] } else { &[1.0] };
    for &exponent in exponents {
        search.exponent = exponent;
        w = search.refine(w);
    }
    let value = search.true_value(&w);
    Relaxed { visits: w, value, bound: search.best.min(value), models: search.models }
}

struct Search<'a> {
    scenes: &'a Scenes,
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
        self.scenes.all.iter().map(factor).collect()
    }

    fn true_value(&self, w: &[f64]) -> f64 {
        self.scenes.value(&self.factors(w))
    }

    fn value(&self, factors: &[Factor]) -> f64 {
        let of = |(scene, factor): (&Scene, &Factor)| scene.smooth(factor, self.exponent).value;
        let logs: Vec<f64> = self.scenes.all.iter().zip(factors).map(of).collect();
        self.scenes.smooth(&logs, self.exponent).0
    }

    /// The sensitivities at `w`, and the bound that they give.
    fn look(&mut self, factors: Vec<Factor>) -> (Point, f64) {
        let options = self.polytope.options;
        let mut sensitivity = vec![0.0; self.polytope.price.len()];
        let (mut support, mut of_priors) = (0.0, 0.0);
        let smooth = self.scenes.all.iter().zip(&factors).map(|(scene, factor)| scene.smooth(factor, self.exponent));
        let smooth: Vec<Smooth> = smooth.collect();
        let logs: Vec<f64> = smooth.iter().map(|of_scene| of_scene.value).collect();
        let (value, parts) = self.scenes.smooth(&logs, self.exponent);
        for (((scene, factor), here), part) in self.scenes.all.iter().zip(&factors).zip(&smooth).zip(&parts) {
            for c in (0..self.polytope.plateaus()).filter(|&c| self.is_open(c)) {
                let g = Scene::weighed(&scene.response(factor, c), &here.columns);
                for x in c * options..(c + 1) * options {
                    sensitivity[x] += part * trace_of_product(scene.precision(x), &g);
                }
            }
            support += part * here.support;
            of_priors += part * scene.prior_part(factor, &here.columns);
        }
        let (most, lambda) = self.polytope.most(&sensitivity);
        self.best = self.best.max(support - (of_priors + most).ln());
        (Point { factors, smooth, parts, value, sensitivity }, lambda)
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
