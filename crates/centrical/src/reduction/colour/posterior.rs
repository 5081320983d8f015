//! Densities of the noise as their posterior mean, for rests that show them to a third or worse.
//!
//! A mean of variance `v`, known with some doubt, errs by `E[v]` in the mean of squares: by more than the likeliest `v`, by the factor
//! `nu / (nu - 2)` if `v` is known with `nu` degrees of freedom (JCGM 101, 6.4.9). And noise that is too weak to be found is
//! not absent. So the covariance takes the posterior mean, over white noise alone and over all strengths and correlation times of
//! one Markov process beside it. The white noise has the density `d`; the process has the density `r d` at zero frequency and the
//! correlation time `tau`. A contrast of unit variance under white noise then has the variance `d s`, `s = 1 + r b(tau)`. White noise
//! alone, `r = 0`, is as likely beforehand as all processes together, whose prior is `1 / (d r)`: no strength and no time is
//! preferred. The integral over `d` is a closed form,
//!
//! `p(r, tau) ~ prod s_j^(-n_j/2) Q^(-n/2) / r`, `Q = sum_j n_j y_j^2 / s_j`, `E[d | r, tau] = Q / (n - 2)`.
//!
//! A test of residuals against the noise asks for more than a mean: for all noise that the contrasts do not exclude. Those are the `r` and
//! `tau` whose likelihood is at least `beta` of the largest. Twice the logarithm of that ratio is chi^2 of two degrees of freedom
//! (Wilks 1938), so the region holds the true ones but for a chance of `beta`.

/// Ratios of the densities: per decade, and from where on. Below the first the process adds less than a thousandth to the variance of
/// any mean; above the last it is all of it.
const PER_DECADE: usize = 5;
const SMALLEST: f64 = 1e-3;
const DECADES: usize = 8;

/// Contrasts of nearly one frequency.
#[derive(Debug, Clone, Copy)]
pub(super) struct Power<'a> {
    /// Number of contrasts.
    pub count: f64,
    /// Their mean square.
    pub square: f64,
    /// Variance under each Markov process of unit density.
    pub gains: &'a [f64],
}

/// White noise and one Markov process beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mixture {
    /// Density of the white noise.
    pub white: f64,
    /// Index of the correlation time of the process.
    pub time: usize,
    /// Density of the process at zero frequency.
    pub slow: f64,
}

/// What contrasts say of the densities.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Posterior {
    /// Posterior mean of the density of white noise.
    pub white: f64,
    /// That of the process of each correlation time.
    pub slow: Vec<f64>,
    /// All noise that is not excluded.
    pub not_excluded: Vec<Mixture>,
}

/// The posterior of the densities, and the noise that is not excluded but for a chance of `beta`. `None` where the contrasts are
/// too few, or show no noise.
pub(super) fn posterior(powers: &[Power], beta: f64) -> Option<Posterior> {
    let count: f64 = powers.iter().map(|power| power.count).sum();
    let times = powers.first().map_or(0, |power| power.gains.len());
    if count <= 2.0 || times == 0 {
        return None;
    }
    let ratios = (0..=PER_DECADE * DECADES).map(|k| SMALLEST * 10_f64.powf(k as f64 / PER_DECADE as f64));
    let slow: Vec<(usize, f64)> = ratios.flat_map(|ratio| (0..times).map(move |time| (time, ratio))).collect();
    // The prior of each is that of all of them, shared; white noise alone has as much.
    let alone = (0, 0.0);
    let prior = |ratio: f64| if ratio > 0.0 { 1.0 / slow.len() as f64 } else { 1.0 };
    let points: Vec<(usize, f64)> = std::iter::once(alone).chain(slow.iter().copied()).collect();
    let of_point = |&(time, ratio): &(usize, f64)| {
        let (mut logarithms, mut squares) = (0.0, 0.0);
        for power in powers {
            let s = 1.0 + ratio * power.gains[time];
            logarithms += power.count * s.ln();
            squares += power.count * power.square / s;
        }
        (-0.5 * (logarithms + count * squares.ln()), squares / (count - 2.0))
    };
    let likelihoods: Vec<(f64, f64)> = points.iter().map(of_point).collect();
    let highest = likelihoods.iter().map(|(logarithm, _)| *logarithm).fold(f64::NEG_INFINITY, f64::max);
    if !highest.is_finite() {
        return None;
    }
    let (mut sum, mut white, mut densities, mut not_excluded) = (0.0, 0.0, vec![0.0; times], Vec::new());
    for ((time, ratio), (logarithm, density)) in points.iter().zip(&likelihoods) {
        if logarithm - highest >= beta.ln() {
            not_excluded.push(Mixture { white: *density, time: *time, slow: density * ratio });
        }
        let weight = prior(*ratio) * (logarithm - highest).exp();
        sum += weight;
        white += weight * density;
        densities[*time] += weight * density * ratio;
    }
    let slow = densities.into_iter().map(|density| density / sum).collect();
    Some(Posterior { white: white / sum, slow, not_excluded })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise alone, known ever better: its density and next to nothing beside, never less than what was seen.
    #[test]
    fn white_noise_is_found_and_little_beside() {
        let gains: Vec<[f64; 2]> = (1..40).map(|k| [0.1, 1.0].map(|x| 1.0 / (1.0 + x * f64::from(k * k)))).collect();
        let at_zero = |count: f64| {
            let power = |gains| Power { count: count / 39.0, square: 4.0, gains };
            let powers: Vec<Power> = gains.iter().map(|gains| power(gains.as_slice())).collect();
            let Posterior { white, slow, not_excluded } = posterior(&powers, 1e-5).unwrap();
            let most = not_excluded.iter().map(|noise| noise.white + noise.slow).fold(0.0, f64::max);
            assert!(most >= white + slow.iter().sum::<f64>());
            (white + slow.iter().sum::<f64>()) / 4.0
        };
        let found = [30.0, 1e3, 1e5].map(at_zero);
        // The most that could pass unseen: a strength is known to 1/sqrt(sum n g^2 / 2), 0.02 of white noise in 1e5 contrasts.
        assert!(found.is_sorted_by(|a, b| a > b) && found[2] > 1.0 && found[2] < 1.02, "{found:?}");
    }

    #[test]
    fn nothing_follows_from_nothing() {
        assert_eq!(posterior(&[], 1e-5), None);
        assert_eq!(posterior(&[Power { count: 100.0, square: 0.0, gains: &[0.5] }], 1e-5), None);
    }
}
