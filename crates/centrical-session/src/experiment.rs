//! What stands in the files of a session before any reading: `experiment.toml`, plans, tables of plateaus.

mod attitude;
mod candidates;
mod columns;
mod folder;
mod form;
mod plan;
mod plateau_name;
mod plateaus;
mod prior;
mod rests;
mod schedule;
mod session;
mod speeds;
mod stated_attitudes;
mod terms;
mod toml_path;
mod turning;
mod uncertainty;
mod unit;

pub use self::candidates::{Planning, available_time};
pub use self::folder::Folder;
pub(crate) use self::form::{Form as ExperimentForm, PlanForm};
pub use self::plan::{ExpectedValues, Plan};
pub use self::plateau_name::PlateauName;
pub(crate) use self::plateaus::write_plateaus_parquet;
pub use self::plateaus::{PlateauMean, PlateauTable, read_plateaus, write_plateaus};
pub use self::rests::{KnownAttitudes, PlannedRests, RecordedRests, RestSource, RestTable};
pub(crate) use self::session::EXPERIMENT_FILE;
pub use self::session::{MountingFiles, Session};
pub use self::speeds::{Measured, SpeedSource, Speeds};
pub use self::stated_attitudes::StatedAttitudes;
pub(crate) use self::stated_attitudes::write_attitudes;
pub(crate) use self::toml_path::TomlPath;
pub use self::turning::{MOST_DISTANT, Turning};
pub use self::unit::OutputUnit;
