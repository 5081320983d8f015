//! Statements of conformity: values against limits by the decision rule.

use centrical::Group;
use centrical_session::{CalibrationResult, Decision, DecisionRule, Limited, StatedLimit};

use super::expanded::expanded;
use super::reading_error::reading_errors;

/// What a decision says of the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitStatement {
    /// The specification: document and clause.
    pub specification: String,
    /// How the uncertainty is taken into account.
    pub rule: DecisionRule,
    /// The limits, judged.
    pub judged: Vec<Judged>,
}

/// Limits and whether their quantity keeps them.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The limits.
    pub limit: StatedLimit,
    /// Estimate and expanded uncertainty, SI; `None` if the data do not determine it. Of a compensated reading: the error on
    /// the plateau that comes nearest to the limits, and its expanded uncertainty.
    pub value: Option<(f64, f64)>,
    /// That plateau, `mounting:plateau` counted from 1; `None` of a parameter.
    pub plateau: Option<String>,
    /// Whether it conforms; nothing can be stated of what the data do not determine, from a result that is not acceptable, or against nominal
    /// values that the result itself found.
    pub conforms: Option<bool>,
    /// Whether it is not accepted although the value lies within the limits: by less than the guard band.
    pub is_in_guard_band: bool,
}

/// What is said of the unit as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitVerdict {
    /// Every limit is kept.
    Within,
    /// A value lies beyond a limit.
    Outside,
    /// All values lie within their limits, some of them by less than the guard band: they are not accepted.
    InGuardBand,
    /// No limit is known not to be kept, but not all of them are known to be.
    NotStated,
}

impl UnitStatement {
    /// The `limits` of a decision, judged.
    pub fn new(result: &CalibrationResult, decision: &Decision, limits: Vec<StatedLimit>) -> Self {
        let is_acceptable = result.objections().is_empty();
        let judge = |limit: StatedLimit| {
            let (value, plateau) = match &limit.of {
                Limited::Parameter(name) => (parameter(result, name), None),
                Limited::CompensatedReading(axis) => worst_reading(result, *axis, &limit, decision.rule).unzip(),
            };
            let judged = value.filter(|_| is_acceptable && !is_relative_to_itself(result, &limit.of));
            let conforms = judged.map(|value| margin(value, &limit, decision.rule) >= 0.0);
            let is_inside = judged.is_some_and(|value| margin(value, &limit, DecisionRule::Simple) >= 0.0);
            Judged { limit, value, plateau, conforms, is_in_guard_band: conforms == Some(false) && is_inside }
        };
        Self {
            specification: decision.specification.clone(),
            rule: decision.rule,
            judged: limits.into_iter().map(judge).collect(),
        }
    }

    /// What is said of the unit as a whole.
    pub fn verdict(&self) -> UnitVerdict {
        let mut broken = self.judged.iter().filter(|judged| judged.conforms == Some(false)).peekable();
        if broken.peek().is_some() {
            if broken.all(|judged| judged.is_in_guard_band) { UnitVerdict::InGuardBand } else { UnitVerdict::Outside }
        } else if self.judged.iter().any(|judged| judged.conforms.is_none()) {
            UnitVerdict::NotStated
        } else {
            UnitVerdict::Within
        }
    }

    /// Whether the unit is stated to keep its limits.
    pub fn is_within(&self) -> bool {
        self.verdict() == UnitVerdict::Within
    }
}

/// Whether it is a bias or scale error against nominal values that the same calibration found: it conforms to any limit.
fn is_relative_to_itself(result: &CalibrationResult, of: &Limited) -> bool {
    let Limited::Parameter(name) = of else { return false };
    let group = result.parameter(name).map(|parameter| parameter.group);
    result.model.nominal_found && matches!(group, Some(Group::Bias | Group::Scale))
}

fn parameter(result: &CalibrationResult, name: &str) -> Option<(f64, f64)> {
    result.parameter(name).and_then(|p| Some((p.value?, expanded(result, p)?.uncertainty)))
}

/// Distance of a value from the nearest end of what the rule accepts; below zero if it is not accepted.
fn margin((value, expanded): (f64, f64), limit: &StatedLimit, rule: DecisionRule) -> f64 {
    let guard = match rule {
        DecisionRule::Simple => 0.0,
        DecisionRule::Guarded => expanded,
    };
    let above = limit.low.as_ref().map_or(f64::INFINITY, |low| value - guard - low.si);
    let below = limit.high.as_ref().map_or(f64::INFINITY, |high| high.si - value - guard);
    above.min(below)
}

/// Error of the compensated reading of newtonometer `axis` (1, 2, 3) on the plateau where its margin is smallest, without
/// what the plateau's own speed explains, and where that is. Its expanded uncertainty holds the noise of the mean and what
/// the parameters leave in a compensated reading of that force.
fn worst_reading(
    result: &CalibrationResult,
    axis: usize,
    limit: &StatedLimit,
    rule: DecisionRule,
) -> Option<((f64, f64), String)> {
    let errors = reading_errors(result)?;
    let points = errors.iter().zip(&result.plateaus).map(|(error, plateau)| {
        let j = axis - 1;
        let value = (error.speed_free[j], error.expanded[j]);
        (value, format!("{}:{}", plateau.mounting, plateau.index + 1))
    });
    points.min_by(|(a, _), (b, _)| margin(*a, limit, rule).total_cmp(&margin(*b, limit, rule)))
}
