//! The form of `experiment.toml` and of plans as it is written.

mod entries;
mod entry_schemas;
mod plan_tables;
mod tables;

pub(crate) use self::entries::{
    AttitudeList, ColumnEntry, ColumnTable, PriorValue, RecordEntry, Steps, TermEntry, TermList, TermTable,
};
pub(crate) use self::plan_tables::{CandidatesTable, PlanTable};
pub(crate) use self::tables::{
    CentrifugeTable, ColumnsTable, Form, MeasuredTable, ModelTable, MountingTable, PlanForm, PlateauEntry,
    PositionTable, PresetCentrifugeTable, PresetForm, PresetTable, RawTable, SiteTable, TumbleTable, TurningTable,
    UnitTable,
};
