//! Measured speeds: as accurate as they say, contradicted only by what contradicts them, and worth what is predicted.

use centrical::ThirdPosition;
use centrical::plan::{Noise, Prediction};
use centrical::reduction::{Located, MeasuredSpeed, PulseTrain, Record, ReducedMounting, ScheduledPlateau, Survey};
use centrical::simulate::{Counter, Equipment, Machine, Recorder, Sensor, Simulation, Tachometer};
use centrical::uncertainty::{Extent, Level, ShownSpeed, StatedSpeeds};
use centrical::{Calibration, Data, Experiment, MeasurementModel, Observation, PairRelation, SetPoint, Weight};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::common::{Random, experiment, kozlov, truth};

/// Relative standard deviation of a plateau's speed.
const SPEED_ERROR: f64 = 1e-5;

fn equipment(tachometer: Tachometer, counter: Counter) -> Equipment {
    Equipment {
        machine: Machine { speed_error: SPEED_ERROR, settling: 1e-3, plateau_spread: 1.0, ..Machine::default() },
        sensor: Sensor { white: 2e-3, ..Sensor::default() },
        recorder: Recorder { rate: 100.0, ..Recorder::default() },
        tachometer,
        counter,
        ..Equipment::default()
    }
}

/// Every plateau that spins: speed that was set, true speed, speed as measured, in a few mountings.
fn measured(
    model: &MeasurementModel,
    equipment: &Equipment,
    mountings: usize,
    seed: u64,
    is_counted: bool,
) -> Vec<(f64, f64, Option<MeasuredSpeed>)> {
    let values = Simulation::draw_truth(model, 1.0, seed);
    let simulation = Simulation::new(model, &values, equipment, seed).unwrap();
    let (mut set, mut of_truth, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for m in 0..mountings {
        let mounting = simulation.mounting(m);
        let reduced = reduced(model, &simulation, m, is_counted.then_some(equipment.counter.per_revolution));
        let set_points = model.experiment().set_points.iter().filter(|s| s.mounting == m);
        set.extend(set_points.map(|s| s.omega));
        of_truth.extend(mounting.plateaus().iter().map(|(_, omega)| omega.abs()));
        all.push(reduced);
    }
    let speeds = MeasuredSpeed::of_all(&set, &all);
    let all = set.into_iter().zip(of_truth).zip(speeds).map(|((set, truth), speed)| (set, truth, speed));
    all.filter(|(set, ..)| *set != 0.0).collect()
}

/// The record of a mounting, and its plateaus in it.
fn located(model: &MeasurementModel, simulation: &Simulation, m: usize) -> (Record, Located) {
    let record = simulation.mounting(m).records().fold(Record::default(), |mut whole, stretch| {
        whole.t.extend(stretch.t);
        whole.f_z.iter_mut().zip(stretch.f_z).for_each(|(column, values)| column.extend(values));
        whole
    });
    let schedule = ScheduledPlateau::of_mounting(model.experiment(), m);
    let located = Survey::of(record.as_slice()).unwrap().locate(&schedule).unwrap();
    (record, located)
}

fn reduced(model: &MeasurementModel, simulation: &Simulation, m: usize, counted: Option<f64>) -> ReducedMounting {
    let (record, mut located) = located(model, simulation, m);
    match counted {
        Some(per_revolution) => {
            located.time_pulses(&PulseTrain { t: simulation.mounting(m).pulses(), per_revolution });
        }
        None => located.time_telemetry(&simulation.mounting(m).telemetry()),
    }
    located.averaged(record.as_slice()).unwrap()
}

/// Pulses that are not of the record show no speed, and telemetry beside them does not stand in for them.
#[test]
fn pulses_of_another_record_leave_no_speeds() {
    let model = kozlov(experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let tachometer = Tachometer { noise: 2e-3, measures: true, ..Tachometer::default() };
    let equipment = equipment(tachometer, Counter::default());
    let values = Simulation::draw_truth(&model, 1.0, 1);
    let simulation = Simulation::new(&model, &values, &equipment, 1).unwrap();
    let (record, mut located) = located(&model, &simulation, 0);
    let shown = |located: &Located| {
        let reduced = located.clone().averaged(record.as_slice()).unwrap();
        let set: Vec<f64> = model.experiment().set_points.iter().map(|s| s.omega).collect();
        MeasuredSpeed::of_all(&set, &[reduced]).iter().flatten().count()
    };
    located.time_telemetry(&simulation.mounting(0).telemetry());
    assert_eq!(shown(&located), 7);
    let t = simulation.mounting(0).pulses().iter().map(|t| 3.0 * t).collect();
    located.time_pulses(&PulseTrain { t, per_revolution: equipment.counter.per_revolution });
    assert_eq!(shown(&located), 0);
}

/// Mean square of errors over their stated uncertainty, `beyond` what the scatter shows, and the median uncertainty.
fn squared(speeds: &[(f64, f64, Option<MeasuredSpeed>)], beyond: f64) -> (f64, f64) {
    let all: Vec<(f64, f64)> = speeds
        .iter()
        .map(|(_, truth, speed)| {
            let speed = speed.expect("every plateau has a speed");
            let u = speed.uncertainty.hypot(beyond);
            ((speed.speed / truth - 1.0) / u, u)
        })
        .collect();
    let mut sizes: Vec<f64> = all.iter().map(|(_, u)| *u).collect();
    sizes.sort_by(f64::total_cmp);
    (all.iter().map(|(z, _)| z * z).sum::<f64>() / all.len() as f64, sizes[sizes.len() / 2])
}

/// 56 plateaus of eight mountings: the mean square of a normal deviate scatters by sqrt(2 / 56) = 0.19; four of them. The scatter
/// of eight plateaus of one speed has a hundred degrees of freedom.
#[test]
fn a_measured_speed_is_as_accurate_as_it_says() {
    let model = kozlov(experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]));
    let tachometer =
        Tachometer { noise: 2e-3, clock_offset: 1.0, clock_drift: 1e-6, measures: true, ..Tachometer::default() };
    let telemetry = measured(&model, &equipment(tachometer, Counter::default()), 8, 1, false);
    let (square, u) = squared(&telemetry, 0.0);
    println!("telemetry: {} plateaus, squared error {square:.2}, u {u:.1e}", telemetry.len());
    assert!((square - 1.0).abs() < 0.8 && (2e-6..3e-5).contains(&u), "{square}, {u}");
    // Times of one pulse a revolution to 10 us: 1e-6 to 1e-7 of the speed.
    let tachometer = Tachometer { clock_offset: 1.0, ..Tachometer::default() };
    let counter = Counter { jitter: 1e-5, ..Counter::default() };
    let pulses = measured(&model, &equipment(tachometer, counter), 8, 2, true);
    let (square, u) = squared(&pulses, 0.0);
    println!("pulses: squared error {square:.2}, u {u:.1e}");
    assert!((square - 1.0).abs() < 0.8 && (1e-7..1e-6).contains(&u), "{square}, {u}");
    // An error of each plateau that no scatter shows is what the laboratory states.
    let counter = Counter { jitter: 1e-6, plateau_error: 1e-6, ..Counter::default() };
    let (square, _) = squared(&measured(&model, &equipment(tachometer, counter), 8, 3, true), 1e-6);
    println!("pulses with errors of plateaus: squared error {square:.2}");
    assert!((square - 1.0).abs() < 0.8, "{square}");
}

