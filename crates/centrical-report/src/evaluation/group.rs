//! Parameters group by group: what belongs together stands together, whatever the order of the covariance.

use centrical_session::ParameterEstimate;

/// The parameters by group, groups in the order of their first member.
pub(crate) fn by_group<'p>(parameters: &[&'p ParameterEstimate]) -> Vec<&'p ParameterEstimate> {
    let mut sorted = parameters.to_vec();
    sorted.sort_by_key(|parameter| parameters.iter().position(|first| first.group == parameter.group));
    sorted
}
