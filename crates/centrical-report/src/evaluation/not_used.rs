//! Samples that are not used.

use centrical_session::{CalibrationResult, LeftOutSummary};

/// Samples of all plateaus that are not used, by kind.
pub(crate) fn not_used(result: &CalibrationResult) -> LeftOutSummary {
    let plateaus = result.plateaus.iter().filter_map(|plateau| plateau.left_out);
    plateaus.fold(LeftOutSummary::default(), |sum, of| LeftOutSummary {
        spikes: sum.spikes + of.spikes,
        stuck: sum.stuck + of.stuck,
        missing: sum.missing + of.missing,
        repeated: sum.repeated + of.repeated,
    })
}