/// Both senses of rotation in one mounting: all plateaus are found, and their speeds measured.
#[test]
fn both_senses_of_rotation_in_one_mounting() {
    let mut both = experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0]);
    let speeds = [14.0, -14.0, 28.0, 56.0, -56.0, -28.0];
    both.set_points = (0..both.mountings.len())
        .flat_map(|m| {
            let rest = SetPoint::at_rest(m, 0.0);
            std::iter::once(rest).chain(speeds.map(|omega| SetPoint::spinning(m, omega)))
        })
        .collect();
    let model = kozlov(both);
    let tachometer = Tachometer { noise: 1e-3, measures: true, ..Tachometer::default() };
    let found = measured(&model, &equipment(tachometer, Counter::default()), 4, 5, false);
    assert_eq!(found.len(), 24);
    let (square, _) = squared(&found, 0.0);
    // 24 plateaus: 0.29; four of them.
    assert!((square - 1.0).abs() < 1.2, "{square}");
}

/// A telemetry of 84 plateaus, twelve mountings of seven speeds, `off` by a relative difference.
fn telemetry(random: &mut Random, off: impl Fn(usize, f64) -> f64) -> Vec<ShownSpeed> {
    let speeds = [14.0, 20.0, 28.0, 40.0, 48.0, 56.0, 62.0];
    (0..84)
        .map(|n| {
            let (mounting, set) = (n / 7, speeds[n % 7]);
            let noise = 1e-5;
            let error = SPEED_ERROR * random.normal() + noise * random.normal() + off(mounting, set);
            let speed = set * (1.0 + error);
            let (uncertainty, degrees_of_freedom) = (noise, 168);
            let shown = MeasuredSpeed { speed, uncertainty, degrees_of_freedom, step_uncertainty: 0.0, slope: None };
            ShownSpeed { set_point: n, mounting, set, shown }
        })
        .collect()
}

