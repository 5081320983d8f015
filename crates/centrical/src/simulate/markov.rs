//! First-order Gauss-Markov noise.

use crate::statistics::Random;

/// `x(n) = phi x(n-1) + sqrt(1 - phi^2) deviation e(n)`, `phi = exp(-interval / time)`; stationary from the beginning.
#[derive(Debug, Clone)]
pub(super) struct Markov {
    phi: f64,
    innovation: f64,
    value: f64,
    random: Random,
}

impl Markov {
    /// `step`: the interval over the correlation time. Zero throughout for no `deviation`.
    pub fn new(deviation: f64, step: f64, mut random: Random) -> Self {
        let phi = (-step).exp();
        let innovation = deviation * (-(-2.0 * step).exp_m1()).sqrt();
        Self { phi, innovation, value: deviation * random.normal(), random }
    }

    #[inline]
    pub fn next(&mut self) -> f64 {
        if self.innovation == 0.0 {
            return 0.0;
        }
        let value = self.value;
        self.value = self.phi * value + self.innovation * self.random.normal();
        value
    }
}
