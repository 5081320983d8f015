//! Whether a calibration is acceptable, and the levels of probability at which its checks speak.

use crate::fit::Termination;

use crate::reduction::NoiseModel;
use crate::statistics::chi_squared_tail;

/// A level of probability: what is less probable by chance is not taken for chance.
///
/// Reports inform and may be wrong in one sound session of twenty. An objection refuses a result, so it must be rare in
/// sound sessions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// A plateau stands out, or a pattern shows in the residuals: family-wise 5 %.
    Reported,
    /// Two calibrations of one unit disagree: 1 %.
    Disagreement,
    /// A drift or a difference of tilts is real: 0.1 %.
    Real,
    /// An objection to the result: 0.01 %.
    Objection,
}

impl Level {
    /// Its probability.
    pub const fn probability(self) -> f64 {
        match self {
            Self::Reported => 0.05,
            Self::Disagreement => 1e-2,
            Self::Real => 1e-3,
            Self::Objection => 1e-4,
        }
    }

    /// Whether something of this probability by chance is beyond the level.
    pub fn is_passed_by(self, probability: f64) -> bool {
        probability < self.probability()
    }
}

/// What the checks of a calibration found; `P` names a plateau, `Q` a pattern, `R` a rival, `S` a contradiction of speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings<P, Q, R, S> {
    /// How the fit ended.
    pub termination: Termination,
    /// Linearisations made.
    pub iterations: usize,
    /// chi^2 of the fit.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// chi^2 with the strongest noise that is not excluded ([`Rests`](crate::reduction::Rests)); `None` where the noise is known.
    pub of_strongest_noise: Option<f64>,
    /// Plateaus that stand out, each with its family-wise probability, the most outlying first.
    pub outlying: Vec<(P, f64)>,
    /// The rival that explains most and those which the data cannot tell from it, each with its family-wise probability.
    pub rivals: Vec<(R, f64)>,
    /// Patterns in the residuals, each with its family-wise probability.
    pub patterns: Vec<(Q, f64)>,
    /// Speeds that contradict the schedule, each with its family-wise probability.
    pub speeds: Vec<(S, f64)>,
    /// chi^2 of the slopes of all plateaus beyond what their speeds explain, and their number, where records show them
    /// ([`PlateauDrift`](super::PlateauDrift)).
    pub slopes: Option<(f64, usize)>,
    /// Probability of slopes of rests that follow the change of the reading before ([`Creep`](super::Creep)), where rests show them.
    pub creep: Option<f64>,
    /// Names of the instrument's parameters that are not determined.
    pub not_determined: Vec<String>,
}

/// Variance of the slope of a plateau at most, over the one stated: noise that is slower than a plateau hardly shows within it, and doubles
/// the variance where it is as strong as the white noise.
const SLOW_NOISE: f64 = 2.0;

/// An objection to a result.
#[derive(Debug, Clone, PartialEq)]
pub enum Objection<P, Q, R, S> {
    /// The fit did not converge.
    NotConverged {
        /// How it ended.
        termination: Termination,
        /// Linearisations made.
        iterations: usize,
    },
    /// The model leaves out what the residuals show: the rival that explains most, and those which the data cannot tell from it.
    LeftOut(Vec<R>),
    /// Residuals are larger than the stated uncertainties explain.
    Residuals {
        /// chi^2.
        chi_squared: f64,
        /// Its degrees of freedom.
        degrees_of_freedom: usize,
        /// Probability of so large a chi^2.
        chance: f64,
    },
    /// Plateaus that stand out, and the probability of the first.
    Outlying(Vec<P>, f64),
    /// Residuals follow something that the model does not have.
    Patterns(Vec<Q>),
    /// The telemetry contradicts the schedule or the record.
    Speeds(Vec<S>),
    /// Readings drift over plateaus by more than slow noise and the speeds explain.
    Drift {
        /// chi^2 of the slopes.
        chi_squared: f64,
        /// Their number.
        degrees_of_freedom: usize,
        /// Probability of so large a chi^2.
        chance: f64,
    },
    /// Readings creep after the unit is turned, and rests are too short for that; with the probability of such slopes by chance.
    Creep(f64),
    /// Parameters of the instrument are not determined. Lost geometry alone is not an objection.
    NotDetermined(Vec<String>),
}

