//! Seeded noise with known coefficients.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

use crate::common::Random;

/// Gaussian numbers by Box and Muller, both of a pair.
pub struct Gaussian {
    random: Random,
    spare: Option<f64>,
}

impl Gaussian {
    pub fn new(seed: u64) -> Self {
        // The state steps by one constant, so seeds must lie apart: the generator's own numbers do.
        Self { random: Random::new(Random::new(seed).next()), spare: None }
    }

    pub fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * self.random.uniform().ln()).sqrt();
        let (sine, cosine) = (TAU * self.random.uniform()).sin_cos();
        self.spare = Some(radius * sine);
        radius * cosine
    }

    pub fn take(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// What a simulated record holds, in the units of `NoiseTerm`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Recipe {
    pub quantisation: f64,
    pub white: f64,
    pub bias_instability: f64,
    pub random_walk: f64,
    pub ramp: f64,
}

impl Recipe {
    /// In the order of `NoiseTerm::ALL`.
    pub fn coefficients(&self) -> [f64; 5] {
        [self.quantisation, self.white, self.bias_instability, self.random_walk, self.ramp]
    }

    /// `n` readings every `tau0` seconds.
    pub fn readings(&self, n: usize, tau0: f64, seed: usize) -> Vec<f64> {
        let mut gaussian = Gaussian::new(seed as u64);
        let mut readings = vec![0.0; n];
        if self.white > 0.0 {
            for y in &mut readings {
                *y += self.white / tau0.sqrt() * gaussian.next();
            }
        }
        if self.quantisation > 0.0 {
            let x = gaussian.take(n + 1);
            readings.iter_mut().zip(x.windows(2)).for_each(|(y, x)| *y += self.quantisation / tau0 * (x[1] - x[0]));
        }
        if self.random_walk > 0.0 {
            let mut walk = 0.0;
            for y in &mut readings {
                walk += self.random_walk * tau0.sqrt() * gaussian.next();
                *y += walk;
            }
        }
        if self.bias_instability > 0.0 {
            let flicker = flicker(n, &mut gaussian);
            readings.iter_mut().zip(flicker).for_each(|(y, z)| *y += self.bias_instability * z);
        }
        for (k, y) in readings.iter_mut().enumerate() {
            *y += self.ramp * tau0 * k as f64;
        }
        readings
    }
}

/// Noise of two-sided spectrum `1 / (2 sin(pi f))` per cycle per sample: white noise through the half integrator
/// `(1 - z^-1)^(-1/2)` (N. J. Kasdin, Proc. IEEE 83, 1995), after as many samples of run-in.
fn flicker(n: usize, gaussian: &mut Gaussian) -> Vec<f64> {
    let length = (4 * n).next_power_of_two();
    let mut filter = vec![0.0; length];
    filter[0] = 1.0;
    for k in 1..2 * n {
        filter[k] = filter[k - 1] * (k as f64 - 0.5) / k as f64;
    }
    let mut white = gaussian.take(2 * n);
    white.resize(length, 0.0);
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let transform = |mut values: Vec<f64>| {
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut values, &mut spectrum).unwrap();
        spectrum
    };
    let mut product = transform(white);
    product.iter_mut().zip(transform(filter)).for_each(|(z, h)| *z *= h / length as f64);
    let mut noise = inverse.make_output_vec();
    inverse.process(&mut product, &mut noise).unwrap();
    noise[n..2 * n].to_vec()
}
