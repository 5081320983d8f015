//! The record of one mounting: the physics, the noise and the recorder's errors.

use nalgebra::Vector3;

use super::draw::{Arrivals, Draw};
use super::equipment::Equipment;
use super::motion::Motion;
use super::response::Response;
use super::sensor_noise::{Sampling, SensorNoise};
use super::tumble::Felt;
use crate::model::{ArmMotion, MeasurementModel, MountedUnit};
use crate::reduction::Record;

/// Samples in a stretch: a few hundred kilobytes.
const STRETCH: u64 = 8192;

/// Rows of a stretch and a few repeated ones.
const ROOM: usize = 8200;

/// The record of one mounting, a stretch at a time, in memory that does not grow with the record.
#[derive(Debug, Clone)]
pub struct Records<'a> {
    signal: Signal<'a>,
    /// Samples per second [Hz].
    rate: f64,
    noise: [SensorNoise; 3],
    transmission: Transmission,
    /// Next sample and number of samples.
    next: u64,
    count: u64,
}

impl<'a> Records<'a> {
    pub(super) fn new(signal: Signal<'a>, equipment: &Equipment, sampling: &Sampling) -> Self {
        let rate = equipment.recorder.rate;
        // Lengths are finite and not negative, and a cast to an integer saturates.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = (sampling.duration * rate) as u64 + 1;
        Self {
            signal,
            rate,
            noise: [0, 1, 2].map(|axis| SensorNoise::new(&equipment.sensor, sampling, axis)),
            transmission: Transmission::new(equipment, sampling),
            next: 0,
            count,
        }
    }

    /// Sample `n`: its time [s] and the sensor's output without noise [m/s^2].
    fn sample(&mut self, n: u64) -> (f64, Vector3<f64>) {
        let t = n as f64 / self.rate;
        (t, self.signal.at(t))
    }
}

/// The sensor's output without noise.
#[derive(Debug, Clone)]
pub(super) enum Signal<'a> {
    /// On the arm.
    Arm {
        physics: Physics<'a>,
        motion: &'a Motion,
        /// Segment of the motion that the last sample was in, 0 at first.
        segment: usize,
    },
    /// In a hand.
    Hand { response: Response, felt: Felt<'a> },
}

impl Signal<'_> {
    /// At time `t` [s], which ascends from call to call [m/s^2].
    #[inline]
    fn at(&mut self, t: f64) -> Vector3<f64> {
        match self {
            Self::Arm { physics, motion, segment } => physics.reading(&motion.at(t, segment)),
            Self::Hand { response, felt } => {
                let (force, disturbance) = felt.at(t);
                response.reading(&force) + disturbance
            }
        }
    }
}

impl Iterator for Records<'_> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        let end = self.count.min(self.next + STRETCH);
        if self.next == end {
            return None;
        }
        let mut record = Record { t: Vec::with_capacity(ROOM), f_z: [(); 3].map(|()| Vec::with_capacity(ROOM)) };
        // The noise of a stretch at once, newtonometer by newtonometer: its generators stay in registers.
        let stretch = self.next..end;
        let noise = self.noise.each_mut().map(|noise| stretch.clone().map(|n| noise.at(n)).collect::<Vec<f64>>());
        for (k, n) in stretch.enumerate() {
            let (t, mut f) = self.sample(n);
            for axis in 0..3 {
                f[axis] += noise[axis][k];
            }
            self.transmission.pass(n, t, f, &mut record);
        }
        self.next = end;
        Some(record)
    }
}

/// The unit on the arm, and its response.
#[derive(Debug, Clone)]
pub(super) struct Physics<'a> {
    model: &'a MeasurementModel,
    truth: &'a [f64],
    mounting: usize,
    response: Response,
    /// The unit on the arm at any speed, unless it changes with the speed.
    rigid: Option<MountedUnit>,
}

impl<'a> Physics<'a> {
    pub fn new(model: &'a MeasurementModel, truth: &'a [f64], mounting: usize) -> Self {
        let response = Response::new(model.error_model(), model.parameters().coefficients(truth));
        let rigid = (!model.changes_with_speed()).then(|| model.mounted_unit(mounting, truth, &ArmMotion::default()));
        Self { model, truth, mounting, response, rigid }
    }