impl<P, Q, R, S> Findings<P, Q, R, S> {
    /// The objections to a calibration; empty if it is acceptable.
    pub fn objections(self) -> Vec<Objection<P, Q, R, S>> {
        let Findings {
            termination,
            iterations,
            chi_squared,
            degrees_of_freedom,
            of_strongest_noise,
            outlying,
            rivals,
            patterns,
            speeds,
            slopes,
            creep,
            not_determined,
        } = self;
        let is_beyond = |probability: f64| Level::Objection.is_passed_by(probability);
        let mut objections = Vec::new();
        match termination {
            Termination::Stalled | Termination::IterationLimit => {
                objections.push(Objection::NotConverged { termination, iterations });
            }
            Termination::Linear | Termination::Converged => {}
        }
        if rivals.iter().any(|(_, probability)| is_beyond(*probability)) {
            objections.push(Objection::LeftOut(rivals.into_iter().map(|(rival, _)| rival).collect()));
        }
        let chance = chance_of_residuals(chi_squared, degrees_of_freedom, of_strongest_noise);
        if is_beyond(chance) {
            objections.push(Objection::Residuals { chi_squared, degrees_of_freedom, chance });
        }
        let (plateaus, chances): (Vec<P>, Vec<f64>) =
            outlying.into_iter().filter(|(_, chance)| is_beyond(*chance)).unzip();
        objections.extend(chances.first().map(|first| Objection::Outlying(plateaus, *first)));
        let patterns: Vec<Q> =
            patterns.into_iter().filter(|(_, p)| is_beyond(*p)).map(|(pattern, _)| pattern).collect();
        if !patterns.is_empty() {
            objections.push(Objection::Patterns(patterns));
        }
        let speeds: Vec<S> = speeds.into_iter().filter(|(_, p)| is_beyond(*p)).map(|(speed, _)| speed).collect();
        if !speeds.is_empty() {
            objections.push(Objection::Speeds(speeds));
        }
        if let Some((chi_squared, degrees_of_freedom)) = slopes {
            let chance = chi_squared_tail(chi_squared / SLOW_NOISE, degrees_of_freedom);
            if is_beyond(chance) {
                objections.push(Objection::Drift { chi_squared, degrees_of_freedom, chance });
            }
        }
        objections.extend(creep.filter(|chance| is_beyond(*chance)).map(Objection::Creep));
        if !not_determined.is_empty() {
            objections.push(Objection::NotDetermined(not_determined));
        }
        objections
    }
}

/// Probability of a chi^2 as large by chance. Unknown noise is at most as strong as that by which chi^2 is `of_strongest_noise`,
/// but for a chance of [`NoiseModel::EXCLUDED`]: the largest probability over all noise that is not excluded, plus that chance (Berger and Boos 1994).
pub fn chance_of_residuals(chi_squared: f64, degrees_of_freedom: usize, of_strongest_noise: Option<f64>) -> f64 {
    let chance = |chi_squared| chi_squared_tail(chi_squared, degrees_of_freedom);
    of_strongest_noise.map_or_else(|| chance(chi_squared), |least| (chance(least) + NoiseModel::EXCLUDED).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_slopes(slopes: (f64, usize)) -> Vec<Objection<(), (), (), ()>> {
        Findings {
            termination: Termination::Converged,
            iterations: 3,
            chi_squared: 275.0,
            degrees_of_freedom: 275,
            of_strongest_noise: None,
            outlying: Vec::new(),
            rivals: Vec::new(),
            patterns: Vec::new(),
            speeds: Vec::new(),
            slopes: Some(slopes),
            creep: None,
            not_determined: Vec::new(),
        }
        .objections()
    }

    /// Slow noise that doubles the variance of slopes is not drift; a slope beyond it is.
    #[test]
    fn drift_is_beyond_slow_noise() {
        for chi_squared in [250.0, 330.0, 600.0] {
            assert_eq!(with_slopes((chi_squared, 288)), Vec::new(), "{chi_squared}");
        }
        for chi_squared in [900.0, 2242.0] {
            assert!(matches!(with_slopes((chi_squared, 288))[..], [Objection::Drift { .. }]), "{chi_squared}");
        }
    }
}
