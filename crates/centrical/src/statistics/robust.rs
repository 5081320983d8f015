//! Robust statistics: the median, the spread it gives, and the limit beyond which a value is a spike.

use crate::progress::{OnProgress, Stopped, advance};

/// Normal law: standard deviation over median absolute value.
pub(crate) const MAD: f64 = 1.482_602_218_505_602;

/// Median; of an even number the upper of the middle two. Zero of an empty slice.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// [`median`] of very many values, asking `progress` again and again: 16 bits of the value at a time, from the first, by counting.
///
/// # Errors
/// [`Stopped`] when the caller stops it.
pub(crate) fn watched_median(values: &mut [f64], progress: OnProgress<()>) -> Result<f64, Stopped> {
    if values.len() <= PIECE {
        return Ok(median(values));
    }
    let (mut rank, mut found) = (values.len() / 2, 0_u64);
    let mut counts = vec![0_usize; 1 << 16];
    for shift in [48, 32, 16, 0] {
        counts.fill(0);
        for piece in values.chunks(PIECE) {
            advance(progress, ())?;
            for key in piece.iter().map(|value| ordered(*value)).filter(|key| (key >> shift) >> 16 == found) {
                counts[usize::try_from((key >> shift) & 0xffff).unwrap_or_default()] += 1;
            }
        }
        let mut digits = 0;
        while rank >= counts[digits] {
            rank -= counts[digits];
            digits += 1;
        }
        found = found << 16 | digits as u64;
    }
    Ok(f64::from_bits(if found >> 63 == 1 { found ^ (1 << 63) } else { !found }))
}

/// Values between two questions of long work: some milliseconds.
pub(crate) const PIECE: usize = 1 << 20;

/// A whole number in the order of `f64::total_cmp`.
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// The limit for `n` good samples, in standard deviations: fewer than one in twenty such sets has a sample beyond it, since
/// the normal law leaves less than `exp(-c^2 / 2)` beyond `c`.
pub(crate) fn cut(n: usize) -> f64 {
    (2.0 * (20.0 * n as f64).ln()).sqrt()
}

/// Robust standard deviation of readings whose last digit is `step`, by the median size of their deviations.
///
/// The median of rounded sizes is rounded, too: half a step is added, so that it is not below that of the noise. Steps of
/// twice the noise leave half the deviations zero.
pub(crate) fn spread(median_size: f64, step: f64) -> f64 {
    MAD * (median_size + 0.5 * step)
}

/// The whole part of a number of blocks, cells or revolutions; zero of a negative number.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(crate) fn whole(number: f64) -> usize {
    number.max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::{PIECE, median, watched_median};
    use crate::progress::unwatched;
    use crate::statistics::Random;

    #[test]
    fn the_median_of_very_many_is_the_median() {
        let mut random = Random::stream(3, 0);
        // Values that differ in the last bits, repeat, and have both signs; as many as are counted, and one more.
        let values = [(0.0, 1.0), (5.0, 1e-15), (-5.0, 1e-15), (0.0, 0.0)]
            .map(|(mean, deviation)| (0..=PIECE).map(|_| mean + deviation * random.normal()).collect::<Vec<f64>>());
        for mut values in values.into_iter().flat_map(|values| [values[1..].to_vec(), values]) {
            values[7] = f64::NEG_INFINITY;
            let counted = watched_median(&mut values, &unwatched).unwrap();
            assert_eq!(counted.to_bits(), median(&mut values).to_bits());
        }
    }

    #[test]
    fn the_median_of_very_many_is_stopped() {
        assert!(watched_median(&mut vec![0.0; PIECE + 1], &|()| ControlFlow::Break(())).is_err());
    }
}
