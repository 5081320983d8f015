//! Spikes: readings that differ from their neighbours by more than noise.

use crate::progress::{OnProgress, Stopped, advance};
use crate::statistics::{PIECE, Side, cut, spread, watched_median, widened};

/// Marks the spikes among evenly spaced readings as missing (NaN) and returns their number.
///
/// A reading is compared with the median of the two on either side of it, which one more spike among them does not
/// move. The limit is what fewer than one in twenty records of good readings exceed anywhere, `sqrt(2 ln 20 n)` robust
/// standard deviations, which allow for the last digit. Noise slower than a few samples does not enter the comparison, and
/// so is not cut. A tail that falls off as an exponential does is noise, and stays (`widened`). `progress` is asked again and again.
///
/// # Errors
/// [`Stopped`] when the caller stops it; no reading is marked then.
pub fn leave_out_spikes(readings: &mut [f64], progress: OnProgress<()>) -> Result<usize, Stopped> {
    let mut residuals: Vec<f64> = Vec::with_capacity(readings.len());
    while residuals.len() < readings.len() {
        advance(progress, ())?;
        let next = residuals.len()..readings.len().min(residuals.len() + PIECE);
        residuals.extend(next.map(|i| readings[i] - median_of_neighbours(readings, i)));
    }
    let mut sizes: Vec<f64> = residuals.iter().filter(|r| r.is_finite()).map(|r| r.abs()).collect();
    let limit = cut(sizes.len()) * spread(watched_median(&mut sizes, progress)?, last_digit(readings));
    let mut sides = [Side::default(); 2];
    for residual in residuals.iter().filter(|r| r.is_finite()) {
        sides[usize::from(*residual > 0.0)].count(residual.abs() / limit);
    }
    let limit = limit * sides.into_iter().filter_map(widened).fold(1.0, f64::max);
    let mut spikes = 0;
    for (reading, residual) in readings.iter_mut().zip(&residuals) {
        if residual.abs() > limit {
            *reading = f64::NAN;
            spikes += 1;
        }
    }
    Ok(spikes)
}

/// Last digit of the readings: the smallest step between neighbours, beyond the rounding of `f64` itself.
pub(super) fn last_digit(readings: &[f64]) -> f64 {
    let largest = readings.iter().filter(|y| y.is_finite()).fold(0.0, |largest: f64, y| largest.max(y.abs()));
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 1e-12 * largest);
    steps.fold(f64::INFINITY, f64::min)
}

/// Median of up to four neighbours, two on either side; the mean of the middle two of four. NaN without neighbours.
fn median_of_neighbours(readings: &[f64], i: usize) -> f64 {
    let near = [i.wrapping_sub(2), i.wrapping_sub(1), i + 1, i + 2];
    let mut values = near.map(|j| readings.get(j).copied().unwrap_or(f64::NAN));
    values.sort_by(f64::total_cmp);
    // NaN of either sign stands at one of the ends.
    let from = values.iter().position(|value| value.is_finite()).unwrap_or(0);
    let seen = values.iter().filter(|value| value.is_finite()).count();
    match seen {
        0 => f64::NAN,
        n => 0.5 * (values[from + (n - 1) / 2] + values[from + n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::leave_out_spikes;
    use crate::progress::unwatched;
    use crate::statistics::Random;

    #[test]
    fn spikes_go_and_the_rest_stays() {
        let mut readings: Vec<f64> =
            (0..2000).map(|i| f64::from(i * 7919 % 131) * 1e-3 + f64::from(i) * 1e-2).collect();
        readings[700] = f64::NAN;
        for (i, size) in [(0, 5.0), (500, -2.0), (501, 3.0), (1999, 9.0)] {
            readings[i] += size;
        }
        assert_eq!(leave_out_spikes(&mut readings, &unwatched), Ok(4));
        let missing: Vec<usize> = (0..2000).filter(|i| readings[*i].is_nan()).collect();
        assert_eq!(missing, [0, 500, 501, 700, 1999]);
    }

    /// Steps from a tenth to ten of the standard deviation: no good reading goes, and a spike of ten steps and noises does.
    #[test]
    fn rounded_noise_has_no_spikes() {
        for step in [0.1, 0.2, 0.3, 0.45, 0.5, 0.7, 1.0, 1.3, 1.5, 2.0, 2.5, 3.0, 5.0, 7.0, 10.0] {
            for place in [0.1, 0.25, 0.4] {
                let mut random = Random::stream(5, 0);
                let mut readings: Vec<f64> =
                    (0..12_000).map(|_| (random.normal() / step + place).round() * step).collect();
                assert_eq!(leave_out_spikes(&mut readings, &unwatched), Ok(0), "steps of {step}, {place}");
                if readings.iter().any(|reading| *reading != 0.0) {
                    readings[700] += 10.0 * (1.0 + step);
                    assert_eq!(leave_out_spikes(&mut readings, &unwatched), Ok(1), "steps of {step}, {place}");
                }
            }
        }
    }

    /// Readings of a squared or an exponential law keep their tails, beside spikes.
    #[test]
    fn a_tail_is_no_spike() {
        let mut random = Random::stream(7, 0);
        let mut readings: Vec<f64> = (0..100_000).map(|_| random.normal().hypot(random.normal()).powi(2)).collect();
        assert_eq!(leave_out_spikes(&mut readings, &unwatched), Ok(0));
        readings[500] += 1e3;
        assert_eq!(leave_out_spikes(&mut readings, &unwatched), Ok(1));
    }

    #[test]
    fn constant_or_coarse_readings_have_no_spikes() {
        assert_eq!(leave_out_spikes(&mut [3.0; 100], &unwatched), Ok(0));
        let mut coarse: Vec<f64> = (0..1000).map(|i| if i * i % 97 > 80 { 1.0 } else { 0.0 }).collect();
        assert_eq!(leave_out_spikes(&mut coarse, &unwatched), Ok(0));
        assert_eq!(leave_out_spikes(&mut [], &unwatched), Ok(0));
    }
}
