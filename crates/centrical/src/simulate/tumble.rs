//! The motion of a unit that is turned in a hand or on a table and left alone again and again.
//!
//! At rest the specific force is gravity in the attitude of the rest. A hand trembles: the attitude moves, and the size of gravity
//! stays. From one attitude to the next the unit turns by the shortest way, about one axis and along `3 s^2 - 2 s^3`, and is
//! shaken meanwhile, most in the middle of the turn.

use nalgebra::{Rotation3, Unit, Vector3};

use super::draw::Draw;
use super::equipment::Hand;
use super::markov::Markov;
use crate::statistics::Random;

/// What acts in one rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    /// Least duration [s].
    pub duration: f64,
    /// Specific force [m/s^2].
    pub force: Vector3<f64>,
    /// What is added to the readings [m/s^2].
    pub disturbance: Vector3<f64>,
}

/// The motion of the unit from the beginning of a record to its end.
#[derive(Debug, Clone)]
pub(super) struct HandMotion {
    stages: Vec<Stage>,
    duration: f64,
}

/// A rest or a turn.
#[derive(Debug, Clone, Copy)]
struct Stage {
    /// Begin [s].
    start: f64,
    /// Duration [s].
    duration: f64,
    /// Specific force as it begins [m/s^2].
    force: Vector3<f64>,
    /// Turn of the force by its end, instrument axes [rad]; `None` at rest.
    turn: Option<Vector3<f64>>,
    /// What is added to the readings [m/s^2].
    disturbance: Vector3<f64>,
    /// When the unit is bumped, since the start [s].
    bump: Option<f64>,
}

/// How long a bump acts [s].
const BUMP: f64 = 0.05;

impl HandMotion {
    /// The motion through `rests` in their order. Random parts of durations and bumps are drawn from the streams of `number`.
    pub fn new(rests: &[Held], hand: &Hand, seed: u64, number: usize) -> Self {
        let mut lengths = Draw::Hand.stream_of(seed, number, LENGTHS);
        let mut bumps = Draw::Hand.stream_of(seed, number, BUMPS);
        let mut motion = Self { stages: Vec::with_capacity(2 * rests.len()), duration: 0.0 };
        for (k, held) in rests.iter().enumerate() {
            let still = Stage {
                start: 0.0,
                duration: held.duration + hand.rest_spread * lengths.uniform(),
                force: held.force,
                turn: None,
                disturbance: held.disturbance,
                bump: None,
            };
            let turn = hand.turn + hand.turn_spread * lengths.uniform();
            if let Some(before) = k.checked_sub(1).map(|before| rests[before].force) {
                let by = shortest(&before, &held.force);
                motion.add(Stage { duration: turn, force: before, turn: Some(by), ..still });
            }
            let (chance, when) = (bumps.uniform(), bumps.uniform());
            let bump = (chance < hand.bumps.probability).then_some(when * still.duration);
            motion.add(Stage { bump, ..still });
        }
        motion
    }

    fn add(&mut self, stage: Stage) {
        self.stages.push(Stage { start: self.duration, ..stage });
        self.duration += stage.duration;
    }

    /// Length of the record [s].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Window and direction of up of each rest.
    pub fn rests(&self) -> impl Iterator<Item = ([f64; 2], Vector3<f64>)> {
        let still = self.stages.iter().filter(|stage| stage.turn.is_none());
        still.map(|s| ([s.start, s.start + s.duration], s.force.normalize()))
    }
}

/// The smallest rotation vector that takes the direction of `from` to that of `to`.
fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let half_turn = || {
        // Opposite directions: half a turn about any axis across them.
        let across = from.cross(&Vector3::ith(from.iamin(), 1.0));
        Rotation3::from_axis_angle(&Unit::new_normalize(across), std::f64::consts::PI)
    };
    Rotation3::rotation_between(from, to).unwrap_or_else(half_turn).scaled_axis()
}

/// Streams of a hand; the last two have one for each instrument axis.
const LENGTHS: usize = 0;
const BUMPS: usize = 1;
const BUMPED: usize = 2;
const TREMOR: usize = 4;
const SHAKE: usize = 8;

/// What a unit in a hand feels, sample after sample.
#[derive(Debug, Clone)]
pub(super) struct Felt<'a> {
    motion: &'a HandMotion,
    stage: usize,
    /// Tilt of the attitude about the three instrument axes [rad].
    tremor: [Markov; 3],
    /// Acceleration in the middle of a turn [m/s^2].
    shake: [Markov; 3],
    bump: f64,
    bumped: Random,
}

impl<'a> Felt<'a> {
    /// `interval`: of the samples [s].
    pub fn new(motion: &'a HandMotion, hand: &Hand, interval: f64, seed: u64, number: usize) -> Self {
        /// Correlation time of what shakes a unit that is turned [s].
        const SHAKING: f64 = 0.1;
        let random = |stream: usize| Draw::Hand.stream_of(seed, number, stream);
        let tremor = |axis| Markov::new(hand.tremor.deviation, interval / hand.tremor.time, random(TREMOR + axis));
        let shake = |axis| Markov::new(hand.shake, interval / SHAKING, random(SHAKE + axis));
        Self {
            motion,
            stage: 0,
            tremor: [0, 1, 2].map(tremor),
            shake: [0, 1, 2].map(shake),
            bump: hand.bumps.size,
            bumped: random(BUMPED),
        }
    }

    /// Specific force at time `t` [m/s^2], and what is added to the readings; `t` ascends from call to call.
    pub fn at(&mut self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        while self.motion.stages.get(self.stage + 1).is_some_and(|next| next.start <= t) {
            self.stage += 1;
        }
        let tremor = Vector3::from(self.tremor.each_mut().map(Markov::next));
        let shake = Vector3::from(self.shake.each_mut().map(Markov::next));
        let Some(stage) = self.motion.stages.get(self.stage) else { return (Vector3::zeros(), Vector3::zeros()) };
        let since = t - stage.start;
        let s = (since / stage.duration).min(1.0);
        let attitude = stage
            .turn
            .map_or(stage.force, |turn| Rotation3::from_scaled_axis(turn * (s * s * (3.0 - 2.0 * s))) * stage.force);
        let mut force = Rotation3::from_scaled_axis(tremor) * attitude;
        if stage.turn.is_some() {
            force += shake * (std::f64::consts::PI * s).sin();
        }
        if stage.bump.is_some_and(|bump| (bump..bump + BUMP).contains(&since)) {
            force += Vector3::from_fn(|_, _| self.bump * self.bumped.normal());
        }
        (force, stage.disturbance)
    }
}
