//! How far a result can be trusted: the uncertainties by their sources, and the checks of the fit.

use centrical::uncertainty::{BetweenRests, Budget, Level, Pattern, Rivals, Test, Trend, Validity};
use centrical::{Calibration, Experiment, FitError};
use centrical::{Prior, Source};
use serde::{Deserialize, Serialize};

use super::rivals::RivalSummary;
use crate::document::json::finite_degrees;
use crate::experiment::PlateauName;

/// The uncertainties by their sources.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BudgetSummary {
    /// The sources.
    pub sources: Vec<BudgetSource>,
    /// Combined standard uncertainty, SI, in the order of the parameters; null where one is not estimable.
    pub combined: Vec<Option<f64>>,
    /// Effective degrees of freedom of each (Welch-Satterthwaite); null where they are infinite or one is not estimable.
    #[serde(default)]
    pub degrees_of_freedom: Vec<Option<f64>>,
}

/// What one source of uncertainty leaves in the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BudgetSource {
    /// Which.
    #[serde(with = "crate::document::json")]
    pub name: Source,
    /// Whether the fit weighs it (noise, speed of each plateau, priors); what it does not weigh, the session states.
    #[serde(default)]
    pub weighed_in_fit: bool,
    /// Standard uncertainty it leaves, SI, in the order of the parameters; null where one is not estimable.
    pub standard_uncertainty: Vec<Option<f64>>,
    /// Signed changes of the parameters, SI, by each influence of the source at one standard uncertainty: a row for each influence,
    /// in the order of the parameters. Of priors a row for each, in the order of the parameters that have one. None for sources that are drawn
    /// anew in every session, and in results of older programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changes: Option<Vec<Vec<Option<f64>>>>,
}

/// Whether the residuals are those of a true model with true weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ValiditySummary {
    /// Probability of so large a chi^2 by chance.
    pub probability: f64,
    /// Variance of the residuals of rests at most, over the one stated, where the colour of their noise is known poorly. The
    /// verdict takes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_at_most: Option<f64>,
    /// chi^2 of a fit with that noise, and with the stated uncertainties of attitudes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_strongest_noise: Option<f64>,
    /// Plateaus that stand out at a family-wise error of 5 % (Bonferroni), the most outlying first.
    pub outlying: Vec<OutlyingPlateau>,
    /// Each mounting predicted from all others.
    pub mountings: Vec<MountingPrediction>,
    /// Patterns that were looked for in the residuals.
    pub patterns_tested: usize,
    /// Those found at a family-wise error of 5 % (Holm), the likeliest to be real first: beside what the first rival explains.
    pub patterns: Vec<PatternSummary>,
    /// Effects left out by the model that the residuals were asked for.
    #[serde(default)]
    pub rivals_tested: usize,
    /// Those shown at a family-wise error of 5 % (Holm), the one that explains most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rivals: Vec<RivalSummary>,
    /// Parameters of the instrument that rest on readings which no other reading checks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unchecked: Vec<String>,
}

impl ValiditySummary {
    /// The mounting that its prediction from all others meets worst, with the probability of as bad a worst one (Bonferroni).
    pub fn worst_mounting(&self) -> Option<(&MountingPrediction, f64)> {
        let worst = self.mountings.iter().min_by(|a, b| a.probability.total_cmp(&b.probability))?;
        Some((worst, (self.mountings.len() as f64 * worst.probability).min(1.0)))
    }
}

/// A plateau that stands out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OutlyingPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// Plateau of the mounting's schedule, counted from 0.
    pub index: usize,
    /// Residuals over their standard deviations.
    pub standardised: [f64; 3],
    /// Probability of one so far out among all plateaus.
    pub probability: f64,
}

/// A mounting against its prediction from all others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MountingPrediction {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// Fall of chi^2 without it.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of so large a one by chance; 1 when nothing is redundant.
    pub probability: f64,
}

/// A pattern in the residuals of one newtonometer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PatternSummary {
    /// Newtonometer: 1, 2 or 3.
    pub axis: usize,
    /// What they follow.
    #[serde(flatten)]
    pub follows: Follows,
    /// Amplitude [m/s^2]: of a step; at the highest speed or load; over the session.
    pub amplitude: f64,
    /// Its standard uncertainty [m/s^2].
    pub standard_uncertainty: f64,
    /// Probability of so large a one by chance among all that were looked for.
    pub probability: f64,
}

/// What residuals follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "follows", rename_all = "kebab-case")]
pub enum Follows {
    /// A step in one position.
    Position {
        /// Its id.
        position: String,
    },
    /// The square of the speed in one position.
    SpeedInPosition {
        /// Its id.
        position: String,
    },
    /// The square of the speed on one seat.
    SpeedOnSeat {
        /// Its radius [m].
        radius: f64,
    },
    /// The square of the speed.
    Speed,
    /// The square of the speed times the radius.
    Load,
    /// A step in one mounting.
    Mounting {
        /// Counted from 1.
        mounting: usize,
    },
    /// The order of the plateaus.
    Time,
}

