//! `truth.json`: what was simulated, schema `centrical-truth/1`.

use centrical::simulate::{Counter, Equipment, Hand, Tachometer, TruePlateau, TrueRest};
use centrical::{Kind, Parameter, SetPoint};
use nalgebra::Vector3;
use serde_json::{Value, json};

use super::result::Program;
use crate::experiment::Session;
use crate::truth::Truth;

/// Name of the schema's present version.
const SCHEMA: &str = "centrical-truth/1";

/// A mounting as it was simulated and written.
#[derive(Debug)]
pub(crate) struct Written {
    pub plateaus: Vec<TruePlateau>,
    pub clock_offset: f64,
    pub clock_drift: f64,
}

/// A session as it was simulated and written.
#[derive(Debug)]
pub(crate) struct WrittenSession {
    pub mountings: Vec<Written>,
    /// Each `[[tumble]]`.
    pub tumbles: Vec<WrittenTumble>,
}

/// A `[[tumble]]` as it was simulated and written.
#[derive(Debug)]
pub(crate) struct WrittenTumble {
    pub rests: Vec<TrueRest>,
    /// Change of each bias from the switch-on of the arm, or of the first tumble, to that of its rests [m/s^2].
    pub bias_change: Vector3<f64>,
}

/// The truth as JSON text. Attitudes of rests are with the rests: a calibration counts them from other nominal ones.
pub(crate) fn truth_json(truth: &Truth, seed: u64, written: &WrittenSession) -> String {
    let WrittenSession { mountings, tumbles } = written;
    let parameters = truth.model.parameters().iter().zip(&truth.values);
    let is_of_rest = |p: &Parameter| matches!(p.kind, Kind::Attitude { .. });
    let parameters: Vec<Value> = parameters
        .filter(|(p, _)| !is_of_rest(p))
        .map(|(p, value)| json!({"name": p.name, "value": value, "unit": p.unit}))
        .collect();
    let clocks: Vec<Value> = (1..)
        .zip(mountings)
        .map(|(m, w)| json!({"mounting": m, "offset": w.clock_offset, "drift": w.clock_drift}))
        .collect();
    let plateaus: Vec<Value> =
        mountings.iter().enumerate().flat_map(|(m, written)| plateaus_of(&truth.plan, m, &written.plateaus)).collect();
    let mut whole = json!({
        "schema": SCHEMA,
        "program": Program::this(),
        "seed": seed,
        "parameters": parameters,
        "settings": equipment(&truth.equipment),
        "telemetry_clocks": clocks,
        "plateaus": plateaus,
    });
    if !tumbles.is_empty() {
        whole["settings"]["hand"] = hand(&truth.equipment.hand);
        whole["rests"] = tumbles.iter().enumerate().flat_map(|(n, tumble)| rests_of(n, &tumble.rests)).collect();
        let tumble =
            |(n, tumble): (usize, &WrittenTumble)| json!({"tumble": n, "bias_change": tumble.bias_change.as_slice()});
        whole["tumbles"] = (1..).zip(tumbles).map(tumble).collect();
    }
    format!("{whole:#}\n")
}

/// The rests of `[[tumble]]` number `n` from 0: tumble from 1, index from 0, up in instrument axes.
fn rests_of(n: usize, rests: &[TrueRest]) -> Vec<Value> {
    let rest = |(index, TrueRest { window, up_z }): (usize, &TrueRest)| json!({"tumble": n + 1, "index": index, "up": up_z.as_slice(), "window": window});
    rests.iter().enumerate().map(rest).collect()
}

/// What turns the unit, under the names that a truth file gives it, SI.
fn hand(hand: &Hand) -> Value {
    json!({
        "rest": hand.rest, "rest_spread": hand.rest_spread, "turn": hand.turn, "turn_spread": hand.turn_spread,
        "shake": hand.shake, "tremor": {"deviation": hand.tremor.deviation, "time": hand.tremor.time},
        "bumps": {"probability": hand.bumps.probability, "size": hand.bumps.size}, "bias_change": hand.bias_change,
    })
}

/// The plateaus of mounting `m`, named as in `result.json`: mounting from 1, index from 0.
fn plateaus_of(plan: &Session, m: usize, plateaus: &[TruePlateau]) -> Vec<Value> {
    let schedule = plan.experiment.set_points.iter().filter(|s| s.mounting == m);
    let plateau = |(index, (set_point, plateau)): (usize, (&SetPoint, &TruePlateau))| {
        let angle = set_point.is_rest().then_some(set_point.angle);
        let TruePlateau { window, omega } = plateau;
        json!({"mounting": m + 1, "index": index, "speed": omega, "angle": angle, "window": window})
    };
    schedule.zip(plateaus).enumerate().map(plateau).collect()
}

/// The equipment under the names that a truth file gives them, SI.
fn equipment(equipment: &Equipment) -> Value {
    let Equipment { machine, sensor, recorder, tachometer, counter, .. } = equipment;
    let mut settings = json!({
        "machine": {
            "plateau": machine.plateau, "plateau_spread": machine.plateau_spread, "ramp": machine.ramp,
            "speed_error": machine.speed_error, "settling": machine.settling, "settling_time": machine.settling_time,
        },
        "sensor": {
            "white": sensor.white,
            "coloured": {"deviation": sensor.coloured.deviation, "time": sensor.coloured.time},
            "bias_instability": sensor.bias_instability, "random_walk": sensor.random_walk, "drift": sensor.drift,
            "quantum": sensor.quantum, "range": sensor.range,
        },
        "recorder": {
            "rate": recorder.rate,
            "spikes": {"probability": recorder.spikes.probability, "size": recorder.spikes.size},
            "gaps": {"probability": recorder.gaps.probability, "length": recorder.gaps.length},
            "repeats": recorder.repeats,
        },
        "tachometer": {
            "rate": tachometer.rate, "clock_offset": tachometer.clock_offset, "clock_drift": tachometer.clock_drift,
            "noise": tachometer.noise, "quantum": tachometer.quantum,
        },
    });
    // Only what differs from equipment that measures no speed: a session without measured speeds keeps its bytes.
    let usual = Tachometer::default();
    if (tachometer.measures, tachometer.scale_error, tachometer.plateau_error)
        != (usual.measures, usual.scale_error, usual.plateau_error)
    {
        settings["tachometer"]["measures"] = tachometer.measures.into();
        settings["tachometer"]["scale_error"] = tachometer.scale_error.into();
        settings["tachometer"]["plateau_error"] = tachometer.plateau_error.into();
    }
    if *counter != Counter::default() {
        settings["counter"] = json!({
            "per_revolution": counter.per_revolution, "jitter": counter.jitter, "scale_error": counter.scale_error,
            "plateau_error": counter.plateau_error,
        });
    }
    settings
}
