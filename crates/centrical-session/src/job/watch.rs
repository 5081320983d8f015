//! A session folder that is followed while it is being filled.

mod arrivals;
mod board;
mod following;
mod growth;
mod progress;
mod rests;

pub use self::arrivals::Watch;
pub use self::board::LiveRequest;
pub use self::following::{Following, WatchEnd, WatchEvent, WatchRequest};
pub use self::progress::WatchProgress;
pub use self::rests::with_rests_there;
