//! What is served: answers to paths, and a panel that changes.

mod answer;
mod results;
mod stored;
mod watched;

pub use self::answer::{Answer, Query, Site};
pub use self::results::Results;
pub use self::stored::Stored;
pub use self::watched::Watched;
