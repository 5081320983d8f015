//! What a watch keeps: where it stands, a line for each plateau, and what it sees at this moment.

mod history;
mod live;
mod state;

pub use self::history::*;
pub use self::live::*;
pub use self::state::*;