const STATED: StatedSpeeds = StatedSpeeds { plateau: SPEED_ERROR, scale: SPEED_ERROR };

/// 2000 sound sessions, the scale of the tachometer drawn as it is taken to be: at most 5 % are reported, which scatters by
/// 0.5 %, and at most 1 in 10,000 refused.
#[test]
fn sound_telemetry_contradicts_nothing() {
    let mut random = Random::new(11);
    let (mut reported, mut refused) = (0, 0);
    for _ in 0..2000 {
        let scale = SPEED_ERROR * random.normal();
        let found = STATED.contradictions(&telemetry(&mut random, |_, _| scale));
        reported += usize::from(!found.is_empty());
        refused += usize::from(found.iter().any(|c| Level::Objection.is_passed_by(c.probability)));
    }
    println!("reported {reported}, refused {refused} of 2000");
    assert!(reported <= 130, "{reported} of 2000 reported");
    assert!(refused <= 1, "{refused} of 2000 refused");
}

#[test]
fn what_contradicts_the_schedule_is_named() {
    let mut random = Random::new(12);
    let mut found = |off: &dyn Fn(usize, f64) -> f64| {
        let found = STATED.contradictions(&telemetry(&mut random, off));
        assert!(found.iter().all(|c| Level::Objection.is_passed_by(c.probability)), "{found:?}");
        found.into_iter().map(|c| (c.extent, c.set_points.len(), c.difference)).collect::<Vec<_>>()
    };
    let all = found(&|_, _| 1e-3);
    assert!(matches!(all[..], [(Extent::All, 84, d)] if (d - 1e-3).abs() < 1e-5), "{all:?}");
    let unit = found(&|_, _| 60.0 / std::f64::consts::TAU - 1.0);
    assert!(matches!(unit[..], [(Extent::All, 84, _)]), "{unit:?}");
    let mountings = found(&|m, _| if m == 3 || m == 7 { -1e-3 } else { 0.0 });
    assert!(matches!(&mountings[..], [(Extent::Mountings(m), 14, _)] if m[..] == [3, 7]), "{mountings:?}");
    let speed = found(&|_, set| if set == 40.0 { 1e-3 } else { 0.0 });
    assert!(matches!(&speed[..], [(Extent::Speeds(s), 12, _)] if s[..] == [40.0]), "{speed:?}");
    let plateau = found(&|m, set| if m == 5 && set == 40.0 { 1e-3 } else { 0.0 });
    assert!(matches!(plateau[..], [(Extent::Plateaus, 1, _)]), "{plateau:?}");
}