impl BudgetSummary {
    pub(crate) fn new(budget: &Budget, count: usize, priors: &[Prior]) -> Self {
        let known = |j: usize| budget.standard_uncertainty(j);
        let influences = |c: &centrical::uncertainty::Contribution| -> Option<Vec<usize>> {
            if c.source == Source::Priors && !priors.is_empty() {
                // What curvature adds stands behind them.
                let mut rows: Vec<usize> = (0..priors.len()).collect();
                rows.sort_by_key(|&n| priors[n].parameter);
                return Some(rows);
            }
            c.source.is_shared().then(|| (0..c.changes().ncols()).collect())
        };
        let source = |c: &centrical::uncertainty::Contribution| BudgetSource {
            name: c.source,
            weighed_in_fit: c.source.is_weighed(),
            standard_uncertainty: (0..count).map(|j| known(j).map(|_| c.standard_uncertainty(j))).collect(),
            changes: influences(c).map(|rows| {
                let influence = |n| (0..count).map(|j| known(j).map(|_| c.changes()[(j, n)])).collect();
                rows.into_iter().map(influence).collect()
            }),
        };
        Self {
            sources: budget.contributions().iter().map(source).collect(),
            combined: (0..count).map(known).collect(),
            degrees_of_freedom: (0..count).map(|j| budget.degrees_of_freedom(j).and_then(finite_degrees)).collect(),
        }
    }
}

impl ValiditySummary {
    /// The checks of a calibration, of rests whose noise may be stronger by `noise_at_most`.
    pub(crate) fn of(calibration: &Calibration, rivals: &Rivals, noise_at_most: Option<f64>) -> Result<Self, FitError> {
        let experiment = calibration.data().model().experiment();
        let suspects = rivals.suspects(Level::Reported.probability());
        let patterns = match suspects.shown.first() {
            Some(first) => calibration.patterns_beside(rivals, first.rival)?,
            None => calibration.patterns()?,
        };
        let checks = Self::new(experiment, &calibration.validity()?, &patterns);
        let parameters = calibration.data().model().parameters();
        let unchecked = calibration.unchecked()?.into_iter().map(|j| parameters[j].name.clone()).collect();
        let of_strongest_noise = noise_at_most.map(|times| calibration.chi_squared_of_noise(times)).transpose()?;
        let (rivals_tested, rivals) = (suspects.tested, RivalSummary::all(&suspects, experiment));
        Ok(Self { noise_at_most, of_strongest_noise, rivals_tested, rivals, unchecked, ..checks })
    }

    /// The checks of a fit in the form of the file.
    pub fn new(experiment: &Experiment, validity: &Validity, patterns: &[Pattern]) -> Self {
        let family = validity.plateaus.len() as f64;
        let mut outlying: Vec<OutlyingPlateau> = validity
            .plateaus
            .iter()
            .map(|check| {
                let PlateauName { mounting, plateau } = PlateauName::among(&experiment.set_points, check.set_point);
                OutlyingPlateau {
                    mounting,
                    index: plateau - 1,
                    standardised: check.standardised.into(),
                    probability: (family * check.test.probability).min(1.0),
                }
            })
            .filter(|plateau| Level::Reported.is_passed_by(plateau.probability))
            .collect();
        outlying.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        let prediction = |(mounting, test): &(usize, Test)| MountingPrediction {
            mounting: mounting + 1,
            chi_squared: test.statistic,
            degrees_of_freedom: test.degrees_of_freedom,
            probability: test.probability,
        };
        let reported = patterns.iter().filter(|pattern| Level::Reported.is_passed_by(pattern.family_wise));
        Self {
            probability: validity.probability,
            noise_at_most: None,
            of_strongest_noise: None,
            outlying,
            mountings: validity.mountings.iter().map(prediction).collect(),
            patterns_tested: patterns.len(),
            patterns: reported.map(|pattern| PatternSummary::new(experiment, pattern)).collect(),
            rivals_tested: 0,
            rivals: Vec::new(),
            unchecked: Vec::new(),
        }
    }
}

impl PatternSummary {
    /// A pattern in the form of the file.
    pub fn new(experiment: &Experiment, pattern: &Pattern) -> Self {
        let id = |k: usize| experiment.positions[k].id.clone();
        let follows = match pattern.trend {
            Trend::Position(k) => Follows::Position { position: id(k) },
            Trend::SpeedInPosition(k) => Follows::SpeedInPosition { position: id(k) },
            Trend::SpeedOnSeat(m) => Follows::SpeedOnSeat { radius: experiment.mountings[m].arm_y.x },
            Trend::Speed => Follows::Speed,
            Trend::Load => Follows::Load,
            Trend::Mounting(m) => Follows::Mounting { mounting: m + 1 },
            Trend::Time => Follows::Time,
        };
        Self {
            axis: pattern.axis + 1,
            follows,
            amplitude: pattern.amplitude,
            standard_uncertainty: pattern.standard_uncertainty,
            probability: pattern.family_wise,
        }
    }
}

/// Standard deviations of what the residuals of rests alone cannot exclude; the uncertainties include both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BetweenRestsSummary {
    /// Scatter of the reading of a rest beside its noise [m/s^2].
    pub scatter: f64,
    /// Change of each bias from the first rest to the last [m/s^2]; zero where the session has or states one.
    pub drift: f64,
}

impl From<BetweenRests> for BetweenRestsSummary {
    fn from(BetweenRests { scatter, drift }: BetweenRests) -> Self {
        Self { scatter, drift }
    }
}
