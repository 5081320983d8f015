//! The scenarios together: one criterion of those of all.

use super::criterion::Robustness;
use super::information::{Factor, LinearisedScenario};

/// All scenarios, linearised.
#[derive(Debug, Clone)]
pub(super) struct LinearisedScenarios {
    pub all: Vec<LinearisedScenario>,
    pub robustness: Robustness,
}

impl LinearisedScenarios {
    /// Logarithm of the joint criterion, of those of the scenarios.
    pub fn joint(&self, logs: impl Iterator<Item = f64>) -> f64 {
        match self.robustness {
            Robustness::Mean => self.all.iter().zip(logs).map(|(scenario, log)| scenario.weight * log).sum(),
            Robustness::Worst => logs.fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Logarithm of the joint criterion at a design.
    pub fn value(&self, factors: &[Factor]) -> f64 {
        self.joint(factors.iter().map(LinearisedScenario::value))
    }

    /// Whether the joint criterion is approached by norms of rising order.
    pub fn has_norm(&self) -> bool {
        self.is_worst() || self.all.iter().any(|scenario| scenario.goals() > 1)
    }

    /// Whether the worst of several scenarios counts.
    pub fn is_worst(&self) -> bool {
        self.robustness == Robustness::Worst && self.all.len() > 1
    }

    /// The smooth joint criterion `(sum_s Phi_s^q)^(1/q)` in place of the largest, its logarithm, and the parts `pi_s` of the
    /// scenarios in its derivatives, `sum pi_s = 1`. For the mean they are the weights.
    ///
    /// The parts bound the largest as well: `ln max Phi_s >= sum pi_s ln Phi_s` for any `pi`, and the right side is what the
    /// equivalence theorem bounds for the mean. Where the norm is the largest, at the optimum, the two meet.
    pub fn smooth(&self, logs: &[f64], exponent: f64) -> (f64, Vec<f64>) {
        if !self.is_worst() {
            return (self.joint(logs.iter().copied()), self.all.iter().map(|scenario| scenario.weight).collect());
        }
        let worst = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let powers: Vec<f64> = logs.iter().map(|log| (exponent * (log - worst)).exp()).collect();
        let sum: f64 = powers.iter().sum();
        (worst + sum.ln() / exponent, powers.into_iter().map(|power| power / sum).collect())
    }
}
