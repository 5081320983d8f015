//! Statements of conformity: values against limits by the decision rule.

use centrical_io::{CalibrationResult, Decision, DecisionRule, Limit};

use crate::expanded::expanded;

/// A limit and whether its parameter keeps it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judged<'d> {
    /// The limit.
    pub limit: &'d Limit,
    /// Estimate and expanded uncertainty, SI; none if the data do not determine it.
    pub value: Option<(f64, f64)>,
    /// Whether conformity can be stated.
    pub conforms: bool,
}

/// Every limit of a decision, judged. A parameter that is not determined does not conform.
pub(crate) fn conformity<'d>(result: &CalibrationResult, decision: &'d Decision) -> Vec<Judged<'d>> {
    let judge = |limit: &'d Limit| {
        let value = result.parameter(&limit.parameter).and_then(|p| Some((p.value?, expanded(result, p)?.uncertainty)));
        let conforms = value.is_some_and(|(value, expanded)| {
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
