//! What rests show: their lengths, and how well the size of gravity is met in them.

use centrical_session::{PlateauSummary, Turning};

/// A lag that a filter or a recorder may well have [s].
pub(crate) const LAG: f64 = 0.1;

/// What the size of the compensated force misses of gravity, over the rests [m/s^2].
pub(crate) struct GravityMisfit {
    pub root_mean_square: f64,
    pub largest: f64,
}

impl GravityMisfit {
    /// That of `rests`; `None` of rests that do not determine the coefficients: they have no compensated force.
    pub fn of(rests: &[&PlateauSummary]) -> Option<Self> {
        let misfits: Vec<f64> = rests.iter().filter_map(|rest| misfit(rest)).collect();
        let square: f64 = misfits.iter().map(|misfit| misfit * misfit).sum();
        let largest = misfits.iter().fold(0.0_f64, |most, misfit| most.max(misfit.abs()));
        (!misfits.is_empty()).then(|| Self { root_mean_square: (square / misfits.len() as f64).sqrt(), largest })
    }
}

/// Residual along the specific force.
fn misfit(rest: &PlateauSummary) -> Option<f64> {
    let force = rest.specific_force?;
    let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    Some(force.iter().zip(rest.residual).map(|(f, residual)| f / size * residual).sum())
}

/// The shortest and the longest rest [s]; `None` where none has a length.
pub(crate) fn rest_lengths(rests: &[&PlateauSummary]) -> Option<[f64; 2]> {
    let lengths = rests.iter().filter_map(|rest| rest.window).map(|[from, to]| to - from);
    let [shortest, longest] = lengths.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], t| [low.min(t), high.max(t)]);
    (longest > 0.0).then_some([shortest, longest])
}

/// Rests that are sure to be found have four blocks of eight samples [s]; `None` where that is below the second that a rest has at least.
pub(crate) fn least_rest(rests: &[&PlateauSummary]) -> Option<f64> {
    const SAMPLES: f64 = 32.0;
    let spans = rests.iter().filter_map(|rest| Some((rest.window?, rest.samples.saturating_sub(1))));
    let (time, steps) = spans.fold((0.0, 0), |(time, all), ([from, to], steps)| (time + to - from, all + steps));
    Some(SAMPLES * time / steps as f64).filter(|least| *least > 1.0 && steps > 0)
}

/// By how much readings that lag by [`LAG`] are too small in slow rotation, relative: the size of a force that turns at a rate w is
/// shortened by `(w tau)^2 / 2` where readings lag by tau.
pub(crate) fn shortened_by_lag(turning: &Turning) -> f64 {
    0.5 * (turning.rate * LAG).powi(2)
}
