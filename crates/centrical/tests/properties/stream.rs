//! Simulated records of one mounting with all the dirt of real ones, and the truth beside them.

use std::f64::consts::{PI, TAU};

use centrical::reduction::{Record, ScheduledPlateau, SpeedTrace};
use nalgebra::Vector3;

use crate::common::Random;

/// What a stream is like.
#[derive(Debug, Clone)]
pub struct Stream {
    /// Speeds of the plateaus, in the order they are run [rad/s].
    pub omegas: Vec<f64>,
    /// Lengths of the plateaus [s].
    pub lengths: Vec<f64>,
    /// Length of a ramp [s].
    pub ramp: f64,
    /// Sampling rate [Hz].
    pub rate: f64,
    /// Standard deviation of the white noise of a sample [m/s^2].
    pub white: f64,
    /// Standard deviation of white noise at 62.6 rad/s that grows with the square of the speed [m/s^2].
    pub shaking: f64,
    /// Speed at which the machine resonates, and the standard deviation of its white noise within 1 rad/s [rad/s], [m/s^2].
    pub resonance: (f64, f64),
    /// Size of squared white noise at 62.6 rad/s, less its mean, that grows with the square of the speed [m/s^2].
    pub squared: f64,
    /// Standard deviation of white noise along the force, over the force.
    pub jitter: f64,
    /// Standard deviation and correlation time of the first-order Markov noise [m/s^2], [s].
    pub colour: (f64, f64),
    /// Correlation of the Markov noise between the axes.
    pub correlation: f64,
    /// Speed error at the end of a ramp, relative, and the time constant it fades with [s].
    pub settling: (f64, f64),
    /// Relative change of the speed over each plateau, along a straight line about what was set.
    pub running: f64,
    /// Once-per-revolution amplitude [m/s^2].
    pub tilt: f64,
    /// Share of samples with a spike on one axis.
    pub spikes: f64,
    /// Share of samples that are missing.
    pub gaps: f64,
    /// Share of samples that come twice.
    pub repeats: f64,
    /// Last digit of the readings [m/s^2]; 0 for all digits.
    pub lsb: f64,
    /// Relative error of the unit: scale and misalignment.
    pub unit_error: f64,
    /// Seed of everything random.
    pub seed: u64,
}

/// Distance of the unit from the axis of rotation [m].
const ARM: f64 = 0.5;

/// Bias of the unit [m/s^2].
const BIAS: [f64; 3] = [0.05, -0.04, 0.03];

impl Default for Stream {
    fn default() -> Self {
        Self {
            omegas: vec![0.0, 14.0, 28.0, 44.0, 62.6, 0.0],
            lengths: vec![10.0; 6],
            ramp: 4.0,
            rate: 100.0,
            white: 2e-3,
            shaking: 0.0,
            resonance: (0.0, 0.0),
            squared: 0.0,
            jitter: 0.0,
            colour: (0.0, 1.0),
            correlation: 0.0,
            settling: (1e-3, 0.4),
            running: 0.0,
            tilt: 3e-3,
            spikes: 0.0,
            gaps: 0.0,
            repeats: 0.0,
            lsb: 0.0,
            unit_error: 2e-3,
            seed: 1,
        }
    }
}

impl Stream {
    /// The same with everything that can go wrong with a sample.
    pub fn rough(self) -> Self {
        Self { spikes: 1e-3, gaps: 1e-2, repeats: 1e-3, lsb: 1e-4, ..self }
    }

    /// Nominal plateaus, as the schedule has them.
    pub fn schedule(&self) -> Vec<ScheduledPlateau> {
        let plateau = |omega: &f64| ScheduledPlateau { omega: *omega, nominal_z: force(*omega, 0.0) };
        self.omegas.iter().map(plateau).collect()
    }

    /// True mean reading of a plateau [m/s^2].
    pub fn truth(&self, plateau: usize) -> Vector3<f64> {
        self.reading(force(self.omegas[plateau], 0.0))
    }

    /// Start and end of each plateau [s]; the settling is at the start.
    pub fn windows(&self) -> Vec<[f64; 2]> {
        let mut start = 0.0;
        let window = |length: &f64| {
            let window = [start, start + length];
            start = window[1] + self.ramp;
            window
        };
        self.lengths.iter().map(window).collect()
    }

    /// Telemetry at 20 Hz on a clock that is behind the record's by `offset` [s].
    pub fn telemetry(&self, offset: f64) -> SpeedTrace {
        let end = self.windows().last().map_or(0.0, |window| window[1]);
        let t: Vec<f64> = (0..(end * 20.0) as usize).map(|i| i as f64 / 20.0).collect();
        let omega = t.iter().map(|t| (1e5 * self.speed(*t).0).round() / 1e5).collect();
        SpeedTrace { t: t.iter().map(|t| t - offset).collect(), omega }
    }

