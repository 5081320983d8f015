//! Stamps: instants as files write and count them.

mod stamps;
mod written;

pub use self::stamps::Stamps;
pub(crate) use self::stamps::{TickForm, TickUnit};
pub use self::written::StampKind;
pub(crate) use self::written::{dated_seconds, joined, kind, seconds};
