//! Simulation of records: what the unit and the centrifuge deliver, sample by sample.
//!
//! `reading(t) = quantised( saturated( f'(angle, Omega, dOmega/dt) + noise(t) + spike ) )` with `f'` of
//! [`MeasurementModel::reading_at`], so that the mean over whole revolutions of a perfect sensor's record is the
//! plateau model's reading (test `mean_of_a_record_is_the_reading`). Ramps, settling, speed errors and durations are
//! the centrifuge's ([`Machine`]), noise is the unit's ([`Sensor`]), lost and spoilt samples are the
//! recorder's ([`Recorder`]), and the telemetry has a clock of its own ([`Tachometer`]). Rests in attitudes of their own are one
//! record of a unit that is turned in between ([`Hand`]).
//!
//! Everything follows from the seed: each imperfection of each mounting draws from a generator of its own, so
//! nothing depends on the number of threads, and switching one imperfection on leaves the others as they were.
//! `Default` is perfect equipment: every imperfection has to be named.

mod draw;
mod equipment;
mod markov;
mod motion;
mod record;
mod response;
mod sensor_noise;
mod telemetry;
mod tumble;

pub use equipment::{
    Chance, Coloured, Counter, Equipment, Hand, Machine, Recorder, Sensor, SimulationError, Tachometer,
};
pub use record::Records;

use std::ops::Range;

use nalgebra::Vector3;

use crate::model::{ArmMotion, Kind, MeasurementModel, Parameter, SetPoint};
use crate::reduction::SpeedTrace;
use draw::Draw;
use motion::Motion;
use record::{Physics, Signal};
use response::Response;
use sensor_noise::Sampling;
use tumble::{Felt, HandMotion, Held};

/// Readings beyond this [m/s^2] are of a truth in a mistaken unit.
const LARGEST_READING: f64 = 1e9;

/// Samples of a session at most: twelve mountings of an hour at 20 kHz. Telemetry is held in memory.
const MOST_SAMPLES: f64 = 1e9;
const MOST_REPORTS: f64 = 1e7;

/// A session as it would be recorded: a pure function of model, truth, equipment and seed.
#[derive(Debug, Clone, Copy)]
pub struct Simulation<'a> {
    model: &'a MeasurementModel,
    truth: &'a [f64],
    equipment: &'a Equipment,
    seed: u64,
    /// Duration of each plateau, where it is not the machine's or the hand's [s].
    durations: &'a [Option<f64>],
}

/// Rests of a simulated session in attitudes of their own, in one record.
#[derive(Debug, Clone)]
pub struct SimulatedTumble<'a> {
    simulation: Simulation<'a>,
    /// The first mounting, which names its random draws.
    first: usize,
    motion: HandMotion,
}

/// One mounting of a simulated session.
#[derive(Debug, Clone)]
pub struct SimulatedMounting<'a> {
    simulation: Simulation<'a>,
    mounting: usize,
    motion: Motion,
}

impl<'a> Simulation<'a> {
    /// A session of `model`'s experiment with the unknowns at `truth` (in the order of the model's parameters).
    ///
    /// # Errors
    /// [`SimulationError`] when `truth` does not fit this model, or a setting of the equipment is out of its bounds.
    pub fn new(
        model: &'a MeasurementModel,
        truth: &'a [f64],
        equipment: &'a Equipment,
        seed: u64,
    ) -> Result<Self, SimulationError> {
        equipment.check()?;
        let parameters = model.parameters();
        if truth.len() != parameters.len() {
            return Err(SimulationError::TruthLength { found: truth.len(), expected: parameters.len() });
        }
        if let Some(j) = truth.iter().position(|value| !value.is_finite()) {
            return Err(SimulationError::Truth { name: parameters[j].name.clone(), found: truth[j] });
        }
        let simulation = Self { model, truth, equipment, seed, durations: &[] };
        simulation.check_readings()?;
        simulation.check_samples()?;
        Ok(simulation)
    }

    /// The session with a duration for every set point [s]; `None` for [`Machine::plateau`] or [`Hand::rest`].
    ///
    /// # Errors
    /// [`SimulationError`] when their number differs from that of the set points, or one of them is not positive.
    pub fn with_durations(self, durations: &'a [Option<f64>]) -> Result<Self, SimulationError> {
        let expected = self.model.experiment().set_points.len();
        if durations.len() != expected {
            return Err(SimulationError::Durations { found: durations.len(), expected });
        }
        for plateau in durations.iter().flatten().copied() {
            Equipment { machine: Machine { plateau, ..self.equipment.machine }, ..*self.equipment }.check()?;
        }
        let simulation = Self { durations, ..self };
        simulation.check_samples()?;
        Ok(simulation)
    }

