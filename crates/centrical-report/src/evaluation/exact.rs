//! What a result takes as exact.

use centrical::Source;
use centrical_session::CalibrationResult;

/// Quantities that an uncertainty may be stated of, and that this session states none of.
pub(crate) fn exact(result: &CalibrationResult) -> Vec<Source> {
    let stated = result.stated_sources();
    let of_quantity = [
        Source::Gravity,
        Source::Latitude,
        Source::Radius,
        Source::SpeedScale,
        Source::RestAngle,
        Source::ProofMasses,
        Source::Attitude,
    ];
    let is_exact = |source: &Source| {
        let is_in_model = *source != Source::Latitude || result.model.latitude.is_some();
        let acts = result.model.has_arm() || *source == Source::Gravity;
        acts && is_in_model && !stated.contains(source)
    };
    of_quantity.into_iter().filter(is_exact).collect()
}
