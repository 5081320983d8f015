//! The truth file of a simulation: the unit's true parameters and the equipment's errors.

mod equipment;
mod file;

pub use self::file::Truth;
pub(crate) use self::file::TruthForm;