    fn reading(&self, f_z: Vector3<f64>) -> Vector3<f64> {
        let misaligned = Vector3::new(f_z.x, f_z.y + f_z.x, f_z.z - 0.7 * f_z.x);
        f_z + misaligned * self.unit_error + Vector3::from(BIAS)
    }

    /// Speed and its rate at a time.
    fn speed(&self, t: f64) -> (f64, f64) {
        let windows = self.windows();
        let k = windows.iter().position(|window| t < window[1] + self.ramp).unwrap_or(windows.len() - 1);
        let omega = self.omegas[k];
        if t <= windows[k][1] || k + 1 == windows.len() {
            let (amplitude, tau) = if k == 0 { (0.0, 1.0) } else { self.settling };
            let off = omega * amplitude * (-(t - windows[k][0]) / tau).exp();
            let run = omega * self.running / self.lengths[k];
            let middle = 0.5 * (windows[k][0] + windows[k][1]);
            return (omega + off + run * (t - middle), run - off / tau);
        }
        // A cosine ramp: the drive starts and stops without a jerk.
        let (x, rise) = ((t - windows[k][1]) / self.ramp, self.omegas[k + 1] - omega);
        (omega + rise * 0.5 * (1.0 - (PI * x).cos()), rise * 0.5 * PI / self.ramp * (PI * x).sin())
    }

    /// The record.
    pub fn record(&self) -> Record {
        let mut random = Random::new(self.seed);
        let mut record = Record::default();
        let end = self.windows().last().map_or(0.0, |window| window[1]);
        let mut slow = Markov::new(self, &mut random);
        let mut angle = TAU * random.uniform();
        for i in 0..(end * self.rate) as usize {
            let t = i as f64 / self.rate;
            let (omega, rate) = self.speed(t);
            angle += omega / self.rate;
            let mut f = self.reading(force(omega, rate)) + self.tilt * turning(omega, angle);
            f += slow.next(&mut random);
            f += Vector3::from_fn(|_, _| self.white * random.normal());
            if self.shaking > 0.0 {
                let size = self.shaking * (omega / 62.6).powi(2);
                f += Vector3::from_fn(|_, _| size * random.normal());
            }
            if self.resonance.1 > 0.0 && (omega - self.resonance.0).abs() < 1.0 {
                f += Vector3::from_fn(|_, _| self.resonance.1 * random.normal());
            }
            if self.squared > 0.0 {
                let size = self.squared * (omega / 62.6).powi(2);
                f += Vector3::from_fn(|_, _| size * (random.normal().powi(2) - 1.0));
            }
            if self.jitter > 0.0 {
                f += force(omega, rate) * (self.jitter * random.normal());
            }
            if random.uniform() < self.spikes {
                f[(3.0 * random.uniform()) as usize] += 50.0 * random.normal();
            }
            if self.lsb > 0.0 {
                f = f.map(|value| (value / self.lsb).round() * self.lsb);
            }
            let times = if random.uniform() < self.gaps { 0 } else { 1 + usize::from(random.uniform() < self.repeats) };
            for _ in 0..times {
                record.t.push(t);
                (0..3).for_each(|axis| record.f_z[axis].push(f[axis]));
            }
        }
        record
    }
}

/// First-order Markov noise on three axes, with a part common to all.
struct Markov {
    decay: f64,
    size: f64,
    correlation: f64,
    state: Vector3<f64>,
}

impl Markov {
    fn new(stream: &Stream, random: &mut Random) -> Self {
        let (size, time) = stream.colour;
        let decay = (-1.0 / (stream.rate * time)).exp();
        let mut markov = Self { decay: 0.0, size, correlation: stream.correlation, state: Vector3::zeros() };
        markov.next(random);
        Self { decay, ..markov }
    }

    fn next(&mut self, random: &mut Random) -> Vector3<f64> {
        let common = self.correlation.sqrt() * random.normal();
        let own = (1.0 - self.correlation).sqrt();
        let kick = Vector3::from_fn(|_, _| common + own * random.normal());
        self.state = self.state * self.decay + kick * (self.size * (1.0 - self.decay * self.decay).sqrt());
        self.state
    }
}

fn force(omega: f64, rate: f64) -> Vector3<f64> {
    Vector3::new(-omega * omega * ARM, rate * ARM, 9.81)
}

fn turning(omega: f64, angle: f64) -> Vector3<f64> {
    if omega == 0.0 { Vector3::zeros() } else { Vector3::new(angle.cos(), -angle.sin(), 0.3 * angle.sin()) }
}
