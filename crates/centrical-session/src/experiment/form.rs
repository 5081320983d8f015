//! The form of `experiment.toml` and of plans as it is written.

mod entries;
mod tables;

pub(crate) use self::entries::{ColumnEntry, ColumnTable, Steps, TermEntry, TermList, TermTable};
pub(crate) use self::tables::{
    CandidatesTable, ColumnsTable, CountsTable, Form, ModelTable, MountingTable, PlanTable, PlateauEntry,
    PositionTable, PresetForm, PresetTable, SiteTable, UncertaintyTable, UnitTable,
};
