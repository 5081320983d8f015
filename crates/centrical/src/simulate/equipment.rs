//! The equipment of a simulated laboratory and its imperfections, with their bounds.

use thiserror::Error;

/// The laboratory's equipment. The default is perfect, at 100 Hz.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Equipment {
    /// The centrifuge.
    pub machine: Machine,
    /// The unit's noise.
    pub sensor: Sensor,
    /// The recorder of the unit's samples.
    pub recorder: Recorder,
    /// The report of the speed.
    pub tachometer: Tachometer,
    /// The counter of revolutions.
    pub counter: Counter,
    /// What turns the unit between rests in attitudes of their own.
    pub hand: Hand,
}

/// The centrifuge's operation and its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    /// Least duration of a plateau [s].
    pub plateau: f64,
    /// A plateau lasts up to this longer, uniformly [s]; before a rest up to a revolution more, to stop at its angle.
    pub plateau_spread: f64,
    /// Duration of a change of speed or angle [s], along a cubic without a jump of speed.
    pub ramp: f64,
    /// Standard deviation of a plateau's speed about the set point, relative.
    pub speed_error: f64,
    /// Excess of speed as a plateau begins, relative; it dies away exponentially.
    pub settling: f64,
    /// Its time constant [s].
    pub settling_time: f64,
}

/// SensorNoise of each of the three newtonometers, alike and independent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    /// Standard deviation of white noise of one sample [m/s^2].
    pub white: f64,
    /// SensorNoise of one correlation time.
    pub coloured: Coloured,
    /// Bias instability `B` (IEEE Std 952) [m/s^2]: two-sided spectrum `B^2 / (2 pi f)`, Allan deviation
    /// `sqrt(2 ln 2 / pi) B = 0.664 B`; correlation times from 8 samples to the length of the record.
    pub bias_instability: f64,
    /// Random walk `K` of the bias [m/s^2 per sqrt(s)]: variance `K^2 t`, zero as a record begins.
    pub random_walk: f64,
    /// Standard deviation of the slope of the bias, one slope a record [m/s^3].
    pub drift: f64,
    /// Step of the output [m/s^2]; 0 for all digits.
    pub quantum: f64,
    /// Largest magnitude of the output [m/s^2]; `None` for unlimited.
    pub range: Option<f64>,
}

/// First-order Gauss-Markov noise: AR(1) at the rate of sampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coloured {
    /// Standard deviation [m/s^2, or as stated].
    pub deviation: f64,
    /// Correlation time [s].
    pub time: f64,
}

/// What turns a unit from one rest to the next, a hand or a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hand {
    /// Number of rests where nothing states their attitudes.
    pub rests: usize,
    /// Least duration of a rest that states none [s].
    pub rest: f64,
    /// A rest lasts up to this longer, uniformly [s].
    pub rest_spread: f64,
    /// Least duration of a turn [s].
    pub turn: f64,
    /// A turn lasts up to this longer, uniformly [s].
    pub turn_spread: f64,
    /// Standard deviation of the acceleration of the unit in the middle of a turn [m/s^2].
    pub shake: f64,
    /// Tremor of the attitude about each instrument axis [rad]. The size of gravity stays.
    pub tremor: Coloured,
    /// Knocks of 0.05 s in the midst of rests: probability per rest, and the standard deviation of a reading while one lasts [m/s^2].
    pub bumps: Chance,
    /// Standard deviation of the change of each bias from one switch-on to another that states none of its own [m/s^2].
    pub bias_change: f64,
}

/// The recorder, which loses or spoils some samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recorder {
    /// Samples per second [Hz].
    pub rate: f64,
    /// Errors of transmission in one newtonometer's reading: probability per sample, and the standard deviation of the error [m/s^2].
    pub spikes: Chance,
    /// Runs of lost samples: probability per sample that one begins, and the mean number of its samples, 1 or more, geometrically distributed.
    pub gaps: Chance,
    /// Probability that a sample is recorded twice, with the same time.
    pub repeats: f64,
}

/// What happens by chance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Chance {
    /// Its probability.
    pub probability: f64,
    /// Its size.
    pub size: f64,
}

