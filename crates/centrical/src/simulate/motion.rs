//! The true motion of the arm through a mounting's schedule: plateaus, ramps between them, settling.
//!
//! Angle, speed and acceleration are closed forms within each segment, joined without a jump of angle or speed.

use std::f64::consts::{PI, TAU};

use super::draw::Draw;
use super::equipment::Machine;
use crate::model::{ArmMotion, SetPoint};
use crate::statistics::Random;
use crate::statistics::whole;

/// The motion of the arm from the beginning of a record to its end.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    segments: Vec<Segment>,
    duration: f64,
}

/// A stretch of one law.
#[derive(Debug, Clone, Copy)]
struct Segment {
    /// Begin [s].
    start: f64,
    /// Duration [s].
    duration: f64,
    /// Carousel angle as it begins [rad].
    angle: f64,
    law: Law,
    /// Relative speed error of the plateau, or of the one being reached.
    speed_error: f64,
}

#[derive(Debug, Clone, Copy)]
enum Law {
    /// `Omega + excess exp(-t / time)`.
    Plateau { omega: f64, excess: f64, time: f64 },
    /// From one speed to another along `3 s^2 - 2 s^3`, `s = t / duration`.
    Ramp { from: f64, to: f64 },
    /// From rest to rest by an angle, along the same cubic.
    Turn { by: f64 },
}

impl Motion {
    /// The motion through `schedule`, plateaus with their durations [s], their random parts and the speed errors drawn from
    /// `random`.
    pub fn new(schedule: &[(SetPoint, f64)], machine: &Machine, mut random: Random) -> Self {
        let first_angle = match schedule.first() {
            Some((first, _)) if first.is_rest() => first.angle,
            _ => TAU * random.uniform(),
        };
        let mut path = Path { machine, segments: Vec::with_capacity(2 * schedule.len()), end: 0.0, angle: first_angle };
        for (k, (set_point, plateau)) in schedule.iter().enumerate() {
            let duration = plateau + machine.plateau_spread * random.uniform();
            let speed_error = machine.speed_error * random.normal();
            if k > 0 {
                path.reach(set_point, speed_error);
            }
            path.hold(set_point, speed_error, duration);
        }
        Self { segments: path.segments, duration: path.end }
    }

    /// Angle and motion of the arm at time `t` [s]; `segment` is that of the time before, 0 at first.
    #[inline]
    pub fn at(&self, t: f64, segment: &mut usize) -> ArmMotion {
        while self.segments.get(*segment + 1).is_some_and(|next| next.start <= t) {
            *segment += 1;
        }
        let at_rest = ArmMotion { angle: 0.0, speed: 0.0, acceleration: 0.0 };
        self.segments.get(*segment).map_or(at_rest, |segment| segment.at(t))
    }

    /// The speed as the centrifuge believes it to be at time `t` [rad/s].
    pub fn believed_speed(&self, t: f64) -> f64 {
        self.segment(t).map_or(0.0, |segment| segment.at(t).speed / (1.0 + segment.speed_error))
    }

    /// The speed at time `t` [rad/s], and the number of its segment.
    pub fn true_speed(&self, t: f64) -> (f64, usize) {
        let segment = self.segments.partition_point(|segment| segment.start <= t).saturating_sub(1);
        (self.segments.get(segment).map_or(0.0, |segment| segment.at(t).speed), segment)
    }

    /// The relative error of a measured speed in each segment: of the standard deviation `deviation` on plateaus, one a
    /// plateau, and none between them.
    pub fn measured_errors(&self, deviation: f64, seed: u64, mounting: usize) -> Vec<f64> {
        let mut random = Draw::MeasuredSpeed.stream(seed, mounting);
        let error = |segment: &Segment| match segment.law {
            Law::Plateau { .. } => deviation * random.normal(),
            Law::Ramp { .. } | Law::Turn { .. } => 0.0,
        };
        self.segments.iter().map(error).collect()
    }

    /// Times since the start of a segment at which the arm passes a multiple of `step` [rad], and its duration [s].
    pub fn passages(&self, segment: usize, step: f64) -> (Vec<f64>, f64) {
        let Some(segment) = self.segments.get(segment) else { return (Vec::new(), 0.0) };
        let angle = |since: f64| segment.at(segment.start + since).angle;
        let [from, to] = [angle(0.0), angle(segment.duration)];
        let (low, high) = ((from.min(to) / step).ceil(), (from.max(to) / step).ceil());
        let count = whole((high - low).max(0.0));
        let rises = to > from;
        // The angle of a segment goes one way: bisection, to the last place of the time.
        let time = |k: usize| {
            let sought = (low + k as f64) * step;
            let (mut before, mut after) = (0.0, segment.duration);
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                if (angle(middle) < sought) == rises { before = middle } else { after = middle }
            }
            0.5 * (before + after)
        };
        ((0..count).map(time).collect(), segment.duration)
    }

    /// Length of the record [s].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Window and speed once settled of each plateau.
    pub fn plateaus(&self) -> Vec<([f64; 2], f64)> {
        let plateau = |segment: &Segment| match segment.law {
            Law::Plateau { omega, .. } => Some(([segment.start, segment.start + segment.duration], omega)),
            _ => None,
        };
        self.segments.iter().filter_map(plateau).collect()
    }

    fn segment(&self, t: f64) -> Option<&Segment> {
        let after = self.segments.partition_point(|segment| segment.start <= t);
        self.segments.get(after.saturating_sub(1))
    }
}

