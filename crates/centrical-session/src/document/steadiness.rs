//! How steady the readings were: over a plateau, over the session, over a revolution; and what was left out.

use centrical::reduction::LeftOut;
use centrical::uncertainty::{
    OncePerRevolution, TiltComparison, Trend, chi_squared_tail, tilt_while_spinning, trends_of,
};
use centrical::{Fit, MeasurementModel, Termination};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::reduced::{Reduced, ReducedPlateau, Steadiness};

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
    /// Trend of the residuals with the order of the plateaus; empty where the unknowns follow it.
    pub over_session: Vec<SessionTrend>,
    /// Plateaus of one mounting that were run again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<RepeatedPlateau>,
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
    /// chi^2 of the plateaus about their mean, with one degree of freedom less than plateaus.
    pub scatter_chi_squared: f64,
    /// Probability of so large a scatter by chance.
    pub scatter_probability: f64,
    /// chi^2 of the difference, with one degree of freedom.
    pub chi_squared: f64,
    /// Probability of so large a difference by chance.
    pub probability: f64,
}

impl From<TiltComparison> for TiltSummary {
    fn from(tilt: TiltComparison) -> Self {
        Self {
            at_rest: tilt.at_rest,
            at_rest_uncertainty: tilt.at_rest_uncertainty,
            spinning: tilt.spinning,
            spinning_uncertainty: tilt.spinning_uncertainty,
            reversed: tilt.reversed,
            plateaus: tilt.plateaus,
            scatter_chi_squared: tilt.scatter_chi_squared,
            scatter_probability: tilt.scatter_probability,
            chi_squared: tilt.chi_squared,
            probability: tilt.probability,
        }
    }
}

/// The tilts of a session; none for one that came already averaged.
pub(crate) fn tilt(model: &MeasurementModel, reduced: &Reduced, fit: &Fit) -> Option<TiltSummary> {
    let term = |(set_point, plateau): (usize, &ReducedPlateau)| {
        let Steadiness { quadratures, quadrature_covariance: covariance, .. } = plateau.steadiness?;
        let spins = !model.experiment().set_points[set_point].is_rest();
        spins.then_some(OncePerRevolution { set_point, quadratures, covariance })
    };
    let terms: Vec<OncePerRevolution> = reduced.plateaus.iter().enumerate().filter_map(term).collect();
    tilt_while_spinning(fit, model, &terms).map(TiltSummary::from)
}

/// The drift of a session; none for one that came already averaged.
pub(crate) fn drift(model: &MeasurementModel, reduced: &Reduced, fit: &Fit) -> Option<DriftSummary> {
    let steadiness: Vec<Steadiness> =
        reduced.plateaus.iter().map(|plateau| plateau.steadiness).collect::<Option<_>>()?;
    let (mut weights, mut sums, mut chi_squared) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for Steadiness { drift, drift_uncertainty, .. } in &steadiness {
        let weight = drift_uncertainty.map(|u| 1.0 / (u * u));
        weights += weight;
        sums += weight.component_mul(drift);
        chi_squared += drift.component_div(drift_uncertainty).norm_squared();
    }
    let degrees_of_freedom = 3 * steadiness.len();
    Some(DriftSummary {
        slope: sums.component_div(&weights).into(),
        slope_uncertainty: weights.map(|weight| 1.0 / weight.sqrt()).into(),
        chi_squared,
        degrees_of_freedom,
        probability: chi_squared_tail(chi_squared, degrees_of_freedom),
        over_session: over_session(model, reduced, fit),
        repeats: repeats(model, reduced, fit),
    })
}

fn over_session(model: &MeasurementModel, reduced: &Reduced, fit: &Fit) -> Vec<SessionTrend> {
    // A linear fit leaves its second-order terms in the residuals.
    if fit.termination == Termination::Linear {
        return Vec::new();
    }
    let found = trends_of(fit, model, &reduced.observations(), &[Trend::Time]);
    let trend = |pattern: &centrical::uncertainty::Pattern| SessionTrend {
        axis: pattern.axis + 1,
        // The pattern's largest entry is half of the way from the first plateau to the last.
        change: 2.0 * pattern.amplitude,
        standard_uncertainty: 2.0 * pattern.standard_uncertainty,
        probability: pattern.probability,
    };
    let mut trends: Vec<SessionTrend> = found.unwrap_or_default().iter().map(trend).collect();
    trends.sort_by_key(|trend| trend.axis);
    trends
}

/// Every plateau against the first of the same set point in the same mounting.
fn repeats(model: &MeasurementModel, reduced: &Reduced, fit: &Fit) -> Vec<RepeatedPlateau> {
    let set_points = &model.experiment().set_points;
    let first_of = |m: usize| set_points.iter().position(|s| s.mounting == m).unwrap_or(0);
    let repeat = |second: usize| {
        let set_point = &set_points[second];
        let first = set_points[..second].iter().position(|other| other == set_point)?;
        let [one, two] = [first, second].map(|n| &reduced.plateaus[n]);
        let along = model.linearise(set_point, fit.state()).speed_error;
        let difference = two.mean - one.mean;
        let covariance = one.covariance + two.covariance + 2.0 * along * along.transpose();
        let chi_squared = difference.dot(&covariance.cholesky()?.solve(&difference));
        let start = first_of(set_point.mounting);
        Some(RepeatedPlateau {
            mounting: set_point.mounting + 1,
            indices: [first - start, second - start],
            difference: difference.into(),
            chi_squared,
            probability: chi_squared_tail(chi_squared, 3),
        })
    };
    (0..set_points.len()).filter_map(repeat).collect()
}