/// The centrifuge's own report of its speed. It does not see the plateaus' speed errors unless it measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tachometer {
    /// Reports per second [Hz].
    pub rate: f64,
    /// Its clock is at most this far from the unit's as a record begins, uniformly [s].
    pub clock_offset: f64,
    /// Standard deviation of its clock's rate against the unit's, relative.
    pub clock_drift: f64,
    /// Standard deviation of a report [rad/s].
    pub noise: f64,
    /// Step of the report [rad/s]; 0 for all digits.
    pub quantum: f64,
    /// Whether it measures the speed; otherwise it reports the speed that is set.
    pub measures: bool,
    /// Relative error of its scale.
    pub scale_error: f64,
    /// Standard deviation of its relative error on a plateau, one a plateau.
    pub plateau_error: f64,
}

/// A counter of the pulses of an index mark or an encoder, on the telemetry's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counter {
    /// Pulses in a revolution.
    pub per_revolution: f64,
    /// Standard deviation of the time of a pulse [s].
    pub jitter: f64,
    /// Relative error of its speeds: that of its time base.
    pub scale_error: f64,
    /// Standard deviation of its relative error on a plateau, one a plateau.
    pub plateau_error: f64,
}

impl Default for Machine {
    fn default() -> Self {
        Self { plateau: 10.0, plateau_spread: 0.0, ramp: 4.0, speed_error: 0.0, settling: 0.0, settling_time: 0.4 }
    }
}

impl Default for Coloured {
    fn default() -> Self {
        Self { deviation: 0.0, time: 0.5 }
    }
}

impl Default for Recorder {
    fn default() -> Self {
        Self { rate: 100.0, spikes: Chance::default(), gaps: Chance { probability: 0.0, size: 1.0 }, repeats: 0.0 }
    }
}

impl Default for Tachometer {
    fn default() -> Self {
        Self {
            rate: 20.0,
            clock_offset: 0.0,
            clock_drift: 0.0,
            noise: 0.0,
            quantum: 0.0,
            measures: false,
            scale_error: 0.0,
            plateau_error: 0.0,
        }
    }
}

impl Default for Counter {
    fn default() -> Self {
        Self { per_revolution: 1.0, jitter: 0.0, scale_error: 0.0, plateau_error: 0.0 }
    }
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            rests: 24,
            rest: 4.0,
            rest_spread: 0.0,
            turn: 1.0,
            turn_spread: 0.0,
            shake: 0.0,
            tremor: Coloured { deviation: 0.0, time: 0.3 },
            bumps: Chance::default(),
            bias_change: 0.0,
        }
    }
}

/// Why a session cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SimulationError {
    /// The truth belongs to another model.
    #[error("truth: found {found} values, expected {expected}, one for each parameter")]
    TruthLength {
        /// Values given.
        found: usize,
        /// Parameters.
        expected: usize,
    },
    /// A true value is not finite.
    #[error("truth of {name}: found {found}, expected a finite number")]
    Truth {
        /// The parameter.
        name: String,
        /// Its value.
        found: f64,
    },
    /// The number of durations differs from that of the plateaus.
    #[error("durations: found {found}, expected one for each of {expected} plateaus")]
    Durations {
        /// Given.
        found: usize,
        /// Set points of the experiment.
        expected: usize,
    },
    /// A record would have next to no samples of a plateau, or more samples than a campaign.
    #[error("{setting}: found {found:.3e} samples {of}, expected {expected}")]
    Samples {
        /// What the number follows from.
        setting: &'static str,
        /// Samples.
        found: f64,
        /// Of what they are.
        of: &'static str,
        /// Their bounds.
        expected: &'static str,
    },
    /// The unit would read what no number holds.
    #[error("truth: found a reading of {found:e} m/s^2 in mounting {mounting}, expected readings below 1e9 m/s^2")]
    Reading {
        /// Number of the mounting, from 1.
        mounting: usize,
        /// The reading.
        found: f64,
    },
    /// A setting is out of its bounds.
    #[error("{setting}: found {found}, expected {expected}")]
    Setting {
        /// Its table and name.
        setting: &'static str,
        /// Its value.
        found: f64,
        /// Its bounds.
        expected: &'static str,
    },
}

