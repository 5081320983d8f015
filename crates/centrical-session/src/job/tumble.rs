//! Calibration by gravity alone: a unit that was turned by hand or on a table and rested again and again.

mod calibrated;
mod plausible;
mod request;
mod session_text;

pub use self::calibrated::{Tumble, tumble};
pub use self::request::TumbleRequest;
