//! Deviations with their confidence intervals.

use super::error::NoiseError;
use super::estimator::Estimator;
use super::phase::Phase;
use super::power_law::{FollowedLaw, PowerLaw};
use crate::progress::{OnProgress, Watch};
use crate::statistics::chi_squared_quantiles;

/// One point of a stability plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Averaging factor m.
    pub factor: usize,
    /// Averaging time tau = m tau0, s.
    pub tau: f64,
    /// The deviation, corrected for `bias`, in the readings' unit (time deviations: the phase's).
    pub value: f64,
    /// Lower end of the confidence interval.
    pub lower: f64,
    /// Upper end of the confidence interval.
    pub upper: f64,
    /// Terms averaged.
    pub terms: usize,
    /// Equivalent degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Power law that the bias and the degrees of freedom hold for.
    pub law: PowerLaw,
    /// Whether enough points were left to look for the power law at this tau; else it is that of the next shorter tau.
    pub is_identified: bool,
    /// Expected variance of the estimator over the true one; the variance was divided by it.
    pub bias: f64,
}

impl Phase {
    /// The deviations of the record at the averaging factors `factors`, with intervals at the level `confidence`
    /// (0.683 for one standard deviation).
    ///
    /// The true variance is within `edf s^2 / chi^2_(1-p) .. edf s^2 / chi^2_p`, p = (1 - confidence) / 2 [SP 1065,
    /// eq. 45]. Degrees of freedom and bias follow from the power law, which is that of the next shorter tau unless
    /// another is shown, white at first; gaps cost freedom in proportion to the terms they cost. Factors too long for the
    /// record are left out of the answer. `progress` is asked again and again.
    ///
    /// # Errors
    /// [`NoiseError::BadConfidence`], or [`NoiseError::Stopped`].
    pub fn deviations(
        &self,
        estimator: Estimator,
        factors: &[usize],
        confidence: f64,
        progress: OnProgress<()>,
    ) -> Result<Vec<Deviation>, NoiseError> {
        if !(confidence > 0.0 && confidence < 1.0) {
            return Err(NoiseError::BadConfidence { found: confidence });
        }
        let mut factors = factors.to_vec();
        factors.sort_unstable();
        factors.dedup();
        let watch = Watch::new(progress);
        let mut followed = FollowedLaw::new(estimator.order());
        let mut deviations = Vec::with_capacity(factors.len());
        for m in factors {
            let raw = watch.found(estimator.watched_variance(self, m, &watch))?;
            let Some(raw) = raw else { continue };
            let (law, is_identified) = followed.at(self, m);
            let points = self.points().len();
            let bias = bias(estimator, law, m, points);
            let share = raw.terms as f64 / raw.possible as f64;
            let freedom = share * estimator.degrees_of_freedom(law, m, points);
            let value = (raw.value / bias).sqrt();
            let (lower, upper) = interval(value, freedom, confidence);
            deviations.push(Deviation {
                factor: m,
                tau: m as f64 * self.tau0(),
                value,
                lower,
                upper,
                terms: raw.terms,
                degrees_of_freedom: freedom,
                law,
                is_identified,
                bias,
            });
        }
        Ok(deviations)
    }
}

fn interval(value: f64, freedom: f64, confidence: f64) -> (f64, f64) {
    // No freedom, no interval.
    let Some([low, high]) = chi_squared_quantiles(freedom, confidence) else { return (0.0, f64::INFINITY) };
    let end = |quantile: f64| value * (freedom / quantile).sqrt();
    (end(high), end(low))
}

/// Expected variance of a total estimator over that of the one it improves on [SP 1065; for the
/// total variance `1 - a tau / T`]; 1 where the source gives none.
fn bias(estimator: Estimator, law: PowerLaw, m: usize, points: usize) -> f64 {
    let share = m as f64 / (points - 1) as f64;
    match (estimator, law) {
        (Estimator::Total, PowerLaw::Flicker) => 1.0 - share / (3.0 * std::f64::consts::LN_2),
        (Estimator::Total, PowerLaw::RandomWalk) => 1.0 - 0.75 * share,
        (Estimator::ModifiedTotal | Estimator::TimeTotal, law) => match law {
            PowerLaw::WhitePhase => 0.94,
            PowerLaw::FlickerPhase => 0.83,
            PowerLaw::White => 0.73,
            PowerLaw::Flicker => 0.70,
            _ => 0.69,
        },
        // At m = 1 it is the overlapping Hadamard itself.
        (Estimator::HadamardTotal, law) if m > 1 => match law {
            PowerLaw::RandomRun => 0.679,
            PowerLaw::FlickerWalk => 0.717,
            PowerLaw::RandomWalk => 0.771,
            PowerLaw::Flicker => 0.851,
            PowerLaw::White => 0.995,
            _ => 1.0,
        },
        _ => 1.0,
    }
}