impl Equipment {
    /// Whether every setting is within its bounds.
    ///
    /// # Errors
    /// [`SimulationError::Setting`], the first that is not.
    pub fn check(&self) -> Result<(), SimulationError> {
        let Self { machine, sensor, recorder, tachometer, counter, hand } = self;
        time("machine.plateau", machine.plateau)?;
        magnitude("machine.plateau_spread", machine.plateau_spread)?;
        time("machine.ramp", machine.ramp)?;
        ratio("machine.speed_error", machine.speed_error)?;
        ratio("machine.settling", machine.settling)?;
        time("machine.settling_time", machine.settling_time)?;
        magnitude("sensor.white", sensor.white)?;
        magnitude("sensor.coloured.deviation", sensor.coloured.deviation)?;
        time("sensor.coloured.time", sensor.coloured.time)?;
        magnitude("sensor.bias_instability", sensor.bias_instability)?;
        magnitude("sensor.random_walk", sensor.random_walk)?;
        magnitude("sensor.drift", sensor.drift)?;
        magnitude("sensor.quantum", sensor.quantum)?;
        let above_zero = |found: f64| found.is_finite() && found > 0.0;
        let range = |range| bounded("sensor.range", range, above_zero, "a finite number above 0");
        sensor.range.map_or(Ok(()), range)?;
        rate("recorder.rate", recorder.rate)?;
        ratio("recorder.spikes.probability", recorder.spikes.probability)?;
        magnitude("recorder.spikes.size", recorder.spikes.size)?;
        ratio("recorder.gaps.probability", recorder.gaps.probability)?;
        let expected = "a number of samples, 1 to a million";
        bounded("recorder.gaps.length", recorder.gaps.size, |found| (1.0..=1e6).contains(&found), expected)?;
        ratio("recorder.repeats", recorder.repeats)?;
        rate("tachometer.rate", tachometer.rate)?;
        magnitude("tachometer.clock_offset", tachometer.clock_offset)?;
        ratio("tachometer.clock_drift", tachometer.clock_drift)?;
        magnitude("tachometer.noise", tachometer.noise)?;
        magnitude("tachometer.quantum", tachometer.quantum)?;
        error("tachometer.scale_error", tachometer.scale_error)?;
        ratio("tachometer.plateau_error", tachometer.plateau_error)?;
        bounded("counter.per_revolution", counter.per_revolution, |n| (1e-3..=1e6).contains(&n), "from 1e-3 to 1e6")?;
        magnitude("counter.jitter", counter.jitter)?;
        error("counter.scale_error", counter.scale_error)?;
        ratio("counter.plateau_error", counter.plateau_error)?;
        hand.check()
    }
}

impl Hand {
    fn check(&self) -> Result<(), SimulationError> {
        bounded("hand.rests", self.rests as f64, |n| (1.0..=1e4).contains(&n), "a number of rests, 1 to 10000")?;
        time("hand.rest", self.rest)?;
        magnitude("hand.rest_spread", self.rest_spread)?;
        time("hand.turn", self.turn)?;
        magnitude("hand.turn_spread", self.turn_spread)?;
        magnitude("hand.shake", self.shake)?;
        ratio("hand.tremor.deviation", self.tremor.deviation)?;
        time("hand.tremor.time", self.tremor.time)?;
        ratio("hand.bumps.probability", self.bumps.probability)?;
        magnitude("hand.bumps.size", self.bumps.size)?;
        magnitude("hand.bias_change", self.bias_change)
    }
}

/// No plateau, ramp or correlation of a laboratory is shorter than a millisecond or longer than a fortnight.
fn time(setting: &'static str, found: f64) -> Result<(), SimulationError> {
    bounded(setting, found, |f| (1e-3..=1e7).contains(&f), "a time above 0, from 1 ms to 1e7 s")
}

/// Beyond a million m/s^2, s or rad/s a unit was mistaken.
fn magnitude(setting: &'static str, found: f64) -> Result<(), SimulationError> {
    bounded(setting, found, |f| (0.0..=1e6).contains(&f), "0 to 1e6")
}

fn rate(setting: &'static str, found: f64) -> Result<(), SimulationError> {
    bounded(setting, found, |f| (1e-3..=1e7).contains(&f), "a rate above 0, from 1 mHz to 10 MHz")
}

fn ratio(setting: &'static str, found: f64) -> Result<(), SimulationError> {
    bounded(setting, found, |f| (0.0..1.0).contains(&f), "0 or more and below 1")
}

fn error(setting: &'static str, found: f64) -> Result<(), SimulationError> {
    bounded(setting, found, |f| f.abs() < 0.5, "a relative error, of less than 0.5 either way")
}

fn bounded(
    setting: &'static str,
    found: f64,
    holds: impl Fn(f64) -> bool,
    expected: &'static str,
) -> Result<(), SimulationError> {
    if holds(found) { Ok(()) } else { Err(SimulationError::Setting { setting, found, expected }) }
}
