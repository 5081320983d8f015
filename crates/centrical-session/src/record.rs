//! Records of the unit and telemetry of the centrifuge, in SI.

mod columns;
mod input;
mod kept;
mod overview;
mod passes;
mod read;
mod times;

pub use self::columns::{Column, Columns, Scale};
pub use self::input::Input;
pub(crate) use self::kept::{Kept, Room};
pub use self::overview::RecordOverview;
pub(crate) use self::passes::{RecordFile, Windows};
pub use self::read::{read_growing_record, read_record, read_telemetry, scan_record};
pub(crate) use self::read::{scan_blocks, stretch};
