//! Expanded uncertainties, as certificates state them.

use centrical::uncertainty::{Degrees, coverage_factor};
use centrical_session::{CalibrationResult, ParameterEstimate};

/// Coverage factor where the degrees of freedom are infinite.
const COVERAGE_FACTOR: f64 = 2.0;

/// Probability that it covers in a normal distribution.
const COVERAGE_PROBABILITY: f64 = 0.954_499_736_103_642;

/// An expanded uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expanded {
    /// Coverage factor `k`: 2, or that of Student's distribution of the same probability where the effective degrees of
    /// freedom are finite (GUM, G.6.4).
    pub factor: f64,
    /// `U = k u` [unit of the parameter].
    pub uncertainty: f64,
}

impl Expanded {
    /// Whether the coverage factor is that of the normal distribution.
    pub fn is_normal(&self) -> bool {
        self.factor == COVERAGE_FACTOR
    }
}

/// `U = 2 u` of a quantity of infinite degrees of freedom.
pub(crate) fn expanded_of_normal(standard_uncertainty: f64) -> f64 {
    COVERAGE_FACTOR * standard_uncertainty
}

/// Expanded uncertainty of a parameter of the result; `None` if it is not determined.
pub(crate) fn expanded(result: &CalibrationResult, parameter: &ParameterEstimate) -> Option<Expanded> {
    let place = result.parameters.iter().position(|other| other.name == parameter.name);
    let degrees = |j: usize| result.budget.as_ref()?.degrees_of_freedom.get(j).copied().flatten();
    let factor = place
        .and_then(degrees)
        .map_or(COVERAGE_FACTOR, |nu| coverage_factor(COVERAGE_PROBABILITY, Degrees::Finite(nu)));
    Some(Expanded { factor, uncertainty: factor * parameter.standard_uncertainty? })
}
