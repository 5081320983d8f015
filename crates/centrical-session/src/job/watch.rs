//! A session folder that is followed while it is being filled.

mod arrivals;
mod following;

pub use self::arrivals::Watch;
pub use self::following::{Following, WatchEnd, WatchEvent, WatchProgress, WatchRequest};
