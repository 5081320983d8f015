//! Histories, one schema a file.

mod chart;
mod station;
mod unit;
mod units;

pub use self::chart::*;
pub use self::station::*;
pub use self::unit::*;
pub use self::units::*;
