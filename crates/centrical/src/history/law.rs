//! The law of a value: a mixture of normal laws.

use std::f64::consts::{PI, SQRT_2};

use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::erf::erfc;

/// The law of a value that is estimated, or to come.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMixture {
    parts: Vec<Part>,
}

/// A normal law and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Weight; all sum to 1.
    pub weight: f64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Part {
    /// Probability below a bound.
    fn below(&self, bound: f64) -> f64 {
        0.5 * erfc((self.mean - bound) / (self.deviation * SQRT_2))
    }

    fn density(&self, at: f64) -> f64 {
        let z = (at - self.mean) / self.deviation;
        (-0.5 * z * z).exp() / (self.deviation * (2.0 * PI).sqrt())
    }

    /// Probability above a bound: by symmetry, as `1 - P` would lose what is rare.
    fn above(&self, bound: f64) -> f64 {
        0.5 * erfc((bound - self.mean) / (self.deviation * SQRT_2))
    }
}

impl NormalMixture {
    /// The mixture of `parts`.
    pub(super) fn new(parts: impl Iterator<Item = Part>) -> Self {
        Self { parts: parts.collect() }
    }

    /// Probability that the value is below `bound`.
    pub fn probability_below(&self, bound: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.below(bound)).sum()
    }

    /// Probability that the value is farther than `limit` from `centre`.
    pub fn probability_beyond(&self, centre: f64, limit: f64) -> f64 {
        let outside = |part: &Part| {
            let is_far = (part.mean - centre).abs() + FAR * part.deviation < limit;
            if is_far { 0.0 } else { part.below(centre - limit) + part.above(centre + limit) }
        };
        self.parts.iter().map(|part| part.weight * outside(part)).sum()
    }

    /// The value below which the law has `probability`, in (0, 1): by Halley's method within a bracket, which is halved where a step would
    /// leave it.
    pub fn quantile(&self, probability: f64) -> f64 {
        let ends = |sign: f64| self.parts.iter().map(move |part| part.mean + sign * FAR * part.deviation);
        let (mut low, mut high) =
            (ends(-1.0).fold(f64::INFINITY, f64::min), ends(1.0).fold(f64::NEG_INFINITY, f64::max));
        let negligible = f64::EPSILON * (high - low);
        let close = CLOSE * probability.min(1.0 - probability);
        let mut value = self.beginning(probability).max(low).min(high);
        for _ in 0..STEPS {
            let excess = self.probability_below(value) - probability;
            if excess < 0.0 {
                low = value;
            } else {
                high = value;
            }
            let halley = value - self.halley_step(value, excess);
            let is_inside = halley > low && halley < high;
            let next = if is_inside { halley } else { 0.5 * (low + high) };
            let is_last = is_inside && excess.abs() <= close || (next - value).abs() <= negligible;
            value = next;
            if is_last {
                break;
            }
        }
        value
    }

    /// `n / (1 - n f' / 2 f)` with Newton's step `n = excess / f` and the density `f`.
    fn halley_step(&self, value: f64, excess: f64) -> f64 {
        let (mut density, mut slope) = (0.0, 0.0);
        for part in &self.parts {
            let of_part = part.weight * part.density(value);
            density += of_part;
            slope += of_part * (part.mean - value) / part.deviation.powi(2);
        }
        let newton = excess / density;
        newton / (1.0 - 0.5 * newton * slope / density)
    }

    /// The quantile of the part in the middle: in a tail it lies on the side from which Newton's steps never go too far.
    fn beginning(&self, probability: f64) -> f64 {
        let at = |part: &Part| part.mean + part.deviation * Normal::standard().inverse_cdf(probability);
        self.parts.get(self.parts.len() / 2).map_or(f64::NAN, at)
    }

    /// The interval that covers the value with probability `coverage`, as much outside on either side.
    pub fn interval(&self, coverage: f64) -> [f64; 2] {
        [0.5 - 0.5 * coverage, 0.5 + 0.5 * coverage].map(|probability| self.quantile(probability))
    }
}

/// Standard deviations beyond which a normal law has nothing that a double shows beside 1.
const FAR: f64 = 9.0;

/// Part of the rarer probability that may still be missing before the last step: an error is its third power afterwards.
const CLOSE: f64 = 1e-5;

/// Halvings alone would end by then.
const STEPS: usize = 60;
