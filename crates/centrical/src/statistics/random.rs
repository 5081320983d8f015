//! Random numbers that are the same on every run and for any number of threads: each stream has its own number.

use rand_distr::{Distribution, Open01, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// A stream of random numbers: xoshiro256++ (D. Blackman and S. Vigna, 2021), normal ones by the ziggurat.
#[derive(Debug, Clone)]
pub(crate) struct Random(Xoshiro256PlusPlus);

impl Random {
    /// Stream number `stream` of `seed`.
    pub fn stream(seed: u64, stream: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(mixed(mixed(seed) ^ stream)))
    }

    /// Uniform on (0, 1).
    pub fn uniform(&mut self) -> f64 {
        Open01.sample(&mut self.0)
    }

    /// Uniform on (-1, 1).
    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }

    /// Normal, mean 0, standard deviation 1.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Number of failures before the first success of trials that succeed with `probability`.
    pub fn failures(&mut self, probability: f64) -> u64 {
        if probability <= 0.0 {
            return u64::MAX;
        }
        // The cast saturates: "practically never" becomes the largest number.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let failures = (self.uniform().ln() / (-probability).ln_1p()) as u64;
        failures
    }
}

/// SplitMix64's output function (G. L. Steele et al., OOPSLA 2014): neighbouring numbers become unrelated ones.
fn mixed(n: u64) -> u64 {
    let z = n.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
