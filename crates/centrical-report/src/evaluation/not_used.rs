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

/// Whether more samples were left out for a time that the one before had than were used: the times are rounded.
pub(crate) fn has_rounded_times(result: &CalibrationResult) -> bool {
    not_used(result).repeated as u64 > result.plateaus.iter().map(|plateau| plateau.samples).sum()
}
