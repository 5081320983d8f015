//! The unit in which the criterion of a plan is shown.

use centrical_session::{CriterionName, MICRO_G, PlanReport};

/// Size of the unit [unit of the criterion], and its name; none of a number without a unit.
pub(crate) fn criterion_unit(report: &PlanReport) -> (f64, Option<&'static str>) {
    match report.criterion {
        CriterionName::I => (MICRO_G, Some("ug")),
        CriterionName::A | CriterionName::D | CriterionName::Worst => (1.0, None),
    }
}
