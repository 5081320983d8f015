//! Faults of a series whose noise is then not that of the sensor: readings that are held, cut off at the end of their range, or missing
//! here and there.

use super::error::NoiseError;
use super::phase::missing_runs;
use super::spikes::last_digit;
use crate::progress::{OnProgress, Stopped};
use crate::statistics::{longest_run, may_be_piled_up, piled_up, watched_median};

/// Whether changes from reading to reading are larger than a few digits: noise below them allows no decision on values that repeat.
/// `progress` is asked again and again.
///
/// # Errors
/// [`Stopped`] when the caller stops it.
pub(super) fn is_fine(readings: &[f64], progress: OnProgress<()>) -> Result<bool, Stopped> {
    /// Digits in the median change: fewer than one reading in ten then repeats by chance.
    const DIGITS: f64 = 3.0;
    let digit = last_digit(readings);
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut changes: Vec<f64> = steps.filter(|step| *step >= digit).collect();
    Ok(!changes.is_empty() && watched_median(&mut changes, progress)? > DIGITS * digit)
}

/// Held readings of this part of the record move no coefficient by more than its uncertainty.
const FEW: usize = 1000;

/// Refuses readings that repeat more often, or for longer, than noise does, if they are fine.
pub(super) fn refuse_held(readings: &[f64], is_fine: bool) -> Result<(), NoiseError> {
    /// Of fine readings fewer than one in ten repeats by chance.
    const MANY: usize = 4;
    let lengths: Vec<usize> = readings.chunk_by(f64::eq).map(<[f64]>::len).collect();
    let (repeated, longest) = (readings.len() - lengths.len(), lengths.iter().copied().max().unwrap_or(0));
    // The longest run is judged by the rate of the others.
    let of_others = (repeated + 1 - longest.min(repeated)).max(1) as f64 / readings.len() as f64;
    let by_chance = longest_run(readings.len(), of_others);
    let in_long_runs: usize = lengths.into_iter().filter(|length| *length as f64 > by_chance).sum();
    let is_held = is_fine && (MANY * repeated > readings.len() || FEW * in_long_runs > readings.len());
    if is_held { Err(NoiseError::Held { repeated, readings: readings.len(), longest }) } else { Ok(()) }
}

/// Refuses readings without spikes that pile up at an end of their range, if they are fine, or lack more than a fiftieth in short gaps.
/// Means over `n` readings that lack a part `p` have the deviation of `(1 - p) n`: it is larger by `p/2`.
pub(super) fn refuse_faults(readings: &[f64], is_fine: bool) -> Result<(), NoiseError> {
    /// A gap longer than this part of the record is a long one: averages that lack so much are left out.
    const LONG: usize = 200;
    let seen = || readings.iter().copied().filter(|y| y.is_finite());
    let at = |end: f64| seen().filter(|y| *y == end).count();
    let most = at(seen().fold(f64::INFINITY, f64::min)).max(at(seen().fold(f64::NEG_INFINITY, f64::max)));
    if let Some((value, found)) = (is_fine && may_be_piled_up(most)).then(|| piled_up(seen().collect())).flatten() {
        return Err(NoiseError::Saturated { found, value });
    }
    let gaps = missing_runs(readings).into_iter().map(|run| run.len());
    let missing: usize = gaps.filter(|gap| LONG * gap < readings.len()).sum();
    let readings = readings.len();
    if 50 * missing > readings { Err(NoiseError::ScatteredGaps { missing, readings }) } else { Ok(()) }
}

