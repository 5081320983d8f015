//! The bounds within which a design is sought: least and most visits of each atom, most visits of each candidate, time.

use crate::plan::atom::Atoms;

/// Halvings of a Lagrange multiplier: any is a bound, these make it tight to a part in a million.
const HALVINGS: usize = 36;

/// The bounds within which a design is sought.
#[derive(Debug, Clone)]
pub(in crate::plan) struct Polytope {
    /// Price of a visit of each atom [s].
    pub price: Vec<f64>,
    /// Time there is [s].
    pub time: f64,
    /// Least and most visits of each atom.
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    /// The atoms.
    pub atoms: Atoms,
    /// Most visits of each candidate.
    pub most: Vec<f64>,
}

impl Polytope {
    /// Whether a candidate may be visited.
    pub fn is_open(&self, candidate: usize) -> bool {
        self.atoms.of(candidate).any(|x| self.high[x] > 0.0)
    }

    /// Time that a design takes [s].
    pub fn spent(&self, w: &[f64]) -> f64 {
        w.iter().zip(&self.price).map(|(w, price)| w * price).sum()
    }

    /// Whether there is a design at all.
    pub fn is_feasible(&self) -> bool {
        self.spent(&self.low) <= self.time * (1.0 + 1e-12)
            && (0..self.atoms.candidates).all(|c| self.low[self.atoms.of(c)].iter().sum::<f64>() <= self.most[c])
    }

    /// An upper bound of `sum gain w` over the polytope, tight but for rounding, and its multiplier.
    pub fn greatest(&self, gain: &[f64]) -> (f64, f64) {
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
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(self.atoms.durations);
        for c in 0..self.atoms.candidates {
            let mut left = self.most[c];
            best.clear();
            for x in self.atoms.of(c) {
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
    pub fn within(&self, w: &[f64]) -> Vec<f64> {
        let mut w: Vec<f64> = (0..w.len()).map(|x| w[x].clamp(self.low[x], self.high[x])).collect();
        for c in 0..self.atoms.candidates {
            let atoms = self.atoms.of(c);
            let (sum, low): (f64, f64) = (w[atoms.clone()].iter().sum(), self.low[atoms.clone()].iter().sum());
            if sum > self.most[c] {
                let part = ((self.most[c] - low) / (sum - low)).max(0.0);
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

    /// Every atom that may be visited for the same part of the time.
    pub fn spread(&self) -> Vec<f64> {
        let room = |x: usize| (self.high[x] - self.low[x]).min(self.most[self.atoms.at(x).candidate]);
        let all: f64 = (0..self.price.len()).map(|x| room(x) * self.price[x]).sum();
        let part = ((self.time - self.spent(&self.low)) / all).min(1.0);
        (0..self.price.len()).map(|x| self.low[x] + part * room(x)).collect()
    }

    /// `w` times the factor that spends all the time, within the bounds.
    pub fn filled(&self, w: &[f64]) -> Vec<f64> {
        let scaled = |factor: f64| -> Vec<f64> { w.iter().map(|w| w * factor).collect() };
        let unbounded = Self { time: f64::INFINITY, ..self.clone() };
        let (mut below, mut above) = (0.0, 64.0);
        for _ in 0..40 {
            let middle = 0.5 * (below + above);
            let spent = self.spent(&unbounded.within(&scaled(middle)));
            if spent > self.time { above = middle } else { below = middle }
        }
        self.within(&unbounded.within(&scaled(below)))
    }
}
