//! `truth.json`: what was simulated, schema `centrical-truth/1`.

use centrical::simulate::{Counter, Equipment, Tachometer};
use centrical::{Kind, Parameter, SetPoint};
use nalgebra::Vector3;
use serde_json::{Value, json};

use super::result::Program;
use crate::experiment::Session;
use crate::truth::{Truth, settings};

/// Name of the schema's present version.
const SCHEMA: &str = "centrical-truth/1";

/// A mounting as it was simulated and written.
#[derive(Debug)]
pub(crate) struct Written {
    /// Window [s] and speed [rad/s].
    pub plateaus: Vec<([f64; 2], f64)>,
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
    /// Window [s] and direction of up, instrument axes.
    pub rests: Vec<([f64; 2], Vector3<f64>)>,
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
        "settings": equipment(&truth.equipment, !tumbles.is_empty()),
        "telemetry_clocks": clocks,
        "plateaus": plateaus,
    });
    if !tumbles.is_empty() {
        whole["rests"] = tumbles.iter().enumerate().flat_map(|(n, tumble)| rests_of(n, &tumble.rests)).collect();
        let tumble =
            |(n, tumble): (usize, &WrittenTumble)| json!({"tumble": n, "bias_change": tumble.bias_change.as_slice()});
        whole["tumbles"] = (1..).zip(tumbles).map(tumble).collect();
    }
    format!("{whole:#}\n")
}

/// The rests of `[[tumble]]` number `n` from 0: tumble from 1, index from 0, up in instrument axes.
fn rests_of(n: usize, rests: &[([f64; 2], Vector3<f64>)]) -> Vec<Value> {
    let rest = |(index, (window, up_z)): (usize, &([f64; 2], Vector3<f64>))| json!({"tumble": n + 1, "index": index, "up": up_z.as_slice(), "window": window});
    rests.iter().enumerate().map(rest).collect()
}

/// The plateaus of mounting `m`, named as in `result.json`: mounting from 1, index from 0.
fn plateaus_of(plan: &Session, m: usize, plateaus: &[([f64; 2], f64)]) -> Vec<Value> {
    let schedule = plan.experiment.set_points.iter().filter(|s| s.mounting == m);
    let plateau = |(index, (set_point, (window, omega))): (usize, (&SetPoint, &([f64; 2], f64)))| {
        let angle = set_point.is_rest().then_some(set_point.angle);
        json!({"mounting": m + 1, "index": index, "speed": omega, "angle": angle, "window": window})
    };
    schedule.zip(plateaus).enumerate().map(plateau).collect()
}

/// The equipment under the names that a truth file gives them, SI.
fn equipment(equipment: &Equipment, has_tumbles: bool) -> Value {
    let Equipment { tachometer, counter, .. } = equipment;
    let of_measured = ["tachometer.scale_error", "tachometer.plateau_error"];
    let mut written = Value::Null;
    let add = |written: &mut Value, is_added: &dyn Fn(&str) -> bool| {
        for (name, number) in settings(*equipment).filter(|(name, _)| is_added(name)) {
            *name.split('.').fold(&mut *written, |table, key| &mut table[key]) = number.into();
        }
    };
    let is_optional =
        |name: &str| name.starts_with("counter.") || name.starts_with("hand.") || of_measured.contains(&name);
    add(&mut written, &|name| !is_optional(name));
    // Only what differs from equipment that measures no speed: a session without measured speeds keeps its bytes.
    let usual = Tachometer::default();
    if (tachometer.measures, tachometer.scale_error, tachometer.plateau_error)
        != (usual.measures, usual.scale_error, usual.plateau_error)
    {
        written["tachometer"]["measures"] = tachometer.measures.into();
        add(&mut written, &|name| of_measured.contains(&name));
    }
    if *counter != Counter::default() {
        written["counter"]["per_revolution"] = counter.per_revolution.into();
        add(&mut written, &|name| name.starts_with("counter."));
    }
    if has_tumbles {
        add(&mut written, &|name| name.starts_with("hand."));
    }
    written
}
