//! Many calibrations: a unit over the years, units beside each other, a machine over its sessions.
//!
//! - [`Between`]: the component of variance between sessions, beside the uncertainty that each session states.
//! - [`Series::evolution`]: level, slope, forecast, due date.
//! - [`Series::step`]: a repair in place of a drift.
//! - [`sameness`]: all parameters together, with their full covariances.
//! - [`unit_trends`], [`distances`], [`capability`], [`batch_test`]: units beside each other.
//! - [`station_test`]: a machine over its sessions.
//! - [`Control`], [`ewma`], [`cusum`], [`signals`]: control charts.
//!
//! Times are in years, values in any unit.

mod batches;
mod between;
mod capability;
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

pub use batches::{BatchTest, batch_test};
pub use between::{Between, Likely};
pub use capability::{Capability, Index, capability};
pub use chart::{Control, Cusum, Ewma, Rule, cusum, ewma, moving_ranges, signals};
pub use evolution::{DAYS_IN_YEAR, Estimated, Evolution};
pub use law::Law;
pub use line::Curve;
pub use outlying::{FEWEST_UNITS, UnitDistance, UnitSessions, distances};
pub use quantiles::Quantiles;
pub use series::{Point, Series};
pub use station::{FEWEST_READINGS, Reading, StationTest, station_test};
pub use together::{FarthestSession, Sameness, SessionEstimates, sameness};
pub use units::{UnitTrend, unit_trends};
