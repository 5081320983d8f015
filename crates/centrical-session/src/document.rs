//! The JSON documents that the program writes, one schema a file.

mod added;
mod assessment;
mod compact;
mod comparison;
mod compensation;
mod documents;
mod draft;
mod history;
mod history_list;
mod json;
mod models;
mod montecarlo;
mod noise;
mod observability;
mod plan;
mod prediction;
mod record_findings;
mod reduction;
mod result;
mod series;
mod simulation;
mod steadiness;
mod truth;
mod watch;

pub use self::added::*;
pub use self::assessment::*;
pub use self::comparison::*;
pub use self::compensation::*;
pub use self::documents::*;
pub use self::draft::*;
pub use self::history::*;
pub use self::history_list::*;
pub(crate) use self::json::line as json_line;
pub use self::models::*;
pub use self::montecarlo::*;
pub use self::noise::*;
pub use self::observability::*;
pub use self::plan::*;
pub use self::prediction::*;
pub(crate) use self::record_findings::RecordFindings;
pub use self::reduction::*;
pub use self::result::*;
pub use self::series::*;
pub use self::simulation::*;
pub use self::steadiness::*;
pub(crate) use self::truth::{Written, WrittenSession, WrittenTumble, truth_json};
pub use self::watch::*;

json::documents! {
    AddedReport: added::ADDED_SCHEMA,
    AssessmentReport: assessment::ASSESSMENT_SCHEMA,
    CalibrationResult: result::SCHEMA,
    ChartReport: CHART_SCHEMA,
    ComparisonReport: comparison::COMPARISON_SCHEMA,
    CompensationReport: COMPENSATION_SCHEMA,
    DocumentsReport: documents::DOCUMENTS_SCHEMA,
    DraftReport: draft::DRAFT_SCHEMA,
    HistoryList: history_list::HISTORY_LIST_SCHEMA,
    ModelsReport: models::MODELS_SCHEMA,
    MonteCarloReport: montecarlo::MONTE_CARLO_SCHEMA,
    ObservabilityReport: observability::OBSERVABILITY_SCHEMA,
    PlanReport: PLAN_SCHEMA,
    RecordFindings: record_findings::KEY,
    ReductionReport: reduction::REDUCTION_SCHEMA,
    SeriesSummary: series::SERIES_SCHEMA,
    SimulationReport: simulation::SIMULATION_SCHEMA,
    StationHistoryReport: STATION_HISTORY_SCHEMA,
    UnitHistoryReport: UNIT_HISTORY_SCHEMA,
    UnitsHistoryReport: UNITS_HISTORY_SCHEMA,
}
