//! The best plan for the time, or the shortest for the goals, with all that is said of it.

mod frontier;
mod read;
mod report;
mod request;
mod schedule_file;
mod search;

pub use self::read::{read_plan, read_planning};
pub use self::request::{PlanRequest, USUAL_LEVELS, USUAL_TIMES};