/// [K5.5] with seven levels of speed to 20 Omega*^2, rest among them, arm 0.5 m, 20 ug/sqrt(Hz) over 60 s: uncertainty of a
/// compensated reading over all directions, as `observe` prints it for plateau speeds to 10, 3 and 1 ppm.
#[test]
fn measured_speeds_are_worth_what_is_predicted() {
    for (uncertainty, expected) in [(1e-5, 814.0), (3e-6, 268.0), (1e-6, 116.0)] {
        let mut normalised = experiment_of_seven_speeds();
        normalised.set_points.iter_mut().for_each(|s| s.speed_uncertainty = Some(uncertainty));
        let found = predicted(&kozlov(normalised));
        println!("{uncertainty:e}: {found:.1} ug");
        // To the digits printed.
        assert!((found - expected).abs() < 0.6, "{uncertainty}: {found}");
    }
}

fn experiment_of_seven_speeds() -> Experiment {
    let mut experiment = centrical::plan::Normalised {
        pair_relation: PairRelation::Common,
        rho: Matrix3::from_columns(&[
            Vector3::zeros(),
            Vector3::new(0.05, 0.03, 0.02),
            Vector3::new(0.04, -0.02, -0.03),
        ]),
        levels: vec![0.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0],
        arm: 0.5,
        ..centrical::plan::Normalised::default()
    }
    .experiment();
    experiment.centrifuge.speed_uncertainty = SPEED_ERROR;
    experiment
}

fn weights(model: &MeasurementModel) -> Vec<Weight> {
    let noise = Noise { density: 20e-6 * centrical::STANDARD_GRAVITY, floor: 0.0 };
    (0..model.experiment().set_points.len()).map(|n| noise.weight(n, 60.0)).collect()
}

/// Uncertainty of a compensated reading over the forces of the experiment [ug].
fn predicted(model: &MeasurementModel) -> f64 {
    let set_points = &model.experiment().set_points;
    let force = set_points.iter().map(|s| model.experiment().nominal(s).norm()).fold(0.0, f64::max);
    let zero = vec![0.0; model.parameters().len()];
    let prediction = Prediction::of(model, &weights(model), &zero).unwrap();
    prediction.reading(force).unwrap()[0] / (1e-6 * centrical::STANDARD_GRAVITY)
}

/// 200 sessions of speeds that err by 10 ppm and are measured to 1 ppm. The squared error of 49 parameters over their stated
/// covariance scatters by sqrt(2 / 49 / 200) = 1.4 %. The stated uncertainty is the predicted one, 116 and not 814 ug.
#[test]
fn the_error_with_measured_speeds_is_as_stated() {
    const MEASURED: f64 = 1e-6;
    let nominal = kozlov(experiment_of_seven_speeds());
    let n = nominal.parameters().len();
    let weights = weights(&nominal);
    let mut random = Random::new(13);
    let mut square = 0.0;
    let sessions = 200;
    for _ in 0..sessions {
        let x = truth(&nominal, 1.0, &mut random);
        let mut experiment = nominal.experiment().clone();
        let mut observations = Vec::new();
        for (weight, set_point) in weights.iter().zip(&mut experiment.set_points) {
            let of_truth = SetPoint { omega: set_point.omega * (1.0 + SPEED_ERROR * random.normal()), ..*set_point };
            let noise = weight.covariance[(0, 0)].sqrt();
            let noise = Vector3::from_fn(|_, _| noise * random.normal());
            let mean = nominal.reading(&of_truth, &x) + noise;
            observations.push(Observation { set_point: weight.set_point, mean, covariance: weight.covariance });
            set_point.omega = of_truth.omega * (1.0 + MEASURED * random.normal());
            set_point.speed_uncertainty = Some(MEASURED);
        }
        let model = nominal.in_experiment(experiment);
        let data = Data::new(&model, observations).unwrap();
        let calibration = Calibration::exact(&data).unwrap();
        let fit = calibration.fit();
        let u: Vec<f64> = (0..n).map(|j| fit.covariance(j, j).unwrap().sqrt()).collect();
        let error = DVector::from_fn(n, |j, _| (fit.value(j).unwrap() - x[j]) / u[j]);
        let correlation = DMatrix::from_fn(n, n, |i, j| fit.covariance(i, j).unwrap() / (u[i] * u[j]));
        square += error.dot(&correlation.cholesky().unwrap().solve(&error)) / (n * sessions) as f64;
    }
    println!("squared error over covariance {square:.3}");
    assert!((square - 1.0).abs() < 0.05, "{square}");
}
