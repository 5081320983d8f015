//! How steady the readings were: over a plateau, over the session, over a revolution; and what was left out.

use centrical::reduction::LeftOut;
use centrical::uncertainty::{Level, OncePerRevolution, Pattern, Slope, Test, TiltComparison};
use centrical::{Calibration, Experiment, FitError, Observation, SetPoint};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::experiment::PlateauName;
use crate::reduced::{Reduced, ReducedPlateau};

/// Samples that are not used, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LeftOutSummary {
    /// Samples that stand out of the noise.
    pub spikes: usize,
    /// Samples in runs that repeat one reading for longer than noise does.
    pub stuck: usize,
    /// Samples that never came, and readings that are not numbers.
    pub missing: usize,
    /// Samples with the stamp of the one before.
    pub repeated: usize,
}

impl From<LeftOut> for LeftOutSummary {
    fn from(LeftOut { spikes, stuck, missing, repeated }: LeftOut) -> Self {
        Self { spikes, stuck, missing, repeated }
    }
}

/// How the readings drifted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriftSummary {
    /// Mean slope over the plateaus, newtonometers 1, 2, 3 [m/s^3].
    pub slope: [f64; 3],
    /// Its standard uncertainty [m/s^3].
    pub slope_uncertainty: [f64; 3],
    /// Sum of the squared slopes of all plateaus over their variances.
    pub chi_squared: f64,
    /// Slopes.
    pub degrees_of_freedom: usize,
    /// Probability of so large a chi^2 without any drift.
    pub probability: f64,
    /// The same sum of what the speed of each plateau leaves unexplained, by its measured slope and its stated uncertainty. Older programs
    /// wrote none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_speed: Option<f64>,
    /// Slopes of rests as they follow the change of the reading before them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creep: Option<CreepSummary>,
    /// Trend of the residuals with the order of the plateaus; empty where the unknowns follow it.
    pub over_session: Vec<SessionTrend>,
    /// Plateaus of one mounting that were run again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<RepeatedPlateau>,
}

/// Readings that creep after the unit was turned.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CreepSummary {
    /// Slope over a rest per change of the reading before it [1/s].
    pub rate: f64,
    /// Its standard uncertainty [1/s].
    pub standard_uncertainty: f64,
    /// Probability of so large a rate by chance.
    pub probability: f64,
}

impl CreepSummary {
    /// Whether chance is ruled out.
    pub fn is_real(&self) -> bool {
        Level::Real.is_passed_by(self.probability)
    }
}

/// A trend over the session.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SessionTrend {
    /// Newtonometer: 1, 2 or 3.
    pub axis: usize,
    /// Change from the first to the last plateau, as one more unknown of the fit [m/s^2].
    pub change: f64,
    /// Its standard uncertainty [m/s^2].
    pub standard_uncertainty: f64,
    /// Probability of so large a change by chance.
    pub probability: f64,
}

/// A plateau that was run again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RepeatedPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// The two plateaus of its schedule, counted from 0.
    pub indices: [usize; 2],
    /// Second mean less the first [m/s^2].
    pub difference: [f64; 3],
    /// Square of the difference over its covariance, speeds included: chi^2 of three degrees of freedom.
    pub chi_squared: f64,
    /// Probability of so large a chi^2 by chance.
    pub probability: f64,
}

/// The tilt of the axis of rotation seen while spinning, against the fitted one, which is known from rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TiltSummary {
    /// Tilt by the fit [rad].
    pub at_rest: f64,
    /// Its standard uncertainty [rad].
    pub at_rest_uncertainty: f64,
    /// Tilt seen while spinning [rad].
    pub spinning: f64,
    /// Its standard uncertainty [rad].
    pub spinning_uncertainty: f64,
    /// The same if the arm turned the other way [rad]: nothing but noise.
    pub reversed: f64,
    /// Plateaus that tell.
    pub plateaus: usize,
    /// Plateaus in which something else turns with the arm, left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub disturbed: Vec<DisturbedPlateau>,
    /// chi^2 of the plateaus about their mean, with one degree of freedom less than plateaus.
    pub scatter_chi_squared: f64,
    /// Probability of so large a scatter by chance.
    pub scatter_probability: f64,
    /// chi^2 of the difference, with one degree of freedom.
    pub chi_squared: f64,
    /// Probability of so large a difference by chance.
    pub probability: f64,
}

/// A plateau in which something turns with the arm that no tilt makes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DisturbedPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// The plateau of its schedule, counted from 0.
    pub index: usize,
    /// The tilt that it looks like [rad].
    pub tilt: f64,
}

/// What the two tilts say of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TiltVerdict {
    /// Chance explains their difference.
    Agree,
    /// They differ.
    Differ,
    /// The one seen while spinning would agree better if the arm turned the other way.
    Reversed,
    /// They differ, and while spinning none is seen.
    Absent,
}