    /// Whether every plateau reads what can be recorded.
    fn check_readings(&self) -> Result<(), SimulationError> {
        for set_point in &self.model.experiment().set_points {
            let motion = ArmMotion { angle: set_point.angle, speed: set_point.omega, acceleration: 0.0 };
            let reading = Physics::new(self.model, self.truth, set_point.mounting).reading(&motion);
            if let Some(&found) = reading.iter().find(|f| !f.is_finite() || f.abs() >= LARGEST_READING) {
                return Err(SimulationError::Reading { mounting: set_point.mounting + 1, found });
            }
        }
        Ok(())
    }

    /// Whether every plateau has samples, and the session not more than can be written.
    fn check_samples(&self) -> Result<(), SimulationError> {
        let Equipment { machine, recorder, tachometer, hand, .. } = self.equipment;
        let set_points = self.model.experiment().set_points.len();
        let shortest = (0..set_points).map(|n| self.duration(n)).fold(f64::INFINITY, f64::min) * recorder.rate;
        if shortest < 2.0 {
            let (of, expected) = ("in a plateau", "two or more");
            return Err(SimulationError::Samples { setting: "recorder.rate", found: shortest, of, expected });
        }
        let on_the_way = (machine.plateau_spread + machine.ramp).max(hand.rest_spread + hand.turn + hand.turn_spread);
        let of_plateau = |n: usize| self.duration(n) + on_the_way;
        let all: f64 = (0..set_points).map(of_plateau).sum();
        let (samples, reports) = (all * recorder.rate, all * tachometer.rate);
        if samples > MOST_SAMPLES {
            let (of, expected) = ("in all records", "1e9 at most");
            return Err(SimulationError::Samples { setting: "recorder.rate", found: samples, of, expected });
        }
        if reports > MOST_REPORTS {
            let (of, expected) = ("of telemetry", "1e7 at most");
            return Err(SimulationError::Samples { setting: "tachometer.rate", found: reports, of, expected });
        }
        Ok(())
    }

    /// Least duration of plateau `n` [s].
    fn duration(&self, n: usize) -> f64 {
        let experiment = self.model.experiment();
        let is_on_arm = experiment.is_on_arm(experiment.set_points[n].mounting);
        let usual = if is_on_arm { self.equipment.machine.plateau } else { self.equipment.hand.rest };
        self.durations.get(n).copied().flatten().unwrap_or(usual)
    }

    /// The plateaus of a mounting with their least durations [s].
    fn schedule(&self, mounting: usize) -> Vec<(SetPoint, f64)> {
        let visited = self.model.experiment().set_points.iter().enumerate().filter(|(_, s)| s.mounting == mounting);
        visited.map(|(n, set_point)| (*set_point, self.duration(n))).collect()
    }

    /// The rests in attitudes of their own that are `mountings` of the experiment, as they follow each other in one record.
    pub fn tumble(&self, mountings: Range<usize>) -> SimulatedTumble<'a> {
        let first = mountings.start;
        let held = |mounting: usize| {
            let change = self.bias_change(mounting);
            let physics = Physics::new(self.model, self.truth, mounting);
            self.schedule(mounting).into_iter().map(move |(_, duration)| {
                let (force, disturbance) = physics.at_rest();
                Held { duration, force, disturbance: disturbance + change }
            })
        };
        let rests: Vec<Held> = mountings.flat_map(held).collect();
        let motion = HandMotion::new(&rests, &self.equipment.hand, self.seed, first);
        SimulatedTumble { simulation: *self, first, motion }
    }

    /// Change of each bias from the reference, the switch-on of the arm or else of the first rest, to that of a mounting [m/s^2].
    pub fn bias_change(&self, mounting: usize) -> Vector3<f64> {
        let experiment = self.model.experiment();
        let number = experiment.positions[experiment.mountings[mounting].position].switch_on.number;
        let other = experiment.other_switch_ons().into_iter().find(|other| other.number == number);
        let size = other.map_or(0.0, |other| other.bias_change.unwrap_or(self.equipment.hand.bias_change));
        let mut random = Draw::Rests.stream_of(self.seed, number, CHANGE);
        Vector3::from_fn(|_, _| size * random.normal())
    }

    /// One mounting, by its index in the experiment.
    pub fn mounting(&self, mounting: usize) -> SimulatedMounting<'a> {
        let schedule = self.schedule(mounting);
        let random = Draw::Motion.stream(self.seed, mounting);
        let motion = Motion::new(&schedule, &self.equipment.machine, random);
        SimulatedMounting { simulation: *self, mounting, motion }
    }
}

