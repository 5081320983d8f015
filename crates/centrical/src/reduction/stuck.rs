//! Readings that repeat themselves for longer than noise lets them: a stuck sensor, a saturated one, a logger that
//! holds.

use nalgebra::Vector3;

/// Share of readings equal to the one before, of those whose own predecessor was different: a long run counts once.
pub(super) fn repeat_rate(f: &[f64]) -> f64 {
    let fresh = f.windows(3).filter(|w| w[0] != w[1]);
    let (all, repeats) = fresh.fold((0_usize, 0_usize), |(all, n), w| (all + 1, n + usize::from(w[1] == w[2])));
    // Rule of succession: a rate is never known to be 0 or 1.
    (repeats as f64 + 1.0) / (all as f64 + 2.0)
}

/// Which samples are stuck on any axis, by the axes' repeat rates.
pub(super) fn stuck_on_any_axis(f_z: &[Vector3<f64>], repeat_rate: &[f64; 3]) -> Vec<bool> {
    let on = [0, 1, 2].map(|axis| stuck(&f_z.iter().map(|f| f[axis]).collect::<Vec<f64>>(), repeat_rate[axis]));
    (0..f_z.len()).map(|i| on.iter().any(|on| on[i])).collect()
}

/// The newtonometer of which most readings are stuck, the reading at which it stands most, and how many are.
pub(super) fn most_stuck(f_z: &[Vector3<f64>], repeat_rate: &[f64; 3]) -> (usize, f64, usize) {
    let of = |axis: usize| {
        let f: Vec<f64> = f_z.iter().map(|f| f[axis]).collect();
        let is_stuck = stuck(&f, repeat_rate[axis]);
        let mut standing: Vec<f64> = f.iter().zip(&is_stuck).filter(|(_, stuck)| **stuck).map(|(f, _)| *f).collect();
        let count = standing.len();
        standing.sort_by(f64::total_cmp);
        let most = standing.chunk_by(f64::eq).max_by_key(|same| same.len());
        (axis, most.map_or(f64::NAN, |same| same[0]), count)
    };
    [0, 1, 2].map(of).into_iter().max_by_key(|(_, _, count)| *count).unwrap_or((0, f64::NAN, 0))
}

/// Which readings stand in a run that `n` readings of that repeat rate have less than once in a million times.
fn stuck(f: &[f64], repeat_rate: f64) -> Vec<bool> {
    const CHANCE: f64 = 1e-6;
    let longest = 1.0 + (CHANCE / f.len() as f64).ln() / repeat_rate.ln();
    let runs = f.chunk_by(f64::eq);
    runs.flat_map(|run| std::iter::repeat_n(run.len() as f64 > longest, run.len())).collect()
}

#[cfg(test)]
mod tests {
    use super::{repeat_rate, stuck};

    #[test]
    fn a_held_reading_is_stuck_and_chance_repeats_are_not() {
        let mut f: Vec<f64> = (0..1000).map(|i| f64::from(i * 7919 % 31)).collect();
        f[500..520].fill(3.0);
        f[700] = f[699];
        let rate = repeat_rate(&f);
        let found = stuck(&f, rate);
        assert!(rate < 0.01);
        assert!((0..1000).all(|i| found[i] == (500..520).contains(&i)));
    }

    #[test]
    fn coarse_digits_are_not_stuck() {
        let f: Vec<f64> = (0..1000).map(|i| f64::from(u8::from(i * i % 97 > 80))).collect();
        assert!(!stuck(&f, repeat_rate(&f)).contains(&true));
    }
}
