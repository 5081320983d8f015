//! How steady the readings were: what of drift and tilt is no chance, and the samples left out.

use centrical::uncertainty::chi_squared_tail;
use centrical_session::{CalibrationResult, DriftSummary, LeftOutSummary, RepeatedPlateau, SessionTrend, TiltSummary};

/// An effect less probable than this by chance is reported as real.
const CHANCE: f64 = 1e-3;

/// Seconds in a minute.
pub(crate) const MINUTE: f64 = 60.0;

/// Whether the plateaus drift.
pub(crate) fn plateaus_drift(drift: &DriftSummary) -> bool {
    drift.probability < CHANCE
}

/// What the residuals say of a drift over the session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SessionDrift {
    NotSeen,
    /// More than the stated uncertainties explain, and no more than the plateaus scatter about the fit.
    WithinScatter,
    Seen,
}

impl SessionDrift {
    pub fn of(drift: &DriftSummary) -> Self {
        // Family-wise over the newtonometers, by Bonferroni.
        let tests = drift.over_session.len() as f64;
        let any = |is: &dyn Fn(&SessionTrend) -> bool| drift.over_session.iter().any(is);
        if any(&|trend| tests * trend.probability < CHANCE) {
            Self::Seen
        } else if any(&|trend| {
            tests * chi_squared_tail((trend.change / trend.standard_uncertainty).powi(2), 1) < CHANCE
        }) {
            Self::WithinScatter
        } else {
            Self::NotSeen
        }
    }
}

/// The plateaus run again that are farthest apart, and whether they differ, by Bonferroni.
pub(crate) fn farthest_apart(drift: &DriftSummary) -> Option<(&RepeatedPlateau, bool)> {
    let worst = drift.repeats.iter().min_by(|a, b| a.probability.total_cmp(&b.probability))?;
    Some((worst, drift.repeats.len() as f64 * worst.probability < CHANCE))
}

/// What the two tilts say of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tilts {
    Agree,
    Differ,
    /// The one seen while spinning would agree better if the arm turned the other way.
    Reversed,
}

impl Tilts {
    pub fn of(tilt: &TiltSummary) -> Self {
        match tilt.probability < CHANCE {
            false => Self::Agree,
            true if tilt.reversed > tilt.spinning => Self::Reversed,
            true => Self::Differ,
        }
    }
}

/// Whether the plateaus' own tilts scatter.
pub(crate) fn tilts_scatter(tilt: &TiltSummary) -> bool {
    tilt.scatter_probability < CHANCE
}

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