/// What the slopes say of a drift over the plateaus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlateauDriftVerdict {
    /// No more than the noise explains.
    NotSeen,
    /// More than the noise explains, and no more than the speeds may run.
    WithinSpeed,
    /// More than both explain.
    Seen,
}

/// What the residuals say of a drift over the session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SessionDriftVerdict {
    /// No more than the stated uncertainties explain.
    NotSeen,
    /// Larger than chance makes it in one session of twenty, and no proof of a drift.
    Unsure,
    /// More than the stated uncertainties explain, and no more than the plateaus scatter about the fit.
    WithinScatter,
    /// More than the plateaus scatter about the fit.
    Seen,
}

impl TiltSummary {
    fn new(tilt: &TiltComparison, set_points: &[SetPoint]) -> Self {
        let disturbed = |&(set_point, tilt): &(usize, f64)| {
            let PlateauName { mounting, plateau } = PlateauName::among(set_points, set_point);
            DisturbedPlateau { mounting, index: plateau - 1, tilt }
        };
        Self {
            at_rest: tilt.at_rest,
            at_rest_uncertainty: tilt.at_rest_uncertainty,
            spinning: tilt.spinning,
            spinning_uncertainty: tilt.spinning_uncertainty,
            reversed: tilt.reversed,
            plateaus: tilt.plateaus,
            disturbed: tilt.disturbed.iter().map(disturbed).collect(),
            scatter_chi_squared: tilt.scatter_chi_squared,
            scatter_probability: tilt.scatter_probability,
            chi_squared: tilt.chi_squared,
            probability: tilt.probability,
        }
    }

    /// What the two tilts say of each other.
    pub fn verdict(&self) -> TiltVerdict {
        match Level::Real.is_passed_by(self.probability) {
            false => TiltVerdict::Agree,
            true if self.is_absent(self.spinning) && self.is_absent(self.reversed) => TiltVerdict::Absent,
            true if self.reversed > self.spinning => TiltVerdict::Reversed,
            true => TiltVerdict::Differ,
        }
    }

    /// Whether a tilt while spinning is within its expanded uncertainty.
    fn is_absent(&self, tilt: f64) -> bool {
        tilt < 2.0 * self.spinning_uncertainty
    }

    /// Whether the plateaus' own tilts scatter.
    pub fn scatters(&self) -> bool {
        Level::Real.is_passed_by(self.scatter_probability)
    }

    /// The tilts of a session; none for one that came already averaged.
    pub(crate) fn of(calibration: &Calibration, reduced: &Reduced) -> Option<Self> {
        let set_points = &calibration.data().model().experiment().set_points;
        let term = |(set_point, plateau): (usize, &ReducedPlateau)| {
            let seen = plateau.steady().filter(|_| !set_points[set_point].is_rest())?;
            let (quadratures, covariance) = (seen.once_per_revolution, seen.once_per_revolution_covariance);
            Some(OncePerRevolution { set_point, quadratures, covariance })
        };
        let terms: Vec<OncePerRevolution> = reduced.plateaus.iter().enumerate().filter_map(term).collect();
        calibration.tilt_while_spinning(&terms).map(|tilt| Self::new(&tilt, set_points))
    }
}

impl DriftSummary {
    /// What the slopes say of a drift over the plateaus.
    pub fn plateau_verdict(&self) -> PlateauDriftVerdict {
        let beyond_speed = |chi_squared| Test::chi_squared(chi_squared, self.degrees_of_freedom).probability;
        if !Level::Real.is_passed_by(self.probability) {
            PlateauDriftVerdict::NotSeen
        } else if Level::Real.is_passed_by(self.beyond_speed.map_or(self.probability, beyond_speed)) {
            PlateauDriftVerdict::Seen
        } else {
            PlateauDriftVerdict::WithinSpeed
        }
    }

    /// What the residuals say of a drift over the session, family-wise over the newtonometers (Bonferroni).
    pub fn session_verdict(&self) -> SessionDriftVerdict {
        let tests = self.over_session.len() as f64;
        let any = |level: Level, probability: &dyn Fn(&SessionTrend) -> f64| {
            self.over_session.iter().any(|trend| level.is_passed_by(tests * probability(trend)))
        };
        let stated = |trend: &SessionTrend| {
            Test::chi_squared((trend.change / trend.standard_uncertainty).powi(2), 1).probability
        };
        if any(Level::Real, &|trend| trend.probability) {
            SessionDriftVerdict::Seen
        } else if any(Level::Real, &stated) {
            SessionDriftVerdict::WithinScatter
        } else if any(Level::Reported, &stated) {
            SessionDriftVerdict::Unsure
        } else {
            SessionDriftVerdict::NotSeen
        }
    }

    /// The plateaus run again that are farthest apart, and whether they differ (Bonferroni).
    pub fn farthest_apart(&self) -> Option<(&RepeatedPlateau, bool)> {
        let worst = self.repeats.iter().min_by(|a, b| a.probability.total_cmp(&b.probability))?;
        Some((worst, Level::Real.is_passed_by(self.repeats.len() as f64 * worst.probability)))
    }