impl SimulatedMounting<'_> {
    /// The plateaus in the order of the schedule: beginning and end, between ramps, the unit's clock [s]; speed once settled [rad/s].
    pub fn plateaus(&self) -> Vec<([f64; 2], f64)> {
        self.motion.plateaus()
    }

    /// Length of the record [s].
    pub fn duration(&self) -> f64 {
        self.motion.duration()
    }

    /// The record, a stretch of it at a time.
    pub fn records(&self) -> Records<'_> {
        let Simulation { model, truth, equipment, seed, .. } = self.simulation;
        let (interval, duration) = (1.0 / equipment.recorder.rate, self.duration());
        let sampling = Sampling { seed, mounting: self.mounting, interval, duration };
        let physics = Physics::new(model, truth, self.mounting);
        Records::new(Signal::Arm { physics, motion: &self.motion, segment: 0 }, equipment, &sampling)
    }

    /// The centrifuge's clock less the unit's as the record begins [s], and its rate against the unit's, less 1.
    pub fn clock(&self) -> [f64; 2] {
        telemetry::clock(&self.simulation.equipment.tachometer, self.simulation.seed, self.mounting)
    }

    /// The centrifuge's telemetry by that clock.
    pub fn telemetry(&self) -> SpeedTrace {
        telemetry::telemetry(&self.motion, &self.simulation.equipment.tachometer, self.simulation.seed, self.mounting)
    }

    /// Times of the counter's pulses [s], by the telemetry's clock as the record begins.
    pub fn pulses(&self) -> Vec<f64> {
        let Simulation { equipment, seed, .. } = self.simulation;
        telemetry::pulses(&self.motion, &equipment.counter, self.clock()[0], seed, self.mounting)
    }
}

impl SimulatedTumble<'_> {
    /// The rests in their order: beginning and end, between turns, the unit's clock [s]; where up is, instrument axes, of length 1.
    pub fn rests(&self) -> Vec<([f64; 2], Vector3<f64>)> {
        self.motion.rests().collect()
    }

    /// The record, a stretch of it at a time.
    pub fn records(&self) -> Records<'_> {
        let Simulation { model, truth, equipment, seed, .. } = self.simulation;
        let interval = 1.0 / equipment.recorder.rate;
        let sampling = Sampling { seed, mounting: self.first, interval, duration: self.motion.duration() };
        let response = Response::new(model.error_model(), model.parameters().coefficients(truth));
        let felt = Felt::new(&self.motion, &equipment.hand, interval, seed, self.first);
        Records::new(Signal::Hand { response, felt }, equipment, &sampling)
    }
}

/// Streams of the attitudes of rests.
const ERRORS: usize = 0;
const ATTITUDES: usize = 1;
const CHANGE: usize = 2;

impl Simulation<'_> {
    /// Unknowns drawn from a normal law of `size` times the typical magnitude of each; attitudes of rests that are known from one of
    /// their stated uncertainty. Rests leave the draws of the unit and the arm as they are.
    pub fn draw_truth(model: &MeasurementModel, size: f64, seed: u64) -> Vec<f64> {
        let (mut random, mut of_rests) = (Draw::Truth.stream(seed, 0), Draw::Rests.stream_of(seed, 0, ERRORS));
        let mut drawn = |parameter: &Parameter| match parameter.kind {
            Kind::Attitude { position, .. } => {
                let known = model.experiment().positions[position].attitude_uncertainty;
                known.unwrap_or(size * parameter.typical) * of_rests.normal()
            }
            Kind::CaseTurn(_) => size * parameter.typical * of_rests.normal(),
            Kind::Tilt(_)
            | Kind::Turn { .. }
            | Kind::Shift { .. }
            | Kind::ProofMass(_)
            | Kind::Term(_)
            | Kind::Effect(_) => size * parameter.typical * random.normal(),
        };
        model.parameters().iter().map(&mut drawn).collect()
    }

    /// Directions of up in `count` attitudes, instrument axes: all directions are as likely. `number` counts the tumbles of a session.
    pub fn draw_attitudes(count: usize, seed: u64, number: usize) -> Vec<Vector3<f64>> {
        let mut random = Draw::Rests.stream_of(seed, number, ATTITUDES);
        (0..count).map(|_| Vector3::from_fn(|_, _| random.normal()).normalize()).collect()
    }
}
