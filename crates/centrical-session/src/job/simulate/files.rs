//! Where the tables of a session are, and in which format.

use centrical_table::TableFormat;

/// Path of the record of a mounting within the session's folder.
pub(crate) fn record_path(mounting: usize, format: TableFormat) -> String {
    format!("records/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the pulses of a mounting within the session's folder.
pub(crate) fn pulses_path(mounting: usize, format: TableFormat) -> String {
    format!("pulses/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the telemetry of a mounting within the session's folder.
pub(crate) fn telemetry_path(mounting: usize, format: TableFormat) -> String {
    format!("telemetry/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the record of the rests of `[[tumble]]` number `tumble`, from 0, within the session's folder.
pub(crate) fn tumble_path(tumble: usize, format: TableFormat) -> String {
    format!("records/tumble-{}.{}", tumble + 1, format.extension())
}

/// Name of the table of their attitudes.
pub(crate) fn attitudes_path(tumble: usize) -> String {
    format!("attitudes-{}.csv", tumble + 1)
}
