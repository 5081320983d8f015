//! Random draws: each imperfection of each mounting has a stream of its own, so that they do not disturb each other.

use crate::statistics::Random;

/// A kind of draw. The numbers are part of what a seed means: never reuse one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Draw {
    /// The unknowns.
    Truth = 0,
    /// Durations and speed errors of plateaus.
    Motion = 1,
    /// White noise.
    White = 2,
    /// Coloured noise.
    Coloured = 3,
    /// Bias instability.
    Flicker = 4,
    /// Random walk of the bias.
    Walk = 5,
    /// Drift of the bias.
    Drift = 6,
    /// Spikes.
    Spikes = 7,
    /// Losses.
    Losses = 8,
    /// Repeated samples.
    Repeats = 9,
    /// The telemetry's clock.
    Clock = 10,
    /// SensorNoise of the speed in the telemetry.
    Tachometer = 11,
    /// Errors of the tachometer's or the counter's speed, one a plateau.
    MeasuredSpeed = 12,
    /// Times of the counter's pulses.
    Counter = 13,
    /// Durations, tremor and bumps of a unit in a hand.
    Hand = 14,
    /// Attitudes of rests and their errors, and the change of the bias.
    Rests = 15,
}

impl Draw {
    /// Its stream in a mounting.
    pub fn stream(self, seed: u64, mounting: usize) -> Random {
        self.stream_of(seed, mounting, 0)
    }

    /// Its stream in a mounting, of one newtonometer.
    pub fn stream_of(self, seed: u64, mounting: usize, axis: usize) -> Random {
        Random::stream(seed, (mounting as u64) << 8 | (self as u64) << 4 | axis as u64)
    }
}

/// Rare events among numbered samples, each with the same probability.
#[derive(Debug, Clone)]
pub(super) struct Arrivals {
    random: Random,
    probability: f64,
    next: u64,
}

impl Arrivals {
    pub fn new(mut random: Random, probability: f64) -> Self {
        let next = random.failures(probability);
        Self { random, probability, next }
    }

    /// The generator for the properties of the event if one occurs at sample `n`; `n` ascends from call to call.
    #[inline]
    pub fn at(&mut self, n: u64) -> Option<&mut Random> {
        if n < self.next {
            return None;
        }
        let failures = self.random.failures(self.probability);
        self.next = n.saturating_add(1).saturating_add(failures);
        Some(&mut self.random)
    }
}
