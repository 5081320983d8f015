//! Where the tables of a session are, and in which format.

/// How records and telemetry are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableFormat {
    /// Text, `records/m01.csv`.
    #[default]
    Csv,
    /// Parquet, `records/m01.parquet`.
    Parquet,
}

/// Path of the record of a mounting within the session's folder.
pub(crate) fn record_path(mounting: usize, format: TableFormat) -> String {
    format!("records/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the telemetry of a mounting within the session's folder.
pub(crate) fn telemetry_path(mounting: usize, format: TableFormat) -> String {
    format!("telemetry/m{:02}.{}", mounting + 1, format.extension())
}

impl TableFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}
