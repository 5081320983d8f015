//! The bounds within which a design is sought: at least and at most so many visits, so many of a plateau, so much time, and
//! totals of visits of some sets of atoms between bounds of their own.

use std::sync::Arc;

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
    /// Durations to a plateau.
    pub options: usize,
    /// Most visits of a plateau.
    pub repeats: f64,
    /// Totals that are bounded.
    pub totals: Vec<Total>,
}

/// Bounds of the visits of a set of atoms together.
#[derive(Debug, Clone)]
pub(in crate::plan) struct Total {
    /// Rising.
    pub atoms: Arc<[usize]>,
    pub low: f64,
    pub high: f64,
}

/// Visits of a design in a set of atoms.
pub(in crate::plan) fn visits_in(atoms: &[usize], w: &[f64]) -> f64 {
    atoms.iter().map(|&x| w[x]).sum()
}

/// A design keeps a total to this.
const KEPT: f64 = 1e-4;

impl Polytope {
    pub fn plateaus(&self) -> usize {
        self.price.len() / self.options
    }

    pub fn atoms_of(&self, plateau: usize) -> std::ops::Range<usize> {
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
            && self.least_time().is_some_and(|least| least <= self.time * (1.0 + 1e-12))
    }

    /// Least time that the totals ask for [s], of sets any two of which hold one another or have nothing in common; none where
    /// they contradict each other.
    fn least_time(&self) -> Option<f64> {
        let mut order: Vec<&Total> = self.totals.iter().collect();
        order.sort_by_key(|total| total.atoms.len());
        // Least visits and their time, of sets that no larger one has taken in yet.
        let mut outermost: Vec<(&Total, f64, f64)> = Vec::new();
        let low_of = |atoms: &mut dyn Iterator<Item = usize>| {
            atoms.fold((0.0, 0.0), |(n, time), x| (n + self.low[x], time + self.low[x] * self.price[x]))
        };
        for total in order {
            let is_inside = |(inner, _, _): &(&Total, f64, f64)| total.atoms.binary_search(&inner.atoms[0]).is_ok();
            let (inside, others): (Vec<_>, Vec<_>) = outermost.into_iter().partition(is_inside);
            let is_free = |x: &usize| inside.iter().all(|(inner, _, _)| inner.atoms.binary_search(x).is_err());
            let (mut visits, mut time) = low_of(&mut total.atoms.iter().copied().filter(is_free));
            visits += inside.iter().map(|(_, visits, _)| visits).sum::<f64>();
            time += inside.iter().map(|(_, _, time)| time).sum::<f64>();
            let room = |&x: &usize| (self.high[x] > self.low[x]).then_some(self.price[x]);
            if visits < total.low - KEPT {
                time += (total.low - visits) * total.atoms.iter().filter_map(room).reduce(f64::min)?;
                visits = total.low;
            }
            if visits > total.high + KEPT {
                return None;
            }
            outermost = others;
            outermost.push((total, visits, time));
        }
        let is_free = |x: &usize| outermost.iter().all(|(total, _, _)| total.atoms.binary_search(x).is_err());
        let rest = low_of(&mut (0..self.price.len()).filter(is_free)).1;
        Some(rest + outermost.iter().map(|(_, _, time)| time).sum::<f64>())
    }

    /// Whether a design keeps the totals.
    pub fn keeps_totals(&self, w: &[f64]) -> bool {
        self.totals.iter().all(|total| (total.low - KEPT..=total.high + KEPT).contains(&visits_in(&total.atoms, w)))
    }

    /// Gains less what a visit is charged for the totals that it counts in.
    pub fn charged(&self, gain: &[f64], charges: &[f64]) -> Vec<f64> {
        let mut charged = gain.to_vec();
        for (total, charge) in self.totals.iter().zip(charges) {
            total.atoms.iter().for_each(|&x| charged[x] -= charge);
        }
        charged
    }

    /// An upper bound of `sum gain w` over the polytope with its totals, of gains that are `charged` for them, and the
    /// multiplier of time: a design pays no more than `charge * low` for a charge below 0, and no less than what
    /// `charge * high` leaves it above. Any charges give a bound.
    pub fn most_charged(&self, charged: &[f64], charges: &[f64]) -> (f64, f64) {
        let (most, lambda) = self.most(charged);
        let refund = |(total, charge): (&Total, &f64)| charge * if *charge < 0.0 { total.low } else { total.high };
        (most + self.totals.iter().zip(charges).map(refund).sum::<f64>(), lambda)
    }

    /// An upper bound of `sum gain w` over the polytope, tight but for rounding, and its multiplier.
    pub fn most(&self, gain: &[f64]) -> (f64, f64) {
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
    pub fn within(&self, w: &[f64]) -> Vec<f64> {
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
