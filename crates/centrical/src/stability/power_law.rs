//! Power-law noises, and the identification of the one that dominates at a given tau.

use super::phase::Phase;

/// Noise whose spectral density of the readings is proportional to f^alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PowerLaw {
    /// alpha = -4: random run of the reading.
    RandomRun,
    /// alpha = -3: flicker walk of the reading.
    FlickerWalk,
    /// alpha = -2: random walk of the reading (acceleration random walk).
    RandomWalk,
    /// alpha = -1: flicker of the reading (bias instability).
    Flicker,
    /// alpha = 0: white reading (velocity random walk).
    White,
    /// alpha = 1: flicker of the phase.
    FlickerPhase,
    /// alpha = 2: white phase (velocity quantisation).
    WhitePhase,
}

impl PowerLaw {
    /// Every power law, from the reddest.
    pub const ALL: [Self; 7] = [
        Self::RandomRun,
        Self::FlickerWalk,
        Self::RandomWalk,
        Self::Flicker,
        Self::White,
        Self::FlickerPhase,
        Self::WhitePhase,
    ];

    /// The exponent alpha.
    pub fn alpha(self) -> i32 {
        match self {
            Self::RandomRun => -4,
            Self::FlickerWalk => -3,
            Self::RandomWalk => -2,
            Self::Flicker => -1,
            Self::White => 0,
            Self::FlickerPhase => 1,
            Self::WhitePhase => 2,
        }
    }

    /// The power law next to a fractional alpha, among those for which the estimator of that order converges.
    fn nearest(alpha: f64, order: usize) -> Self {
        let reddest = if order >= 3 { Self::RandomRun } else { Self::RandomWalk };
        let apart = |law: &Self| (f64::from(law.alpha()) - alpha).abs();
        Self::ALL
            .into_iter()
            .filter(|law| *law >= reddest)
            .min_by(|a, b| apart(a).total_cmp(&apart(b)))
            .unwrap_or(Self::White)
    }
}

/// The power law by which bias and degrees of freedom are taken, followed from tau to tau.
///
/// The autocorrelation of few points is uncertain: white readings look like phase noise in a fifth of the records at
/// 30 points, and phase noise would give them a hundred times their degrees of freedom. The law is therefore that
/// of the shorter tau until the autocorrelation shows another at two standard deviations. It never turns from a
/// reading's noise to a phase's: in a sum of power laws the largest alpha rules the shortest tau.
#[derive(Debug)]
pub(super) struct FollowedLaw {
    law: PowerLaw,
    order: usize,
    /// The octave to be looked at next.
    octave: usize,
}

impl FollowedLaw {
    /// White until another law is shown, for an estimator of differences of that order.
    pub fn new(order: usize) -> Self {
        Self { law: PowerLaw::White, order, octave: 1 }
    }

    /// The law at averaging factor `m`, not less than that of the last call, and whether it could be looked for there.
    /// All octaves up to `m` are looked at, so that the law does not depend on the factors asked for.
    pub fn at(&mut self, phase: &Phase, m: usize) -> (PowerLaw, bool) {
        while self.octave < m {
            self.look(phase, self.octave);
            self.octave *= 2;
        }
        let is_identified = self.look(phase, m);
        (self.law, is_identified)
    }

    fn look(&mut self, phase: &Phase, m: usize) -> bool {
        /// Standard deviations that show another law.
        const SHOWN: f64 = 2.0;
        let Some((alpha, uncertainty)) = exponent(phase, m, self.order) else { return false };
        let reach = SHOWN * uncertainty;
        let near = f64::from(self.law.alpha()).clamp(alpha - reach, alpha + reach);
        let law = PowerLaw::nearest(near, self.order);
        let is_first = m == 1;
        self.law = if is_first { law } else { law.min(self.law.max(PowerLaw::White)) };
        true
    }
}

/// Fractional alpha of the noise that dominates the phase at averaging factor `m`, by lag-1 autocorrelation, and its standard
/// uncertainty.
///
/// Every m-th phase point, less a quadratic, is differenced until it is no longer more correlated than flicker:
/// `rho = r_1 / (1 + r_1) < 1/4` or `order` times; then `alpha = 2 - 2 rho - 2 d` after d differences.
/// `order` is that of the estimator, 2 (Allan) or 3 (Hadamard); its reddest noise is alpha = 2 - 2 order.
/// `None` with fewer than 30 points left, or if they do not vary.
/// Source: Riley and Greenhall, "Power law noise identification using the lag 1 autocorrelation", EFTF 2004.
fn exponent(phase: &Phase, m: usize, order: usize) -> Option<(f64, f64)> {
    const FEWEST: usize = 30;
    let mut z: Vec<f64> = phase.points().iter().step_by(m.max(1)).copied().collect();
    if z.len() < FEWEST {
        return None;
    }
    remove_quadratic(&mut z);
    for differences in 0..=order {
        let r_1 = lag_1_autocorrelation(&z)?;
        let rho = r_1 / (1.0 + r_1);
        if rho < 0.25 || differences == order {
            let alpha = 2.0 - 2.0 * rho - 2.0 * differences as f64;
            // Bartlett's variance of r_1 for noise correlated over one lag, and d alpha / d r_1 = 2 / (1 + r_1)^2.
            let r = r_1.clamp(-0.5, 0.5);
            let variance = (1.0 - 3.0 * r * r + 4.0 * r.powi(4)) / z.len() as f64;
            return Some((alpha, 2.0 * variance.sqrt() / (1.0 + r).powi(2)));
        }
        z = z.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    None
}

/// `sum (z_i - mean)(z_(i+1) - mean) / sum (z_i - mean)^2`; `None` for a constant.
fn lag_1_autocorrelation(z: &[f64]) -> Option<f64> {
    let mean = z.iter().sum::<f64>() / z.len() as f64;
    let variance: f64 = z.iter().map(|v| (v - mean).powi(2)).sum();
    let covariance: f64 = z.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

/// Takes off the least-squares quadratic, by its discrete orthogonal polynomials 1, t, t^2 - mean(t^2).
fn remove_quadratic(z: &mut [f64]) {
    let n = z.len() as f64;
    let time = |k: usize| k as f64 - (n - 1.0) / 2.0;
    let mean_square = (n * n - 1.0) / 12.0;
    let polynomials: [&dyn Fn(usize) -> f64; 3] = [&|_| 1.0, &time, &|k| time(k).powi(2) - mean_square];
    for polynomial in polynomials {
        let norm: f64 = (0..z.len()).map(|k| polynomial(k).powi(2)).sum();
        let share = z.iter().enumerate().map(|(k, v)| v * polynomial(k)).sum::<f64>() / norm;
        for (k, v) in z.iter_mut().enumerate() {
            *v -= share * polynomial(k);
        }
    }
}
