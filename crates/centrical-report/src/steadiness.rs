//! How steady the readings were: drift, tilt while spinning, samples left out; what of it is no chance, and all of it
//! in words for the terminal.

mod facts;

use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical::uncertainty::chi_squared_tail;
use centrical_session::{CalibrationResult, DriftSummary, LeftOutSummary, RepeatedPlateau, SessionTrend, TiltSummary};

pub(crate) use self::facts::facts;
use crate::customary::with_uncertainty;

/// What comes by chance less often than this is said to be there.
const CHANCE: f64 = 1e-3;

/// ug per m/s^2.
pub(crate) const MICRO_G: f64 = 1e6 / STANDARD_GRAVITY;

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

/// The section of the terminal's table; empty for a session that came already averaged.
pub(crate) fn steadiness(text: &mut String, result: &CalibrationResult) {
    left_out(text, result);
    if let Some(drift) = &result.drift {
        over_plateaus(text, drift);
        over_session(text, drift);
        repeats(text, drift);
    }
    if let Some(tilt) = &result.tilt {
        tilts(text, tilt);
    }
}

/// Samples that are not used, by kind, where there are any.
fn left_out(text: &mut String, result: &CalibrationResult) {
    let LeftOutSummary { spikes, stuck, missing, repeated } = not_used(result);
    let kinds = [("spikes", spikes), ("missing", missing), ("stuck", stuck), ("repeated", repeated)];
    let named: Vec<String> =
        kinds.iter().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{kind} {count}")).collect();
    if !named.is_empty() {
        let _ = writeln!(text, "      samples not used: {}", named.join(", "));
    }
}

fn over_plateaus(text: &mut String, drift: &DriftSummary) {
    let shown: Vec<String> = (drift.slope.iter().zip(&drift.slope_uncertainty))
        .map(|(slope, u)| with_uncertainty(MICRO_G * MINUTE * slope, MICRO_G * MINUTE * u))
        .map(|(slope, u)| format!("{slope} ± {u}"))
        .collect();
    let verdict = if plateaus_drift(drift) { "plateaus drift" } else { "no drift seen" };
    let _ = writeln!(
        text,
        "DRIFT over a plateau, mean: {} ug/min; chi^2 {:.1} of {} slopes, {verdict}",
        shown.join(", "),
        drift.chi_squared,
        drift.degrees_of_freedom
    );
}

fn over_session(text: &mut String, drift: &DriftSummary) {
    if drift.over_session.is_empty() {
        return;
    }
    let trends = drift.over_session.iter().map(|trend| {
        let (change, u) = with_uncertainty(MICRO_G * trend.change, MICRO_G * trend.standard_uncertainty);
        format!("f{} {change} ± {u}", trend.axis)
    });
    let trends: Vec<String> = trends.collect();
    let verdict = match SessionDrift::of(drift) {
        SessionDrift::NotSeen => "no drift seen",
        SessionDrift::WithinScatter => "no more than the plateaus scatter",
        SessionDrift::Seen => "the session drifts",
    };
    let _ = writeln!(text, "      over the session: {} ug, {verdict}", trends.join(", "));
}

fn repeats(text: &mut String, drift: &DriftSummary) {
    let Some((worst, differ)) = farthest_apart(drift) else { return };
    let count = drift.repeats.len();
    let [first, second] = worst.indices.map(|index| index + 1);
    let verdict = if differ { "they differ" } else { "no difference seen" };
    let _ = writeln!(
        text,
        "      plateaus run again: {count}; farthest apart are {}:{first} and {0}:{second}, chi^2 {:.1} of 3, {verdict}",
        worst.mounting, worst.chi_squared
    );
}

fn tilts(text: &mut String, tilt: &TiltSummary) {
    let shown = |value: f64, u: f64| {
        let (value, u) = with_uncertainty(1e6 * value, 1e6 * u);
        format!("{value} ± {u} urad")
    };
    let verdict = match Tilts::of(tilt) {
        Tilts::Agree => "they agree".to_owned(),
        Tilts::Differ => {
            "they differ: the axis is not the same while it spins, or something else turns with it".to_owned()
        }
        Tilts::Reversed => {
            let as_if = shown(tilt.reversed, tilt.spinning_uncertainty);
            format!("it turns the other way ({as_if}): the sense of rotation is wrong")
        }
    };
    let _ = writeln!(
        text,
        "TILT  by the once-per-revolution term of {} plateaus {}, by rest {}; chi^2 {:.1} of 1, {verdict}",
        tilt.plateaus,
        shown(tilt.spinning, tilt.spinning_uncertainty),
        shown(tilt.at_rest, tilt.at_rest_uncertainty),
        tilt.chi_squared
    );
    if tilts_scatter(tilt) {
        let _ = writeln!(
            text,
            "      the plateaus' own tilts scatter: chi^2 {:.1} of {}",
            tilt.scatter_chi_squared,
            tilt.plateaus.saturating_sub(1)
        );
    }
}
