//! What a watch keeps: where it stands, a line for each plateau, and what it sees at this moment.

mod history;
mod live;
mod state;

pub use self::history::{HistoryEntry, HistoryEstimate, InnovationSummary, append_history, keep_history, read_history};
pub use self::live::{
    Agreement, GroupProgress, LIVE_SCHEMA, LiveBenefit, LiveCause, LiveLost, LivePlateau, LiveRecord, LiveReport,
    LiveSpeed, LiveStatus, PlateauLabel, seconds_since_1970,
};
pub use self::state::{WatchState, WatchedPlateau};
