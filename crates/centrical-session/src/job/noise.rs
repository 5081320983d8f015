//! The noise of a record, or of one plateau of a session.

mod request;
mod series;

pub use self::request::{NoiseRequest, noise_of, noise_of_plateau};
pub use self::series::Series;
