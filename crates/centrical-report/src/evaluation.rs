//! What follows from a result: expanded uncertainties, errors of the readings, statements of conformity, objections.

mod combination;
mod conformity;
mod criterion;
pub(crate) mod drift;
mod equation;
mod expanded;
mod group;
mod noise;
mod reading_error;
mod verdict;

pub(crate) use self::combination::combination;
pub(crate) use self::conformity::conformity;
pub(crate) use self::criterion::criterion_unit;
pub(crate) use self::equation::{equation, equations, monomial};
pub(crate) use self::expanded::{COVERAGE_FACTOR, Expanded, expanded};
pub(crate) use self::group::by_group;
pub(crate) use self::noise::Shown;
pub(crate) use self::reading_error::{ReadingError, compensated, reading_errors};
pub use self::verdict::{Objection, objections};
