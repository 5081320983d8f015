//! Saturation: readings that pile up at the end of their range.

/// Probability below which a count is not chance.
const CHANCE: f64 = 1e-6;

/// The value at which readings pile up, and their number; `None` if they do not.
///
/// The numbers of readings at the outermost values of a noisy reading fall off: log-concavity, which the normal law keeps
/// when it is rounded, makes the outermost number no more than `n_1^2 / n_2` of the next two on average. A number that
/// Poisson's law exceeds less than once in a million times about that average is a pile. Noise below a digit allows no
/// decision: the crest of a slow wave piles up as well.
pub(super) fn piled_up(mut readings: Vec<f64>) -> Option<(f64, usize)> {
    readings.sort_by(f64::total_cmp);
    let counts: Vec<(f64, usize)> = readings.chunk_by(f64::eq).map(|same| (same[0], same.len())).collect();
    let at_end = |[outer, next, inner]: [(f64, usize); 3]| {
        let usual = (next.1 as f64 + 1.0).powi(2) / inner.1 as f64;
        (poisson_tail(outer.1, usual) < CHANCE).then_some(outer)
    };
    let bottom = counts.first_chunk().copied().and_then(at_end);
    let top = counts.last_chunk().copied().and_then(|[inner, next, outer]| at_end([outer, next, inner]));
    top.into_iter().chain(bottom).max_by_key(|end| end.1)
}

/// Whether this number of readings at the end of their range calls for a closer look: nearly always it is one or two.
pub(super) fn may_be_piled_up(most: usize) -> bool {
    poisson_tail(most, 1.0) < CHANCE
}

/// The most frequent value of the readings, and its count.
pub(super) fn standing(f: &[f64]) -> (f64, usize) {
    let mut values: Vec<f64> = f.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.chunk_by(f64::eq).map(|same| (same[0], same.len())).max_by_key(|same| same.1).unwrap_or((f64::NAN, 0))
}

/// Probability of `count` or more under Poisson's law of that mean, from above (Chernoff): `(e m / k)^k exp(-m)`.
fn poisson_tail(count: usize, mean: f64) -> f64 {
    let k = count as f64;
    if k <= mean { 1.0 } else { (k - mean + k * (mean / k).ln()).exp() }
}

#[cfg(test)]
mod tests {
    use super::piled_up;
    use crate::statistics::Random;

    #[test]
    fn clipped_readings_pile_up_and_noise_does_not() {
        let mut random = Random::stream(1, 0);
        let readings: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
        for digit in [0.0, 1e-3, 0.1, 0.5, 1.0] {
            let rounded = |f: f64| if digit > 0.0 { (f / digit).round() * digit } else { f };
            for part in readings.chunks(2000) {
                let plain: Vec<f64> = part.iter().map(|f| rounded(*f)).collect();
                assert_eq!(piled_up(plain), None, "digit {digit}");
                if digit < 0.2 {
                    let clipped: Vec<f64> = part.iter().map(|f| rounded(f.min(1.5))).collect();
                    let (value, count) = piled_up(clipped).expect("a fifteenth of them is clipped");
                    assert!((value - 1.5).abs() < 0.05 + digit && count > 80, "{value} {count}");
                }
            }
        }
    }
}