/// The fault of readings, spikes among them, in place of one that follows from it: the lowest or the highest reading is an error code if it
/// is farther from all others than most of these are from each other.
pub(super) fn named(fault: NoiseError, readings: &[f64]) -> NoiseError {
    /// Part of the others that may be other codes or spikes, on either side.
    const ODD: usize = 10;
    let mut sorted: Vec<f64> = readings.iter().copied().filter(|y| y.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let code = |value: &f64| {
        let others: Vec<f64> = sorted.iter().copied().filter(|y| y != value).collect();
        let odd = others.len() / ODD;
        let range = others.get(others.len().checked_sub(odd + 1)?)? - others[odd];
        let nearest = others.iter().map(|y| (y - value).abs()).fold(f64::INFINITY, f64::min);
        let (found, readings) = (sorted.len() - others.len(), readings.len());
        let is_code = FEW * found > readings && nearest > range;
        is_code.then_some(NoiseError::ErrorCode { found, readings, value: *value })
    };
    sorted.first().into_iter().chain(sorted.last()).find_map(code).unwrap_or(fault)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::unwatched;
    use crate::statistics::Random;

    fn noise(step: f64) -> Vec<f64> {
        let mut random = Random::stream(3, 0);
        let rounded = |y: f64| if step > 0.0 { (y / step).round() * step } else { y };
        (0..50_000).map(|_| rounded(random.normal())).collect()
    }

    fn held(readings: &[f64]) -> Result<(), NoiseError> {
        refuse_held(readings, is_fine(readings, &unwatched).unwrap())
    }

    fn faults(readings: &[f64]) -> Result<(), NoiseError> {
        refuse_faults(readings, is_fine(readings, &unwatched).unwrap())
    }

    #[test]
    fn noise_of_any_digit_has_no_fault() {
        for step in [0.0, 1e-6, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0] {
            assert_eq!(held(&noise(step)), Ok(()), "steps of {step}");
            assert_eq!(faults(&noise(step)), Ok(()), "steps of {step}");
        }
    }

    #[test]
    fn faults_are_named() {
        for step in [0.0, 0.01] {
            let mut stuck = noise(step);
            stuck[9000..9500].fill(0.3);
            assert!(matches!(held(&stuck), Err(NoiseError::Held { longest: 500.., .. })));
            let repeated: Vec<f64> = noise(step).iter().flat_map(|y| [*y; 4]).collect();
            assert!(matches!(held(&repeated), Err(NoiseError::Held { .. })));
            let clipped: Vec<f64> = noise(step).iter().map(|y| y.min(2.3)).collect();
            assert!(matches!(faults(&clipped), Err(NoiseError::Saturated { found: 100.., .. })));
            let lost = |part: usize| -> Vec<f64> {
                let lose = |(k, y): (usize, f64)| if k % part == 7 { f64::NAN } else { y };
                noise(step).into_iter().enumerate().map(lose).collect()
            };
            assert_eq!(faults(&lost(100)), Ok(()));
            assert_eq!(faults(&lost(20)), Err(NoiseError::ScatteredGaps { missing: 2500, readings: 50_000 }));
            let mut gap = noise(step);
            gap[10_000..20_000].fill(f64::NAN);
            assert_eq!(faults(&gap), Ok(()));
        }
    }

    /// Readings of one value far from all others, whatever fault they look like; not those that stand among the others.
    #[test]
    fn error_codes_are_named() {
        let fault = || NoiseError::Constant;
        for step in [0.0, 0.01] {
            let coded = |is_coded: &dyn Fn(usize) -> bool, code: f64| -> Vec<f64> {
                let read = |(k, y): (usize, f64)| if is_coded(k) { code } else { y };
                noise(step).into_iter().enumerate().map(read).collect()
            };
            let scattered = coded(&|k| k % 20 == 7, 99.0);
            let named_as = NoiseError::ErrorCode { found: 2500, readings: 50_000, value: 99.0 };
            assert_eq!(named(fault(), &scattered), named_as);
            let in_runs = coded(&|k| k / 10 % 100 == 7, -30.0);
            assert!(matches!(named(fault(), &in_runs), NoiseError::ErrorCode { found: 500, .. }));
            for value in [0.3, 2.3, 5.0] {
                assert_eq!(named(fault(), &coded(&|k| (9000..9500).contains(&k), value)), fault());
            }
            let clipped: Vec<f64> = noise(step).iter().map(|y| y.min(2.3)).collect();
            assert_eq!(named(fault(), &clipped), fault());
            assert_eq!(named(fault(), &noise(step)), fault());
        }
        assert_eq!(named(fault(), &[1.0; 100]), fault());
        assert_eq!(named(fault(), &[f64::NAN; 100]), fault());
    }
}
