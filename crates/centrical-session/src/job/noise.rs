//! The noise of a record, or of one plateau of a session.

mod analysis;
mod series;

pub use self::analysis::analyse_noise;
pub use self::series::Series;
