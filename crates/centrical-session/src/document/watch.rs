//! What a watch keeps: where it stands, and a line for each plateau.

mod history;
mod state;

pub use self::history::{HistoryEntry, HistoryEstimate, InnovationSummary, append_history, keep_history, read_history};
pub use self::state::{WatchState, WatchedPlateau};
