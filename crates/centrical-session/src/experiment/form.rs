//! The form of `experiment.toml` and of plans as it is written.

mod entries;
mod entry_schemas;
mod plan_tables;
mod tables;

pub(crate) use self::entries::*;
pub(crate) use self::plan_tables::*;
pub(crate) use self::tables::*;
