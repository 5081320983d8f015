//! What follows from a result: expanded uncertainties, errors of the readings, statements of conformity.

mod combination;
mod conformity;
mod criterion;
mod equation;
mod expanded;
mod group;
mod noise;
mod not_used;
mod reading_error;

pub(crate) use self::combination::combination;
pub(crate) use self::conformity::conformity;
pub(crate) use self::criterion::criterion_unit;
pub(crate) use self::equation::{equation, equations, monomial};
pub(crate) use self::expanded::{Expanded, expanded, expanded_of_normal};
pub(crate) use self::group::by_group;
pub(crate) use self::noise::Shown;
pub(crate) use self::not_used::not_used;
pub(crate) use self::reading_error::{ReadingError, compensated, reading_errors};
