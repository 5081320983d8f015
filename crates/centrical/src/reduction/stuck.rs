//! Readings that repeat themselves for longer than noise lets them: a stuck sensor, a saturated one, a logger that
//! holds.

use nalgebra::Vector3;

/// Which samples are stuck on any axis, by the axes' repeat rates.
pub(super) fn stuck_on_any_axis(f_z: &[Vector3<f64>], repeat_rate: &[f64; 3]) -> Vec<bool> {
    let on = [0, 1, 2].map(|axis| stuck(&f_z.iter().map(|f| f[axis]).collect::<Vec<f64>>(), repeat_rate[axis]));
    (0..f_z.len()).map(|i| on.iter().any(|on| on[i])).collect()
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
    use super::stuck;

    #[test]
    fn a_held_reading_is_stuck_and_chance_repeats_are_not() {
        let mut f: Vec<f64> = (0..1000).map(|i| f64::from(i * 7919 % 31)).collect();
        f[500..520].fill(3.0);
        f[700] = f[699];
        let found = stuck(&f, 1.0 / 1000.0);
        assert!((0..1000).all(|i| found[i] == (500..520).contains(&i)));
    }

    #[test]
    fn coarse_digits_are_not_stuck() {
        let f: Vec<f64> = (0..1000).map(|i| f64::from(u8::from(i * i % 97 > 80))).collect();
        assert!(!stuck(&f, 0.8).contains(&true));
    }
}
