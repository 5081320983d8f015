//! Rests that are laid down in one attitude again and again.
//!
//! What a face of a cube or a mark of a table is off by, all rests on it share. What a hand lays down differently, each has for itself, and their
//! readings show it: they turn by as much across the force. Of a stated variance `u^2` the part `1 - s^2 / u^2` is common where the directions of
//! rests in one attitude scatter by `s` about either horizontal axis. The mean of `m` such rests has the variance `u^2 (1 + (m - 1) c) / m`
//! with that part `c`. As independent ones with `u^2 (1 + (m - 1) c)` each, they leave the same.

use nalgebra::Vector3;

/// Standard uncertainty of the attitude of each rest as an independent one, over that which is stated: of rests in the attitudes `up_b`, `None`
/// where they are unknown, with these mean forces.
pub(super) fn as_independent(up_b: &[Option<Vector3<f64>>], means: &[Vector3<f64>], uncertainty: f64) -> Vec<f64> {
    let mut groups: Vec<(Vector3<f64>, Vec<usize>)> = Vec::new();
    for (rest, up_b) in up_b.iter().enumerate().take(means.len()) {
        let Some(up_b) = up_b else { continue };
        match groups.iter_mut().find(|(known, _)| known == up_b) {
            Some((_, rests)) => rests.push(rest),
            None => groups.push((*up_b, vec![rest])),
        }
    }
    let (mut squares, mut freedom) = (0.0, 0);
    for (_, rests) in &groups {
        let directions: Vec<Vector3<f64>> = rests.iter().map(|rest| means[*rest].normalize()).collect();
        let middle = directions.iter().sum::<Vector3<f64>>() / directions.len() as f64;
        squares += directions.iter().map(|direction| (direction - middle).norm_squared()).sum::<f64>();
        freedom += 2 * (rests.len() - 1);
    }
    let mut factors = vec![1.0; up_b.len()];
    if freedom > 0 {
        let common = (1.0 - squares / freedom as f64 / (uncertainty * uncertainty)).clamp(0.0, 1.0);
        for (_, rests) in groups {
            let factor = (1.0 + (rests.len() - 1) as f64 * common).sqrt();
            for rest in rests {
                factors[rest] = factor;
            }
        }
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rests that lie alike share all that is stated of their attitude; those that scatter by it share nothing.
    #[test]
    fn rests_that_lie_alike_share_their_error() {
        let up = [Some(Vector3::z()), Some(Vector3::x()), Some(Vector3::z()), None];
        let alike = [Vector3::z() * 9.8, Vector3::x() * 9.8, Vector3::z() * 9.81, Vector3::y()];
        assert_eq!(as_independent(&up, &alike, 1e-3), [2_f64.sqrt(), 1.0, 2_f64.sqrt(), 1.0]);
        let apart = [Vector3::new(2e-2, 0.0, 9.8), alike[1], Vector3::new(-2e-2, 1e-2, 9.8), alike[3]];
        assert_eq!(as_independent(&up, &apart, 1e-3), [1.0; 4]);
        assert_eq!(as_independent(&up, &[], 1e-3), [1.0; 4]);
    }
}