/// A motion as it grows.
struct Path<'a> {
    machine: &'a Machine,
    segments: Vec<Segment>,
    /// End of the last segment [s], and the angle at it [rad].
    end: f64,
    angle: f64,
}

impl Path<'_> {
    /// From the last plateau to the speed and, at rest, to the angle of the next.
    fn reach(&mut self, next: &SetPoint, speed_error: f64) {
        let from = self.segments.last().map_or(0.0, |last| last.at(self.end).speed);
        let duration = self.machine.ramp;
        if next.is_rest() && from == 0.0 {
            self.push(Law::Turn { by: half_turn_at_most(next.angle - self.angle) }, duration, speed_error);
        } else if next.is_rest() {
            self.stop_at(next.angle, speed_error);
        } else {
            let to = next.omega * (1.0 + speed_error) * (1.0 + self.machine.settling);
            self.push(Law::Ramp { from, to }, duration, speed_error);
        }
    }

    fn hold(&mut self, set_point: &SetPoint, speed_error: f64, duration: f64) {
        let omega = set_point.omega * (1.0 + speed_error);
        let law = Law::Plateau { omega, excess: omega * self.machine.settling, time: self.machine.settling_time };
        self.push(law, duration, speed_error);
    }

    /// Stays on the plateau up to a revolution longer, so that the ramp to rest ends at `angle`.
    fn stop_at(&mut self, angle: f64, speed_error: f64) {
        let Some(mut plateau) = self.segments.pop() else { return };
        let Law::Plateau { omega, .. } = plateau.law else { return };
        let mut wait = |by: f64| {
            plateau.duration += by / omega;
            self.end = plateau.start + plateau.duration;
            let speed = plateau.at(self.end).speed;
            self.angle = wrapped(plateau.at(self.end).angle);
            // A ramp along the cubic turns the arm by the mean of its speeds.
            angle - (self.angle + 0.5 * speed * self.machine.ramp)
        };
        let missing = wait(0.0);
        let mut missing = wait((missing * omega.signum()).rem_euclid(TAU) * omega.signum());
        // The remaining settling makes the first guess inexact; each round reduces the error by a large factor.
        for _ in 0..8 {
            missing = wait(half_turn_at_most(missing));
        }
        self.segments.push(plateau);
        let from = plateau.at(self.end).speed;
        self.push(Law::Ramp { from, to: 0.0 }, self.machine.ramp, speed_error);
        // To the last bit, so that errors of rounding do not gather.
        self.angle = wrapped(angle);
    }

    fn push(&mut self, law: Law, duration: f64, speed_error: f64) {
        let segment = Segment { start: self.end, duration, angle: self.angle, law, speed_error };
        self.end += duration;
        self.angle = wrapped(segment.at(self.end).angle);
        self.segments.push(segment);
    }
}

impl Segment {
    fn at(&self, t: f64) -> ArmMotion {
        let t = t - self.start;
        let motion = match self.law {
            Law::Plateau { omega, excess, time } => on_plateau(t, omega, excess, time),
            Law::Ramp { from, to } => {
                let (s, change) = (t / self.duration, to - from);
                let half_quartic = s * s * s * (1.0 - 0.5 * s);
                ArmMotion {
                    angle: from * t + change * self.duration * half_quartic,
                    speed: from + change * smooth(s),
                    acceleration: change * 6.0 * s * (1.0 - s) / self.duration,
                }
            }
            Law::Turn { by } => {
                let s = t / self.duration;
                ArmMotion {
                    angle: by * smooth(s),
                    speed: by * 6.0 * s * (1.0 - s) / self.duration,
                    acceleration: by * (6.0 - 12.0 * s) / (self.duration * self.duration),
                }
            }
        };
        ArmMotion { angle: self.angle + motion.angle, ..motion }
    }
}

fn on_plateau(t: f64, omega: f64, excess: f64, time: f64) -> ArmMotion {
    if excess == 0.0 {
        return ArmMotion { angle: omega * t, speed: omega, acceleration: 0.0 };
    }
    let left = excess * (-t / time).exp();
    ArmMotion { angle: omega * t + (excess - left) * time, speed: omega + left, acceleration: -left / time }
}

/// `3 s^2 - 2 s^3`.
fn smooth(s: f64) -> f64 {
    s * s * (3.0 - 2.0 * s)
}

/// The angle on [0, 2 pi).
fn wrapped(angle: f64) -> f64 {
    angle.rem_euclid(TAU)
}

/// The angle on (-pi, pi].
fn half_turn_at_most(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}
