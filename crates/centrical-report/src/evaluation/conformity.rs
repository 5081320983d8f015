//! Statements of conformity: values against limits by the decision rule.

use centrical_session::{CalibrationResult, Decision, DecisionRule, Limit};

use super::expanded::expanded;
use super::verdict::objections;

/// A limit and whether its parameter keeps it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judged<'d> {
    /// The limit.
    pub limit: &'d Limit,
    /// Estimate and expanded uncertainty, SI; `None` if the data do not determine it.
    pub value: Option<(f64, f64)>,
    /// Whether it conforms; nothing can be stated of what the data do not determine, or from a result that is not
    /// acceptable.
    pub conforms: Option<bool>,
}

/// Every limit of a decision, judged.
pub(crate) fn conformity<'d>(result: &CalibrationResult, decision: &'d Decision) -> Vec<Judged<'d>> {
    let is_acceptable = objections(result).is_empty();
    let judge = |limit: &'d Limit| {
        let value = result.parameter(&limit.parameter).and_then(|p| Some((p.value?, expanded(result, p)?.uncertainty)));
        let conforms = value.filter(|_| is_acceptable).map(|(value, expanded)| {
            let guard = match decision.rule {
                DecisionRule::Simple => 0.0,
                DecisionRule::Guarded => expanded,
            };
            (limit.low + guard..=limit.high - guard).contains(&value)
        });
        Judged { limit, value, conforms }
    };
    decision.limit.iter().map(judge).collect()
}
