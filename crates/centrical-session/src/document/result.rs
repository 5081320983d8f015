//! `result.json`: the form in which a calibration leaves the program, schema `centrical-result/1`.

mod axes;
mod axes_summary;
mod budget_and_checks;
mod contradiction;
mod error_terms;
mod file;
mod from_calibration;
mod next_attitude;
mod rivals;
mod schema;
mod speeds;
mod verdict;

pub(crate) use self::axes::Attitude;
pub use self::axes_summary::*;
pub use self::budget_and_checks::*;
pub use self::from_calibration::*;
pub use self::next_attitude::*;
pub use self::rivals::*;
pub use self::schema::*;
pub use self::speeds::*;
pub use self::verdict::*;
