//! Many calibrations: a unit over the years, units beside each other, a machine over its sessions.
//!
//! - [`Between`]: the component of variance between sessions, beside the uncertainty that each session states.
//! - [`Series::evolution`]: level, slope, forecast, due date.
//! - [`Series::step`]: a repair in place of a drift.
//! - [`Estimates::sameness`](crate::uncertainty::Estimates::sameness): all parameters together, with their full covariances.
//! - [`UnitTrend`], [`UnitDistance`], [`Capability`], [`BatchTest`]: units beside each other.
//! - [`StationTest`]: a machine over its sessions.
//! - [`Control`]: control charts.
//!
//! Times are in years, values in any unit.

mod between;
mod chart;
mod evolution;
mod law;
mod line;
mod outlying;
mod quantiles;
mod series;
mod station;
mod step;
mod succession;
mod together;
mod units;

pub use between::{Between, Likely};
pub use chart::{Control, Cusum, Ewma, Rule};
pub use evolution::{DAYS_IN_YEAR, Estimated, Evolution};
pub use law::NormalMixture;
pub use line::Curve;
pub use outlying::UnitDistance;
pub use quantiles::Quantiles;
pub use series::{Point, Series};
pub use station::{Reading, StationTest};
pub use together::FarthestSession;
pub use units::{BatchTest, Capability, UnitTrend};
