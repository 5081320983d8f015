//! What follows from a result: expanded uncertainties, errors of the readings, statements of conformity.

mod conformity;
mod equation;
mod expanded;
mod reading_error;
mod shown;
mod symbol;

pub use self::conformity::{Judged, UnitStatement, UnitVerdict};
pub(crate) use self::equation::{combination, equation, equations, monomial, printed_combination};
pub(crate) use self::expanded::{
    COVERAGE_PROBABILITY, Expanded, expanded, expanded_of, expanded_of_normal, is_nearly_infinite,
};
pub(crate) use self::reading_error::{ReadingError, compensated, expanded_along_axes, reading_errors};
pub(crate) use self::shown::{Shown, criterion_unit};
pub(crate) use self::symbol::{ParameterName, newtonometer, symbol};
