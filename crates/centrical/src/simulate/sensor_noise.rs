//! The noise of one newtonometer, a sum of terms with a generator each.

use std::f64::consts::{LN_2, PI};

use super::draw::Draw;
use super::equipment::Sensor;
use super::markov::Markov;
use crate::statistics::Random;

/// The sampling of one record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sampling {
    pub seed: u64,
    pub mounting: usize,
    /// Interval of the samples [s].
    pub interval: f64,
    /// Length of the record [s].
    pub duration: f64,
}

/// The noise of one newtonometer, sample after sample.
#[derive(Debug, Clone)]
pub(super) struct SensorNoise {
    white: White,
    coloured: Markov,
    flicker: Flicker,
    walk: Walk,
    /// Slope of the bias, per sample [m/s^2].
    slope: f64,
}

impl SensorNoise {
    pub fn new(sensor: &Sensor, sampling: &Sampling, axis: usize) -> Self {
        let random = |draw: Draw| draw.stream_of(sampling.seed, sampling.mounting, axis);
        let Sampling { interval, duration, .. } = *sampling;
        let coloured = &sensor.coloured;
        Self {
            white: White { deviation: sensor.white, random: random(Draw::White) },
            coloured: Markov::new(coloured.deviation, interval / coloured.time, random(Draw::Coloured)),
            flicker: Flicker::new(sensor.bias_instability, duration / interval, random(Draw::Flicker)),
            walk: Walk { step: sensor.random_walk * interval.sqrt(), value: 0.0, random: random(Draw::Walk) },
            slope: sensor.drift * interval * random(Draw::Drift).normal(),
        }
    }

    /// SensorNoise of sample `n` [m/s^2]; `n` ascends from call to call.
    #[inline]
    pub fn at(&mut self, n: u64) -> f64 {
        self.white.next() + self.coloured.next() + self.flicker.at(n) + self.walk.next() + self.slope * n as f64
    }
}

#[derive(Debug, Clone)]
struct White {
    deviation: f64,
    random: Random,
}

impl White {
    #[inline]
    fn next(&mut self) -> f64 {
        if self.deviation == 0.0 { 0.0 } else { self.deviation * self.random.normal() }
    }
}

/// Bias instability: a sum of Gauss-Markov processes, one to each octave of correlation time, of equal variance.
///
/// With variance `q` each, their two-sided spectra `2 q T / (1 + (2 pi f T)^2)` at `T = 2^k` add up to `q / (2 ln 2 f)`,
/// which is `B^2 / (2 pi f)` for `q = B^2 ln 2 / pi`. The process of octave `k` steps every `2^(k+1)` samples,
/// when `k` is the number of factors 2 in the sample's number, as in Voss' algorithm: one step a sample in all.
#[derive(Debug, Clone)]
struct Flicker {
    octaves: Vec<f64>,
    sum: f64,
    innovation: f64,
    random: Random,
}

/// Correlation time of an octave in its steps: the stairs add `1 / (12 STEPS^2)` to its spectrum at low frequency, 0.5 %.
const STEPS: f64 = 4.0;

impl Flicker {
    /// `samples`: length of the record.
    fn new(instability: f64, samples: f64, mut random: Random) -> Self {
        let deviation = instability * (LN_2 / PI).sqrt();
        let mut octaves = Vec::new();
        let mut correlation = 2.0 * STEPS;
        while instability > 0.0 && (octaves.is_empty() || correlation <= samples) {
            octaves.push(deviation * random.normal());
            correlation *= 2.0;
        }
        let innovation = deviation * (-(-2.0 / STEPS).exp_m1()).sqrt();
        Self { sum: octaves.iter().sum(), octaves, innovation, random }
    }

    #[inline]
    fn at(&mut self, n: u64) -> f64 {
        if let Some(octave) = self.octaves.get_mut(n.trailing_zeros() as usize) {
            let value = PHI * *octave + self.innovation * self.random.normal();
            self.sum += value - *octave;
            *octave = value;
        }
        self.sum
    }
}

/// `exp(-1 / STEPS)`.
const PHI: f64 = 0.778_800_783_071_404_9;

#[derive(Debug, Clone)]
struct Walk {
    /// Standard deviation of a step [m/s^2].
    step: f64,
    value: f64,
    random: Random,
}

impl Walk {
    #[inline]
    fn next(&mut self) -> f64 {
        if self.step == 0.0 {
            return 0.0;
        }
        let value = self.value;
        self.value += self.step * self.random.normal();
        value
    }
}