    /// Specific force of the unit at rest, and what is added to its readings [m/s^2].
    pub fn at_rest(&self) -> (Vector3<f64>, Vector3<f64>) {
        let unit = self.model.mounted_unit(self.mounting, self.truth, &ArmMotion::default());
        (unit.specific_force(&ArmMotion::default()), unit.disturbance)
    }

    #[inline]
    pub fn reading(&self, motion: &ArmMotion) -> Vector3<f64> {
        if let Some(unit) = &self.rigid {
            return self.response.reading(&unit.specific_force(motion));
        }
        let unit = self.model.mounted_unit(self.mounting, self.truth, motion);
        self.response.reading(&unit.specific_force(motion)) + unit.disturbance
    }
}

/// From the sensor's output to the rows of the record.
#[derive(Debug, Clone)]
struct Transmission {
    spikes: Arrivals,
    spike_size: f64,
    gaps: Arrivals,
    /// Probability that a gap ends with a sample.
    gap_end: f64,
    /// First sample after the present gap.
    resumes: u64,
    repeats: Arrivals,
    quantum: f64,
    range: f64,
}

impl Transmission {
    fn new(equipment: &Equipment, sampling: &Sampling) -> Self {
        let random = |draw: Draw| draw.stream(sampling.seed, sampling.mounting);
        let (recorder, sensor) = (&equipment.recorder, &equipment.sensor);
        Self {
            spikes: Arrivals::new(random(Draw::Spikes), recorder.spikes.probability),
            spike_size: recorder.spikes.size,
            gaps: Arrivals::new(random(Draw::Losses), recorder.gaps.probability),
            gap_end: 1.0 / recorder.gaps.size,
            resumes: 0,
            repeats: Arrivals::new(random(Draw::Repeats), recorder.repeats),
            quantum: sensor.quantum,
            range: sensor.range.unwrap_or(f64::INFINITY),
        }
    }

    /// Adds sample `n` to the record, as zero, one or two rows.
    #[inline]
    fn pass(&mut self, n: u64, t: f64, mut f: Vector3<f64>, record: &mut Record) {
        if let Some(random) = self.spikes.at(n) {
            let third = random.uniform();
            let axis = usize::from(third > 1.0 / 3.0) + usize::from(third > 2.0 / 3.0);
            f[axis] += self.spike_size * random.normal();
        }
        if let Some(random) = self.gaps.at(n) {
            let longer = if self.gap_end < 1.0 { random.failures(self.gap_end) } else { 0 };
            self.resumes = self.resumes.max(n.saturating_add(1).saturating_add(longer));
        }
        let rows = if self.repeats.at(n).is_some() { 2 } else { 1 };
        if n < self.resumes {
            return;
        }
        for _ in 0..rows {
            record.t.push(t);
            for (column, f) in record.f_z.iter_mut().zip(&f) {
                column.push(self.output(*f));
            }
        }
    }

    /// Saturated and quantised.
    #[inline]
    fn output(&self, f: f64) -> f64 {
        let f = f.clamp(-self.range, self.range);
        if self.quantum > 0.0 { rounded(f / self.quantum) * self.quantum } else { f }
    }
}

/// [`f64::round`], which is a call where the processor that is compiled for has no instruction for it.
#[inline]
fn rounded(x: f64) -> f64 {
    /// Numbers from here on have no fraction.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    if x.abs() < WHOLE {
        #[expect(clippy::cast_possible_truncation)]
        let whole = x as i64 as f64;
        // Exact: both are multiples of the last place of `x`.
        let rest = x - whole;
        let away = f64::from(i8::from(rest >= 0.5) - i8::from(rest <= -0.5));
        (whole + away).copysign(x)
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn rounding_is_that_of_the_standard_library() {
        let halves = (-20..=20).map(|k| 0.5 * f64::from(k));
        let edges = [0.499_999_999_999_999_94, 4_503_599_627_370_495.5, 4_503_599_627_370_497.0, 1e300, f64::INFINITY];
        for value in halves.chain(edges).chain([-0.0, 1.0 / 3.0, -1e-300]) {
            for value in [value, -value, value.next_up(), value.next_down()] {
                assert_eq!(rounded(value).to_bits(), value.round().to_bits(), "{value}");
            }
        }
        assert!(rounded(f64::NAN).is_nan());
    }
}