    /// The drift of a session; none for one that came already averaged.
    pub(crate) fn of(calibration: &Calibration, reduced: &Reduced) -> Result<Option<Self>, FitError> {
        let experiment = calibration.data().model().experiment();
        let slope = |(plateau, set_point): (&ReducedPlateau, &SetPoint)| {
            let seen = plateau.steady()?;
            let is_free = experiment.position_of(set_point).is_free;
            Some(Slope {
                slope: seen.drift,
                standard_uncertainty: seen.drift_uncertainty,
                along: is_free.then(|| plateau.mean.normalize()),
            })
        };
        let slopes = reduced.plateaus.iter().zip(&experiment.set_points).map(slope);
        let Some(slopes) = slopes.collect::<Option<Vec<Slope>>>() else { return Ok(None) };
        let (mean, drift) = Slope::together(&slopes);
        // Telemetry may repeat the set speed: what the stated uncertainty of the speed explains is no drift, whatever telemetry shows.
        let beyond = |counts| Slope::together(&beyond_speed(calibration, reduced, &slopes, counts)).1.statistic;
        Ok(Some(Self {
            slope: mean.slope.into(),
            slope_uncertainty: mean.standard_uncertainty.into(),
            chi_squared: drift.statistic,
            degrees_of_freedom: drift.degrees_of_freedom,
            probability: drift.probability,
            beyond_speed: Some(beyond(true).min(beyond(false))),
            creep: creep(experiment, reduced, &slopes),
            over_session: calibration.drift_over_session()?.iter().map(SessionTrend::from).collect(),
            repeats: repeated(calibration, reduced),
        }))
    }
}

impl From<&Pattern> for SessionTrend {
    fn from(&Pattern { axis, amplitude, standard_uncertainty, probability, .. }: &Pattern) -> Self {
        // The amplitude is half of the way from the first plateau to the last.
        let [change, standard_uncertainty] = [amplitude, standard_uncertainty].map(|half| 2.0 * half);
        Self { axis: axis + 1, change, standard_uncertainty, probability }
    }
}

/// How the rests apart from the arm creep, each after the one before in its record.
fn creep(experiment: &Experiment, reduced: &Reduced, slopes: &[Slope]) -> Option<CreepSummary> {
    let is_rest =
        |n: usize| !experiment.is_on_arm(experiment.set_points[n].mounting) && reduced.plateaus[n].steady().is_some();
    let after = |n: usize| {
        let [before, plateau] = [n - 1, n].map(|n| &reduced.plateaus[n]);
        let follows = is_rest(n - 1) && is_rest(n) && before.window()?[1] < plateau.window()?[0];
        follows.then(|| (slopes[n], plateau.mean, plateau.mean - before.mean))
    };
    let rests: Vec<_> = (1..slopes.len()).filter_map(after).collect();
    let ([rate, standard_uncertainty], test) = Slope::creep(&rests)?;
    Some(CreepSummary { rate, standard_uncertainty, probability: test.probability })
}

/// The slopes of all plateaus, less what their speeds explain as they are stated, and as telemetry shows them where it `counts`.
fn beyond_speed(calibration: &Calibration, reduced: &Reduced, slopes: &[Slope], counts: bool) -> Vec<Slope> {
    let model = calibration.data().model();
    let experiment = model.experiment();
    let beyond = |(n, slope): (usize, &Slope)| {
        let set_point = &experiment.set_points[n];
        let own = experiment.speed_uncertainty_of(set_point);
        let Some([from, to]) = reduced.plateaus[n].window().filter(|_| own > 0.0) else { return *slope };
        let by_log_speed = model.linearise(set_point, calibration.fit().state()).setting_error / own;
        let speed = reduced.speeds.get(n).copied().flatten().filter(|_| counts);
        let measured = speed.and_then(|speed| speed.slope);
        slope.beyond_speed(&by_log_speed, Slope::of_speed(experiment.centrifuge.speed_uncertainty, to - from, measured))
    };
    slopes.iter().enumerate().map(beyond).collect()
}

fn repeated(calibration: &Calibration, reduced: &Reduced) -> Vec<RepeatedPlateau> {
    let model = calibration.data().model();
    let set_points = &model.experiment().set_points;
    let plateaus = reduced.plateaus.iter().enumerate();
    let plateaus: Vec<Observation> = plateaus.map(|(set_point, plateau)| plateau.observation(set_point)).collect();
    let summary = |(pair, difference, test): ([usize; 2], Vector3<f64>, Test)| RepeatedPlateau {
        mounting: PlateauName::among(set_points, pair[0]).mounting,
        indices: pair.map(|set_point| PlateauName::among(set_points, set_point).plateau - 1),
        difference: difference.into(),
        chi_squared: test.statistic,
        probability: test.probability,
    };
    model.repeats(calibration.fit().state(), &plateaus).into_iter().map(summary).collect()
}
