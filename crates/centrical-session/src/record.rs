//! Records of the unit and telemetry of the centrifuge, in SI.

mod columns;
mod equal_columns;
mod input;
mod joined;
mod overview;
mod packed_times;
mod passes;
mod reader;
mod sample_cache;
mod writer;

pub(crate) use self::columns::{
    CheckedTable, Form as TableForm, LEFT_OUT, NEWTONOMETER_RECORD, PULSES, RECORD, StatedUnits, TELEMETRY, TimeSpan,
    named_columns,
};
pub use self::columns::{Column, Columns, MissingReadings, Scale};
pub(crate) use self::equal_columns::EqualColumns;
pub use self::input::Input;
pub(crate) use self::input::hexadecimal;
pub use self::overview::RecordOverview;
pub(crate) use self::passes::RecordFile;
pub use self::reader::{RecordReader, stretch};
pub(crate) use self::reader::{pulses_of, read_records, read_telemetry, telemetry_of};
pub(crate) use self::sample_cache::{MemoryBudget, SampleCache};
pub use self::writer::RecordWriter;
