//! Histories, one schema a file.

mod chart;
mod station;
mod unit;
mod units;

pub use self::chart::{CHART_SCHEMA, ChartKind, ChartReport, ChartRule, ChartSignal};
pub(crate) use self::station::FAMILY;
pub use self::station::{STATION_HISTORY_SCHEMA, StationHistoryReport, StationParameter};
pub(crate) use self::unit::shown_readings;
pub use self::unit::{
    DeviatingSession, DueDate, LeftOutSession, PastSession, ReadingHistory, SamenessSummary, UNIT_HISTORY_SCHEMA,
    UnitHistoryReport, UnitParameter,
};
pub use self::units::{
    BatchSummary, BatchWithoutUnit, BeyondLimit, CapabilitySummary, NotComparedParameter, OutlyingUnit,
    UNITS_HISTORY_SCHEMA, UnitFinding, UnitFindingKind, UnitsHistoryReport, UnitsParameter, UntestedStation,
};
