//! What follows from a result: expanded uncertainties, errors of the readings, statements of conformity.

mod combination;
mod conformity;
mod criterion;
mod equation;
mod exact;
mod expanded;
mod group;
mod interpolated;
mod monte_carlo;
mod noise;
mod not_used;
mod reading_error;
mod rests;
mod symbol;
mod typeset;
mod unit_due;
mod unscheduled;

pub(crate) use self::combination::{combination, printed_combination};
pub use self::conformity::{Judged, UnitStatement, UnitVerdict};
pub(crate) use self::criterion::criterion_unit;
pub(crate) use self::equation::{equation, equations, monomial};
pub(crate) use self::exact::exact;
pub(crate) use self::expanded::{COVERAGE_PROBABILITY, Expanded, expanded, expanded_of, expanded_of_normal};
pub(crate) use self::group::by_group;
pub(crate) use self::interpolated::interpolated;
pub(crate) use self::monte_carlo::{chance_distance, chance_of_coverage, expected_deviation};
pub(crate) use self::noise::Shown;
pub(crate) use self::not_used::{has_rounded_times, not_used};
pub(crate) use self::reading_error::{ReadingError, compensated, reading_errors};
pub(crate) use self::rests::{GravityMisfit, LAG, least_rest, rest_lengths, shortened_by_lag};
pub(crate) use self::symbol::{ParameterName, newtonometer, symbol};
pub(crate) use self::unit_due::UnitDue;
pub use self::unscheduled::unscheduled;
