//! The criterion at one design: its factors, its sensitivities, and the bound that they give.

use super::polytope::Polytope;
use crate::plan::information::{Factor, LinearisedScenario, Smooth, trace_of_product};
use crate::plan::scenarios::LinearisedScenarios;

/// The smooth criterion on a polytope.
#[derive(Clone, Copy)]
pub(super) struct Objective<'a> {
    pub scenarios: &'a LinearisedScenarios,
    pub polytope: &'a Polytope,
    /// Exponent of the norms in place of the largest.
    pub exponent: f64,
}

/// A scenario at a design.
pub(super) struct ScenarioPoint<'a> {
    pub scenario: &'a LinearisedScenario,
    pub factor: Factor,
    pub smooth: Smooth,
    /// Its part in the joint criterion; the parts sum to 1.
    pub part: f64,
}

/// The criterion at one design.
pub(super) struct Point<'a> {
    pub scenarios: Vec<ScenarioPoint<'a>>,
    /// Logarithm of the smooth criterion.
    pub value: f64,
    /// By atom.
    pub sensitivity: Vec<f64>,
    /// Multiplier of the time in the bound.
    pub lambda: f64,
    /// No design of the polytope has a lower logarithm of the criterion.
    pub bound: f64,
}

impl<'a> Objective<'a> {
    /// The factors of a design, by scenario.
    pub fn factors(&self, w: &[f64]) -> Vec<Factor> {
        let factor =
            |scenario: &LinearisedScenario| scenario.factor(&scenario.information(self.polytope.atoms, |x| w[x]));
        self.scenarios.all.iter().map(factor).collect()
    }

    /// Logarithm of the smooth criterion.
    pub fn value(&self, factors: &[Factor]) -> f64 {
        let of = |(scenario, factor): (&LinearisedScenario, &Factor)| scenario.smooth(factor, self.exponent).value;
        let logs: Vec<f64> = self.scenarios.all.iter().zip(factors).map(of).collect();
        self.scenarios.smooth(&logs, self.exponent).0
    }

    /// The point of a design with these factors.
    pub fn point(&self, factors: Vec<Factor>) -> Point<'a> {
        let atoms = self.polytope.atoms;
        let all = self.scenarios.all.iter().zip(factors);
        let mut scenarios: Vec<ScenarioPoint> = all
            .map(|(scenario, factor)| {
                let smooth = scenario.smooth(&factor, self.exponent);
                ScenarioPoint { scenario, factor, smooth, part: 0.0 }
            })
            .collect();
        let logs: Vec<f64> = scenarios.iter().map(|at| at.smooth.value).collect();
        let (value, parts) = self.scenarios.smooth(&logs, self.exponent);
        let mut sensitivity = vec![0.0; atoms.count()];
        let (mut support, mut of_priors) = (0.0, 0.0);
        for (at, part) in scenarios.iter_mut().zip(parts) {
            at.part = part;
            for c in (0..atoms.candidates).filter(|&c| self.polytope.is_open(c)) {
                let g = at.weighed(c);
                for x in atoms.of(c) {
                    sensitivity[x] += part * trace_of_product(at.scenario.precision(x), &g);
                }
            }
            support += part * at.smooth.support;
            of_priors += part * at.scenario.prior_part(&at.factor, &at.smooth.columns);
        }
        let (most, lambda) = self.polytope.greatest(&sensitivity);
        Point { scenarios, value, sensitivity, lambda, bound: support - (of_priors + most).ln() }
    }
}

impl ScenarioPoint<'_> {
    /// `G` of a candidate: `-d ln Phi_s / d w_x = tr(N_x G)` for its atoms.
    pub fn weighed(&self, candidate: usize) -> nalgebra::Matrix3<f64> {
        LinearisedScenario::weighed(&self.scenario.response(&self.factor, candidate), &self.smooth.columns)
    }
}
